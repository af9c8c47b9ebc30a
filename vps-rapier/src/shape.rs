use std::path::Path;
use std::sync::{Arc, OnceLock};

use rapier3d::math::{Matrix, Real, Vector};
use rapier3d::parry::bounding_volume::{Aabb as ParryAabb, BoundingSphere};
use rapier3d::parry::mass_properties::MassProperties;
use rapier3d::parry::shape::{PolygonalFeatureMap, Shape, ShapeType, SharedShape, TypedShape};
use vps_core::{Aabb, Asset, SurfaceMesh, Vec3};

use crate::check::asked_for_faces;
use crate::real::{core_real, core_vector, real, vector};
use crate::thickness::thickness;

mod project;
mod ray;

/// What a shape is in a pair of VPS shapes (Fig. 5). Against a shape of parry it is the shell, and
/// the field of the other's edges.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Role {
    /// The field, if the other is not that rather.
    Voxelmap,
    /// The shell if its points are closer together than the other's, and the field too if the other is
    /// thinner somewhere than twice their spacing. (Section 3.2 takes the shell of fewer points: faster,
    /// but a small body on a large one is then met by few points.)
    #[default]
    Mixed,
    /// The shell, if the other is not that rather.
    Pointshell,
    /// Shell and field, always: what only one of two shells shows is not missed, for about twice
    /// the time.
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

/// How many times its spacing squared a point of a shell covers, about.
const COVERED: f32 = 1.5;

impl VpsShape {
    /// A shape of an asset, shell or field as fits the pair. Takes some milliseconds to see how thick
    /// it is.
    pub fn new(asset: Arc<Asset<'static>>) -> Self {
        let areas = asset.tree.areas();
        let area: f32 = areas.iter().sum();
        let spacing = (area / (COVERED * areas.len() as f32)).sqrt();
        Self {
            thickness: thickness(&asset),
            asset,
            spacing,
            role: Role::Mixed,
            file: None,
            surface: Arc::default(),
        }
    }

    /// The surface as a mesh to look at, where the field is zero; made when it is first asked for, and
    /// shared by clones.
    pub fn surface_mesh(&self) -> &SurfaceMesh {
        self.surface
            .get_or_init(|| self.asset.voxelmap.surface_mesh())
    }

    /// How far the points of the shell are apart in metres, about.
    pub fn spacing(&self) -> f32 {
        self.spacing
    }

    /// How thick the solid is in metres, but for the thinnest parts: along the normals of all but a
    /// twentieth of its points.
    pub fn thickness(&self) -> f32 {
        self.thickness
    }

    /// The same shape, its asset being the one in a file.
    #[cfg(feature = "build")]
    pub(crate) fn in_file(self, file: &Path) -> Self {
        Self {
            file: Some(file.into()),
            ..self
        }
    }

    /// The file its asset is in, if it is known.
    pub fn file(&self) -> Option<&Path> {
        self.file.as_deref()
    }

    /// The same shape with a preference for what it is in a pair.
    pub fn with_role(self, role: Role) -> Self {
        Self { role, ..self }
    }

    /// What the shape was made from.
    pub fn asset(&self) -> &Asset<'static> {
        &self.asset
    }

    /// What the shape prefers to be in a pair.
    pub fn role(&self) -> Role {
        self.role
    }

    /// Whether a place is where values are stored.
    pub(crate) fn has_in_grid(&self, place: Vec3) -> bool {
        self.asset.voxelmap.grid().bounds().contains(place)
    }

    /// A box that holds all places where the field changes its sign, within the grid.
    fn surface_bounds(&self) -> Aabb {
        let map = &self.asset.voxelmap;
        let (grid, solid, size) = (map.grid().bounds(), map.solid(), map.grid().voxel_size());
        // Between voxels the surface may be this far from where it is.
        let around = 2.0 * size;
        Aabb {
            min: (solid.min - around).max(grid.min + 0.5 * size),
            max: (solid.max + around).min(grid.max - 0.5 * size),
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

    /// By the same positive factor along all axes, which copies the asset; `None` for other scales:
    /// a stretched mesh has other distances, build an asset of it.
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

    /// None: only parry's own dispatcher asks for them, where it finds no contacts.
    fn as_polygonal_feature_map(&self) -> Option<(&dyn PolygonalFeatureMap, Real)> {
        asked_for_faces();
        None
    }

    fn ccd_thickness(&self) -> Real {
        real(0.5 * self.asset.voxelmap.solid().extents().min_element())
    }

    fn ccd_angular_thickness(&self) -> Real {
        real(std::f32::consts::FRAC_PI_4)
    }
}
