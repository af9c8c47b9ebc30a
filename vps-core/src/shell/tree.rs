//! The point-sphere tree.

use glamx::Vec3;

use crate::aabb::Aabb;
use crate::shell::cluster::Cluster;
use crate::shell::error::TreeError;
use crate::storage::Storage;

/// The largest number of levels: 2^32 points with two children a cluster.
pub const MAX_LEVELS: usize = 32;

/// A pointshell in a tree of clusters, each with a ball around its points (section 2.1.2).
///
/// The children of a cluster are consecutive, and so are the points of a leaf. Every point belongs to
/// exactly one leaf. All leaves are on the last level.
///
/// ```
/// use vps_core::{PointSphereTree, Vec3};
///
/// // Two points of a wall, 1 cm² each.
/// let tree = PointSphereTree::flat(&[Vec3::ZERO, Vec3::X], &[Vec3::Y, Vec3::Y], 1e-4)?;
/// assert_eq!((tree.point_count(), tree.level_count()), (2, 1));
/// assert_eq!(tree.point(1), Vec3::X);
/// # Ok::<(), vps_core::TreeError>(())
/// ```
#[derive(Clone, Debug)]
pub struct PointSphereTree<'a> {
    points: Storage<'a, [f32; 3]>,
    normals: Storage<'a, [f32; 3]>,
    areas: Storage<'a, f32>,
    clusters: Storage<'a, Cluster>,
    level_starts: Storage<'a, u32>,
    bounds: Aabb,
    origin_distance_bound: f32,
}

/// The parts of a [`PointSphereTree`], for [`PointSphereTree::from_parts`].
#[derive(Clone, Debug)]
pub struct TreeParts<'a> {
    /// Points in metres in the shell frame, in the order of the leaves.
    pub points: Storage<'a, [f32; 3]>,
    /// Unit inward normals of the points.
    pub normals: Storage<'a, [f32; 3]>,
    /// Areas of the surface that the points represent, in m².
    pub areas: Storage<'a, f32>,
    /// The clusters, one level after the other from the top.
    pub clusters: Storage<'a, Cluster>,
    /// Level L is `level_starts[L - 1]..level_starts[L]`, so there is one start more than levels.
    pub level_starts: Storage<'a, u32>,
}

impl<'a> PointSphereTree<'a> {
    /// A tree from its [parts](crate::raw::TreeParts), for builders of trees.
    ///
    /// Checks all requirements of queries, in one pass over the points for each level.
    ///
    /// # Errors
    /// When the parts do not form such a tree.
    pub fn from_parts(parts: TreeParts<'a>) -> Result<Self, TreeError> {
        let TreeParts {
            points,
            normals,
            areas,
            clusters,
            level_starts,
        } = parts;
        if normals.len() != points.len() || areas.len() != points.len() {
            return Err(TreeError::Counts {
                points: points.len(),
                normals: normals.len(),
                areas: areas.len(),
            });
        }
        let position = |p: &[f32; 3]| Vec3::from_array(*p);
        if let Some(i) = points.iter().position(|p| !position(p).is_finite()) {
            return Err(TreeError::Point(i));
        }
        if let Some(i) = normals.iter().position(|n| !is_unit(position(n), 1e-3)) {
            return Err(TreeError::Normal(i));
        }
        let is_area = |a: &f32| a.is_finite() && *a >= 0.0;
        if let Some(i) = areas.iter().position(|a| !is_area(a)) {
            return Err(TreeError::Area(i));
        }
        let bounds = Aabb::of_points(points.iter().map(position)).ok_or(TreeError::NoPoints)?;
        let origin_distance_bound = bounds.min.abs().max(bounds.max.abs()).length();
        let tree = Self {
            points,
            normals,
            areas,
            clusters,
            level_starts,
            bounds,
            origin_distance_bound,
        };
        tree.check_levels()?;
        tree.check_clusters()?;
        Ok(tree)
    }

    fn check_levels(&self) -> Result<(), TreeError> {
        let starts = &self.level_starts;
        let levels = starts.len().saturating_sub(1);
        let fits = (1..=MAX_LEVELS).contains(&levels)
            && starts[0] == 0
            && starts[1] == 1
            && starts.windows(2).all(|w| w[0] < w[1])
            && starts[levels] as usize == self.clusters.len();
        if fits { Ok(()) } else { Err(TreeError::Levels) }
    }

    fn check_clusters(&self) -> Result<(), TreeError> {
        for level in 1..=self.level_count() {
            let children = if level == self.level_count() {
                self.points.len()
            } else {
                self.level(level + 1).len()
            };
            let mut next = 0;
            let start = self.level_starts[level as usize - 1] as usize;
            for (i, Cluster(cluster)) in self.level(level).iter().enumerate() {
                if cluster.first as usize != next || cluster.count == 0 {
                    return Err(TreeError::Children(start + i));
                }
                next += cluster.count as usize;
                if next > children {
                    return Err(TreeError::Children(start + i));
                }
            }
            if next != children {
                return Err(TreeError::Children(start + self.level(level).len() - 1));
            }
        }
        // From here on all ranges of children are valid.
        for level in 1..=self.level_count() {
            let start = self.level_starts[level as usize - 1] as usize;
            for (i, cluster) in self.level(level).iter().enumerate() {
                let below = self.points_below(level, cluster);
                let Cluster(cluster) = cluster;
                if !below.contains(&(cluster.parent_point as usize)) {
                    return Err(TreeError::ParentPoint(start + i));
                }
                let center = Vec3::from_array(cluster.center);
                // Required by the bounds of queries.
                if !is_unit(Vec3::from_array(cluster.normal), 1e-6) {
                    return Err(TreeError::ClusterNormal(start + i));
                }
                let outside = |&p: &usize| {
                    // A NaN counts as outside.
                    let inside = center.distance(self.point(p)) <= cluster.radius
                        && cluster.distance_from_paraboloid(self.point(p))
                            <= cluster.half_thickness;
                    !inside
                };
                let area: f64 = below.clone().map(|p| f64::from(self.areas[p])).sum();
                // A NaN does not count as equal.
                let is_equal = (f64::from(cluster.area) - area).abs() <= 1e-4 * area;
                if !is_equal {
                    return Err(TreeError::ClusterArea(start + i));
                }
                if let Some(point) = below.into_iter().find(outside) {
                    return Err(TreeError::Bounds {
                        cluster: start + i,
                        point,
                    });
                }
            }
        }
        Ok(())
    }

    /// The points below a cluster of a level, as a range of indices.
    ///
    /// # Panics
    /// If the cluster does not belong to that level.
    pub fn points_below(&self, level: u32, cluster: &Cluster) -> core::ops::Range<usize> {
        let mut range = cluster.children();
        for below in level + 1..=self.level_count() {
            let clusters = self.level(below);
            let [first, last] =
                [range.start, range.end - 1].map(|c| clusters[c as usize].children());
            range = first.start..last.end;
        }
        range.start as usize..range.end as usize
    }

    /// Size of points, normals, areas, clusters and levels in memory in bytes; the same in a file,
    /// without padding.
    pub fn byte_len(&self) -> usize {
        size_of_val(&*self.points)
            + size_of_val(&*self.normals)
            + size_of_val(&*self.areas)
            + size_of_val(&*self.clusters)
            + size_of_val(&*self.level_starts)
    }

    /// Number of points N_P.
    #[inline]
    pub fn point_count(&self) -> usize {
        self.points.len()
    }

    /// Number of levels N_L.
    #[inline]
    pub fn level_count(&self) -> u32 {
        self.level_starts.len() as u32 - 1
    }

    /// The clusters of a level; level 1 is the top with one cluster, level N_L the leaves.
    ///
    /// # Panics
    /// If there is no such level.
    #[inline]
    pub fn level(&self, level: u32) -> &[Cluster] {
        let start = self.level_starts[level as usize - 1] as usize;
        let end = self.level_starts[level as usize] as usize;
        &self.clusters[start..end]
    }

    /// Position P of a point in metres in the shell frame.
    #[inline]
    pub fn point(&self, index: usize) -> Vec3 {
        Vec3::from_array(self.points[index])
    }

    /// Unit inward normal n of a point in the shell frame.
    #[inline]
    pub fn normal(&self, index: usize) -> Vec3 {
        Vec3::from_array(self.normals[index])
    }

    /// The area of the surface that a point represents, in m².
    #[inline]
    pub fn area(&self, index: usize) -> f32 {
        self.areas[index]
    }

    /// All points, in the order of the leaves.
    #[inline]
    pub fn points(&self) -> &[[f32; 3]] {
        &self.points
    }

    /// All normals, in the order of the points.
    #[inline]
    pub fn normals(&self) -> &[[f32; 3]] {
        &self.normals
    }

    /// All areas, in the order of the points.
    #[inline]
    pub fn areas(&self) -> &[f32] {
        &self.areas
    }

    /// All clusters, level by level from the top.
    #[inline]
    pub fn clusters(&self) -> &[Cluster] {
        &self.clusters
    }

    /// The index of the first cluster of each level, followed by the number of clusters.
    pub fn level_starts(&self) -> &[u32] {
        &self.level_starts
    }

    /// Upper bound on the distance of any point from the origin of the shell frame, in metres.
    #[inline]
    pub(crate) fn origin_distance_bound(&self) -> f32 {
        self.origin_distance_bound
    }

    /// A box around all points, in the shell frame.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// The same tree owning its data.
    #[cfg(feature = "alloc")]
    pub fn into_owned(self) -> PointSphereTree<'static> {
        PointSphereTree {
            points: self.points.into_owned(),
            normals: self.normals.into_owned(),
            areas: self.areas.into_owned(),
            clusters: self.clusters.into_owned(),
            level_starts: self.level_starts.into_owned(),
            bounds: self.bounds,
            origin_distance_bound: self.origin_distance_bound,
        }
    }
}

fn is_unit(normal: Vec3, tolerance: f32) -> bool {
    (normal.length() - 1.0).abs() < tolerance
}
