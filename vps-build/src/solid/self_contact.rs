//! Self-contact of a closed surface: triangles that cross or coincide, and gaps thinner than a
//! tolerance.

use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

use glamx::DVec3;
use robust::{Coord, Coord3D, orient2d, orient3d};

use crate::mesh::Mesh;
use crate::mesh::triangle::{distance, normal, width};
use crate::spatial::box_tree::BoxTree;

/// Gap tolerance, relative to the diagonal of the mesh.
const GAP_TOLERANCE: f64 = 5e-5;

/// The gap tolerance of a mesh in metres: parts closer than that touch.
pub(crate) fn gap_tolerance(mesh: &Mesh) -> f64 {
    let (low, high) = mesh.bounds();
    GAP_TOLERANCE * low.distance(high)
}

/// How parts of a surface touch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct SelfContact {
    /// Some triangles cross or coincide.
    pub(super) meets: bool,
    /// Some triangles face each other, or away from each other, within the gap tolerance.
    pub(super) has_gaps: bool,
}

/// Largest cosine between the normals of opposed triangles: 25 degrees.
const OPPOSITE: f64 = -0.9;

impl SelfContact {
    /// Tests all pairs of triangles. Triangles that share only corners or edges, or touch in a
    /// point or along a line, do not meet. Gaps, and walls as thin, are at most `gap` metres wide.
    ///
    /// Exact, except for the width of gaps.
    pub(super) fn of(mesh: &Mesh, gap: f64) -> Self {
        let tree = BoxTree::new(mesh, 0.5 * gap);
        let (meets, has_gaps) = (AtomicBool::new(false), AtomicBool::new(false));
        tree.for_each_pair(|a, b| {
            let known = (meets.load(Relaxed), has_gaps.load(Relaxed));
            if !known.0 && intersect(mesh, a, b) {
                meets.store(true, Relaxed);
            }
            if !known.1 && face_across_gap(mesh, a, b, gap) {
                has_gaps.store(true, Relaxed);
            }
            !(known.0 && known.1)
        });
        Self {
            meets: meets.into_inner(),
            has_gaps: has_gaps.into_inner(),
        }
    }
}

/// Vertices that two triangles share, as corner indices of each.
fn shared(a: [u32; 3], b: [u32; 3]) -> impl Iterator<Item = (usize, usize)> {
    (0..3).flat_map(move |i| (0..3).filter_map(move |j| (a[i] == b[j]).then_some((i, j))))
}

/// Whether two triangles face each other within `gap` metres. If they share corners or cross, all
/// of one of them must.
fn face_across_gap(mesh: &Mesh, a: u32, b: u32, gap: f64) -> bool {
    let [p, q] = [a, b].map(|t| mesh.corners(t as usize));
    // Slivers narrower than the gap have no reliable normal.
    let are_wide = || width(p) > gap && width(q) > gap;
    if normal(p).dot(normal(q)) > OPPOSITE || !overlap(p, q) || !are_wide() {
        return false;
    }
    let distance = distance(p, q);
    if distance > 0.0 {
        return distance <= gap;
    }
    // They share a corner or cross. So do the two sides of a blade, and parts deep within each
    // other.
    let thickness = thickness_between(p, q);
    thickness > 0.0 && thickness <= gap
}

/// Whether two triangles coincide, to within `gap` metres.
pub(super) fn are_coincident(mesh: &Mesh, a: u32, b: u32, gap: f64) -> bool {
    let [p, q] = [a, b].map(|t| mesh.corners(t as usize));
    overlap(p, q) && thickness_between(p, q) <= gap
}

/// How far one triangle reaches from the plane of the other, in metres. The lesser of the two.
fn thickness_between(p: [DVec3; 3], q: [DVec3; 3]) -> f64 {
    let reach = |plane: [DVec3; 3], of: [DVec3; 3]| {
        let normal = normal(plane);
        let heights = of.map(|v| (v - plane[0]).dot(normal).abs());
        heights.into_iter().fold(0.0, f64::max)
    };
    reach(p, q).min(reach(q, p))
}

/// Whether two triangles cross, or overlap in a common plane.
fn intersect(mesh: &Mesh, a: u32, b: u32) -> bool {
    let (s, t) = (mesh.triangles()[a as usize], mesh.triangles()[b as usize]);
    let (p, q) = (mesh.corners(a as usize), mesh.corners(b as usize));
    let mut common = shared(s, t);
    match (common.next(), common.next()) {
        (None, _) => {
            edges(p).any(|e| pierces(e, q))
                || edges(q).any(|e| pierces(e, p))
                || q.iter().all(|&v| side(p, v) == 0.0) && overlap(p, q)
        }
        (Some((i, j)), None) => {
            let (e, f) = (opposite(p, i), opposite(q, j));
            pierces(e, q) || pierces(f, p) || f.iter().all(|&v| side(p, v) == 0.0) && overlap(p, q)
        }
        // Signs of shared corners are zero, and the slowest to compute exactly.
        (Some((_, j)), Some((_, k))) => side(p, q[3 - j - k]) == 0.0 && overlap(p, q),
    }
}

fn edges([a, b, c]: [DVec3; 3]) -> impl Iterator<Item = [DVec3; 2]> {
    [[a, b], [b, c], [c, a]].into_iter()
}

/// The edge opposite to a corner.
fn opposite(t: [DVec3; 3], corner: usize) -> [DVec3; 2] {
    [t[(corner + 1) % 3], t[(corner + 2) % 3]]
}

fn side([a, b, c]: [DVec3; 3], point: DVec3) -> f64 {
    let coord = |v: DVec3| Coord3D {
        x: v.x,
        y: v.y,
        z: v.z,
    };
    orient3d(coord(a), coord(b), coord(c), coord(point))
}

/// Whether the interior of a segment crosses the interior of a triangle, or the interior of one of
/// its edges.
fn pierces([from, to]: [DVec3; 2], t: [DVec3; 3]) -> bool {
    if side(t, from) * side(t, to) >= 0.0 {
        return false;
    }
    let [a, b, c] = t;
    let around = [(a, b), (b, c), (c, a)].map(|(u, v)| side([from, to, u], v));
    let zeros = around.iter().filter(|s| **s == 0.0).count();
    zeros <= 1 && (around.iter().all(|s| *s >= 0.0) || around.iter().all(|s| *s <= 0.0))
}

/// Whether two triangles overlap in area, projected along the dominant axis of the first one's
/// normal.
fn overlap(p: [DVec3; 3], q: [DVec3; 3]) -> bool {
    let [a, b, c] = p;
    let normal = (b - a).cross(c - a).abs();
    let axis = normal.max_position();
    let flat = |v: DVec3| match axis {
        0 => Coord { x: v.y, y: v.z },
        1 => Coord { x: v.z, y: v.x },
        _ => Coord { x: v.x, y: v.y },
    };
    let counter_clockwise = |t: [DVec3; 3]| {
        let [a, b, c] = t.map(flat);
        let area = orient2d(a, b, c);
        (area != 0.0).then_some(if area > 0.0 { [a, b, c] } else { [a, c, b] })
    };
    let (Some(p), Some(q)) = (counter_clockwise(p), counter_clockwise(q)) else {
        return false;
    };
    // Separating axis: an edge of one has the other on its outer side.
    let separates = |p: [Coord<f64>; 3], q: [Coord<f64>; 3]| {
        (0..3).any(|i| q.iter().all(|&v| orient2d(p[i], p[(i + 1) % 3], v) <= 0.0))
    };
    !separates(p, q) && !separates(q, p)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn boxes(second_at: DVec3, size: [f64; 3]) -> Mesh {
        let (a, b) = (Mesh::cuboid([1.0; 3]).unwrap(), Mesh::cuboid(size).unwrap());
        let moved = b.vertices().iter().map(|&v| v + second_at);
        let vertices: Vec<_> = a.vertices().iter().copied().chain(moved).collect();
        let shifted = b.triangles().iter().map(|t| t.map(|v| v + 8));
        let triangles: Vec<_> = a.triangles().iter().copied().chain(shifted).collect();
        Mesh::new(&vertices, &triangles).unwrap()
    }

    #[test]
    fn boxes_meet_where_they_share_area_or_cross() {
        let of = |at: [f64; 3], size| {
            let mesh = boxes(DVec3::from_array(at), size);
            let found = SelfContact::of(&mesh, 1e-4);
            (found.meets, found.has_gaps)
        };
        // Apart, with an edge or a corner in common, a small gap apart, partly face to face, across
        // each other, nested.
        assert_eq!(of([3.0, 0.0, 0.0], [1.0; 3]), (false, false));
        assert_eq!(of([1.0, 1.0, 0.0], [1.0; 3]), (false, false));
        assert_eq!(of([1.0, 1.0, 1.0], [1.0; 3]), (false, false));
        assert_eq!(of([1.0, 1.0, 0.3], [1.0; 3]), (false, false));
        assert_eq!(of([1.00005, 0.0, 0.0], [1.0; 3]), (false, true));
        assert_eq!(of([1.00015, 0.0, 0.0], [1.0; 3]), (false, false));
        assert_eq!(of([1.0, 0.0, 0.0], [1.0; 3]), (true, false));
        assert_eq!(of([1.0, 0.3, 0.2], [1.0; 3]), (true, false));
        assert!(of([0.7, 0.3, 0.2], [1.0; 3]).0);
        assert!(of([0.0, 0.0, 0.0], [2.0, 0.5, 0.5]).0);
        assert_eq!(of([0.0, 0.0, 0.0], [0.5; 3]), (false, false));
        assert!(of([0.0, 0.0, 0.0], [0.99999; 3]) == (false, false));
    }

    #[test]
    fn clean_surfaces_do_not_meet_themselves() {
        for mesh in [
            Mesh::icosphere(1.0, 4).unwrap(),
            crate::models::torus(64),
            Mesh::cuboid([1.0, 1.0, 0.01]).unwrap().subdivided(),
        ] {
            let found = SelfContact::of(&mesh, 1e-6);
            assert_eq!(found, SelfContact::default());
        }
    }

    /// Two triangles that share a corner or an edge meet only if they share more.
    #[test]
    fn neighbours_meet_if_they_share_more_than_what_joins_them() {
        let v = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
        let of = |vertices: &[DVec3], triangles: &[[u32; 3]]| {
            SelfContact::of(&Mesh::new(vertices, triangles).unwrap(), 1e-9).meets
        };
        let base = [v(0., 0., 0.), v(2., 0., 0.), v(0., 2., 0.)];
        let with = |more: &[DVec3]| [&base[..], more].concat();
        // On an edge: folded onto it, unfolded, upright.
        for (third, meets) in [
            (v(1.0, 0.5, 0.0), true),
            (v(1.0, -0.5, 0.0), false),
            (v(1.0, 0.5, 0.1), false),
        ] {
            assert_eq!(
                of(&with(&[third]), &[[0, 1, 2], [0, 1, 3]]),
                meets,
                "{third}"
            );
        }
        // At a corner: through the other, onto it, beside it.
        for (b, c, meets) in [
            (v(1.0, 0.5, 1.0), v(0.5, 1.0, -1.0), true),
            (v(0.5, 0.2, 0.0), v(0.2, 0.5, 0.0), true),
            (v(-1.0, 0.5, 1.0), v(-0.5, 1.0, -1.0), false),
            (v(1.0, 0.5, 1.0), v(0.5, 1.0, 1.0), false),
        ] {
            assert_eq!(
                of(&with(&[b, c]), &[[0, 1, 2], [0, 3, 4]]),
                meets,
                "{b} {c}"
            );
        }
    }
}
