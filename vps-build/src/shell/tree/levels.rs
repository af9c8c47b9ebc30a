//! Levels of clusters, and their parent points.

use glamx::DVec3;

/// The members of each cluster of a level: indices of clusters in the level below, or of points.
pub(super) type Members = Vec<Vec<usize>>;

/// The parent point of each cluster: of its members' parent points (`below`), the closest to their
/// mean.
pub(super) fn parent_points(positions: &[DVec3], below: &[usize], members: &Members) -> Vec<usize> {
    let points: Vec<_> = below.iter().map(|&p| positions[p]).collect();
    let parent = |members: &Vec<usize>| below[closest_to_mean(&points, members)];
    members.iter().map(parent).collect()
}

/// The member closest to the mean of all.
pub(super) fn closest_to_mean(points: &[DVec3], members: &[usize]) -> usize {
    let mean = members.iter().map(|&m| points[m]).sum::<DVec3>() / members.len() as f64;
    let distance = |m: usize| points[m].distance_squared(mean);
    let closest = members
        .iter()
        .min_by(|&&a, &&b| distance(a).total_cmp(&distance(b)));
    *closest.expect("a cluster has members")
}
