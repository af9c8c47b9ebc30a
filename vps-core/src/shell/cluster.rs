//! A cluster of shell points, bounded by a ball and a paraboloid.

use bytemuck::{Pod, Zeroable};
use glamx::Vec3;
use wide::f32x4;

/// One cluster of a [`PointSphereTree`](crate::PointSphereTree) (eq. 6).
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Cluster {
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

impl Cluster {
    /// Centre and radius; normal and half thickness; apex and half curvature.
    #[inline(always)]
    pub(crate) fn disc(&self) -> (f32x4, f32x4, [f32; 2]) {
        let ([x, y, z], [u, v, w]) = (self.center, self.normal);
        (
            f32x4::new([x, y, z, self.radius]),
            f32x4::new([u, v, w, self.half_thickness]),
            [self.apex, self.half_curvature],
        )
    }

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
