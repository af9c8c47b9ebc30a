//! A z-buffered software rasterizer.

use vps_core::Vec3;

use crate::figures::render::colors::{self, Color};
use crate::figures::render::view::View;

/// Pixels of a canvas along a pixel of the picture.
pub(crate) const SUPERSAMPLING: u32 = 2;

/// A picture with colours and depths, rendered at [`SUPERSAMPLING`] times its size.
pub(crate) struct Canvas {
    size: [u32; 2],
    colors: Vec<Color>,
    /// Depths towards the eye, in pixels.
    depths: Vec<f32>,
}

/// The direction to the light, in the frame of the eye.
const LIGHT: Vec3 = Vec3::new(-0.36, 0.58, 0.73);

/// Width of the rim of a translucent ball, in pixels of the picture.
const RIM: f32 = 1.6;

/// The share of ambient light.
const AMBIENT: f32 = 0.42;

/// The shaded colour of a surface whose normal is given in the frame of the eye.
fn lit(color: Color, normal: Vec3) -> Color {
    color * (AMBIENT + (1.0 - AMBIENT) * normal.dot(LIGHT).max(0.0))
}

impl Canvas {
    /// A white canvas for a picture of `width` by `height` pixels.
    pub(crate) fn new(width: u32, height: u32) -> Self {
        let size = [width * SUPERSAMPLING, height * SUPERSAMPLING];
        let count = (size[0] * size[1]) as usize;
        Self {
            size,
            colors: vec![colors::WHITE; count],
            depths: vec![f32::NEG_INFINITY; count],
        }
    }

    pub(super) fn size(&self) -> [u32; 2] {
        self.size
    }

    pub(super) fn color(&self, x: u32, y: u32) -> Color {
        self.colors[self.index(x, y)]
    }

    fn index(&self, x: u32, y: u32) -> usize {
        (y * self.size[0] + x) as usize
    }

    /// Calls `draw` with the pixels of a box, given by its corners, and their centres.
    fn for_each_pixel(&self, low: [f32; 2], high: [f32; 2], mut draw: impl FnMut(usize, [f32; 2])) {
        let first = |c: f32| c.floor().max(0.0) as u32;
        let end = |c: f32, size: u32| (c.ceil().max(0.0) as u32).min(size);
        for y in first(low[1])..end(high[1], self.size[1]) {
            for x in first(low[0])..end(high[0], self.size[0]) {
                draw(self.index(x, y), [x as f32 + 0.5, y as f32 + 0.5]);
            }
        }
    }

    /// Gives each pixel the colour of its point in the plane through the view's centre, behind
    /// everything.
    pub(crate) fn fill_background(&mut self, view: &View, color: impl Fn(Vec3) -> Color) {
        let size = self.size;
        for y in 0..size[1] {
            for x in 0..size[0] {
                let point = view.unproject([x as f32 + 0.5, y as f32 + 0.5], size);
                let index = self.index(x, y);
                self.colors[index] = color(point);
            }
        }
    }

    /// Draws a flat shaded triangle, visible from both sides.
    pub(crate) fn triangle(&mut self, view: &View, corners: [Vec3; 3], color: Color) {
        let [a, b, c] = corners.map(|corner| view.project(corner, self.size));
        // In the frame of the picture: y points down.
        let Some(normal) = (b - a).cross(c - a).try_normalize() else {
            return;
        };
        let facing = normal * normal.z.signum();
        let color = lit(color, Vec3::new(facing.x, -facing.y, facing.z));
        self.fill_triangle(a, [b, c], color);
    }

    /// Draws a triangle without shading.
    pub(crate) fn unlit_triangle(&mut self, view: &View, corners: [Vec3; 3], color: Color) {
        let [a, b, c] = corners.map(|corner| view.project(corner, self.size));
        self.fill_triangle(a, [b, c], color);
    }

    fn fill_triangle(&mut self, a: Vec3, [b, c]: [Vec3; 2], color: Color) {
        let area = (b - a).truncate().perp_dot((c - a).truncate());
        if area == 0.0 || !area.is_finite() {
            return;
        }
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let mut drawn = Vec::new();
        self.for_each_pixel([low.x, low.y], [high.x, high.y], |index, [x, y]| {
            let pixel = Vec3::new(x, y, 0.0);
            let side = |from: Vec3, to: Vec3| {
                (to - from).truncate().perp_dot((pixel - from).truncate()) / area
            };
            let (of_c, of_a, of_b) = (side(a, b), side(b, c), side(c, a));
            if of_a >= 0.0 && of_b >= 0.0 && of_c >= 0.0 {
                drawn.push((index, of_a * a.z + of_b * b.z + of_c * c.z));
            }
        });
        for (index, depth) in drawn {
            self.write_pixel(index, depth, color);
        }
    }

    fn write_pixel(&mut self, index: usize, depth: f32, color: Color) {
        if depth > self.depths[index] {
            self.depths[index] = depth;
            self.colors[index] = color;
        }
    }

    /// Calls `draw` with the pixels of a ball, the normals of its front and their depths.
    fn for_each_ball_pixel(
        &mut self,
        view: &View,
        (center, radius): (Vec3, f32),
        mut draw: impl FnMut(&mut Self, usize, Vec3, f32),
    ) {
        let (at, radius) = (
            view.project(center, self.size),
            radius * view.scale(self.size[0]),
        );
        let mut seen = Vec::new();
        self.for_each_pixel(
            [at.x - radius, at.y - radius],
            [at.x + radius, at.y + radius],
            |index, [x, y]| {
                let (right, up) = ((x - at.x) / radius, (at.y - y) / radius);
                let rest = 1.0 - right * right - up * up;
                if rest >= 0.0 {
                    seen.push((index, Vec3::new(right, up, rest.sqrt())));
                }
            },
        );
        for (index, normal) in seen {
            draw(self, index, normal, at.z + radius * normal.z);
        }
    }

    /// Draws a solid ball.
    pub(crate) fn ball(&mut self, view: &View, center: Vec3, radius: f32, color: Color) {
        self.for_each_ball_pixel(view, (center, radius), |canvas, index, normal, depth| {
            canvas.write_pixel(index, depth, lit(color, normal));
        });
    }

    /// Draws translucent balls, clear in the middle and dense at their rims, without writing
    /// depths. Solids must be drawn before. `density` is the opacity in the middle, from 0 to 1.
    pub(crate) fn translucent_balls(
        &mut self,
        view: &View,
        mut balls: Vec<(Vec3, f32, Color)>,
        density: f32,
    ) {
        let depth = |ball: &(Vec3, f32, Color)| view.project(ball.0, self.size).z;
        balls.sort_by(|a, b| depth(a).total_cmp(&depth(b)));
        for (center, radius, color) in balls {
            let pixels = radius * view.scale(self.size[0]);
            let rim = (1.0 - RIM * SUPERSAMPLING as f32 / pixels).max(0.7);
            self.for_each_ball_pixel(view, (center, radius), |canvas, index, normal, depth| {
                if depth > canvas.depths[index] {
                    let is_rim = normal.truncate().length() > rim;
                    let density = if is_rim { 0.75 } else { density };
                    let below = canvas.colors[index];
                    canvas.colors[index] = below.lerp(color, density);
                }
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RED: Color = Vec3::X;
    const GREEN: Color = Vec3::Y;

    /// A square metre, 100 pixels wide, seen from +z.
    fn front() -> (Canvas, View) {
        let view = View::from(0.0, 0.0, Vec3::ZERO, 1.0);
        (Canvas::new(100, 100), view)
    }

    fn large(z: f32) -> [Vec3; 3] {
        [[-3.0, -3.0], [3.0, -3.0], [0.0, 3.0]].map(|[x, y]| Vec3::new(x, y, z))
    }

    fn middle(canvas: &Canvas) -> Color {
        let [width, height] = canvas.size();
        canvas.color(width / 2, height / 2)
    }

    #[test]
    fn a_triangle_in_front_hides_one_behind() {
        for reversed in [false, true] {
            let (mut canvas, view) = front();
            let mut drawn = [(large(0.2), RED), (large(-0.2), GREEN)];
            if reversed {
                drawn.reverse();
            }
            for (corners, color) in drawn {
                canvas.triangle(&view, corners, color);
            }
            let seen = middle(&canvas);
            assert!(seen.x > 0.5 && seen.y == 0.0, "{seen}");
        }
    }

    #[test]
    fn a_triangle_covers_its_area() {
        let (mut canvas, view) = front();
        let corners = [[-0.4, -0.4], [0.4, -0.4], [-0.4, 0.4]].map(|[x, y]| Vec3::new(x, y, 0.0));
        canvas.triangle(&view, corners, RED);
        let count = canvas
            .colors
            .iter()
            .filter(|c| **c != colors::WHITE)
            .count();
        let expected = 0.5 * (80 * SUPERSAMPLING * 80 * SUPERSAMPLING) as f32;
        assert!((count as f32 / expected - 1.0).abs() < 0.02, "{count}");
    }

    #[test]
    fn a_ball_is_as_wide_as_its_diameter() {
        let (mut canvas, view) = front();
        canvas.ball(&view, Vec3::ZERO, 0.25, RED);
        let [width, height] = canvas.size();
        let row = (0..width).filter(|&x| canvas.color(x, height / 2) != colors::WHITE);
        let column = (0..height).filter(|&y| canvas.color(width / 2, y) != colors::WHITE);
        let diameter = (50 * SUPERSAMPLING) as i64;
        for length in [row.count(), column.count()] {
            assert!((length as i64 - diameter).abs() <= 1, "{length}");
        }
        // Its front is nearer than its centre, by no more than its radius.
        canvas.triangle(&view, large(0.24), GREEN);
        assert_eq!(middle(&canvas).y, 0.0);
        canvas.triangle(&view, large(0.26), GREEN);
        assert_eq!(middle(&canvas).x, 0.0);
    }

    #[test]
    fn a_translucent_ball_behind_is_hidden_and_one_in_front_is_not() {
        let (mut canvas, view) = front();
        canvas.triangle(&view, large(0.0), GREEN);
        let solid = middle(&canvas);
        canvas.translucent_balls(&view, vec![(Vec3::new(0.0, 0.0, -0.4), 0.2, RED)], 0.2);
        assert_eq!(middle(&canvas), solid);
        canvas.translucent_balls(&view, vec![(Vec3::new(0.0, 0.0, 0.4), 0.2, RED)], 0.2);
        let seen = middle(&canvas);
        assert!(seen.x > solid.x && seen.y > 0.0, "{seen}");
    }
}
