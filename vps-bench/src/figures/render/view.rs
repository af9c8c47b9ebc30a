//! Where a picture is seen from.

use vps_core::Vec3;

/// A direction to look in, a point in the middle of the picture, and how large all is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct View {
    right: Vec3,
    up: Vec3,
    /// To the eye.
    towards: Vec3,
    middle: Vec3,
    /// Metres from the left side of the picture to the right one.
    width_m: f32,
}

impl View {
    /// From an eye that is turned about the y axis, which points up, by `azimuth` (0: along −z) and
    /// raised by `elevation`, both in degrees.
    pub(crate) fn from(azimuth: f32, elevation: f32, middle: Vec3, width_m: f32) -> Self {
        let (sin_a, cos_a) = azimuth.to_radians().sin_cos();
        let (sin_e, cos_e) = elevation.to_radians().sin_cos();
        let towards = Vec3::new(sin_a * cos_e, sin_e, cos_a * cos_e);
        let right = Vec3::new(cos_a, 0.0, -sin_a);
        Self {
            right,
            up: towards.cross(right),
            towards,
            middle,
            width_m,
        }
    }

    /// Pixels a metre is long in a picture `width` pixels wide.
    pub(super) fn scale(&self, width: u32) -> f32 {
        width as f32 / self.width_m
    }

    /// Where a point is in a picture: pixels to the right, pixels down, and pixels to the eye.
    pub(super) fn at(&self, point: Vec3, [width, height]: [u32; 2]) -> Vec3 {
        let from_middle = (point - self.middle) * self.scale(width);
        Vec3::new(
            0.5 * width as f32 + from_middle.dot(self.right),
            0.5 * height as f32 - from_middle.dot(self.up),
            from_middle.dot(self.towards),
        )
    }

    /// Where a pixel of a picture is, in the plane through the middle.
    pub(super) fn point_at(&self, [x, y]: [f32; 2], [width, height]: [u32; 2]) -> Vec3 {
        let metres = self.scale(width).recip();
        self.middle
            + self.right * ((x - 0.5 * width as f32) * metres)
            + self.up * ((0.5 * height as f32 - y) * metres)
    }
}
