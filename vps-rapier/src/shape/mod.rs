//! The collision shape: an asset as a shape of parry, its construction, and queries about it alone.

use std::path::Path;
use std::sync::{Arc, OnceLock};

use rapier3d::math::{Matrix, Real, Vector};
use rapier3d::parry::bounding_volume::{Aabb as ParryAabb, BoundingSphere};
use rapier3d::parry::mass_properties::MassProperties;
use rapier3d::parry::shape::{PolygonalFeatureMap, Shape, ShapeType, SharedShape, TypedShape};
use vps_core::{Aabb, Asset, SurfaceMesh, Vec3};

use self::thickness::thickness;
use crate::precision::{core_real, core_vector, real, vector};
use crate::warnings::warn_if_disconnected;

#[cfg(feature = "build")]
pub(crate) mod builder;
mod project;
mod ray;
mod thickness;

/// The role of a shape in a pair of VPS shapes (Fig. 5). Against a shape of parry it is the shell, and
/// its field is asked about the edges of the other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Role {
    /// The field. Of two such shapes, the one whose points are further apart.
    Voxelmap,
    /// The shell if its points are closer together than the other's, and also the field if the other is
    /// somewhere thinner than twice their spacing. (Section 3.2 takes the shell of fewer points. That is
    /// faster, but few points of a large body meet a small one.)
    #[default]
    Mixed,
    /// The shell. Of two such shapes, the one whose points are closer together.
    Pointshell,
    /// Always both shell and field: contacts that only one of the two shells shows are found, for about
    /// twice the time.
    Both,
}

/// An [`Asset`] as a shape of parry: solid, in the frame of its mesh.
///
/// Cloning shares the asset.
#[derive(Clone)]
pub struct VpsShape {
    asset: Arc<Asset<'static>>,
    spacing: f32,
    thickness: f32,
    role: Role,
    file: Option<Arc<Path>>,
    surface: Arc<OnceLock<SurfaceMesh>>,
}

/// Area a point of a shell covers, in squares of the spacing of the points.
const AREA_PER_POINT: f32 = 1.5;

impl VpsShape {
    /// A shape of an asset with the default [`Role`]. Takes some milliseconds to measure its thickness.
    pub fn new(asset: Arc<Asset<'static>>) -> Self {
        let areas = asset.tree.areas();
        let area: f32 = areas.iter().sum();
        let spacing = (area / (AREA_PER_POINT * areas.len() as f32)).sqrt();
        Self {
            thickness: thickness(&asset),
            asset,
            spacing,
            role: Role::Mixed,
            file: None,
            surface: Arc::default(),
        }
    }

    /// The zero level of the field as a mesh, for display. It is made at the first call and shared by
    /// clones.
    pub fn surface_mesh(&self) -> &SurfaceMesh {
        self.surface
            .get_or_init(|| self.asset.voxelmap.surface_mesh())
    }

    /// Approximate spacing of the points of the shell in metres.
    pub fn spacing(&self) -> f32 {
        self.spacing
    }

    /// Thickness of the solid in metres: all but a twentieth of the points measure at least that along
    /// their normals.
    pub fn thickness(&self) -> f32 {
        self.thickness
    }

    /// The same shape, which remembers the file of its asset.
    #[cfg(feature = "build")]
    pub(crate) fn in_file(self, file: &Path) -> Self {
        Self {
            file: Some(file.into()),
            ..self
        }
    }

    /// The file of its asset, if it is known.
    pub fn file(&self) -> Option<&Path> {
        self.file.as_deref()
    }

    /// The same shape with another preferred role.
    pub fn with_role(self, role: Role) -> Self {
        Self { role, ..self }
    }

    /// The asset the shape was made from.
    pub fn asset(&self) -> &Asset<'static> {
        &self.asset
    }

    /// The preferred role in a pair of VPS shapes.
    pub fn role(&self) -> Role {
        self.role
    }

    /// Whether a point lies in the grid of the voxelmap, where values are stored.
    pub(crate) fn has_in_grid(&self, point: Vec3) -> bool {
        self.asset.voxelmap.grid().bounds().contains(point)
    }

    /// A box within the grid that holds all zeros of the field.
    fn surface_bounds(&self) -> Aabb {
        let map = &self.asset.voxelmap;
        let (grid, solid, size) = (map.grid().bounds(), map.solid(), map.grid().voxel_size());
        // Interpolation between voxels may move the surface by this much.
        let padding = 2.0 * size;
        Aabb {
            min: (solid.min - padding).max(grid.min + 0.5 * size),
            max: (solid.max + padding).min(grid.max - 0.5 * size),
        }
    }
}

impl From<VpsShape> for SharedShape {
    fn from(shape: VpsShape) -> Self {
        SharedShape::new(shape)
    }
}

impl Shape for VpsShape {
    fn compute_local_aabb(&self) -> ParryAabb {
        let solid = self.asset.voxelmap.solid();
        ParryAabb::new(vector(solid.min), vector(solid.max))
    }

    fn compute_local_bounding_sphere(&self) -> BoundingSphere {
        let solid = self.asset.voxelmap.solid();
        let radius = 0.5 * solid.extents().length();
        BoundingSphere::new(vector(solid.center()), real(radius))
    }

    fn clone_dyn(&self) -> Box<dyn Shape> {
        Box::new(self.clone())
    }

    /// Scales by the same positive factor along all axes, which copies the asset. `None` for other
    /// scales: a stretched mesh has other distances and needs an asset of its own.
    fn scale_dyn(&self, scale: Vector, _subdivisions: u32) -> Option<Box<dyn Shape>> {
        let scale = core_vector(scale);
        let is_uniform = scale.max_element() - scale.min_element() <= 1e-6 * scale.x.abs();
        let asset = self.asset.scaled(scale.x).ok().filter(|_| is_uniform)?;
        Some(Box::new(Self::new(Arc::new(asset)).with_role(self.role)))
    }

    fn mass_properties(&self, density: Real) -> MassProperties {
        let mass = self.asset.mass;
        let kilograms = density * real(mass.volume);
        let inertia = mass.inertia_tensor(core_real(kilograms));
        let inertia = Matrix::from_cols_array(&inertia.to_cols_array().map(real));
        MassProperties::with_inertia_matrix(vector(mass.center()), kilograms, inertia)
    }

    fn shape_type(&self) -> ShapeType {
        ShapeType::Custom
    }

    fn as_typed_shape(&self) -> TypedShape<'_> {
        TypedShape::Custom(self)
    }

    /// `None`. Only parry's own dispatcher asks for it, and then finds no contacts.
    fn as_polygonal_feature_map(&self) -> Option<(&dyn PolygonalFeatureMap, Real)> {
        warn_if_disconnected();
        None
    }

    fn ccd_thickness(&self) -> Real {
        real(0.5 * self.asset.voxelmap.solid().extents().min_element())
    }

    fn ccd_angular_thickness(&self) -> Real {
        real(std::f32::consts::FRAC_PI_4)
    }
}
