//! The spacing of points for their number, and their number for a spacing.

use super::poisson::{PoissonDisk, poisson_sample};
use crate::error::BuildError;
use crate::mesh::Mesh;
use crate::options::PointCount;

/// Relative error of the point count at which the search stops: strict until all rounds together
/// have sampled [`CHEAP_POINTS`].
const STRICT_TOLERANCE: f64 = 0.001;
const COUNT_TOLERANCE: f64 = 0.01;
const CHEAP_POINTS: u64 = 20_000;

/// Most spacings tried.
const MAX_ROUNDS: u64 = 12;

/// Approximate area of a point, in squared spacings.
const AREA_PER_POINT: f64 = 1.5;

/// The number of points at a spacing in metres: estimated from the area, or a lower bound from the
/// longest edge.
fn estimate_count(mesh: &Mesh, spacing: f64) -> f64 {
    let on_area = mesh.area() / (AREA_PER_POINT * spacing * spacing);
    on_area.max(longest_edge(mesh) / (2.0 * COVERING_RADIUS * spacing))
}

/// An estimate of the number of points.
///
/// # Errors
/// When there would be none or too many.
pub(crate) fn max_points(mesh: &Mesh, points: PointCount) -> Result<f64, BuildError> {
    match points {
        PointCount::About(0) => Err(BuildError::Points),
        PointCount::About(count) => Ok(f64::from(count)),
        PointCount::Spacing(spacing) => {
            if !(spacing > 0.0 && spacing.is_finite()) {
                return Err(BuildError::Spacing(spacing));
            }
            let most = estimate_count(mesh, spacing);
            if most > f64::from(u32::MAX >> 2) {
                return Err(BuildError::TooManyPoints {
                    spacing_m: spacing,
                    points: most as u64,
                });
            }
            Ok(most)
        }
    }
}

/// The samples at the spacing that gives about `count` points.
pub(super) fn sample_to_count(mesh: &Mesh, count: u32) -> PoissonDisk {
    let target = f64::from(count);
    let least = min_spacing(mesh, target);
    let mut spacing = spacing_for(mesh, target);
    // Bounds of the spacing: it gave too many points, or too few.
    let (mut too_small, mut too_large) = (0.0, f64::INFINITY);
    let mut last: Option<(f64, f64)> = None;
    let mut best: Option<(f64, PoissonDisk)> = None;
    for round in 0..MAX_ROUNDS {
        let disk = poisson_sample(mesh, spacing);
        let found = disk.points.len() as f64;
        let off = (found - target).abs();
        if best.as_ref().is_none_or(|(least, ..)| off < *least) {
            best = Some((off, disk));
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
        // The number of points is about this power of their spacing.
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

/// The spacing in metres of about `count` points.
pub(crate) fn spacing_for(mesh: &Mesh, count: f64) -> f64 {
    let on_area = (mesh.area() / (AREA_PER_POINT * count)).sqrt();
    on_area.max(min_spacing(mesh, count))
}

/// The spacing in metres below which the longest edge alone has more than `count` points.
fn min_spacing(mesh: &Mesh, count: f64) -> f64 {
    longest_edge(mesh) / (2.0 * COVERING_RADIUS * count)
}

/// Largest distance of a position on the surface from the closest point, in spacings. It is less than
/// one spacing to a rejected candidate, plus half a voxel's diagonal from there to the voxel's centre,
/// plus half a diagonal to the position.
const COVERING_RADIUS: f64 = 2.23;

fn longest_edge(mesh: &Mesh) -> f64 {
    let longest = |t: usize| {
        let [a, b, c] = mesh.corners(t);
        a.distance(b).max(b.distance(c)).max(c.distance(a))
    };
    (0..mesh.triangles().len()).map(longest).fold(0.0, f64::max)
}
