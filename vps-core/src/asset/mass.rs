//! Mass properties.

use bytemuck::{Pod, Zeroable};
use glamx::{Mat3, Vec3};

/// Mass properties of a homogeneous solid of density one (1 kg/m³).
///
/// ```
/// use vps_core::MassProperties;
///
/// // A cube of a metre.
/// let cube = MassProperties {
///     volume: 1.0,
///     center_of_mass: [0.5; 3],
///     inertia: [1.0 / 6.0, 1.0 / 6.0, 1.0 / 6.0, 0.0, 0.0, 0.0],
/// };
/// assert!((cube.inertia_tensor(12.0).x_axis.x - 2.0).abs() < 1e-6);
/// ```
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
