//! The pointshell (section 2.1.2): centres of surface voxels projected onto the triangles, kept
//! when they are not too close to each other.

use glamx::DVec3;
use rustc_hash::FxHashMap;
use vps_core::{DistanceField, Vec3, Voxelmap};

use crate::places::for_each_overlapped;
use crate::triangle::closest_point;
use crate::{Mesh, PointCount};

/// How many voxels of the sampling grid two points are apart: √2, as the paper suggests.
const ALPHA: f64 = std::f64::consts::SQRT_2;

/// How far a point count may be from the one asked for, as a fraction, before another spacing is
/// tried: little while all rounds together have made few points, then more.
const STRICT_TOLERANCE: f64 = 0.001;
const COUNT_TOLERANCE: f64 = 0.005;
const CHEAP_POINTS: u64 = 100_000;

/// How many spacings are tried.
const MOST_ROUNDS: u64 = 12;

/// Points on a surface, in no order.
pub(crate) struct Samples {
    /// Positions in metres.
    pub(crate) positions: Vec<DVec3>,
    /// Unit inward normals.
    pub(crate) normals: Vec<Vec3>,
}

/// What part of its spacing squared a point covers.
const COVERED: f64 = 0.7;

/// About how many points there are on so much area.
pub(crate) fn about_count(area: f64, spacing: f64) -> f64 {
    area / (COVERED * spacing * spacing)
}

/// Samples the mesh, with normals from the field.
pub(crate) fn sample(mesh: &Mesh, count: PointCount, map: &Voxelmap<'_>) -> Samples {
    let positions = match count {
        PointCount::Spacing(spacing) => spread(mesh, spacing).points,
        PointCount::About(count) => about(mesh, count),
    };
    let normals = inward_normals(mesh, &positions, map);
    Samples { positions, normals }
}

/// As close to `count` points as some spacing gives.
fn about(mesh: &Mesh, count: u32) -> Vec<DVec3> {
    let target = f64::from(count);
    let mut spacing = (mesh.area() / (COVERED * target)).sqrt();
    // Spacings that gave too many points and too few; the truth lies between.
    let (mut too_small, mut too_large) = (0.0, f64::INFINITY);
    let mut best: Option<(f64, Vec<DVec3>)> = None;
    for round in 0..MOST_ROUNDS {
        let positions = spread(mesh, spacing).points;
        let found = positions.len() as f64;
        let off = (found - target).abs();
        if best.as_ref().is_none_or(|(least, ..)| off < *least) {
            best = Some((off, positions));
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
        spacing *= (found / target).sqrt();
        if !(too_small < spacing && spacing < too_large) {
            spacing = f64::midpoint(too_small, too_large);
        }
    }
    best.expect("at least one round").1
}

/// Points no closer than `spacing` to each other, but for those on the two sides of a thin wall;
/// from a lattice of voxels smaller than the spacing by [`ALPHA`].
fn spread(mesh: &Mesh, spacing: f64) -> Spaced {
    let size = spacing / ALPHA;
    let origin = mesh.bounds().0;
    let mut kept = Spaced::new(spacing);
    for t in 0..mesh.triangles().len() {
        let triangle = mesh.corners(t);
        let [a, b, c] = triangle;
        let normal = (b - a).cross(c - a).normalize_or_zero();
        for_each_overlapped(triangle, origin, size, |_, center| {
            kept.offer(closest_point(triangle, center), normal);
        });
    }
    kept
}

/// Points whose triangles face away from each other by more than this cosine are not neighbours,
/// however close: they lie on the two sides of a thin wall.
const OPPOSED: f64 = -0.5;

/// Points that keep a distance, in cells of that size.
struct Spaced {
    spacing: f64,
    points: Vec<DVec3>,
    /// Of the triangles the points lie on.
    normals: Vec<DVec3>,
    cells: FxHashMap<[i64; 3], Vec<u32>>,
}

impl Spaced {
    fn new(spacing: f64) -> Self {
        Self {
            spacing,
            points: Vec::new(),
            normals: Vec::new(),
            cells: FxHashMap::default(),
        }
    }

    /// Keeps the point unless a neighbour is closer than the spacing.
    fn offer(&mut self, point: DVec3, normal: DVec3) {
        let cell = (point / self.spacing).floor().as_i64vec3().to_array();
        let closest = self.spacing * self.spacing;
        for dz in -1..=1 {
            for dy in -1..=1 {
                for dx in -1..=1 {
                    let near = [cell[0] + dx, cell[1] + dy, cell[2] + dz];
                    let near = self.cells.get(&near).into_iter().flatten();
                    for &other in near {
                        let other = other as usize;
                        if self.points[other].distance_squared(point) < closest
                            && self.normals[other].dot(normal) > OPPOSED
                        {
                            return;
                        }
                    }
                }
            }
        }
        self.cells
            .entry(cell)
            .or_default()
            .push(self.points.len() as u32);
        self.points.push(point);
        self.normals.push(normal);
    }
}

/// The share of the surface, from 0 to 1, behind which the other side of a wall is closer than
/// `thickness` metres.
pub(crate) fn opposed_within(mesh: &Mesh, thickness: f64) -> f64 {
    // Fine enough that behind every thin place there is a point almost opposite.
    let samples = spread(mesh, 0.5 * thickness);
    let cell = |p: DVec3| (p / thickness).floor().as_i64vec3().to_array();
    let mut cells: FxHashMap<[i64; 3], Vec<usize>> = FxHashMap::default();
    for (i, &point) in samples.points.iter().enumerate() {
        cells.entry(cell(point)).or_default().push(i);
    }
    let is_thin = |&i: &usize| {
        let (point, normal) = (samples.points[i], samples.normals[i]);
        let [x, y, z] = cell(point);
        let around = (-1..=1).flat_map(move |dx| {
            (-1..=1).flat_map(move |dy| (-1..=1).map(move |dz| [x + dx, y + dy, z + dz]))
        });
        around.filter_map(|c| cells.get(&c)).flatten().any(|&j| {
            let to_other = samples.points[j] - point;
            let depth = -to_other.dot(normal);
            let aside = (to_other + normal * depth).length();
            let opposed = samples.normals[j].dot(normal) < OPPOSED;
            opposed && depth > 0.0 && depth < thickness && aside < thickness
        })
    };
    let thin = (0..samples.points.len()).filter(is_thin).count();
    thin as f64 / samples.points.len() as f64
}

/// The gradient of the field at each point; where it has none, in the middle of a thin wall, the
/// normal of the triangle closest to the point, turned inwards.
fn inward_normals(mesh: &Mesh, positions: &[DVec3], map: &Voxelmap<'_>) -> Vec<Vec3> {
    let field = map.trilinear();
    let normal = |&p: &DVec3| {
        let inward = field.inward_direction(p.as_vec3());
        if inward != Vec3::ZERO {
            return inward;
        }
        let closest = (0..mesh.triangles().len()).min_by(|&a, &b| {
            let distance = |t: usize| closest_point(mesh.corners(t), p).distance_squared(p);
            distance(a).total_cmp(&distance(b))
        });
        let [a, b, c] = mesh.corners(closest.expect("a mesh has triangles"));
        (c - a).cross(b - a).normalize_or(DVec3::X).as_vec3()
    };
    positions.iter().map(normal).collect()
}
