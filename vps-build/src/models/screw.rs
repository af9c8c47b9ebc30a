//! Screw threads: bolts and nuts.

use std::f64::consts::{PI, TAU};

use glamx::DVec2;

use super::sweep::{at_angle, segments, swept, turn};
use crate::mesh::Mesh;

/// A round, right-handed thread around the z axis. Its radius varies like a cosine, and rises by
/// the pitch per counter-clockwise turn seen from +z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thread {
    /// Metres from the axis to the middle between root and crest; from 0.05 to 0.3.
    pub radius: f64,
    /// Metres along the axis per turn; from 0.02 to 1.
    pub pitch: f64,
    /// Metres from root to crest; from 0 to the radius.
    pub depth: f64,
}

impl Default for Thread {
    /// A radius of 0.15 m, a pitch of 0.15 m and a depth of 0.05 m: flanks of 46 degrees.
    fn default() -> Self {
        Self {
            radius: 0.15,
            pitch: 0.15,
            depth: 0.05,
        }
    }
}

impl Thread {
    fn within_limits(self) -> Self {
        let radius = within(self.radius, 0.05, 0.3);
        Self {
            radius,
            pitch: within(self.pitch, 0.02, 1.0),
            depth: within(self.depth, 0.0, radius),
        }
    }

    /// Metres from the axis to the surface.
    fn surface(&self, angle: f64, z: f64) -> f64 {
        self.radius + 0.5 * self.depth * (TAU * z / self.pitch - angle).cos()
    }

    /// Heights from `-height / 2` to `height / 2` with `a_turn` steps per pitch, at most 4096.
    fn heights(&self, height: f64, a_turn: usize) -> Vec<f64> {
        let steps = (height / self.pitch * a_turn as f64).ceil().min(4096.0);
        let height_at = |k| height * (f64::from(k) / steps - 0.5);
        (0..=steps as u32).map(height_at).collect()
    }
}

/// A rod around the z axis, threaded over its whole length, with flat ends.
///
/// The length is in metres, from 0.02 to 1. It has `detail` segments around the axis and half as
/// many along a turn of the thread. From 8 to 1024.
pub fn bolt(thread: Thread, length: f64, detail: u32) -> Mesh {
    let thread = thread.within_limits();
    let segments = segments(detail);
    let heights = thread.heights(within(length, 0.02, 1.0), segments / 2);
    let (bottom, top) = (heights[0], heights[heights.len() - 1]);
    swept(segments, heights.len() + 2, |i, j| {
        let angle = turn(i, segments);
        let section = match j {
            0 => DVec2::new(0.0, bottom),
            j if j > heights.len() => DVec2::new(0.0, top),
            j => DVec2::new(thread.surface(angle, heights[j - 1]), heights[j - 1]),
        };
        at_angle(section, angle)
    })
}

/// A hexagonal nut around the z axis, 3.6 radii of the thread across its flats. It fits on [`bolt`]
/// without being turned or moved along the axis.
///
/// Its thread is `clearance` further from the axis, in metres, from 0 to half of the thread's
/// radius. The height is in metres, from 0.02 to 1. It has `detail` segments around the axis,
/// rounded up to a multiple of six, and half as many along a turn. From 8 to 1024.
pub fn nut(thread: Thread, height: f64, clearance: f64, detail: u32) -> Mesh {
    let thread = thread.within_limits();
    let clearance = within(clearance, 0.0, 0.5 * thread.radius);
    let segments = segments(detail).next_multiple_of(6);
    let heights = thread.heights(within(height, 0.02, 1.0), segments / 2);
    let (bottom, top) = (heights[0], heights[heights.len() - 1]);
    // From the bottom of the bore outwards, up and back, then down along the thread.
    swept(segments, heights.len() + 2, |i, j| {
        let angle = turn(i, segments);
        let from_flat = angle.rem_euclid(PI / 3.0) - PI / 6.0;
        let outside = 1.8 * thread.radius / from_flat.cos();
        let section = match j {
            0 => DVec2::new(outside, bottom),
            1 => DVec2::new(outside, top),
            j => {
                let z = heights[heights.len() + 1 - j];
                DVec2::new(thread.surface(angle, z) + clearance, z)
            }
        };
        at_angle(section, angle)
    })
}

/// `value`, clamped; `low` for NaN.
fn within(value: f64, low: f64, high: f64) -> f64 {
    value.max(low).min(high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::tests::{close, inscribed_area_fraction, self_intersects, volume_of};

    /// The mean squared radius of a thread: the mean of a squared cosine is a half.
    fn mean_square(thread: Thread, clearance: f64) -> f64 {
        (thread.radius + clearance).powi(2) + thread.depth.powi(2) / 8.0
    }

    #[test]
    fn a_bolt_is_as_thick_as_its_thread_on_average() {
        for (length, detail, tolerance) in [(1.0, 16, 0.02), (0.97, 64, 2e-3)] {
            let thread = Thread::default();
            let mesh = bolt(thread, length, detail);
            assert!(detail > 16 || !self_intersects(&mesh));
            let round = PI * mean_square(thread, 0.0) * length;
            let chords = inscribed_area_fraction(detail as usize);
            close(volume_of(&mesh, 0), round * chords, tolerance);
        }
    }

    #[test]
    fn a_nut_is_a_hexagon_without_a_bolt() {
        for (detail, tolerance) in [(18, 0.03), (96, 2e-3)] {
            // Scaled to about a metre, within the limits.
            let thread = Thread {
                radius: 0.24,
                ..Thread::default()
            };
            let mesh = nut(thread, 0.3, 0.01, detail);
            assert!(detail > 18 || !self_intersects(&mesh));
            let hexagon = 2.0 * 3.0_f64.sqrt() * (1.8 * 0.24_f64).powi(2);
            let bore = PI * mean_square(thread, 0.01) * inscribed_area_fraction(detail as usize);
            close(volume_of(&mesh, 1), 0.3 * (hexagon - bore), tolerance);
        }
    }

    #[test]
    fn a_nut_follows_the_bolt_along_its_thread() {
        let thread = Thread::default();
        for k in 0..40 {
            let turned = f64::from(k) * 0.3;
            let risen = turned / TAU * thread.pitch;
            for (angle, z) in [(0.0, 0.1), (2.0, -0.2), (5.0, 0.03)] {
                let before = thread.surface(angle, z);
                assert!((thread.surface(angle + turned, z + risen) - before).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn numbers_out_of_range_are_replaced() {
        let nonsense = Thread {
            radius: f64::NAN,
            pitch: -1.0,
            depth: f64::INFINITY,
        };
        let least = Thread {
            radius: 0.05,
            pitch: 0.02,
            depth: 0.05,
        };
        let [bolts, nuts] = [
            [nonsense, least].map(|thread| bolt(thread, -1.0, 0)),
            [nonsense, least].map(|thread| nut(thread, f64::NAN, -1.0, 0)),
        ];
        assert_eq!(bolts[0].vertices(), bolts[1].vertices());
        assert_eq!(nuts[0].vertices(), nuts[1].vertices());
    }
}
