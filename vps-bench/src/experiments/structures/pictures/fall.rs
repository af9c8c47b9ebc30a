//! Steps of the fall.

use vps_core::{Pose3, Vec3};

use super::{Panels, Subject, draw_mesh, triangles};
use crate::figures::render::canvas::Canvas;
use crate::figures::render::colors::{self, Color};
use crate::figures::render::figure_sheet::FigureSheet;
use crate::figures::render::view::View;

/// Edge of a tile of the ground, in metres.
const TILE_M: f32 = 0.1;

pub(super) fn draw(subject: &Subject<'_>) -> Result<FigureSheet, String> {
    let steps = &subject.settings.fall_steps;
    let columns = steps.len().min(4) as u32;
    let mut panels = Panels::new(steps.len() as u32, columns, [1040 / columns, 300], 0);
    let poses: Result<Vec<_>, _> = steps.iter().map(|step| subject.pose(*step)).collect();
    let (middle, longest) = subject.center_and_size();
    for (step, pose) in steps.iter().zip(poses?) {
        let over = pose * middle;
        // The camera follows the body at a constant height.
        let at = Vec3::new(over.x, 0.52 * longest, over.z);
        let view = View::from(30.0, 14.0, at, 1.65 * longest);
        let mut canvas = panels.canvas();
        ground(&mut canvas, &view, over);
        shadow(&mut canvas, &view, subject, pose);
        draw_mesh(&mut canvas, &view, &subject.body.mesh, pose, colors::SKY);
        let time = f64::from(*step) * subject.step_s;
        panels.push(&format!("step {step}, {time:.2} s"), &canvas)?;
    }
    Ok(panels.sheet)
}

/// Tiles around the point below the body, fixed in the world.
fn ground(canvas: &mut Canvas, view: &View, below: Vec3) {
    let tile = |c: f32| (c / TILE_M).floor() as i32;
    for i in -14..14 {
        for j in -14..14 {
            let (x, z) = (tile(below.x) + i, tile(below.z) + j);
            let shade = if (x + z) % 2 == 0 { 0.93 } else { 0.87 };
            let corner =
                |a: i32, b: i32| Vec3::new((x + a) as f32 * TILE_M, 0.0, (z + b) as f32 * TILE_M);
            let [p, q, r, s] = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
            for corners in [[p, q, r], [p, r, s]] {
                canvas.unlit_triangle(view, corners, Color::new(shade, shade, 0.98 * shade));
            }
        }
    }
}

/// The shadow of the body, straight below it.
fn shadow(canvas: &mut Canvas, view: &View, subject: &Subject<'_>, pose: Pose3) {
    for corners in triangles(&subject.body.mesh, pose) {
        let flat = corners.map(|c| Vec3::new(c.x, 1e-4, c.z));
        canvas.unlit_triangle(view, flat, Color::splat(0.68));
    }
}
