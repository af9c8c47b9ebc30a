//! Why a tree is refused.

/// Why a [`PointSphereTree`](crate::PointSphereTree) was refused.
///
/// ```
/// use vps_core::{PointSphereTree, TreeError, Vec3};
///
/// let refused = PointSphereTree::flat(&[Vec3::ZERO], &[Vec3::Y * 2.0], 1e-4);
/// assert_eq!(refused.unwrap_err(), TreeError::Normal(0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TreeError {
    /// The shell is empty.
    #[error("the pointshell has no point")]
    NoPoints,
    /// The numbers of points, normals and areas differ.
    #[error("{points} points but {normals} normals and {areas} areas")]
    Counts {
        /// Points given.
        points: usize,
        /// Normals given.
        normals: usize,
        /// Areas given.
        areas: usize,
    },
    /// A coordinate is not finite.
    #[error("point {0} is not finite")]
    Point(usize),
    /// A normal is not of length one.
    #[error("the normal of point {0} is not of length one")]
    Normal(usize),
    /// An area is negative or not finite.
    #[error("the area of point {0} is not a finite number from 0 on")]
    Area(usize),
    /// The area of a cluster is not the sum of those of its points.
    #[error("the area of cluster {0} is not that of its points")]
    ClusterArea(usize),
    /// The normal of a cluster is not of length one.
    #[error("the normal of cluster {0} is not of length one")]
    ClusterNormal(usize),
    /// The level starts must begin at 0, increase, and end with the number of clusters; the top
    /// level has one cluster.
    #[error("the levels do not divide the clusters, or are more than 32")]
    Levels,
    /// The children of the clusters of a level must be the next level (or the points), each once
    /// and in order.
    #[error("the children of cluster {0} are not the next in order")]
    Children(usize),
    /// The parent point belongs to another cluster.
    #[error("the parent point of cluster {0} is not below it")]
    ParentPoint(usize),
    /// A point lies outside of the ball or too far from the paraboloid.
    #[error("the ball and paraboloid of cluster {cluster} do not contain point {point}")]
    Bounds {
        /// The cluster.
        cluster: usize,
        /// A point below it.
        point: usize,
    },
}
