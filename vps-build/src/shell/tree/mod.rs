//! The point-sphere tree (section 2.1.2): clusters of points, clusters of clusters up to a single one,
//! and a minimal ball around the points of each.
//!
//! `bisect` and `bottom_up` cluster the points, `levels` describes the result, `bounds` computes balls
//! and paraboloids.

mod bisect;
mod bottom_up;
mod bounds;
mod levels;

use vps_core::raw::{ClusterParts, TreeParts};
use vps_core::{Cluster, PointSphereTree, TreeError};

use self::bounds::bound_clusters;
use self::levels::{Members, parent_points};
use super::SurfaceSamples;
use crate::options::Clustering;

/// The tree over the samples with K = `branching`, at least 2. Points are ordered by cluster.
///
/// # Errors
/// When there are no samples, or the tree is invalid.
pub(crate) fn build_tree(
    samples: &SurfaceSamples,
    branching: usize,
    clustering: Clustering,
) -> Result<PointSphereTree<'static>, TreeError> {
    let positions = &samples.positions;
    if positions.is_empty() {
        return Err(TreeError::NoPoints);
    }
    // From the leaves up.
    let levels = match clustering {
        Clustering::Bisect => bisect::clusters(positions, branching),
        Clustering::BottomUp { seed } => bottom_up::clusters(positions, branching, seed),
    };
    assemble(samples, &levels)
}

/// Orders clusters and points so that the children of a cluster are contiguous, and bounds them.
fn assemble(
    samples: &SurfaceSamples,
    levels: &[Members],
) -> Result<PointSphereTree<'static>, TreeError> {
    let mut parents = Vec::new();
    let mut below: Vec<usize> = (0..samples.positions.len()).collect();
    for members in levels {
        below = parent_points(&samples.positions, &below, members);
        parents.push(below.clone());
    }
    let mut clusters: Vec<ClusterParts> = Vec::new();
    let mut level_starts = vec![0];
    let mut order = vec![0];
    for (members, parents) in levels.iter().zip(&parents).rev() {
        let mut next = Vec::new();
        for &cluster in &order {
            clusters.push(ClusterParts {
                center: [0.0; 3],
                radius: 0.0,
                normal: [0.0; 3],
                half_thickness: 0.0,
                apex: 0.0,
                half_curvature: 0.0,
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
    // `order` now holds the points.
    let mut new_position = vec![0; order.len()];
    for (new, &old) in order.iter().enumerate() {
        new_position[old] = new as u32;
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
        cluster.parent_point = new_position[cluster.parent_point as usize];
    }
    let areas: Vec<_> = order.iter().map(|&p| samples.areas[p]).collect();
    bound_clusters(&mut clusters, &level_starts, &points, &normals, &areas);
    let clusters: Vec<_> = clusters.into_iter().map(Cluster::from).collect();
    PointSphereTree::from_parts(TreeParts {
        points: points.into(),
        normals: normals.into(),
        areas: areas.into(),
        clusters: clusters.into(),
        level_starts: level_starts.into(),
    })
}
