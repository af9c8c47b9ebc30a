use bytemuck::{Pod, Zeroable};
use glamx::{Mat3, Vec3};

use crate::{PointSphereTree, Voxelmap};

/// Mass properties of a homogeneous solid of density one (1 kg/m³).
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct MassProperties {
    /// Volume in m³, which is the mass in kg at density one.
    pub volume: f32,
    /// Centre of mass in metres, in the frame of the asset.
    pub center_of_mass: [f32; 3],
    /// Inertia about the centre of mass in kg m² at density one, along the axes of the mesh:
    /// xx, yy, zz, xy, xz, yz.
    pub inertia: [f32; 6],
}

impl MassProperties {
    /// The centre of mass in metres.
    pub fn center(&self) -> Vec3 {
        Vec3::from_array(self.center_of_mass)
    }

    /// The inertia tensor about the centre of mass in kg m², for a body of `mass` kg.
    pub fn inertia_tensor(&self, mass: f32) -> Mat3 {
        let [xx, yy, zz, xy, xz, yz] = self.inertia.map(|i| i * mass / self.volume);
        Mat3::from_cols(
            Vec3::new(xx, xy, xz),
            Vec3::new(xy, yy, yz),
            Vec3::new(xz, yz, zz),
        )
    }
}

/// All that is made from one mesh before it collides (section 2.1): its voxelmap, its pointshell
/// in a point-sphere tree, and its mass properties, all in one frame, that of the asset.
#[derive(Clone, Debug)]
pub struct Asset<'a> {
    /// Where the origin of the asset's frame lies in the coordinates of the mesh it was built from,
    /// in metres; the axes are the same. A point p of the mesh is at p - `origin` in the asset.
    ///
    /// It is zero unless the mesh lies so far from its own origin that 32-bit coordinates would be
    /// off by a thousandth of a voxel. A body whose pose places the mesh in the world places the
    /// asset there with `pose * origin` as its translation, to be computed in 64 bits.
    pub origin: [f64; 3],
    /// The mesh as a distance field.
    pub voxelmap: Voxelmap<'a>,
    /// The mesh as a pointshell.
    pub tree: PointSphereTree<'a>,
    /// The solid's mass properties.
    pub mass: MassProperties,
}

impl Asset<'_> {
    /// The same asset owning its data.
    #[cfg(feature = "alloc")]
    pub fn into_owned(self) -> Asset<'static> {
        Asset {
            origin: self.origin,
            voxelmap: self.voxelmap.into_owned(),
            tree: self.tree.into_owned(),
            mass: self.mass,
        }
    }
}
