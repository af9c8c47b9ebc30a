//! Shapes from meshes and from files.

use std::path::Path;
use std::sync::Arc;
use std::thread::JoinHandle;

use rapier3d::math::Vector;
use vps_build::{
    AssetCache, BuildError, BuildOptions, CacheError, FileError, Mesh, MeshError, ReadError, build,
    read_asset, read_mesh,
};

use crate::shape::{Role, VpsShape};

/// Builds a [`VpsShape`] from a mesh.
///
/// ```
/// # use vps_rapier::rapier3d::prelude::*;
/// use vps_rapier::VpsShapeBuilder;
///
/// let (vertices, triangles) = Cuboid::new(Vector::new(0.2, 0.1, 0.1)).to_trimesh();
/// let shape = VpsShapeBuilder::from_triangles(&vertices, &triangles)?.build()?;
/// let collider = ColliderBuilder::new(shape.into()).restitution(0.3);
/// # Ok::<(), vps_rapier::ShapeError>(())
/// ```
#[derive(Clone, Debug)]
pub struct VpsShapeBuilder {
    mesh: Mesh,
    options: BuildOptions,
    cache: Option<AssetCache>,
    role: Role,
}

/// Why a shape could not be made.
#[derive(Debug, thiserror::Error)]
pub enum ShapeError {
    /// The triangles are not a valid mesh.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// A mesh file cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The mesh cannot be built.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// The mesh lies so far from its origin that 32-bit coordinates would lose it.
    #[error(
        "the mesh lies around ({0}, {1}, {2}) m, too far from its origin for 32-bit coordinates: move \
         it to its origin, and its collider to where it was"
    )]
    Far(f64, f64, f64),
    /// An asset file cannot be read or written.
    #[error(transparent)]
    File(#[from] FileError),
    /// An asset saved with a world is not valid.
    #[error("an asset saved with a world: {0}")]
    Asset(#[from] vps_core::FormatError),
}

impl From<CacheError> for ShapeError {
    fn from(error: CacheError) -> Self {
        match error {
            CacheError::Build(error) => Self::Build(error),
            CacheError::File(error) => Self::File(error),
        }
    }
}

impl VpsShapeBuilder {
    /// From a mesh in metres.
    pub fn new(mesh: Mesh) -> Self {
        Self {
            mesh,
            options: BuildOptions::default(),
            cache: None,
            role: Role::default(),
        }
    }

    /// From triangles over vertices in metres, counter-clockwise seen from outside.
    ///
    /// # Errors
    /// When they are not a valid mesh.
    pub fn from_triangles(vertices: &[Vector], triangles: &[[u32; 3]]) -> Result<Self, ShapeError> {
        let position = |v: &Vector| v.to_array().map(f64::from).into();
        let vertices: Vec<_> = vertices.iter().map(position).collect();
        Ok(Self::new(Mesh::new(&vertices, triangles)?))
    }

    /// From an OBJ, PLY, STL or OFF file in metres; `object` names one of several objects in it.
    ///
    /// # Errors
    /// When it cannot be read.
    pub fn from_mesh_file(path: &Path, object: Option<&str>) -> Result<Self, ShapeError> {
        Ok(Self::new(read_mesh(path, object)?))
    }

    /// Sets the resolution, the number of points and further options.
    pub fn options(self, options: BuildOptions) -> Self {
        Self { options, ..self }
    }

    /// Sets the preferred role in a pair of VPS shapes.
    pub fn role(self, role: Role) -> Self {
        Self { role, ..self }
    }

    /// Caches the asset in a folder by content: the same mesh with the same options is built once.
    pub fn cached_in(self, folder: &Path) -> Self {
        Self {
            cache: Some(AssetCache::new(folder)),
            ..self
        }
    }

    /// Builds the shape, on all cores. Takes seconds for a fine mesh.
    ///
    /// # Errors
    /// When the mesh cannot be built with these options, lies far from its origin, or the cache cannot
    /// be written.
    pub fn build(self) -> Result<VpsShape, ShapeError> {
        let shape = match &self.cache {
            Some(cache) => {
                let cached = cache.get(&self.mesh, &self.options, &|_| ())?;
                VpsShape::new(cached.asset).in_file(&cached.file)
            }
            None => VpsShape::new(Arc::new(build(&self.mesh, &self.options, &|_| ())?.asset)),
        };
        match shape.asset().origin {
            [0.0, 0.0, 0.0] => Ok(shape.with_role(self.role)),
            [x, y, z] => Err(ShapeError::Far(x, y, z)),
        }
    }

    /// Builds the shape in a thread of its own.
    pub fn build_in_background(self) -> PendingShape {
        PendingShape(std::thread::spawn(|| self.build()))
    }
}

/// A shape that is being built.
#[derive(Debug)]
pub struct PendingShape(JoinHandle<Result<VpsShape, ShapeError>>);

impl PendingShape {
    /// Whether [`wait`](Self::wait) would return at once.
    pub fn is_ready(&self) -> bool {
        self.0.is_finished()
    }

    /// Waits for the shape.
    ///
    /// # Errors
    /// Those of [`VpsShapeBuilder::build`].
    pub fn wait(self) -> Result<VpsShape, ShapeError> {
        self.0
            .join()
            .unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    }
}

impl VpsShape {
    /// The shape of a `.vps` file, as the command `vps-build build` makes them, in the asset's own
    /// frame: [`Asset::origin`](vps_core::Asset::origin) says where that lies in the coordinates of
    /// the mesh.
    ///
    /// # Errors
    /// When the file cannot be read or is not a valid asset.
    pub fn from_file(path: &Path) -> Result<Self, ShapeError> {
        Ok(Self::new(Arc::new(read_asset(path)?)).in_file(path))
    }
}
