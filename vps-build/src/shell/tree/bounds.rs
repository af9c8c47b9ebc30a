//! Bounds of a cluster: ball, paraboloid and area of the points below it.

use rayon::prelude::*;
use vps_core::Vec3;
use vps_core::raw::ClusterParts;

use crate::enclosing_ball::minimal_ball;

/// Sets the ball, the paraboloid and the area of each cluster from the points below it.
pub(super) fn bound_clusters(
    clusters: &mut [ClusterParts],
    level_starts: &[u32],
    points: &[[f32; 3]],
    normals: &[[f32; 3]],
    areas: &[f32],
) {
    // The range of points below each cluster, from the leaves up.
    let mut below: Vec<(usize, usize)> = vec![(0, 0); clusters.len()];
    let levels = level_starts.len() - 1;
    for level in (0..levels).rev() {
        for c in level_starts[level] as usize..level_starts[level + 1] as usize {
            let (first, last) = (clusters[c].first, clusters[c].first + clusters[c].count - 1);
            below[c] = if level + 1 == levels {
                (first as usize, last as usize + 1)
            } else {
                let start = level_starts[level + 1];
                (
                    below[(start + first) as usize].0,
                    below[(start + last) as usize].1,
                )
            };
        }
    }
    clusters
        .par_iter_mut()
        .zip(below)
        .for_each(|(cluster, (start, end))| {
            let points_below = || points[start..end].iter().map(|&p| Vec3::from_array(p));
            let exact: Vec<_> = points_below().map(Vec3::as_dvec3).collect();
            let center = minimal_ball(&exact).0.as_vec3();
            cluster.center = center.to_array();
            // From the rounded centre, as in a query, so that no point is outside.
            cluster.radius = points_below()
                .map(|p| center.distance(p))
                .fold(0.0, f32::max);
            let sum: Vec3 = normals[start..end]
                .iter()
                .map(|&n| Vec3::from_array(n))
                .sum();
            let normal = sum.normalize_or(Vec3::Y);
            cluster.normal = normal.to_array();
            let coordinates: Vec<_> = points_below()
                .map(|p| cluster.cylindrical_coordinates(p))
                .collect();
            (cluster.apex, cluster.half_curvature) = fit_paraboloid(&coordinates, cluster.radius);
            cluster.half_thickness = points_below()
                .map(|p| cluster.distance_from_paraboloid(p))
                .fold(0.0, f32::max);
            let area: f64 = areas[start..end].iter().map(|&a| f64::from(a)).sum();
            cluster.area = area as f32;
        });
}

/// The apex and the half curvature of the paraboloid h = apex + half curvature × r² that minimises the
/// largest deviation of points, by a search that ends early. Points are given by r² and h: the squared
/// distance from the axis and the height.
fn fit_paraboloid(coordinates: &[(f32, f32)], radius: f32) -> (f32, f32) {
    // Middle and range of the heights above the paraboloid with apex 0.
    let deviation = |half_curvature: f32| {
        let heights = coordinates
            .iter()
            .map(|(square, height)| height - half_curvature * square);
        let (low, high) = heights.fold((f32::MAX, f32::MIN), |(low, high), h| {
            (low.min(h), high.max(h))
        });
        (0.5 * (low + high), high - low)
    };
    if coordinates.len() < 3 || radius == 0.0 {
        return (deviation(0.0).0, 0.0);
    }
    // The range is convex in the half curvature: ternary search.
    let (mut low, mut high) = (-1.0 / radius, 1.0 / radius);
    for _ in 0..12 {
        let third = (high - low) / 3.0;
        if deviation(low + third).1 < deviation(high - third).1 {
            high -= third;
        } else {
            low += third;
        }
    }
    let half_curvature = 0.5 * (low + high);
    (deviation(half_curvature).0, half_curvature)
}
