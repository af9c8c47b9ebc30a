//! Hull, convex parts and segments.

use rapier3d::math::Pose;
use rapier3d::parry::shape::{ConvexPolyhedron, SharedShape};

use super::{Panels, Subject, count, shells};
use crate::figures::render::canvas::Canvas;
use crate::figures::render::colors::{self, Color};
use crate::figures::render::figure_sheet::FigureSheet;
use crate::figures::render::view::View;

pub(super) fn draw(subject: &Subject<'_>) -> Result<FigureSheet, String> {
    let view = subject.view(1.2);
    let mut panels = Panels::new(3, 3, [350, 340], 0);
    let settings = subject.settings;

    let hull = shape(subject, &settings.hull)?;
    let hull = hull.as_convex_polyhedron();
    let hull = hull.ok_or_else(|| format!("`{}` gives no convex hull", settings.hull))?;
    let mut canvas = panels.canvas();
    polyhedron(&mut canvas, &view, hull, Pose::IDENTITY, colors::SKY);
    let title = format!("(a) convex hull: {} vertices", hull.points().len());
    panels.push(&title, &canvas)?;

    let parts = shape(subject, &settings.decomposition)?;
    let parts = parts.as_compound();
    let parts = parts.ok_or_else(|| format!("`{}` gives no parts", settings.decomposition))?;
    let mut canvas = panels.canvas();
    let hulls = parts.shapes().iter();
    for (i, (pose, part)) in hulls.enumerate() {
        if let Some(part) = part.as_convex_polyhedron() {
            polyhedron(&mut canvas, &view, part, *pose, colors::categorical(i));
        }
    }
    let title = format!("(b) convex decomposition: {} parts", parts.shapes().len());
    panels.push(&title, &canvas)?;

    let tree = &subject.fine.tree;
    let level = settings.segments_level.min(tree.level_count());
    let mut segment = vec![0; tree.point_count()];
    for (i, cluster) in tree.level(level).iter().enumerate() {
        segment[tree.points_below(level, cluster)].fill(i);
    }
    let mut canvas = panels.canvas();
    shells::points(&mut canvas, &view, &subject.fine, |point| {
        colors::categorical(segment[point])
    });
    let segments = count(tree.level(level).len());
    let title = format!("(c) segments of level {level}: {segments}");
    panels.push(&title, &canvas)?;
    Ok(panels.sheet)
}

/// The shape an algorithm makes of the mesh; the ground does not matter.
fn shape(subject: &Subject<'_>, algorithm: &str) -> Result<SharedShape, String> {
    let ready = subject
        .context
        .prepare_on_box(algorithm, &subject.body, [1.0; 3])?;
    Ok(ready.prepared()?.body.clone())
}

fn polyhedron(canvas: &mut Canvas, view: &View, part: &ConvexPolyhedron, pose: Pose, color: Color) {
    let (points, triangles) = part.to_trimesh();
    for triangle in triangles {
        let corners = triangle.map(|i| pose * points[i as usize]);
        canvas.triangle(view, corners, color);
    }
}
