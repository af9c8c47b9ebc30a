//! A tree without a hierarchy.

use alloc::vec::Vec;

use glamx::Vec3;

use crate::aabb::Aabb;
use crate::shell::cluster::{Cluster, ClusterParts};
use crate::shell::error::TreeError;
use crate::shell::tree::{PointSphereTree, TreeParts};

impl PointSphereTree<'static> {
    /// A tree of a single cluster over `points` (metres, shell frame) with unit inward `normals`, each
    /// of which stands for `area` m² of the surface. For shells of a few points: every query near them
    /// tests them all.
    ///
    /// # Errors
    /// When there is no point, or a point, a normal or the area is invalid.
    ///
    /// ```
    /// use vps_core::{PointSphereTree, Vec3};
    ///
    /// // The corners of the underside of a box, in a frame in its middle.
    /// let corners = [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)];
    /// let corners = corners.map(|(x, z)| 0.1 * Vec3::new(x, -1.0, z));
    /// let tree = PointSphereTree::flat(&corners, &[Vec3::Y; 4], 0.01)?;
    /// assert_eq!(tree.areas().iter().sum::<f32>(), 0.04);
    /// # Ok::<(), vps_core::TreeError>(())
    /// ```
    pub fn flat(points: &[Vec3], normals: &[Vec3], area: f32) -> Result<Self, TreeError> {
        let bounds = Aabb::of_points(points.iter().copied()).ok_or(TreeError::NoPoints)?;
        let center = bounds.center();
        let distances = points.iter().map(|p| center.distance(*p));
        // Rounding moves a point along the normal and across it.
        let radius = distances.fold(0.0, f32::max) * (1.0 + 4.0 * f32::EPSILON);
        let cluster = Cluster::from(ClusterParts {
            center: center.to_array(),
            radius,
            normal: Vec3::Y.to_array(),
            half_thickness: radius,
            apex: 0.0,
            half_curvature: 0.0,
            first: 0,
            count: points.len() as u32,
            parent_point: 0,
            area: area * points.len() as f32,
        });
        let arrays = |vectors: &[Vec3]| vectors.iter().map(Vec3::to_array).collect::<Vec<_>>();
        Self::from_parts(TreeParts {
            points: arrays(points).into(),
            normals: arrays(normals).into(),
            areas: alloc::vec![area; points.len()].into(),
            clusters: alloc::vec![cluster].into(),
            level_starts: alloc::vec![0, 1].into(),
        })
    }
}
