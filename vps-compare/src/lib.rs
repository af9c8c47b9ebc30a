//! Collision algorithms for meshes behind one interface.
//!
//! An algorithm [prepares](CollisionAlgorithm::prepare) a [`Scene`] of a body and a ground, which
//! may take seconds, and gives a [`Prepared`] pair that answers queries. All of them speak through
//! the query dispatcher of parry, so that the same pair can be put in a rapier world or be asked
//! directly.
//!
//! | adapter | what it does to the mesh |
//! |---|---|
//! | [`Vps`] | pointshell against a voxelmap or an exact cuboid |
//! | [`ConvexHull`] | a hull of few support points (GJK and EPA) |
//! | [`ConvexDecomposition`] | VHACD parts with few vertices each |
//! | [`Trimesh`] | nothing |
//!
//! | [`Voxels`] | filled voxels, each a cube |
//!
//! [`oracle`] says how deep a body really is.

#![forbid(unsafe_code)]

mod convex_decomposition;
mod convex_hull;
mod few_vertices;
mod memory;
pub mod oracle;
mod trimesh;
mod voxels;
mod vps;

use std::sync::Arc;

use glamx::DVec3;
use rapier3d::geometry::{ContactData, ContactManifold, ContactManifoldData};
use rapier3d::math::{Pose, Vector};
use rapier3d::parry::query::{
    ContactManifoldsWorkspace, DefaultQueryDispatcher, PersistentQueryDispatcher, Unsupported,
};
use rapier3d::parry::shape::SharedShape;
use vps_build::Mesh;

pub use convex_decomposition::ConvexDecomposition;
pub use convex_hull::ConvexHull;
pub use memory::Memory;
pub use trimesh::Trimesh;
pub use voxels::Voxels;
pub use vps::{AssetSource, Vps, VpsGround};

/// Answers of parry in the form rapier keeps them.
pub type Dispatcher = dyn PersistentQueryDispatcher<ContactManifoldData, ContactData>;

/// Two solids: a body and a ground.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'m> {
    /// What moves: a closed mesh in metres.
    pub body: &'m Mesh,
    /// What it meets.
    pub ground: Ground<'m>,
}

/// What a body meets.
#[derive(Clone, Copy, Debug)]
pub enum Ground<'m> {
    /// A box around the origin of the ground's frame, by its edge lengths in metres. It stays a box
    /// whatever the algorithm.
    Cuboid([f64; 3]),
    /// A closed mesh in metres, which becomes what the body becomes.
    Mesh(&'m Mesh),
}

/// A collision algorithm with its parameters.
pub trait CollisionAlgorithm {
    /// Makes from the scene whatever the algorithm needs.
    ///
    /// # Errors
    /// When it cannot be made from this mesh.
    fn prepare(&self, scene: &Scene<'_>) -> Result<Prepared, PrepareError>;
}

/// Why an algorithm cannot work on a mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PrepareError {
    /// Hull or parts have no volume.
    #[error("the {0} of the mesh has no volume")]
    Flat(&'static str),
    /// The parts cannot be found.
    #[error("convex decomposition gives no part with a volume")]
    NoParts,
    /// The asset cannot be built.
    #[error("cannot build the asset: {0}")]
    Asset(String),
    /// A mesh cannot be taken for a box.
    #[error("a mesh is no exact cuboid")]
    NotACuboid,
    /// parry refuses the triangles.
    #[error("not a triangle mesh for parry: {0}")]
    Trimesh(String),
}

/// What a scene became.
#[derive(Clone)]
pub struct Prepared {
    /// The body's shape, in the frame of its mesh.
    pub body: SharedShape,
    /// The ground's shape.
    pub ground: SharedShape,
    /// Who answers queries about the two.
    pub dispatcher: Arc<Dispatcher>,
    /// What the body is made of now, such as a number of points, by name.
    pub size: Size,
    /// The same of a ground that was a mesh; empty if it is a box.
    pub ground_size: Size,
}

/// Numbers by name.
pub type Size = Vec<(&'static str, usize)>;

/// Contacts of a pair, kept from query to query as an engine does.
#[derive(Default)]
pub struct Contacts {
    /// One manifold or several, the ground being the first shape.
    pub manifolds: Vec<ContactManifold>,
    workspace: Option<ContactManifoldsWorkspace>,
}

impl Contacts {
    /// The number of points in all manifolds and the deepest penetration in metres, negative if
    /// nothing touches yet; `None` without a point.
    pub fn summary(&self) -> (usize, Option<f32>) {
        summary(self.manifolds.iter())
    }
}

/// The number of points in manifolds and their deepest penetration in metres.
pub fn summary<'m>(manifolds: impl Iterator<Item = &'m ContactManifold>) -> (usize, Option<f32>) {
    let points = manifolds.flat_map(|m| m.points.iter());
    points.fold((0, None), |(count, deepest), point| {
        let depth = -point.dist;
        (
            count + 1,
            Some(deepest.map_or(depth, |d: f32| d.max(depth))),
        )
    })
}

impl Prepared {
    /// What the two shapes take in memory.
    pub fn memory(&self) -> Memory {
        Memory::of(&*self.body).and(Memory::of(&*self.ground))
    }

    /// Updates the contacts for a pose of the body in the ground's frame; contacts up to
    /// `prediction` metres apart are given as well.
    ///
    /// # Errors
    /// When the dispatcher cannot answer for this pair of shapes.
    pub fn query(
        &self,
        body_in_ground: &Pose,
        prediction: f32,
        contacts: &mut Contacts,
    ) -> Result<(), Unsupported> {
        self.dispatcher.contact_manifolds(
            body_in_ground,
            &*self.ground,
            &*self.body,
            prediction,
            &mut contacts.manifolds,
            &mut contacts.workspace,
        )
    }
}

/// A pair of parry's own shapes, each made of its mesh in the same way.
fn parry_pair(
    scene: &Scene<'_>,
    make: impl Fn(&Mesh) -> Result<(SharedShape, Size), PrepareError>,
) -> Result<Prepared, PrepareError> {
    let (body, size) = make(scene.body)?;
    let (ground, ground_size) = match scene.ground {
        Ground::Cuboid(extents) => (cuboid(extents), Size::new()),
        Ground::Mesh(mesh) => make(mesh)?,
    };
    Ok(Prepared {
        body,
        ground,
        dispatcher: Arc::new(DefaultQueryDispatcher),
        size,
        ground_size,
    })
}

fn cuboid(extents: [f64; 3]) -> SharedShape {
    let [x, y, z] = extents.map(|e| 0.5 * e as f32);
    SharedShape::cuboid(x, y, z)
}

fn single(vertices: &[DVec3]) -> Vec<Vector> {
    vertices.iter().map(|v| v.as_vec3()).collect()
}
