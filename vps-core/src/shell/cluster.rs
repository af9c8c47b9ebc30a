//! A cluster of shell points, with the ball and the dish that hold them.

use bytemuck::{Pod, Zeroable};
use glamx::Vec3;
use wide::f32x4;

/// One cluster of a [`PointSphereTree`](crate::PointSphereTree) (eq. 6).
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Cluster {
    /// Centre X of a ball around all points below the cluster, in the shell frame.
    pub center: [f32; 3],
    /// Radius R of that ball in metres.
    pub radius: f32,
    /// Unit normal of a plane through the centre; the points lie close to a dish on it, a disc that
    /// may be bent like a bowl.
    pub normal: [f32; 3],
    /// How far from the dish they lie at most, in metres along the normal.
    pub thickness: f32,
    /// How high above the centre the middle of the dish is, in metres along the normal.
    pub lift: f32,
    /// How much the dish bends towards the normal, per metre: at a distance r from the line through
    /// the centre along the normal it is lift + bulge × r² high.
    pub bulge: f32,
    /// The first child: a cluster of the next level, counted from that level's start, or on the
    /// leaf level a point.
    pub first: u32,
    /// How many children follow each other from there.
    pub count: u32,
    /// The point that stands for the whole cluster, P_1.
    pub parent_point: u32,
    /// The area of the surface its points stand for, in m².
    pub area: f32,
}

impl Cluster {
    /// Centre and radius, normal and thickness, lift and bulge.
    #[inline(always)]
    pub(crate) fn disc(&self) -> (f32x4, f32x4, [f32; 2]) {
        let ([x, y, z], [u, v, w]) = (self.center, self.normal);
        (
            f32x4::new([x, y, z, self.radius]),
            f32x4::new([u, v, w, self.thickness]),
            [self.lift, self.bulge],
        )
    }

    /// The square of how far a point is from the line through the centre along the normal, and how
    /// high above the centre it is, in metres.
    pub fn around(&self, point: Vec3) -> (f32, f32) {
        let normal = Vec3::from_array(self.normal);
        let from_center = point - Vec3::from_array(self.center);
        let height = from_center.dot(normal);
        ((from_center - normal * height).length_squared(), height)
    }

    /// How far from the dish a point is in metres along the normal.
    pub fn off_dish(&self, point: Vec3) -> f32 {
        let (square, height) = self.around(point);
        (height - (self.lift + self.bulge * square)).abs()
    }
}
