//! Points and spheres by level.

use vps_core::{Cluster, Pose3};

use super::{Panels, Subject, count, draw_mesh};
use crate::figures::render::canvas::Canvas;
use crate::figures::render::colors::{self, Color};
use crate::figures::render::figure_sheet::FigureSheet;
use crate::figures::render::view::View;

/// Number of levels that are drawn, from the second on.
const LEVELS: u32 = 6;

pub(super) fn points(subject: &Subject<'_>) -> Result<FigureSheet, String> {
    let (_, longest) = subject.center_and_size();
    let tree = &subject.fine.tree;
    panels(subject, "points", 1.2, |canvas, view, clusters, color| {
        // Smaller on levels with more points.
        let radius = 0.075 * longest * (clusters.len() as f32).powf(-0.3);
        for cluster in clusters {
            let point = tree.point(cluster.parent_point() as usize);
            canvas.ball(view, point, radius, color);
        }
    })
}

pub(super) fn spheres(subject: &Subject<'_>) -> Result<FigureSheet, String> {
    panels(subject, "spheres", 1.6, |canvas, view, clusters, color| {
        let ball = |c: &Cluster| (c.center(), c.radius(), color);
        canvas.translucent_balls(view, clusters.iter().map(ball).collect(), 0.16);
    })
}

/// A panel for each level, with its clusters drawn over the mesh.
fn panels(
    subject: &Subject<'_>,
    what: &str,
    width: f32,
    draw: impl Fn(&mut Canvas, &View, &[Cluster], Color),
) -> Result<FigureSheet, String> {
    let tree = &subject.fine.tree;
    let view = subject.view(width);
    let last = tree.level_count().min(1 + LEVELS);
    let mut panels = Panels::new(last.max(2) - 1, 3, [350, 340], 0);
    for level in 2..=last {
        let clusters = tree.level(level);
        let color = colors::ramp((level - 2) as f32 / LEVELS as f32);
        let mut canvas = panels.canvas();
        let mesh = &subject.body.mesh;
        draw_mesh(&mut canvas, &view, mesh, Pose3::IDENTITY, colors::PALE);
        draw(&mut canvas, &view, clusters, color);
        let title = format!("level {level}: {} {what}", count(clusters.len()));
        panels.push(&title, &canvas)?;
    }
    Ok(panels.sheet)
}
