//! The point-sphere tree (section 2.1.2): points grouped K by K, the groups grouped again up to a
//! single one, and a minimal ball around the points of each.

use glamx::DVec3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use vps_core::{Cluster, PointSphereTree, TreeError, Vec3};

use crate::ball::minimal_ball;
use crate::kdtree::KdTree;
use crate::sample::Samples;

/// A point this many times further from its parent point than is usual on its level goes
/// elsewhere.
const TOO_FAR: f64 = 2.0;

/// Members of one level's clusters, as positions among the level below, and their parent points.
struct Level {
    members: Vec<Vec<usize>>,
    parent_points: Vec<usize>,
}

/// Groups the samples by K = `branching` (at least 2) and orders them by cluster.
pub(crate) fn build_tree(
    samples: &Samples,
    branching: usize,
    seed: u64,
) -> Result<PointSphereTree<'static>, TreeError> {
    let positions = &samples.positions;
    if positions.is_empty() {
        return Err(TreeError::NoPoints);
    }
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    // From the leaves up; what is grouped first is the points themselves.
    let mut levels: Vec<Level> = Vec::new();
    let mut grouped: Vec<usize> = (0..positions.len()).collect();
    loop {
        let points: Vec<_> = grouped.iter().map(|&p| positions[p]).collect();
        let members = group(&points, branching, &mut rng);
        let parent_points: Vec<_> = members
            .iter()
            .map(|m| grouped[closest_to_average(&points, m)])
            .collect();
        let done = members.len() == 1;
        grouped.clone_from(&parent_points);
        levels.push(Level {
            members,
            parent_points,
        });
        if done {
            break;
        }
    }
    levels.reverse();
    assemble(samples, &levels)
}

/// Orders clusters and points so that the children of a cluster follow each other, and wraps them
/// in balls.
fn assemble(samples: &Samples, levels: &[Level]) -> Result<PointSphereTree<'static>, TreeError> {
    let mut clusters: Vec<Cluster> = Vec::new();
    let mut level_starts = vec![0];
    let mut order = vec![0];
    for level in levels {
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
                count: level.members[cluster].len() as u32,
                parent_point: level.parent_points[cluster] as u32,
                area: 0.0,
            });
            next.extend(&level.members[cluster]);
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
            let held: Vec<_> = points[start..end]
                .iter()
                .map(|&p| Vec3::from_array(p).as_dvec3())
                .collect();
            let center = minimal_ball(&held).0.as_vec3();
            cluster.center = center.to_array();
            // Measured from the rounded centre as a query measures it, so no point is left out.
            cluster.radius = points[start..end]
                .iter()
                .map(|&p| center.distance(Vec3::from_array(p)))
                .fold(0.0, f32::max);
            let facing: Vec3 = normals[start..end]
                .iter()
                .map(|&n| Vec3::from_array(n))
                .sum();
            let normal = facing.normalize_or(Vec3::Y);
            cluster.normal = normal.to_array();
            let held = || points[start..end].iter().map(|&p| Vec3::from_array(p));
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

/// The member closest to the average of all: the parent point.
fn closest_to_average(points: &[DVec3], members: &[usize]) -> usize {
    let average = members.iter().map(|&m| points[m]).sum::<DVec3>() / members.len() as f64;
    let distance = |m: usize| points[m].distance_squared(average);
    let closest = members
        .iter()
        .min_by(|&&a, &&b| distance(a).total_cmp(&distance(b)));
    *closest.expect("a cluster has members")
}
