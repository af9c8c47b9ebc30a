//! Bottom-up clustering of the paper (section 2.1.2): the nearest K points, from the leaves up, and a
//! repair of clusters with outliers.

use glamx::DVec3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::levels::{Members, closest_to_mean, parent_points};
use crate::spatial::kd_tree::KdTree;

/// Distance of an outlier from its parent point, relative to the median radius of its level.
const OUTLIER_FACTOR: f64 = 2.0;

/// Clusters of about K = `branching` points, level by level from the leaves up. The first starts at a
/// random point.
pub(super) fn clusters(positions: &[DVec3], branching: usize, seed: u64) -> Vec<Members> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut levels: Vec<Members> = Vec::new();
    // The points themselves first, then the parent points of each level.
    let mut representatives: Vec<usize> = (0..positions.len()).collect();
    while levels.last().is_none_or(|top| top.len() > 1) {
        let points: Vec<_> = representatives.iter().map(|&p| positions[p]).collect();
        let members = group_nearest(&points, branching, &mut rng);
        representatives = parent_points(positions, &representatives, &members);
        levels.push(members);
    }
    levels
}

/// Divides points into clusters of about `size`. Each takes the points closest to its first one, and
/// the next closest starts the next cluster.
fn group_nearest(points: &[DVec3], size: usize, rng: &mut ChaCha8Rng) -> Vec<Vec<usize>> {
    if points.len() <= size {
        return vec![(0..points.len()).collect()];
    }
    let mut left = KdTree::new(points);
    let mut clusters = Vec::new();
    let mut next = Some(rng.random_range(0..points.len()));
    while let Some(first) = next {
        let mut members = left.closest(points[first], size + 1);
        next = (members.len() > size).then(|| members[size]);
        members.truncate(size);
        for &member in &members {
            left.remove(member);
        }
        clusters.push(members);
    }
    let repaired = reassign_outliers(points, clusters.clone());
    // With too many outliers a level would not shrink.
    if 4 * repaired.len() <= 3 * points.len() {
        repaired
    } else {
        clusters
    }
}

/// The repair of section 2.1.2: outliers join the cluster with the closest parent point, or become a
/// cluster of their own if that is too far as well.
fn reassign_outliers(points: &[DVec3], mut clusters: Vec<Vec<usize>>) -> Vec<Vec<usize>> {
    let mut radii: Vec<f64> = clusters
        .iter()
        .map(|members| {
            let parent = points[closest_to_mean(points, members)];
            let distances = members.iter().map(|&m| points[m].distance(parent));
            distances.fold(0.0, f64::max)
        })
        .collect();
    let middle = radii.len() / 2;
    let median = *radii.select_nth_unstable_by(middle, f64::total_cmp).1;
    let threshold = OUTLIER_FACTOR * median;
    let mut tagged = Vec::new();
    for members in &mut clusters {
        // Removing a point moves the parent point, so the others are tested again.
        loop {
            let parent = points[closest_to_mean(points, members)];
            let before = members.len();
            members.retain(|&m| {
                let far = points[m].distance(parent) > threshold;
                if far {
                    tagged.push(m);
                }
                !far
            });
            if members.len() == before {
                break;
            }
        }
    }
    let parents: Vec<_> = clusters
        .iter()
        .map(|members| points[closest_to_mean(points, members)])
        .collect();
    let parent_tree = KdTree::new(&parents);
    for point in tagged {
        let closest = parent_tree.closest(points[point], 1)[0];
        if parents[closest].distance(points[point]) <= threshold {
            clusters[closest].push(point);
        } else {
            clusters.push(vec![point]);
        }
    }
    clusters
}
