//! Assets: the data made from one mesh, their file format, and scaled copies.

pub mod format;
mod include;
mod mass;
#[cfg(feature = "alloc")]
mod scale;

pub use self::include::Aligned;
pub use self::mass::MassProperties;
#[cfg(feature = "alloc")]
pub use self::scale::ScaleError;
use crate::map::Voxelmap;
use crate::shell::PointSphereTree;

/// The data made from one mesh before collision queries (section 2.1): its voxelmap, its pointshell
/// in a point-sphere tree, and its mass properties, all in the frame of the asset.
///
/// ```
/// use vps_core::{Aligned, Asset, Ball, Grid, MassProperties, PointSphereTree, Vec3, Voxelmap};
///
/// let grid = Grid::new(Vec3::splat(-0.15), 0.02, [15; 3])?;
/// let axes = [Vec3::X, Vec3::Y, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Y, Vec3::NEG_Z];
/// let ball = Asset {
///     origin: [0.0; 3],
///     voxelmap: Voxelmap::of_field(grid, &Ball::new(0.1))?,
///     tree: PointSphereTree::flat(&axes.map(|a| 0.1 * a), &axes.map(|a| -a), 0.02)?,
///     mass: MassProperties {
///         volume: 4.19e-3,
///         center_of_mass: [0.0; 3],
///         inertia: [1.68e-5, 1.68e-5, 1.68e-5, 0.0, 0.0, 0.0],
///     },
/// };
/// let bytes = ball.to_bytes(); // those of a `.vps` file
/// let mut buffer = Aligned([0; 20_000]);
/// buffer.0[..bytes.len()].copy_from_slice(&bytes);
/// let read = Asset::from_bytes(&buffer.0[..bytes.len()])?;
/// assert_eq!(read.tree.points(), ball.tree.points());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Asset<'a> {
    /// The origin of the asset's frame in the coordinates of the mesh it was built from, in metres;
    /// the axes are the same. A point p of the mesh is at p - `origin` in the asset.
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
