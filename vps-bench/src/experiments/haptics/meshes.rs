//! Meshes of the tools and of the block with a hole.

use glamx::{DVec2, DVec3};
use vps_build::{Mesh, MeshError};

/// In metres, as all lengths here.
pub(super) const STYLUS_RADIUS: f64 = 0.004;
pub(super) const STYLUS_LENGTH: f64 = 0.12;

/// A capsule along the z axis, the centre of its tip at the origin.
pub(super) fn stylus() -> Result<Mesh, MeshError> {
    let arc = |middle: f64, from: f64| {
        (0..=8).map(move |i| {
            let angle = from + std::f64::consts::FRAC_PI_2 * f64::from(i) / 8.0;
            DVec2::new(0.0, middle) + STYLUS_RADIUS * DVec2::from_angle(angle)
        })
    };
    let tip = arc(0.0, -std::f64::consts::FRAC_PI_2);
    let mut profile: Vec<_> = tip.chain(arc(STYLUS_LENGTH, 0.0)).collect();
    profile[0].x = 0.0;
    profile[17].x = 0.0;
    revolved(&profile, 32)
}

/// Along the z axis, the middle of its end at the origin.
pub(super) fn peg() -> Result<Mesh, MeshError> {
    let profile = [
        (0.0, 0.0),
        (0.0085, 0.0),
        (0.0095, 0.001),
        (0.0095, 0.06),
        (0.0, 0.06),
    ];
    revolved(&profile.map(|(x, y)| DVec2::new(x, y)), 96)
}

/// Height of the block's face.
pub(super) const FACE: f32 = 0.04;
/// Height of the hole's floor.
pub(super) const FLOOR: f32 = 0.01;

/// A round block around the z axis, its hole open towards +z.
pub(super) fn block() -> Result<Mesh, MeshError> {
    let (face, floor) = (f64::from(FACE), f64::from(FLOOR));
    let profile = [
        (0.0, 0.0),
        (0.03, 0.0),
        (0.03, face),
        (0.01, face),
        (0.01, floor),
        (0.0, floor),
    ];
    revolved(&profile.map(|(x, y)| DVec2::new(x, y)), 96)
}

/// The solid that a closed profile of distances from the z axis and heights, counter-clockwise and
/// beginning and ending on the axis, makes around it.
fn revolved(profile: &[DVec2], segments: u32) -> Result<Mesh, MeshError> {
    let rings = profile.len() as u32;
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for i in 0..segments {
        let angle = std::f64::consts::TAU * f64::from(i) / f64::from(segments);
        let next = (i + 1) % segments;
        for (j, at) in (0..).zip(profile) {
            vertices.push(DVec3::new(at.x * angle.cos(), at.x * angle.sin(), at.y));
            let corner = |i: u32, j: u32| i * rings + j;
            if j > 0 && j + 1 < rings {
                triangles.push([corner(i, j - 1), corner(next, j), corner(i, j)]);
                triangles.push([corner(i, j), corner(next, j), corner(next, j + 1)]);
            }
        }
    }
    Mesh::new(&vertices, &triangles)
}
