//! Clusters as the paper makes them (section 2.1.2): the nearest K points, from the leaves up, and a
//! repair of those with points far apart.

use glamx::DVec3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::cluster::{Members, closest_to_average, parent_points};
use crate::kdtree::KdTree;

/// A point this many times further from its parent point than is usual on its level goes
/// elsewhere.
const TOO_FAR: f64 = 2.0;

/// The members of clusters of about K = `branching` points, level by level from the leaves up; the
/// first starts with a random point.
pub(crate) fn clusters(positions: &[DVec3], branching: usize, seed: u64) -> Vec<Members> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut levels: Vec<Members> = Vec::new();
    // What is grouped first is the points themselves, then those that stand for clusters.
    let mut grouped: Vec<usize> = (0..positions.len()).collect();
    while levels.last().is_none_or(|top| top.len() > 1) {
        let points: Vec<_> = grouped.iter().map(|&p| positions[p]).collect();
        let members = group(&points, branching, &mut rng);
        grouped = parent_points(positions, &grouped, &members);
        levels.push(members);
    }
    levels
}

/// Divides points into clusters of about `size`, one after the other: each takes the points
/// closest to its first one, and the next closest starts the next cluster.
fn group(points: &[DVec3], size: usize, rng: &mut ChaCha8Rng) -> Vec<Vec<usize>> {
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
    let regrouped = regroup_far_points(points, clusters.clone());
    // With nothing but outliers a level would not shrink.
    if 4 * regrouped.len() <= 3 * points.len() {
        regrouped
    } else {
        clusters
    }
}

/// The repair of section 2.1.2: points too far from their cluster's parent point join the cluster
/// whose parent point is closest, or become a cluster of their own if that is too far as well.
fn regroup_far_points(points: &[DVec3], mut clusters: Vec<Vec<usize>>) -> Vec<Vec<usize>> {
    let mut radii: Vec<f64> = clusters
        .iter()
        .map(|members| {
            let parent = points[closest_to_average(points, members)];
            let distances = members.iter().map(|&m| points[m].distance(parent));
            distances.fold(0.0, f64::max)
        })
        .collect();
    let middle = radii.len() / 2;
    let usual = *radii.select_nth_unstable_by(middle, f64::total_cmp).1;
    let threshold = TOO_FAR * usual;
    let mut tagged = Vec::new();
    for members in &mut clusters {
        // Removing a point moves the parent point, so the others are looked at again.
        loop {
            let parent = points[closest_to_average(points, members)];
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
        .map(|members| points[closest_to_average(points, members)])
        .collect();
    let by_place = KdTree::new(&parents);
    for point in tagged {
        let closest = by_place.closest(points[point], 1)[0];
        if parents[closest].distance(points[point]) <= threshold {
            clusters[closest].push(point);
        } else {
            clusters.push(vec![point]);
        }
    }
    clusters
}
