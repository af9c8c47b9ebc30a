//! The mesh and the points on it.

use vps_core::{Asset, Pose3, Vec3};

use super::{Panels, Subject, count, draw_mesh};
use crate::figures::render::canvas::Canvas;
use crate::figures::render::colors;
use crate::figures::render::figure_sheet::FigureSheet;
use crate::figures::render::view::View;

pub(super) fn draw(subject: &Subject<'_>) -> Result<FigureSheet, String> {
    let view = subject.view(1.2);
    let mesh = &subject.body.mesh;
    let mut panels = Panels::new(3, 3, [350, 340], 0);
    let mut canvas = panels.canvas();
    draw_mesh(&mut canvas, &view, mesh, Pose3::IDENTITY, colors::PALE);
    let title = format!("mesh: {} triangles", count(mesh.triangles().len()));
    panels.push(&title, &canvas)?;
    for (asset, color) in [
        (&subject.coarse, colors::BLUE),
        (&subject.fine, colors::VERMILION),
    ] {
        let mut canvas = panels.canvas();
        draw_mesh(&mut canvas, &view, mesh, Pose3::IDENTITY, colors::PALE);
        for i in 0..asset.tree.point_count() {
            canvas.ball(&view, asset.tree.point(i), radius(asset), color);
        }
        let title = format!("pointshell: {} points", count(asset.tree.point_count()));
        panels.push(&title, &canvas)?;
    }
    Ok(panels.sheet)
}

/// A quarter of the spacing of the points.
fn radius(asset: &Asset<'_>) -> f32 {
    let area: f32 = asset.tree.areas().iter().sum();
    0.25 * (area / asset.tree.point_count() as f32).sqrt()
}

/// All points of the fine shell, each in its colour.
pub(super) fn points(
    canvas: &mut Canvas,
    view: &View,
    asset: &Asset<'_>,
    color: impl Fn(usize) -> Vec3,
) {
    for i in 0..asset.tree.point_count() {
        // Large enough for neighbours to touch.
        canvas.ball(view, asset.tree.point(i), 2.6 * radius(asset), color(i));
    }
}
