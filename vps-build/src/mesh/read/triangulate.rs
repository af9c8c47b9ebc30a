//! Triangulation of polygons in space.
//!
//! A polygon is projected along the axis closest to its normal, which keeps the coordinates of the
//! file. If the first corner sees all others, as in a convex polygon, it is cut into a fan from
//! there. Otherwise the triangles are those of the constrained Delaunay triangulation inside of the
//! outline. No vertex is added or left out, so the polygon still meets its neighbours along all
//! edges. An outline that crosses itself bounds no area; it is cut into a fan.

use glamx::{DVec2, DVec3};
use robust::{Coord, orient2d};
use rustc_hash::FxHashMap;
use spade::handles::{DirectedEdgeHandle, FixedVertexHandle, VertexHandle};
use spade::{CdtEdge, ConstrainedDelaunayTriangulation, HasPosition, Point2, Triangulation};

use crate::mesh::sheet::SHEET_THICKNESS;

/// Triangulates polygons, and keeps its memory from one to the next.
#[derive(Default)]
pub(super) struct Triangulator {
    /// The corners, without consecutive duplicates.
    corners: Vec<u32>,
    /// The projected corners, counter-clockwise.
    flat: Vec<DVec2>,
}

impl Triangulator {
    /// Appends the triangles of the polygon with these corners, in its orientation. Vertices must
    /// be finite.
    pub(super) fn triangulate(
        &mut self,
        vertices: &[DVec3],
        corners: &[u32],
        triangles: &mut Vec<[u32; 3]>,
    ) {
        if let &[a, b, c] = corners {
            triangles.push([a, b, c]);
            return;
        }
        let at = |v: u32| vertices[v as usize];
        self.corners.clear();
        self.corners.extend_from_slice(corners);
        self.corners.dedup_by_key(|v| at(*v).to_array());
        while self.corners.len() > 1
            && at(self.corners[0]) == at(self.corners[self.corners.len() - 1])
        {
            self.corners.pop();
        }
        let corners = &self.corners;
        if corners.len() < 3 {
            return;
        }
        let normal = normal(vertices, corners);
        let axis = normal.abs().max_position();
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let (u, v) = if normal[axis] < 0.0 { (v, u) } else { (u, v) };
        self.flat.clear();
        let flat = |&c: &u32| DVec2::new(at(c)[u], at(c)[v]);
        self.flat.extend(corners.iter().map(flat));
        if !self.is_seen_from_first()
            && (self.delaunay(vertices, 0.0, triangles).is_some()
                || self
                    .delaunay(vertices, self.rounding(), triangles)
                    .is_some())
        {
            return;
        }
        triangles.extend(corners[1..].windows(2).map(|e| [corners[0], e[0], e[1]]));
    }

    /// Whether all triangles of a fan from the first corner have the orientation of the polygon.
    fn is_seen_from_first(&self) -> bool {
        let mut edges = self.flat[1..].windows(2);
        edges.all(|edge| orientation(self.flat[0], edge[0], edge[1]) > 0.0)
    }

    /// Largest distance of a corner from an edge that it lies on, with coordinates of six digits.
    fn rounding(&self) -> f64 {
        let from_first = self.flat.iter().map(|p| p.distance(self.flat[0]));
        SHEET_THICKNESS * from_first.fold(0.0, f64::max)
    }

    /// Appends the triangles of the constrained Delaunay triangulation inside of the polygon, or
    /// returns `None` if its outline crosses itself. Edges pass through corners within `rounding`
    /// of them.
    fn delaunay(
        &self,
        vertices: &[DVec3],
        rounding: f64,
        triangles: &mut Vec<[u32; 3]>,
    ) -> Option<()> {
        let mut index_at = FxHashMap::default();
        let mut planar: Vec<PlanarVertex> = Vec::with_capacity(self.flat.len());
        let mut outline = Vec::with_capacity(self.flat.len());
        for (&flat, &corner) in self.flat.iter().zip(&self.corners) {
            let index = *index_at.entry(key(flat)).or_insert(planar.len());
            if index == planar.len() {
                planar.push(PlanarVertex { flat, corner });
            } else if vertices[planar[index].corner as usize] != vertices[corner as usize] {
                return None;
            }
            outline.push(index);
        }
        let mut seeded = planar.clone();
        seeded.extend(
            seed(&planar)
                .into_iter()
                .filter(|p| !index_at.contains_key(&key(p.flat))),
        );
        let mut cdt = ConstrainedDelaunayTriangulation::<PlanarVertex>::bulk_load(seeded).ok()?;
        let is_seed = |vertex: &VertexHandle<'_, PlanarVertex, (), CdtEdge<()>, ()>| {
            vertex.data().corner == SEED
        };
        while let Some(seed) = cdt.vertices().find(is_seed).map(|v| v.fix()) {
            cdt.remove(seed);
        }
        let mut handles = vec![None; planar.len()];
        for vertex in cdt.vertices() {
            handles[*index_at.get(&key(vertex.data().flat))?] = Some(vertex.fix());
        }
        // How often the outline passes an edge forwards, less backwards. Zero where it leads to a
        // hole and back.
        let mut borders: FxHashMap<[FixedVertexHandle; 2], i32> = FxHashMap::default();
        let mut seams = Vec::new();
        let next = outline.iter().cycle().skip(1);
        for (&from, &to) in outline.iter().zip(next) {
            let mut pieces = Vec::new();
            for step in edge_path(&planar, [from, to], rounding).windows(2) {
                let more = cdt.try_add_constraint(handles[step[0]]?, handles[step[1]]?);
                if more.is_empty() {
                    return None;
                }
                pieces.extend(more);
            }
            for (i, &piece) in pieces.iter().enumerate() {
                let ends = cdt.directed_edge(piece).vertices();
                let [a, b] = ends.map(|v| v.fix());
                *borders.entry([a, b]).or_default() += 1;
                *borders.entry([b, a]).or_default() -= 1;
                // An edge through other corners stays one edge for its neighbour: degenerate
                // triangles lie between.
                if i > 0 {
                    let [a, b] = ends.map(|v| v.data().corner);
                    seams.push([planar[from].corner, b, a]);
                }
            }
        }
        // Winding number of the outline around each face, from outside inwards.
        let border = |edge: &DirectedEdgeHandle<'_, PlanarVertex, (), CdtEdge<()>, ()>| {
            let ends = edge.vertices().map(|v| v.fix());
            borders.get(&ends).copied().unwrap_or(0)
        };
        let mut windings = vec![None; cdt.num_all_faces()];
        let mut open = vec![cdt.outer_face().fix()];
        windings[cdt.outer_face().index()] = Some(0);
        for edge in cdt.convex_hull() {
            let inner = edge.rev();
            windings[inner.face().index()] = Some(border(&inner));
            open.push(inner.face().fix());
        }
        while let Some(face) = open.pop() {
            let Some(inner) = cdt.face(face).as_inner() else {
                continue;
            };
            let winding = windings[face.index()]?;
            for edge in inner.adjacent_edges() {
                let other = edge.rev();
                let around = winding + border(&other);
                let known = &mut windings[other.face().index()];
                if known.is_none() {
                    *known = Some(around);
                    open.push(other.face().fix());
                }
            }
        }
        if windings.iter().any(|w| !matches!(w, Some(0 | 1))) {
            return None;
        }
        let inside = cdt
            .inner_faces()
            .filter(|face| windings[face.index()] == Some(1));
        triangles.extend(inside.map(|face| face.vertices().map(|v| v.data().corner)));
        triangles.extend(seams);
        Some(())
    }
}

/// A projected corner.
#[derive(Clone, Copy)]
struct PlanarVertex {
    flat: DVec2,
    corner: u32,
}

impl HasPosition for PlanarVertex {
    type Scalar = f64;

    fn position(&self) -> Point2<f64> {
        Point2::new(self.flat.x, self.flat.y)
    }
}

/// The corners that an edge passes, in order, ends included.
fn edge_path(planar: &[PlanarVertex], [from, to]: [usize; 2], rounding: f64) -> Vec<usize> {
    if rounding == 0.0 {
        return vec![from, to];
    }
    let start = planar[from].flat;
    let along = planar[to].flat - start;
    let length = along.length();
    let passed = planar.iter().enumerate().filter_map(|(i, index)| {
        let edge_path = index.flat - start;
        let (ahead, aside) = (
            edge_path.dot(along) / length,
            edge_path.perp_dot(along) / length,
        );
        let is_passed = aside.abs() <= rounding && ahead > rounding && ahead < length - rounding;
        is_passed.then_some((ahead, i))
    });
    let mut passed: Vec<_> = passed.collect();
    passed.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let passed = passed.into_iter().map(|(_, i)| i);
    std::iter::once(from).chain(passed).chain([to]).collect()
}

/// The corner index of a seed point.
const SEED: u32 = u32::MAX;

/// Three seed points around the centre. Incremental triangulation from the centre outwards is slow
/// if the first corners are collinear.
fn seed(planar: &[PlanarVertex]) -> [PlanarVertex; 3] {
    let sum: DVec2 = planar.iter().map(|p| p.flat).sum();
    let middle = sum / planar.len() as f64;
    let reach = planar.iter().map(|p| (p.flat - middle).abs().max_element());
    let step = 1e-3 * reach.fold(0.0, f64::max);
    [DVec2::X, DVec2::Y, -DVec2::ONE].map(|to| PlanarVertex {
        flat: middle + to * step,
        corner: SEED,
    })
}

/// A hash key of a position.
fn key(flat: DVec2) -> [u64; 2] {
    // Adding 0 makes -0 and 0 equal.
    (flat + 0.0).to_array().map(f64::to_bits)
}

fn orientation(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    let [a, b, c] = [a, b, c].map(|p| Coord { x: p.x, y: p.y });
    orient2d(a, b, c)
}

/// The normal of a polygon, scaled by twice its area (Newell).
fn normal(vertices: &[DVec3], corners: &[u32]) -> DVec3 {
    let at = |v: u32| vertices[v as usize] - vertices[corners[0] as usize];
    let edges = corners.windows(2);
    edges.map(|edge| at(edge[0]).cross(at(edge[1]))).sum()
}

#[cfg(test)]
mod tests {
    use glamx::DQuat;
    use proptest::prelude::*;

    use super::*;
    use crate::mesh::edges::Edges;
    use crate::mesh::triangle;

    fn cut(outline: &[DVec3]) -> Vec<[u32; 3]> {
        let corners: Vec<_> = (0..outline.len() as u32).collect();
        let mut triangles = Vec::new();
        Triangulator::default().triangulate(outline, &corners, &mut triangles);
        triangles
    }

    fn area(vertices: &[DVec3], triangles: &[[u32; 3]]) -> f64 {
        let corners = |t: &[u32; 3]| t.map(|v| vertices[v as usize]);
        triangles.iter().map(corners).map(triangle::area).sum()
    }

    /// The triangles are bounded by the outline alone, and cover its area.
    fn check(outline: &[DVec3], expected: f64) {
        let triangles = cut(outline);
        let found = area(outline, &triangles);
        assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
        // Vertices at one position are one.
        let first = |v: u32| {
            outline
                .iter()
                .position(|p| *p == outline[v as usize])
                .unwrap() as u32
        };
        let n = outline.len() as u32;
        let mut all: Vec<_> = triangles.iter().map(|t| t.map(first)).collect();
        // Closed by a cone to a point, nothing is open.
        all.extend((0..n).map(|i| [first((i + 1) % n), first(i), n]));
        assert_eq!(Edges::of(&all).open_count(), 0);
        // All have the orientation of the outline.
        let normal = normal(outline, &(0..n).collect::<Vec<_>>());
        for t in &triangles {
            let [a, b, c] = t.map(|v| outline[v as usize]);
            assert!((b - a).cross(c - a).dot(normal) >= -1e-12 * normal.length_squared());
        }
    }

    fn flat(outline: &[[f64; 2]]) -> Vec<DVec3> {
        outline
            .iter()
            .map(|&[x, y]| DVec3::new(x, y, 0.0))
            .collect()
    }

    /// In its plane and in others, from every first corner, in both directions.
    fn check_everywhere(outline: &[[f64; 2]], expected: f64) {
        let turns = [
            DQuat::IDENTITY,
            DQuat::from_rotation_x(1.0),
            DQuat::from_rotation_z(0.4) * DQuat::from_rotation_y(2.5),
        ];
        for turn in turns {
            let mut outline: Vec<_> = flat(outline).into_iter().map(|p| turn * p).collect();
            for _ in 0..outline.len() {
                outline.rotate_left(1);
                check(&outline, expected);
                let reversed: Vec<_> = outline.iter().rev().copied().collect();
                check(&reversed, expected);
            }
        }
    }

    /// A corner on an edge of its own polygon is off by rounding.
    #[test]
    fn a_corner_may_touch_an_edge() {
        let notched = [[0, 0], [4, 0], [4, 2], [3, 2], [2, 0], [1, 2], [0, 2]];
        for i in 0..20 {
            let turn = DQuat::from_rotation_z(0.3 * f64::from(i));
            for digits in [1e6, 1e9, 1e17] {
                let outline = flat(&notched.map(|p| p.map(f64::from)));
                let rounded = |p: DVec3| (turn * p * digits).round() / digits;
                let outline: Vec<_> = outline.into_iter().map(rounded).collect();
                let area = area(&outline, &cut(&outline));
                assert!((area - 6.0).abs() < 1e-4, "{i} {digits}: {area}");
            }
        }
    }

    #[test]
    fn a_channel_keeps_its_notch() {
        let channel = [
            [1, 3],
            [0, 3],
            [0, 0],
            [4, 0],
            [4, 3],
            [3, 3],
            [3, 1],
            [1, 1],
        ];
        check_everywhere(&channel.map(|p| p.map(f64::from)), 8.0);
    }

    #[test]
    fn corners_on_straight_edges_stay() {
        let ell = [
            [0, 0],
            [1, 0],
            [2, 0],
            [3, 0],
            [3, 1],
            [1, 1],
            [1, 2],
            [1, 3],
            [0, 3],
            [0, 1],
        ];
        check_everywhere(&ell.map(|p| p.map(f64::from)), 5.0);
    }

    #[test]
    fn a_hole_is_reached_by_an_edge_there_and_back() {
        let keyhole = [
            [0, 0],
            [6, 0],
            [6, 6],
            [0, 6],
            [0, 0],
            [2, 2],
            [2, 4],
            [4, 4],
            [4, 2],
            [2, 2],
        ];
        check_everywhere(&keyhole.map(|p| p.map(f64::from)), 32.0);
    }

    #[test]
    fn an_edge_through_a_corner_stays_one_edge() {
        // The notch reaches the opposite side.
        let touching = [[0, 0], [4, 0], [4, 2], [3, 2], [2, 0], [1, 2], [0, 2]];
        check_everywhere(&touching.map(|p| p.map(f64::from)), 6.0);
    }

    #[test]
    fn convex_and_self_crossing_polygons_are_fans() {
        let square = flat(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
        assert_eq!(cut(&square), [[0, 1, 2], [0, 2, 3]]);
        let bow = flat(&[[0.0, 0.0], [2.0, 1.0], [2.0, 0.0], [0.0, 3.0]]);
        assert_eq!(cut(&bow), [[0, 1, 2], [0, 2, 3]]);
        let with_repeats = flat(&[[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 0.0]]);
        assert_eq!(cut(&with_repeats), [[0, 1, 3]]);
        let point = flat(&[[1.0, 1.0]; 5]);
        assert!(cut(&point).is_empty());
    }

    #[test]
    fn a_bent_polygon_keeps_its_outline() {
        let mut channel = flat(&[
            [1.0, 3.0],
            [0.0, 3.0],
            [0.0, 0.0],
            [4.0, 0.0],
            [4.0, 3.0],
            [3.0, 3.0],
            [3.0, 1.0],
            [1.0, 1.0],
        ]);
        for p in &mut channel {
            p.z = 0.01 * (p.x * 1.7 + p.y * p.y).sin();
        }
        let triangles = cut(&channel);
        assert_eq!(triangles.len(), 6);
        assert!((area(&channel, &triangles) - 8.0).abs() < 0.01);
    }

    #[test]
    fn a_comb_of_many_teeth() {
        let teeth = 2_000;
        let mut comb = vec![[f64::from(teeth), -1.0], [0.0, -1.0]];
        comb.reverse();
        for i in (0..teeth).rev() {
            let x = f64::from(i);
            comb.extend([[x + 0.6, 0.0], [x + 0.5, 100.0], [x + 0.4, 0.0]]);
        }
        let outline = flat(&comb);
        let triangles = cut(&outline);
        assert_eq!(triangles.len(), comb.len() - 2);
        let expected = 30.0 * f64::from(teeth) * 0.2 / 0.6;
        let rest = area(&outline, &triangles) - expected;
        assert!(rest > 0.0 && rest < 1.1 * f64::from(teeth), "{rest}");
    }

    proptest! {
        /// A star-shaped polygon around the origin is simple, and has the area of the triangles to
        /// its centre.
        #[test]
        fn stars_are_covered(
            reach in prop::collection::vec(0.05..1.0_f64, 4..60),
            axis in prop::array::uniform3(-1.0..1.0_f64),
            turn in 0.0..6.0_f64,
        ) {
            let n = reach.len();
            let axis = DVec3::from_array(axis).normalize_or(DVec3::X);
            let turn = DQuat::from_axis_angle(axis, turn);
            let corner = |(i, r): (usize, &f64)| {
                let (sin, cos) = (i as f64 / n as f64 * std::f64::consts::TAU).sin_cos();
                turn * DVec3::new(r * cos, r * sin, 0.0)
            };
            let outline: Vec<_> = reach.iter().enumerate().map(corner).collect();
            let step = (std::f64::consts::TAU / n as f64).sin();
            let expected: f64 = (0..n).map(|i| 0.5 * reach[i] * reach[(i + 1) % n] * step).sum();
            check(&outline, expected);
        }
    }
}
