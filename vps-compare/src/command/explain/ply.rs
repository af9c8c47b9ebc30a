//! The story as a PLY file, for viewers.

use std::fmt::Write;

use glamx::DVec3;
use vps_core::Vec3;

use super::names::{KEPT, MERGED, NO_CONTACT, UNTESTED};
use super::scene::Scene;
use super::story::Story;

/// Length of the normal of a contact, relative to the diagonal of the smallest shell.
const NORMAL_LENGTH: f32 = 0.1;

/// Colours by outcome; the last one is for all reasons that are not listed.
const COLORS: [(&str, [u8; 3]); 7] = [
    (UNTESTED, [120, 120, 120]),
    (NO_CONTACT, [60, 110, 220]),
    ("low_weight", [250, 220, 60]),
    ("no_area", [240, 150, 40]),
    (MERGED, [240, 150, 40]),
    (KEPT, [40, 200, 70]),
    ("dropped otherwise", [220, 40, 40]),
];

/// The points of the shells that were asked, in the frame of A, with the normals out of their solids,
/// and the normals out of A of the contacts that remain as edges.
pub(super) fn text(scene: &Scene, story: &Story) -> String {
    let mut vertices = String::new();
    let mut count = 0;
    let mut vertex = |position: DVec3, normal: Vec3, [r, g, b]: [u8; 3]| {
        let _ = writeln!(
            vertices,
            "{} {} {} {} {} {} {r} {g} {b}",
            position.x, position.y, position.z, normal.x, normal.y, normal.z,
        );
        count += 1;
        count - 1
    };
    for shell in &story.shells {
        let tree = scene.tree(shell.is_first);
        for (i, outcome) in shell.outcome_of_points.iter().enumerate() {
            let position = scene.position(shell.is_first, tree.point(i));
            let outward = -scene.direction(shell.is_first, tree.normal(i));
            vertex(position, outward, color(outcome));
        }
    }
    let sizes = story.shells.iter().map(|shell| {
        let bounds = scene.tree(shell.is_first).bounds();
        bounds.extents().length()
    });
    let length = NORMAL_LENGTH * sizes.fold(f32::INFINITY, f32::min);
    let mut edges = String::new();
    for contact in &story.contacts {
        let normal = Vec3::from_array(contact.normal);
        let start = DVec3::from_array(contact.position_m);
        let end = start + (normal * length).as_dvec3();
        let ends = [start, end].map(|p| vertex(p, normal, color(KEPT)));
        let _ = writeln!(edges, "{} {}", ends[0], ends[1]);
    }
    let mut text = String::from("ply\nformat ascii 1.0\n");
    for (outcome, [r, g, b]) in COLORS {
        let _ = writeln!(text, "comment {r} {g} {b}: {outcome}");
    }
    let _ = writeln!(text, "element vertex {count}");
    text += "property double x\nproperty double y\nproperty double z\n\
             property float nx\nproperty float ny\nproperty float nz\n\
             property uchar red\nproperty uchar green\nproperty uchar blue\n";
    let _ = writeln!(text, "element edge {}", story.contacts.len());
    text += "property int vertex1\nproperty int vertex2\nend_header\n";
    text + &vertices + &edges
}

fn color(outcome: &str) -> [u8; 3] {
    let listed = COLORS.iter().find(|(name, _)| *name == outcome);
    listed.map_or(COLORS[COLORS.len() - 1].1, |(_, color)| *color)
}
