//! Why a tree is refused.

/// Why a [`PointSphereTree`](crate::PointSphereTree) was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TreeError {
    /// A shell needs a point.
    #[error("the pointshell has no point")]
    NoPoints,
    /// Each point has one normal and one area.
    #[error("{points} points but {normals} normals and {areas} areas")]
    Counts {
        /// Points given.
        points: usize,
        /// Normals given.
        normals: usize,
        /// Areas given.
        areas: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("point {0} is not finite")]
    Point(usize),
    /// A normal is not of length one.
    #[error("the normal of point {0} is not of length one")]
    Normal(usize),
    /// An area is negative or no number.
    #[error("the area of point {0} is not a finite number from 0 on")]
    Area(usize),
    /// The area of a cluster is that of its points.
    #[error("the area of cluster {0} is not that of its points")]
    ClusterArea(usize),
    /// The plane of a cluster is none.
    #[error("the normal of cluster {0} is not of length one")]
    ClusterNormal(usize),
    /// Levels begin at 0, grow, and end with the last cluster; the top one holds one cluster.
    #[error("the levels do not divide the clusters, or are more than 32")]
    Levels,
    /// The children of a level's clusters must be the next level (or the points), each once and
    /// in order.
    #[error("the children of cluster {0} are not the next in order")]
    Children(usize),
    /// The parent point lies in another cluster.
    #[error("the parent point of cluster {0} is not below it")]
    ParentPoint(usize),
    /// A ball, or the dish in it, leaves a point out.
    #[error("the ball and dish of cluster {cluster} do not hold point {point}")]
    Disc {
        /// The cluster.
        cluster: usize,
        /// A point below it.
        point: usize,
    },
}
