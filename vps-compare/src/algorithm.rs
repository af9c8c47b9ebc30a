use crate::prepared::Prepared;
use crate::scene::Scene;

/// A collision algorithm with its parameters.
pub trait CollisionAlgorithm {
    /// Prepares the shapes of a scene.
    ///
    /// # Errors
    /// When the algorithm cannot work on a mesh of the scene.
    fn prepare(&self, scene: &Scene<'_>) -> Result<Prepared, PrepareError>;
}

/// Why an algorithm cannot work on a mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PrepareError {
    /// Hull or parts have no volume.
    #[error("the {0} of the mesh has no volume")]
    NoVolume(&'static str),
    /// No parts were found.
    #[error("convex decomposition gives no part with a volume")]
    NoParts,
    /// The asset cannot be built.
    #[error("cannot build the asset: {0}")]
    Asset(String),
    /// A mesh cannot be taken for a box.
    #[error("a mesh cannot be an exact cuboid")]
    NotACuboid,
    /// parry refuses the triangles.
    #[error("not a triangle mesh for parry: {0}")]
    Trimesh(String),
}
