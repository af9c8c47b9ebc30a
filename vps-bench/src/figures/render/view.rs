//! Orthographic views.

use vps_core::Vec3;

/// An orthographic view: its axes, the point at the centre of the picture, and its width.
#[derive(Clone, Copy, Debug)]
pub(crate) struct View {
    right: Vec3,
    up: Vec3,
    /// Towards the eye.
    to_eye: Vec3,
    center: Vec3,
    /// Width of the picture in metres.
    width_m: f32,
}

impl View {
    /// A view turned about the y axis, which points up, by `azimuth` (0: along −z) and raised by
    /// `elevation`, both in degrees.
    pub(crate) fn from(azimuth: f32, elevation: f32, center: Vec3, width_m: f32) -> Self {
        let (sin_a, cos_a) = azimuth.to_radians().sin_cos();
        let (sin_e, cos_e) = elevation.to_radians().sin_cos();
        let to_eye = Vec3::new(sin_a * cos_e, sin_e, cos_a * cos_e);
        let right = Vec3::new(cos_a, 0.0, -sin_a);
        Self {
            right,
            up: to_eye.cross(right),
            to_eye,
            center,
            width_m,
        }
    }

    /// Pixels per metre in a picture `width` pixels wide.
    pub(super) fn scale(&self, width: u32) -> f32 {
        width as f32 / self.width_m
    }

    /// Projects a point: pixels to the right, pixels down, and pixels towards the eye.
    pub(super) fn project(&self, point: Vec3, [width, height]: [u32; 2]) -> Vec3 {
        let from_center = (point - self.center) * self.scale(width);
        Vec3::new(
            0.5 * width as f32 + from_center.dot(self.right),
            0.5 * height as f32 - from_center.dot(self.up),
            from_center.dot(self.to_eye),
        )
    }

    /// The point of a pixel in the plane through the centre.
    pub(super) fn unproject(&self, [x, y]: [f32; 2], [width, height]: [u32; 2]) -> Vec3 {
        let metres = self.scale(width).recip();
        self.center
            + self.right * ((x - 0.5 * width as f32) * metres)
            + self.up * ((0.5 * height as f32 - y) * metres)
    }
}
