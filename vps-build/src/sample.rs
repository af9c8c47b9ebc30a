//! The pointshell (section 2.1.2): centres of surface voxels projected onto the triangles, kept
//! when they are not too close to each other.

use std::ops::Range;

use glamx::DVec3;
use rayon::prelude::*;
use vps_core::{DistanceField, Vec3, Voxelmap};

use crate::cells::Cells;
use crate::kdtree::KdTree;
use crate::places::for_each_overlapped;
use crate::triangle::{area, closest_point, normal};
use crate::{Mesh, PointCount};

/// How many voxels of the sampling grid two points are apart: √2, as the paper suggests.
const ALPHA: f64 = std::f64::consts::SQRT_2;

/// How far a point count may be from the one asked for, as a fraction, before another spacing is
/// tried: little while all rounds together have made few points, then more.
const STRICT_TOLERANCE: f64 = 0.001;
const COUNT_TOLERANCE: f64 = 0.01;
const CHEAP_POINTS: u64 = 20_000;

/// How many spacings are tried.
const MOST_ROUNDS: u64 = 12;

/// Points on a surface, in no order.
pub(crate) struct Samples {
    /// Positions in metres.
    pub(crate) positions: Vec<DVec3>,
    /// Unit inward normals.
    pub(crate) normals: Vec<Vec3>,
    /// The area of the surface each stands for, in m²: all together that of the mesh.
    pub(crate) areas: Vec<f32>,
}

/// How many times its spacing squared a point covers, about.
const COVERED: f64 = 1.5;

/// About how many points there are with so much between them, or more than that are there for sure.
pub(crate) fn about_count(mesh: &Mesh, spacing: f64) -> f64 {
    let on_area = mesh.area() / (COVERED * spacing * spacing);
    on_area.max(longest_edge(mesh) / (2.0 * REACH * spacing))
}

/// Samples the mesh, with normals from the field.
pub(crate) fn sample(mesh: &Mesh, count: PointCount, map: &Voxelmap<'_>) -> Samples {
    let spaced = match count {
        PointCount::Spacing(spacing) => spread(mesh, spacing),
        PointCount::About(count) => about(mesh, count),
    };
    let normals = inward_normals(&spaced, map);
    let areas = shares_of_area(mesh, &spaced, &normals);
    Samples {
        positions: spaced.points,
        normals,
        areas,
    }
}

/// How much of the surface is closest to each point, of those on its side of a thin wall. Triangles
/// are cut until their edges are shorter than half the distance of two points.
fn shares_of_area(mesh: &Mesh, spaced: &Spaced, normals: &[Vec3]) -> Vec<f32> {
    let positions = &spaced.points;
    let by_place = KdTree::new(positions);
    let longest = 0.25 * spaced.spacing * spaced.spacing;
    let triangles: Vec<_> = (0..mesh.triangles().len()).collect();
    let shares: Vec<Vec<(usize, f64)>> = triangles
        .par_chunks(256)
        .map(|triangles| {
            let mut shares = Vec::new();
            for &t in triangles {
                let triangle = mesh.corners(t);
                let [a, b, c] = triangle;
                let normal = (b - a).cross(c - a);
                let inward = -normal.as_vec3();
                for_each_piece(triangle, longest, &mut |[a, b, c]| {
                    let center = (a + b + c) / 3.0;
                    let faces = |p: &usize| normals[*p].dot(inward) >= 0.0;
                    // Most often the closest does, and finding one point is faster.
                    let closest = by_place.closest(center, 1)[0];
                    let others = || by_place.closest(center, CLOSEST).into_iter();
                    let point = Some(closest).filter(faces).or_else(|| others().find(faces));
                    shares.push((point.unwrap_or(closest), area([a, b, c])));
                });
            }
            shares
        })
        .collect();
    let mut areas = vec![0.0; positions.len()];
    for (point, area) in shares.into_iter().flatten() {
        areas[point] += area;
    }
    areas.into_iter().map(|a| a as f32).collect()
}

/// How many points are looked at for one on the same side of a wall.
const CLOSEST: usize = 4;

/// Halves a triangle along its longest edge until no squared edge is longer than `longest`.
fn for_each_piece(triangle: [DVec3; 3], longest: f64, visit: &mut impl FnMut([DVec3; 3])) {
    let edge = |i: usize| triangle[i].distance_squared(triangle[(i + 1) % 3]);
    let at = (0..3).fold(0, |most, i| if edge(i) > edge(most) { i } else { most });
    if edge(at) <= longest {
        visit(triangle);
        return;
    }
    let [a, b, c] = [0, 1, 2].map(|i| triangle[(at + i) % 3]);
    let middle = a.midpoint(b);
    for_each_piece([a, middle, c], longest, visit);
    for_each_piece([middle, b, c], longest, visit);
}

/// As close to `count` points as some spacing gives.
fn about(mesh: &Mesh, count: u32) -> Spaced {
    let target = f64::from(count);
    let least = least_spacing(mesh, target);
    let mut spacing = about_spacing(mesh, target);
    // Spacings that gave too many points and too few; the truth lies between.
    let (mut too_small, mut too_large) = (0.0, f64::INFINITY);
    let mut last: Option<(f64, f64)> = None;
    let mut best: Option<(f64, Spaced)> = None;
    for round in 0..MOST_ROUNDS {
        let spaced = spread(mesh, spacing);
        let found = spaced.points.len() as f64;
        let off = (found - target).abs();
        if best.as_ref().is_none_or(|(least, ..)| off < *least) {
            best = Some((off, spaced));
        }
        let tolerance = if round * u64::from(count) < CHEAP_POINTS {
            STRICT_TOLERANCE
        } else {
            COUNT_TOLERANCE
        };
        if best
            .as_ref()
            .is_some_and(|(least, ..)| *least <= tolerance * target)
        {
            break;
        }
        if found > target {
            too_small = spacing;
        } else {
            too_large = spacing;
        }
        // Points are about as many as this power of their spacing.
        let power = last.map_or(-2.0, |(last_spacing, last_found)| {
            (found / last_found).ln() / (spacing / last_spacing).ln()
        });
        last = Some((spacing, found));
        spacing *= (target / found).powf(1.0 / power.clamp(-3.0, -1.0));
        if !(too_small < spacing && spacing < too_large) {
            spacing = f64::midpoint(too_small, too_large);
        }
        spacing = spacing.max(least);
    }
    best.expect("at least one round").1
}

/// The distance that about so many points have from each other.
pub(crate) fn about_spacing(mesh: &Mesh, count: f64) -> f64 {
    let on_area = (mesh.area() / (COVERED * count)).sqrt();
    on_area.max(least_spacing(mesh, count))
}

/// With less between them there are more points along the longest edge alone, however little area
/// there is.
fn least_spacing(mesh: &Mesh, count: f64) -> f64 {
    longest_edge(mesh) / (2.0 * REACH * count)
}

/// How many spacings a place of the surface may be from the closest point: less than one, and the
/// way from the centre of a voxel to the triangle and on to the place, each half of a diagonal.
const REACH: f64 = 2.23;

fn longest_edge(mesh: &Mesh) -> f64 {
    let longest = |t: usize| {
        let [a, b, c] = mesh.corners(t);
        a.distance(b).max(b.distance(c)).max(c.distance(a))
    };
    (0..mesh.triangles().len()).map(longest).fold(0.0, f64::max)
}

/// Points no closer than `spacing` to each other, but for those on the two sides of a thin wall;
/// from a lattice of voxels smaller than the spacing by [`ALPHA`].
pub(crate) fn spread(mesh: &Mesh, spacing: f64) -> Spaced {
    let size = spacing / ALPHA;
    let origin = mesh.bounds().0;
    let mut kept = Spaced::new(spacing, origin);
    // A few pieces at a time, so that their candidates, however many, take little memory.
    for pieces in pieces(mesh, size).chunks(PIECES_AT_ONCE) {
        let candidates: Vec<Vec<_>> = pieces
            .par_iter()
            .map(|triangles| {
                let mut candidates = Vec::new();
                for t in triangles.clone() {
                    let triangle = mesh.corners(t);
                    let normal = normal(triangle);
                    let first = candidates.len();
                    for_each_overlapped(triangle, origin, size, |[x, y, z], center| {
                        candidates.push(([z, y, x], closest_point(triangle, center), normal));
                    });
                    // Row by row, so that neighbours offer their points one after the other.
                    candidates[first..].sort_unstable_by_key(|candidate| candidate.0);
                }
                candidates
            })
            .collect();
        for (_, point, normal) in candidates.into_iter().flatten() {
            kept.offer(point, normal);
        }
    }
    kept
}

/// How many pieces offer their points in parallel before they are chosen from.
const PIECES_AT_ONCE: usize = 64;

/// About how many cells the triangles of a piece overlap, unless it is a single one.
const CELLS_OF_PIECE: f64 = (1 << 12) as f64;

/// The triangles in pieces of about the same work.
fn pieces(mesh: &Mesh, size: f64) -> Vec<Range<usize>> {
    let mut pieces = Vec::new();
    let (mut start, mut cells) = (0, 0.0);
    for t in 0..mesh.triangles().len() {
        let [a, b, c] = mesh.corners(t);
        let around = a.distance(b) + b.distance(c) + c.distance(a);
        cells += 1.0 + around / size + (b - a).cross(c - a).length() / (size * size);
        if cells >= CELLS_OF_PIECE {
            pieces.push(start..t + 1);
            (start, cells) = (t + 1, 0.0);
        }
    }
    pieces.push(start..mesh.triangles().len());
    pieces
}

/// Points whose triangles face away from each other by more than this cosine are not neighbours,
/// however close: they lie on the two sides of a thin wall.
const OPPOSED: f64 = -0.5;

/// Points that keep a distance.
pub(crate) struct Spaced {
    spacing: f64,
    pub(crate) points: Vec<DVec3>,
    /// Of the triangles the points lie on.
    normals: Vec<DVec3>,
    cells: Cells,
}

impl Spaced {
    fn new(spacing: f64, origin: DVec3) -> Self {
        Self {
            spacing,
            points: Vec::new(),
            normals: Vec::new(),
            cells: Cells::new(spacing, origin),
        }
    }

    /// Keeps the point unless a neighbour is closer than the spacing.
    fn offer(&mut self, point: DVec3, normal: DVec3) {
        let closest = self.spacing * self.spacing;
        let is_taken = |other: usize| {
            self.points[other].distance_squared(point) < closest
                && self.normals[other].dot(normal) > OPPOSED
        };
        if self.cells.find_near(point, is_taken).is_none() {
            self.cells.push(point);
            self.points.push(point);
            self.normals.push(normal);
        }
    }
}

/// The gradient of the field at each point; where it has none, in the middle of a thin wall, the
/// normal of the triangle the point lies on, turned inwards.
fn inward_normals(spaced: &Spaced, map: &Voxelmap<'_>) -> Vec<Vec3> {
    let field = map.trilinear();
    let normal = |(point, outward): (&DVec3, &DVec3)| {
        let inward = field.inward_direction(point.as_vec3());
        if inward != Vec3::ZERO {
            return inward;
        }
        (-*outward).normalize_or(DVec3::X).as_vec3()
    };
    spaced
        .points
        .iter()
        .zip(&spaced.normals)
        .map(normal)
        .collect()
}
