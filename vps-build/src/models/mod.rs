//! Procedural solids, for tests, examples and experiments that must not depend on files.
//!
//! Each is closed, faces outwards, is about a metre in size and lies around the origin. None is
//! convex: they have a hole, a cavity, a thread, tips or strands that wind around each other.
//! Arguments out of range are clamped, so that no function fails.
//!
//! ```
//! let torus = vps_build::models::torus(64);
//! assert_eq!(torus.open_edges(), 0);
//! ```

use std::f64::consts::{PI, TAU};

use glamx::{DVec2, DVec3};

mod blocks;
mod parts;
mod screw;
mod sweep;

pub use blocks::{cube_frame, window};
pub use parts::{link, peg};
pub use screw::{Thread, bolt, nut};

use self::sweep::{at_angle, revolved, segments, swept, turn};
use crate::mesh::Mesh;

/// A ring around the z axis, 1 m wide and 0.3 m thick; its hole is 0.4 m wide.
///
/// It has `detail` segments around the axis and half as many around the tube, so `detail`²
/// triangles for an even `detail`. From 8 to 1024.
pub fn torus(detail: u32) -> Mesh {
    const MIDDLE: DVec2 = DVec2::new(0.35, 0.0);
    const TUBE: f64 = 0.15;
    let segments = segments(detail);
    let around = segments / 2;
    let profile: Vec<_> = (0..around)
        .map(|j| MIDDLE + TUBE * DVec2::from_angle(turn(j, around)))
        .collect();
    revolved(&profile, segments)
}

/// A tube of 1/7 m along a trefoil knot, 1 m wide across the z axis. Strands stay more than 0.09 m
/// from each other.
///
/// It has `detail` segments along each third of the knot and a quarter as many, but at least six,
/// around the tube. From 8 to 1024.
pub fn trefoil_knot(detail: u32) -> Mesh {
    const TUBE: f64 = 1.0 / 14.0;
    let segments = segments(detail);
    let (along, around) = (3 * segments, (segments / 4).max(6));
    swept(along, around, |i, j| {
        let t = turn(i, along);
        let frame = KnotFrame::at(t);
        // The torus's normal turns about the knot two and a half times along the whole knot. Three
        // turns back leave little twist, and a whole number of turns closes the tube exactly.
        let (sin, cos) = (turn(j, around) - 3.0 * t).sin_cos();
        frame.origin + TUBE * (cos * frame.normal + sin * frame.binormal)
    })
}

/// A gear wheel around the z axis: 1 m wide over the tips, 0.76 m over the roots, 0.2 m thick,
/// with a bore of 0.3 m. A straight prism of 48 triangles a tooth.
///
/// From 3 to 4096 `teeth`.
pub fn gear(teeth: u32) -> Mesh {
    const BORE: f64 = 0.15;
    const ROOT: f64 = 0.38;
    const TIP: f64 = 0.5;
    const HALF_THICKNESS: f64 = 0.1;
    /// Corners of the outline: the fraction of a pitch, and the distance from the axis.
    const OUTLINE: [(f64, f64); 6] = [
        (0.0, ROOT),
        (0.1, TIP),
        (0.25, TIP),
        (0.4, TIP),
        (0.5, ROOT),
        (0.75, ROOT),
    ];
    let teeth = teeth.clamp(3, 4096) as usize;
    swept(teeth * OUTLINE.len(), 4, |i, j| {
        let (share, outer) = OUTLINE[i % OUTLINE.len()];
        let angle = TAU * ((i / OUTLINE.len()) as f64 + share) / teeth as f64;
        let (radius, z) = [
            (BORE, -HALF_THICKNESS),
            (outer, -HALF_THICKNESS),
            (outer, HALF_THICKNESS),
            (BORE, HALF_THICKNESS),
        ][j];
        at_angle(DVec2::new(radius, z), angle)
    })
}

/// A cup around the z axis, open towards +z: 1 m high, 0.6 m wide at the bottom and 0.8 m at the
/// rim, with a wall of 0.06 m and a floor of 0.08 m.
///
/// It has `detail` segments around the axis; walls and floor are cut into rings no wider than
/// those segments are at the rim. From 8 to 1024.
pub fn cup(detail: u32) -> Mesh {
    let segments = segments(detail);
    let longest = TAU * CUP[2].x / segments as f64;
    let mut profile = Vec::new();
    for piece in CUP.windows(2) {
        let steps = (piece[0].distance(piece[1]) / longest).ceil();
        let places = (0..steps as u32).map(|k| f64::from(k) / steps);
        profile.extend(places.map(|s| piece[0].lerp(piece[1], s)));
    }
    profile.push(CUP[5]);
    revolved(&profile, segments)
}

/// The half section of the cup: distances from the axis and heights in metres.
const CUP: [DVec2; 6] = [
    DVec2::new(0.0, -0.5),
    DVec2::new(0.3, -0.5),
    DVec2::new(0.4, 0.5),
    DVec2::new(0.34, 0.5),
    DVec2::new(0.25, -0.42),
    DVec2::new(0.0, -0.42),
];

/// A ball of 0.3 m radius with evenly distributed cones on it, whose tips are 0.5 m from the
/// origin.
///
/// From 4 to 512 `spikes`. More spikes are narrower and need more triangles: from 5120 to 81 920.
pub fn spiky_ball(spikes: u32) -> Mesh {
    const BALL: f64 = 0.3;
    const TIP: f64 = 0.5;
    let tips = spread_directions(spikes.clamp(4, 512));
    // Angle in radians from the axis of a cone to its foot. Neighbours are at least 3.09 / √n
    // apart.
    let foot = (1.4 / (tips.len() as f64).sqrt()).min(0.35);
    // Edges of the ball are at most 1.3 / 2^subdivisions long. At least three fit between tip and
    // foot.
    let subdivisions = (3.0 * 1.3 / foot).log2().ceil() as u32;
    let ball = Mesh::icosphere(1.0, subdivisions).expect("the radius is 1");
    let directions = ball.vertices();

    let raised = |direction: &DVec3| {
        let cosine = tips
            .iter()
            .map(|tip| tip.dot(*direction))
            .fold(-1.0, f64::max);
        let slope = 1.0 - cosine.min(1.0).acos() / foot;
        direction * (BALL + (TIP - BALL) * slope.max(0.0))
    };
    let mut vertices: Vec<_> = directions.iter().map(raised).collect();
    for tip in &tips {
        // The closest vertex becomes the tip. It stays within the triangles around it.
        let (closest, _) = directions
            .iter()
            .enumerate()
            .max_by(|(_, a), (_, b)| a.dot(*tip).total_cmp(&b.dot(*tip)))
            .expect("a ball has vertices");
        vertices[closest] = TIP * tip;
    }
    Mesh::new(&vertices, ball.triangles()).expect("a ball's vertices were moved, none beyond 0.5 m")
}

/// `count` evenly distributed unit vectors: a Fibonacci lattice around the z axis.
fn spread_directions(count: u32) -> Vec<DVec3> {
    let golden_angle = PI * (3.0 - 5.0_f64.sqrt());
    let direction = |i: u32| {
        let z = 1.0 - f64::from(2 * i + 1) / f64::from(count);
        at_angle(
            DVec2::new((1.0 - z * z).sqrt(), z),
            f64::from(i) * golden_angle,
        )
    };
    (0..count).map(direction).collect()
}

/// A point of the trefoil knot, and two unit vectors normal to it. The knot winds three times
/// around the tube of a torus, and twice around the z axis.
struct KnotFrame {
    origin: DVec3,
    /// Outward normal of the torus.
    normal: DVec3,
    binormal: DVec3,
}

impl KnotFrame {
    /// Metres from the axis to the centre of the torus's tube.
    const RING: f64 = 2.0 / 7.0;
    /// Radius of the torus's tube in metres.
    const TUBE: f64 = 1.0 / 7.0;

    /// The frame at `t`, from 0 to 2π once along the knot.
    fn at(t: f64) -> Self {
        let (sin, cos) = (3.0 * t).sin_cos();
        let from_axis = Self::RING + Self::TUBE * cos;
        // Within the half plane through the axis at the angle 2 t.
        let (tube_normal, tube_tangent) = (DVec2::new(cos, sin), DVec2::new(-sin, cos));
        let normal = at_angle(tube_normal, 2.0 * t);
        let along_axis = at_angle(DVec2::X, 2.0 * t + PI / 2.0);
        let along_tube = at_angle(tube_tangent, 2.0 * t);
        let tangent = 2.0 * from_axis * along_axis + 3.0 * Self::TUBE * along_tube;
        Self {
            origin: Self::RING * at_angle(DVec2::X, 2.0 * t) + Self::TUBE * normal,
            normal,
            binormal: normal.cross(tangent).normalize(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::sweep::SEGMENTS;
    use super::*;
    use crate::inspection::health::Health;
    use crate::mesh::triangle::signed_volume;

    /// Volume in m³ of a mesh that must be a solid of about a metre with this many handles.
    pub(super) fn volume_of(mesh: &Mesh, handles: i64) -> f64 {
        let health = Health::of(mesh, 0.1);
        assert!(health.is_watertight(), "{health:?}");
        assert_eq!((health.components, health.degenerate_faces), (1, 0));
        let euler = health.vertices as i64 - health.triangles as i64 / 2;
        assert_eq!(euler, 2 - 2 * handles);
        let (low, high) = mesh.bounds();
        let longest = (high - low).max_element();
        assert!(longest > 0.8 && longest < 1.0 + 1e-9, "{longest} m");
        assert!(low.midpoint(high).length() < 0.15, "{low} {high}");
        assert!(health.volume_m3 > 0.0);
        health.volume_m3
    }

    /// Whether an edge passes through a triangle with which it shares no vertex.
    pub(super) fn self_intersects(mesh: &Mesh) -> bool {
        let passes = |p: DVec3, q: DVec3, [a, b, c]: [DVec3; 3]| {
            let above = |p| signed_volume([a, b, c], p);
            let sides = [[p, a, b], [p, b, c], [p, c, a]].map(|t| signed_volume(t, q));
            above(p) * above(q) < -1e-24
                && (sides.iter().all(|&s| s > 1e-12) || sides.iter().all(|&s| s < -1e-12))
        };
        let triangles = mesh.triangles();
        let edges = triangles
            .iter()
            .flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]);
        edges.filter(|(from, to)| from < to).any(|(from, to)| {
            let [p, q] = [from, to].map(|v| mesh.vertices()[v as usize]);
            (0..triangles.len()).any(|t| {
                let corners = mesh.corners(t);
                let aside = (0..3).any(|axis| {
                    corners.iter().all(|v| v[axis] > p[axis].max(q[axis]))
                        || corners.iter().all(|v| v[axis] < p[axis].min(q[axis]))
                });
                let apart = !triangles[t].contains(&from) && !triangles[t].contains(&to);
                !aside && apart && passes(p, q, corners)
            })
        })
    }

    /// Ratio of the area of a regular `n`-gon to that of its circumscribed circle.
    pub(super) fn inscribed_area_fraction(n: usize) -> f64 {
        turn(1, n).sin() / turn(1, n)
    }

    pub(super) fn close(a: f64, b: f64, tolerance: f64) {
        assert!((a - b).abs() <= tolerance * b, "{a} is not {b}");
    }

    #[test]
    fn a_tube_through_itself_is_noticed() {
        let profile = [(0.1, -0.5), (0.5, 0.0), (-0.2, 0.3)].map(|(x, y)| DVec2::new(x, y));
        assert!(self_intersects(&revolved(&profile, 8)));
    }

    #[test]
    fn a_torus_has_its_volume() {
        for detail in [8, 64] {
            let mesh = torus(detail as u32);
            assert_eq!(mesh.triangles().len(), detail * detail);
            assert!(!self_intersects(&mesh));
            let round = TAU * 0.35 * PI * 0.15 * 0.15;
            let chords = inscribed_area_fraction(detail) * inscribed_area_fraction(detail / 2);
            close(volume_of(&mesh, 1), round * chords, 1e-9);
        }
    }

    #[test]
    fn a_knot_is_a_tube_as_long_as_its_curve() {
        for (detail, tolerance) in [(8, 0.1), (48, 0.01)] {
            let mesh = trefoil_knot(detail);
            let around = (detail as usize / 4).max(6);
            assert_eq!(mesh.triangles().len(), 6 * detail as usize * around);
            assert!(!self_intersects(&mesh));
            let position_at = |i| KnotFrame::at(turn(i, 4096)).origin;
            let length: f64 = (0..4096)
                .map(|i| position_at(i).distance(position_at(i + 1)))
                .sum();
            let tube = length * PI / 196.0 * inscribed_area_fraction(around);
            close(volume_of(&mesh, 1), tube, tolerance);
        }
    }

    #[test]
    fn strands_of_the_knot_stay_apart() {
        let places: Vec<_> = (0..600)
            .map(|i| KnotFrame::at(turn(i, 600)).origin)
            .collect();
        let mut closest = f64::MAX;
        for i in 0..600_usize {
            for j in 0..600 {
                if (60..=540).contains(&i.abs_diff(j)) {
                    closest = closest.min(places[i].distance(places[j]));
                }
            }
        }
        assert!(closest - 1.0 / 7.0 > 0.09, "{closest} m");
    }

    #[test]
    fn a_gear_is_between_its_roots_and_its_tips() {
        for teeth in [3, 24] {
            let mesh = gear(teeth);
            assert_eq!(mesh.triangles().len(), 48 * teeth as usize);
            assert!(!self_intersects(&mesh));
            let disc = |radius: f64| 0.2 * PI * (radius * radius - 0.15 * 0.15);
            let volume = volume_of(&mesh, 1);
            assert!(volume > disc(0.38) && volume < disc(0.5), "{volume} m³");
        }
    }

    #[test]
    fn a_cup_is_one_cone_without_another() {
        for detail in [8, 48] {
            let mesh = cup(detail as u32);
            assert!(!self_intersects(&mesh));
            let cone =
                |a: DVec2, b: DVec2| PI / 3.0 * (b.y - a.y) * (a.x * a.x + a.x * b.x + b.x * b.x);
            let round = cone(CUP[1], CUP[2]) - cone(CUP[4], CUP[3]);
            close(
                volume_of(&mesh, 0),
                round * inscribed_area_fraction(detail),
                1e-9,
            );
        }
    }

    #[test]
    fn a_spiky_ball_has_its_spikes() {
        for spikes in [4, 40, 512] {
            let mesh = spiky_ball(spikes);
            let volume = volume_of(&mesh, 0);
            let ball = |radius: f64| 4.0 / 3.0 * PI * radius.powi(3);
            assert!(volume > ball(0.3) && volume < ball(0.4), "{volume} m³");
            let is_tip = |v: &&DVec3| (v.length() - 0.5).abs() < 1e-9;
            assert_eq!(
                mesh.vertices().iter().filter(is_tip).count(),
                spikes as usize
            );
            // Each ray from the origin meets the surface once.
            for t in 0..mesh.triangles().len() {
                assert!(signed_volume(mesh.corners(t), DVec3::ZERO) > 0.0);
            }
        }
    }

    #[test]
    fn numbers_out_of_range_are_replaced() {
        for model in [torus, trefoil_knot, cup, peg, link] {
            assert_eq!(model(0).triangles(), model(SEGMENTS.0).triangles());
        }
        assert_eq!(gear(0).triangles().len(), gear(3).triangles().len());
        assert_eq!(spiky_ball(0).vertices(), spiky_ball(4).vertices());
        assert_eq!(spiky_ball(u32::MAX).vertices(), spiky_ball(512).vertices());
    }
}
