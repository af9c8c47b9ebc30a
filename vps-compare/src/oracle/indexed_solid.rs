//! Solids prepared for distance and depth searches.

use vps_build::ExactSolid;

use super::ball_tree::BallTree;

/// A solid with the triangles of its surface in a tree.
pub(super) struct IndexedSolid {
    pub(super) solid: ExactSolid,
    pub(super) tree: BallTree,
    /// Length of the longest side of the bounding box.
    pub(super) size: f64,
}

impl IndexedSolid {
    pub(super) fn new(solid: ExactSolid) -> Self {
        let (low, high) = solid.surface().bounds();
        Self {
            tree: BallTree::new(solid.surface()),
            size: (high - low).max_element(),
            solid,
        }
    }
}
