//! One traversal of the tree (Algorithm 1), with the sphere test alone.

use vps_core::{Cluster, DistanceField, HalfSpace, PointSphereTree, Pose3, Query, Vec3, Work};

use super::{Panels, Subject, count, draw_mesh};
use crate::figures::render::canvas::Canvas;
use crate::figures::render::colors::{self, Color};
use crate::figures::render::figure_sheet::{Anchor, FigureSheet};
use crate::figures::render::view::View;

const SIDE: u32 = 520;

/// Colour of the ground.
const GROUND: Color = Color::new(0.90, 0.88, 0.84);

pub(super) fn draw(subject: &Subject<'_>) -> Result<FigureSheet, String> {
    let mut pose = subject.pose(subject.settings.traverse_step)?;
    let (tree, ground) = (&subject.coarse.tree, HalfSpace::new(Vec3::Y));
    // Moved so deep that several points are inside.
    let deepest = Query::new(tree, &ground, pose)
        .closest()
        .ok_or("the pose is not finite")?;
    pose.translation.y += deepest.penetration - subject.settings.traverse_depth_m;
    let deepest = pose * deepest.position;
    let seen = Traversal::of(tree, &ground, pose);

    let middle = pose * subject.center_and_size().0;
    let (_, longest) = subject.center_and_size();
    let mut panels = Panels::new(2, 2, [SIDE, 430], 66);
    let near = Vec3::new(deepest.x, 0.012, deepest.z);
    for (title, level, view) in [
        (
            "spheres of all levels",
            0,
            View::from(25.0, 0.0, middle, 1.6 * longest),
        ),
        (
            "around the contacts: spheres of the leaves",
            tree.level_count(),
            View::from(25.0, 0.0, near, 0.42 * longest),
        ),
    ] {
        let mut canvas = panels.canvas();
        canvas.fill_background(
            &view,
            |point| {
                if point.y < 0.0 { GROUND } else { colors::WHITE }
            },
        );
        let mesh = &subject.body.mesh;
        draw_mesh(&mut canvas, &view, mesh, pose, colors::PALE);
        seen.draw(&mut canvas, &view, tree, pose, level);
        panels.push(title, &canvas)?;
    }
    let left_out = seen.spheres.iter().filter(|s| !s.reaches).count();
    let descended = seen.spheres.len() - left_out;
    let inside = seen.points.iter().filter(|p| p.1).count();
    let entries = [
        (
            PASSED,
            format!("{} spheres that reach the ground", count(descended)),
        ),
        (
            colors::GREY,
            format!("{} tested and left out", count(left_out)),
        ),
        (
            colors::ORANGE,
            format!("{} points tested", count(seen.points.len())),
        ),
        (
            colors::VERMILION,
            format!("{} of them in the ground", count(inside)),
        ),
    ];
    let top = 430 + Panels::HEAD + 8;
    panels.legend(&entries, [40, top])?;
    let work = Work::default();
    let query = Query::new(tree, &ground, pose).observed_by(&work);
    query.for_each_contact(|_| ());
    let all = format!(
        "{} points in all. The query itself, which also knows how flat clusters are: {} spheres, {} points",
        count(tree.point_count()),
        work.spheres(),
        work.points()
    );
    panels
        .sheet
        .text(&all, [40, top + 26], Anchor::Left, super::TEXT)?;
    Ok(panels.sheet)
}

const PASSED: Color = colors::BLUE;

/// A cluster whose sphere was tested against the field.
struct Tested {
    cluster: Cluster,
    level: u32,
    reaches: bool,
}

/// The spheres and points a traversal tested.
struct Traversal {
    spheres: Vec<Tested>,
    /// Points, and whether they are inside.
    points: Vec<(usize, bool)>,
}

impl Traversal {
    /// Traverses level by level, as with the queue of the paper.
    fn of(tree: &PointSphereTree<'_>, field: &impl DistanceField, pose: Pose3) -> Self {
        let mut seen = Self {
            spheres: Vec::new(),
            points: Vec::new(),
        };
        let mut current: Vec<usize> = vec![0];
        for level in 1..=tree.level_count() {
            let mut below = Vec::new();
            for index in current {
                let cluster = tree.level(level)[index];
                let center = pose * cluster.center();
                let reaches = field.penetration_bound(center, cluster.radius()) >= 0.0;
                seen.spheres.push(Tested {
                    cluster,
                    level,
                    reaches,
                });
                if reaches {
                    below.extend(cluster.children().map(|i| i as usize));
                }
            }
            current = below;
        }
        for point in current {
            let (position, normal) = (pose * tree.point(point), pose.rotation * tree.normal(point));
            let is_inside = field.penetration(position, normal) >= 0.0;
            seen.points.push((point, is_inside));
        }
        seen
    }

    /// Draws the spheres of a level, or of all levels (0), with the points in front of them.
    fn draw(
        &self,
        canvas: &mut Canvas,
        view: &View,
        tree: &PointSphereTree<'_>,
        pose: Pose3,
        level: u32,
    ) {
        let chosen = self.spheres.iter();
        let chosen = chosen.filter(|tested| level == 0 || tested.level == level);
        let ball = |tested: &Tested| {
            let color = if tested.reaches { PASSED } else { colors::GREY };
            let center = pose * tested.cluster.center();
            (center, tested.cluster.radius(), color)
        };
        canvas.translucent_balls(view, chosen.map(ball).collect(), 0.03);
        for &(point, is_inside) in &self.points {
            let (color, radius) = if is_inside {
                (colors::VERMILION, 0.0030)
            } else {
                (colors::ORANGE, 0.0022)
            };
            canvas.ball(view, pose * tree.point(point), radius, color);
        }
    }
}

#[cfg(test)]
mod tests {
    use vps_build::{BuildOptions, Mesh, PointCount, build};

    use super::*;

    /// The traversal finds the contacts of the query.
    #[test]
    fn the_traversal_finds_all_contacts() {
        let mesh = Mesh::icosphere(0.1, 3).unwrap();
        let options = BuildOptions {
            points: PointCount::About(400),
            ..BuildOptions::default()
        };
        let asset = build(&mesh, &options, &|_| ()).unwrap().asset;
        let ground = HalfSpace::new(Vec3::Y);
        let pose = Pose3::from_translation(Vec3::new(0.0, 0.09, 0.0));
        let seen = Traversal::of(&asset.tree, &ground, pose);
        let mut expected = Vec::new();
        let query = Query::new(&asset.tree, &ground, pose);
        query.for_each_contact_flat(|contact| expected.push(contact.point_index as usize));
        let found: Vec<_> = seen.points.iter().filter(|p| p.1).map(|p| p.0).collect();
        assert_eq!(found, expected);
        assert!(!found.is_empty() && seen.points.len() < asset.tree.point_count());
        assert!(seen.spheres.iter().any(|s| !s.reaches));
    }
}
