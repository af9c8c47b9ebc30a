//! The point-sphere tree (section 2.1.2): points in clusters, clusters in clusters up to a single
//! one, and a minimal ball around the points of each.

use glamx::DVec3;
use rayon::prelude::*;
use vps_core::{Cluster, PointSphereTree, TreeError, Vec3};

use crate::ball::minimal_ball;
use crate::sample::Samples;
use crate::{Clustering, halves, nearest};

/// For each cluster of a level its members, as positions in the level below (in the order of the
/// clusters above them), or among the points.
pub(crate) type Members = Vec<Vec<usize>>;

/// Groups the samples by K = `branching` (at least 2) and orders them by cluster.
pub(crate) fn build_tree(
    samples: &Samples,
    branching: usize,
    clustering: Clustering,
) -> Result<PointSphereTree<'static>, TreeError> {
    let positions = &samples.positions;
    if positions.is_empty() {
        return Err(TreeError::NoPoints);
    }
    // From the leaves up.
    let levels = match clustering {
        Clustering::Halves => halves::clusters(positions, branching),
        Clustering::Nearest { seed } => nearest::clusters(positions, branching, seed),
    };
    assemble(samples, &levels)
}

/// The point that stands for each cluster: of its members, or the points that stand for them, the one
/// closest to their average.
pub(crate) fn parent_points(positions: &[DVec3], below: &[usize], members: &Members) -> Vec<usize> {
    let points: Vec<_> = below.iter().map(|&p| positions[p]).collect();
    let parent = |members: &Vec<usize>| below[closest_to_average(&points, members)];
    members.iter().map(parent).collect()
}

/// Orders clusters and points so that the children of a cluster follow each other, and wraps them
/// in balls.
fn assemble(samples: &Samples, levels: &[Members]) -> Result<PointSphereTree<'static>, TreeError> {
    let mut parents = Vec::new();
    let mut below: Vec<usize> = (0..samples.positions.len()).collect();
    for members in levels {
        below = parent_points(&samples.positions, &below, members);
        parents.push(below.clone());
    }
    let mut clusters: Vec<Cluster> = Vec::new();
    let mut level_starts = vec![0];
    let mut order = vec![0];
    for (members, parents) in levels.iter().zip(&parents).rev() {
        let mut next = Vec::new();
        for &cluster in &order {
            clusters.push(Cluster {
                center: [0.0; 3],
                radius: 0.0,
                normal: [0.0; 3],
                thickness: 0.0,
                lift: 0.0,
                bulge: 0.0,
                first: next.len() as u32,
                count: members[cluster].len() as u32,
                parent_point: parents[cluster] as u32,
                area: 0.0,
            });
            next.extend(&members[cluster]);
        }
        level_starts.push(clusters.len() as u32);
        order = next;
    }
    // Now `order` holds the points.
    let mut new_place = vec![0; order.len()];
    for (new, &old) in order.iter().enumerate() {
        new_place[old] = new as u32;
    }
    let points: Vec<_> = order
        .iter()
        .map(|&p| samples.positions[p].as_vec3().to_array())
        .collect();
    let normals: Vec<_> = order
        .iter()
        .map(|&p| samples.normals[p].to_array())
        .collect();
    for cluster in &mut clusters {
        cluster.parent_point = new_place[cluster.parent_point as usize];
    }
    let areas: Vec<_> = order.iter().map(|&p| samples.areas[p]).collect();
    wrap(&mut clusters, &level_starts, &points, &normals, &areas);
    PointSphereTree::new(
        points.into(),
        normals.into(),
        areas.into(),
        clusters.into(),
        level_starts.into(),
    )
}

/// Gives each cluster the ball, the plane and the area of the points below.
fn wrap(
    clusters: &mut [Cluster],
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
            let held = || points[start..end].iter().map(|&p| Vec3::from_array(p));
            let exact: Vec<_> = held().map(Vec3::as_dvec3).collect();
            let center = minimal_ball(&exact).0.as_vec3();
            cluster.center = center.to_array();
            // Measured from the rounded centre as a query measures it, so no point is left out.
            cluster.radius = held().map(|p| center.distance(p)).fold(0.0, f32::max);
            let facing: Vec3 = normals[start..end]
                .iter()
                .map(|&n| Vec3::from_array(n))
                .sum();
            let normal = facing.normalize_or(Vec3::Y);
            cluster.normal = normal.to_array();
            let around: Vec<_> = held().map(|p| cluster.around(p)).collect();
            (cluster.lift, cluster.bulge) = dish(&around, cluster.radius);
            cluster.thickness = held().map(|p| cluster.off_dish(p)).fold(0.0, f32::max);
            let area: f64 = areas[start..end].iter().map(|&a| f64::from(a)).sum();
            cluster.area = area as f32;
        });
}

/// The lift and bulge of the dish that points lie closest to, given the square of their distance
/// from its axis and their height: the largest distance from it is as small as can be, but for a
/// search that ends early.
fn dish(around: &[(f32, f32)], radius: f32) -> (f32, f32) {
    // The middle of the heights above a bowl without lift, and how far they are from it.
    let off = |bulge: f32| {
        let heights = around
            .iter()
            .map(|(square, height)| height - bulge * square);
        let (low, high) = heights.fold((f32::MAX, f32::MIN), |(low, high), h| {
            (low.min(h), high.max(h))
        });
        (0.5 * (low + high), high - low)
    };
    if around.len() < 3 || radius == 0.0 {
        return (off(0.0).0, 0.0);
    }
    // How far off they are is convex in the bulge: the third of the range beyond the larger of two
    // is left out.
    let (mut low, mut high) = (-1.0 / radius, 1.0 / radius);
    for _ in 0..12 {
        let third = (high - low) / 3.0;
        if off(low + third).1 < off(high - third).1 {
            high -= third;
        } else {
            low += third;
        }
    }
    let bulge = 0.5 * (low + high);
    (off(bulge).0, bulge)
}

/// The member closest to the average of all: the parent point.
pub(crate) fn closest_to_average(points: &[DVec3], members: &[usize]) -> usize {
    let average = members.iter().map(|&m| points[m]).sum::<DVec3>() / members.len() as f64;
    let distance = |m: usize| points[m].distance_squared(average);
    let closest = members
        .iter()
        .min_by(|&&a, &&b| distance(a).total_cmp(&distance(b)));
    *closest.expect("a cluster has members")
}
