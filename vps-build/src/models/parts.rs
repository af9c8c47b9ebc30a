//! A peg and a chain link, for insertion and linking.

use std::f64::consts::{FRAC_PI_2, PI};

use glamx::{DVec2, DVec3};

use super::sweep::{revolved, segments, swept, turn};
use crate::mesh::Mesh;

/// The half section of the peg: distances from the axis and heights in metres.
const PEG: [DVec2; 6] = [
    DVec2::new(0.0, -0.5),
    DVec2::new(0.4, -0.5),
    DVec2::new(0.4, -0.45),
    DVec2::new(0.1, -0.45),
    DVec2::new(0.1, 0.35),
    DVec2::new(0.0, 0.5),
];

/// A peg along the z axis, pointing to +z. It is 1 m high with its foot and 0.2 m thick; the last
/// 0.15 m are a cone. The foot is a disc 0.8 m wide and 0.05 m thick.
///
/// It has `detail` segments around the axis. From 8 to 1024.
pub fn peg(detail: u32) -> Mesh {
    revolved(&PEG, segments(detail))
}

/// Metres from the middle of a link to the centres of its bows.
const LINK_HALF_STRAIGHT: f64 = 0.25;
/// Radius of the bows in metres, to the centre line of the rod.
const LINK_BOW: f64 = 0.18;
/// Radius of the rod in metres.
const LINK_ROD: f64 = 0.07;

/// A link of a chain in the xy plane: a round rod of 0.14 m, bent to a closed link 1 m long (in x)
/// and 0.5 m wide. Its opening is 0.72 m long and 0.22 m wide, which leaves room for the rod of
/// another link.
///
/// It has `detail` segments along the link's two bows and half as many around the rod. From 8 to
/// 1024.
pub fn link(detail: u32) -> Mesh {
    let segments = segments(detail);
    let (a_bow, around) = (segments / 2, segments / 2);
    swept(2 * (a_bow + 1), around, |i, j| {
        let (bow, step) = (i / (a_bow + 1), i % (a_bow + 1));
        let side = if bow == 0 { 1.0 } else { -1.0 };
        let from_end = PI * step as f64 / a_bow as f64 - FRAC_PI_2;
        let outward = side * DVec2::from_angle(from_end);
        let middle = DVec2::new(side * LINK_HALF_STRAIGHT, 0.0) + LINK_BOW * outward;
        let (sin, cos) = turn(j, around).sin_cos();
        (middle + LINK_ROD * cos * outward).extend(0.0) + DVec3::Z * (LINK_ROD * sin)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::tests::{close, inscribed_area_fraction, self_intersects, volume_of};

    #[test]
    fn a_peg_is_a_foot_a_rod_and_a_cone() {
        for detail in [8, 48] {
            let mesh = peg(detail as u32);
            assert!(!self_intersects(&mesh));
            let round = PI * (0.16 * 0.05 + 0.01 * 0.8 + 0.01 * 0.15 / 3.0);
            close(
                volume_of(&mesh, 0),
                round * inscribed_area_fraction(detail),
                1e-9,
            );
        }
    }

    #[test]
    fn a_link_is_a_rod_along_two_bows_and_two_straights() {
        for detail in [8, 64] {
            let mesh = link(detail as u32);
            assert!(!self_intersects(&mesh));
            let (low, high) = mesh.bounds();
            close((high - low).x, 1.0, 1e-9);
            close((high - low).y, 0.5, 1e-9);
            let bows = 2.0 * PI * LINK_BOW * inscribed_area_fraction(detail);
            let rod = PI * LINK_ROD * LINK_ROD * inscribed_area_fraction(detail / 2);
            let length = bows + 4.0 * LINK_HALF_STRAIGHT;
            close(volume_of(&mesh, 1), rod * length, 1e-9);
        }
    }
}
