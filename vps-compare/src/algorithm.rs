use std::sync::Arc;

use vps_build::{BuildOptions, Mesh, build};
use vps_core::Asset;

use crate::prepared::Prepared;
use crate::scene::Scene;

/// A collision algorithm with its options.
///
/// The options are the fields of the type: `Default` gives those of an algorithm that is only named,
/// and serde reads others from TOML or from the command. An algorithm takes part in the command and
/// in the experiments once it is in the list of [`Algorithm`](crate::Algorithm).
///
/// ```
/// use rapier3d::math::Pose;
/// use vps_build::Mesh;
/// use vps_compare::{CollisionAlgorithm, Contacts, ConvexHull, Ground, Scene};
///
/// let ball = Mesh::icosphere(0.1, 2)?;
/// let scene = Scene { body: &ball, ground: Ground::Cuboid([1.0, 0.2, 1.0]) };
/// let prepared = ConvexHull.prepare(&scene)?;
/// // The ground reaches up to 0.1 m. The lowest point of the ball is 5 mm below that.
/// let pose = Pose::translation(0.0, 0.195, 0.0);
/// let mut contacts = Contacts::default();
/// prepared.query(&pose, 0.01, &mut contacts).expect("parry knows hulls and boxes");
/// let (_, deepest) = contacts.count_and_deepest();
/// assert!((deepest.unwrap() - 0.005).abs() < 0.004);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait CollisionAlgorithm {
    /// One line of help: what becomes of a mesh.
    fn about(&self) -> &'static str;

    /// Its name in tables and figures, if an experiment gives it no other.
    fn label(&self) -> &'static str;

    /// Its colour in figures as red, green and blue, if an experiment gives it no other.
    fn color(&self) -> [u8; 3];

    /// Whether the command runs it if no algorithm is named. An algorithm for some meshes only is
    /// not in the default set.
    fn is_in_default_set(&self) -> bool {
        true
    }

    /// Checks the options; an error begins with the name of one.
    ///
    /// # Errors
    /// When an option has a value that makes no sense.
    fn check(&self) -> Result<(), String> {
        Ok(())
    }

    /// Takes over the sizes it knows.
    fn set_sizes(&mut self, _sizes: &Sizes) {}

    /// Prepares the shapes of a scene, which may take seconds. Assets come from `assets`.
    ///
    /// # Errors
    /// When the algorithm cannot work on a mesh of the scene.
    fn prepare_with(
        &self,
        scene: &Scene<'_>,
        assets: &AssetSource<'_>,
    ) -> Result<Prepared, PrepareError>;

    /// Prepares the shapes of a scene, which may take seconds. Assets are built.
    ///
    /// # Errors
    /// When the algorithm cannot work on a mesh of the scene.
    fn prepare(&self, scene: &Scene<'_>) -> Result<Prepared, PrepareError> {
        self.prepare_with(scene, &|mesh, options| {
            let built = build(mesh, options, &|_| ()).map_err(|e| e.to_string())?;
            Ok(Arc::new(built.asset))
        })
    }
}

/// Builds an asset, or returns a cached one; an error is one line of text.
pub type AssetSource<'s> = dyn Fn(&Mesh, &BuildOptions) -> Result<Arc<Asset<'static>>, String> + 's;

/// Sizes by which several algorithms are compared.
#[derive(Clone, Copy, Debug)]
pub struct Sizes {
    /// Points of a pointshell.
    pub points: u32,
    /// Voxels along the longest side of a mesh.
    pub voxels: u32,
    /// Largest number of convex parts.
    pub parts: usize,
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
    /// The mesh lies so far from its origin that 32-bit coordinates would lose it.
    #[error(
        "the mesh lies so far from its origin that 32-bit coordinates would lose it: move it to its \
         origin, and its poses by as much"
    )]
    FarFromOrigin,
    /// The mesh is not that of a ball.
    #[error("the vertices of the mesh are not on a ball around its origin")]
    NotABall,
    /// parry refuses the triangles.
    #[error("not a triangle mesh for parry: {0}")]
    Trimesh(String),
}
