//! A cluster of shell points, bounded by a ball and a paraboloid.

use core::ops::Range;

use bytemuck::{Pod, Zeroable};
use glamx::Vec3;
use wide::f32x4;

/// One cluster of a [`PointSphereTree`](crate::PointSphereTree) (eq. 6). Builders of trees make it from
/// its [parts](crate::raw::ClusterParts).
///
/// ```
/// use vps_core::{PointSphereTree, Vec3};
///
/// let tree = PointSphereTree::flat(&[Vec3::ZERO, Vec3::X], &[Vec3::Y, Vec3::Y], 1e-4)?;
/// let top = &tree.level(1)[0];
/// assert_eq!(top.center(), Vec3::X * 0.5);
/// assert!((top.radius() - 0.5).abs() < 1e-5);
/// # Ok::<(), vps_core::TreeError>(())
/// ```
#[repr(transparent)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Cluster(pub(crate) ClusterParts);

impl Cluster {
    /// Centre X of a ball around all points below the cluster, in metres in the shell frame.
    #[inline]
    pub fn center(&self) -> Vec3 {
        Vec3::from_array(self.0.center)
    }

    /// Radius R of that ball in metres.
    #[inline]
    pub fn radius(&self) -> f32 {
        self.0.radius
    }

    /// The children: indices of clusters within the next level, or on the leaf level of points.
    #[inline]
    pub fn children(&self) -> Range<u32> {
        self.0.first..self.0.first + self.0.count
    }

    /// Index of the point that represents the whole cluster, P_1.
    #[inline]
    pub fn parent_point(&self) -> u32 {
        self.0.parent_point
    }

    /// The area of the surface that its points represent, in m².
    #[inline]
    pub fn area(&self) -> f32 {
        self.0.area
    }

    /// Centre and radius; normal and half thickness; apex and half curvature.
    #[inline(always)]
    pub(crate) fn disc(&self) -> (f32x4, f32x4, [f32; 2]) {
        let parts = &self.0;
        let ([x, y, z], [u, v, w]) = (parts.center, parts.normal);
        (
            f32x4::new([x, y, z, parts.radius]),
            f32x4::new([u, v, w, parts.half_thickness]),
            [parts.apex, parts.half_curvature],
        )
    }
}

impl From<ClusterParts> for Cluster {
    fn from(parts: ClusterParts) -> Self {
        Self(parts)
    }
}

/// The parts of a [`Cluster`], as in a `.vps` file. The tree checks them.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct ClusterParts {
    /// Centre X of a ball around all points below the cluster, in metres in the shell frame.
    pub center: [f32; 3],
    /// Radius R of that ball in metres.
    pub radius: f32,
    /// Unit normal of a plane through the centre. The points lie close to a paraboloid with this axis,
    /// which is a disc if `half_curvature` is zero.
    pub normal: [f32; 3],
    /// The largest distance of the points from the paraboloid, in metres along the normal.
    pub half_thickness: f32,
    /// Height of the apex above the centre, in metres along the normal.
    pub apex: f32,
    /// Half curvature of the paraboloid, per metre, positive towards the normal: at a distance r
    /// from the axis its height is apex + half curvature × r².
    pub half_curvature: f32,
    /// The first child: the index of a cluster within the next level, or on the leaf level of a point.
    pub first: u32,
    /// The number of consecutive children.
    pub count: u32,
    /// The point that represents the whole cluster, P_1.
    pub parent_point: u32,
    /// The area of the surface that its points represent, in m².
    pub area: f32,
}

impl ClusterParts {
    /// Cylindrical coordinates of a point: the squared distance from the axis in m², and the height
    /// above the centre in metres along the normal.
    pub fn cylindrical_coordinates(&self, point: Vec3) -> (f32, f32) {
        let normal = Vec3::from_array(self.normal);
        let from_center = point - Vec3::from_array(self.center);
        let height = from_center.dot(normal);
        ((from_center - normal * height).length_squared(), height)
    }

    /// Distance of a point from the paraboloid, in metres along the normal.
    pub fn distance_from_paraboloid(&self, point: Vec3) -> f32 {
        let (square, height) = self.cylindrical_coordinates(point);
        (height - (self.apex + self.half_curvature * square)).abs()
    }
}
