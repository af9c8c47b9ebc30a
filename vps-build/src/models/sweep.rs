//! Surfaces swept by loops of points, and solids of revolution.

use std::f64::consts::TAU;

use glamx::{DVec2, DVec3};

use crate::mesh::Mesh;

/// Fewest and most segments around an axis or along a rod.
pub(super) const SEGMENTS: (u32, u32) = (8, 1024);

/// A detail, clamped.
pub(super) fn segments(detail: u32) -> usize {
    detail.clamp(SEGMENTS.0, SEGMENTS.1) as usize
}

/// The angle of step `i` of `count` steps per turn.
pub(super) fn turn(i: usize, count: usize) -> f64 {
    TAU * i as f64 / count as f64
}

/// The point at distance `x` from the z axis and height `y`, rotated by `angle` from the x axis to
/// the y axis.
pub(super) fn at_angle(DVec2 { x, y }: DVec2, angle: f64) -> DVec3 {
    let (sin, cos) = angle.sin_cos();
    DVec3::new(x * cos, x * sin, y)
}

/// The solid of revolution of a closed, counter-clockwise `profile` of distances from the z axis
/// and heights, in `segments` steps. A piece of the profile on the axis makes no face.
pub(super) fn revolved(profile: &[DVec2], segments: usize) -> Mesh {
    swept(segments, profile.len(), |i, j| {
        at_angle(profile[j], turn(i, segments))
    })
}

/// `rings` loops of `around` points each. Every loop is joined to the next, and the last to the
/// first. Seen from the next loop, loops turn clockwise.
pub(super) fn swept(rings: usize, around: usize, point: impl Fn(usize, usize) -> DVec3) -> Mesh {
    let mut vertices = Vec::with_capacity(rings * around);
    let mut triangles = Vec::with_capacity(2 * rings * around);
    for i in 0..rings {
        for j in 0..around {
            vertices.push(point(i, j));
            let (next_i, next_j) = ((i + 1) % rings, (j + 1) % around);
            let [a, b, c, d] = [(i, j), (next_i, j), (next_i, next_j), (i, next_j)]
                .map(|(i, j)| (i * around + j) as u32);
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    triangles.retain(|corners| {
        let [a, b, c] = corners.map(|v| vertices[v as usize]);
        a != b && b != c && c != a
    });
    Mesh::new(&vertices, &triangles).expect("loops of finite points enclose a solid")
}
