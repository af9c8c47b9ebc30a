//! The surface mesh of a VPS shape and its debug rendering.

// Numbers of rapier are 32-bit or 64-bit.
#![allow(clippy::unnecessary_cast, clippy::useless_conversion)]

mod support;

use std::collections::HashMap;

use support::asset;
use vps_build::{Mesh, models};
use vps_rapier::VpsShape;

#[test]
fn the_surface_of_a_shape_is_closed_and_where_the_mesh_is() {
    for mesh in [Mesh::cuboid([0.6, 0.4, 0.5]).unwrap(), models::torus(24)] {
        let shape = VpsShape::new(asset(&mesh, 500));
        let map = &shape.asset().voxelmap;
        let surface = shape.surface_mesh();
        assert!(surface.squares.len() > 1000);
        let field = map.trilinear();
        for &vertex in &surface.vertices {
            let off = vps_core::DistanceField::signed_distance(&field, vertex).abs();
            assert!(off < 0.6 * map.grid().voxel_size(), "{vertex}: {off}");
        }
        // Each edge is used in both directions, so the volume is that of a closed mesh.
        let mut edges: HashMap<[u32; 2], i32> = HashMap::new();
        let mut volume = 0.0_f64;
        for [a, b, c] in surface.triangles() {
            for [a, b] in [[a, b], [b, c], [c, a]] {
                *edges.entry([a.min(b), a.max(b)]).or_default() += if a < b { 1 } else { -1 };
            }
            let [a, b, c] = [a, b, c].map(|v| surface.vertices[v as usize].as_dvec3());
            volume += a.dot(b.cross(c)) / 6.0;
        }
        assert!(edges.values().all(|&there_and_back| there_and_back == 0));
        let right = f64::from(shape.asset().mass.volume);
        assert!((volume / right - 1.0).abs() < 0.03, "{volume} {right}");
        assert_eq!(surface.edges().len(), 2 * surface.squares.len());
    }
}

#[cfg(feature = "debug-render")]
#[test]
fn a_shape_is_drawn_where_its_collider_is() {
    use vps_rapier::debug_render;
    use vps_rapier::rapier3d::pipeline::{DebugColor, DebugRenderBackend, DebugRenderObject};
    use vps_rapier::rapier3d::prelude::*;

    #[derive(Default)]
    struct Lines(Vec<[Vector; 2]>);

    impl DebugRenderBackend for Lines {
        fn draw_line(&mut self, _: DebugRenderObject, a: Vector, b: Vector, _: DebugColor) {
            self.0.push([a, b]);
        }
    }

    let shape = VpsShape::new(asset(&Mesh::cuboid([0.6, 0.4, 0.5]).unwrap(), 500));
    let edges = shape.surface_mesh().edges().len();
    let shape: SharedShape = shape.into();
    let mut colliders = ColliderSet::new();
    colliders.insert(ColliderBuilder::ball(9.0));
    let place = Vector::new(3.0, 1.0, 0.0);
    colliders.insert(ColliderBuilder::new(shape.clone()).translation(place));
    let part = vec![(Pose::from_translation(Vector::Y), shape)];
    colliders.insert(ColliderBuilder::new(SharedShape::compound(part)).translation(-place));
    let mut lines = Lines::default();
    debug_render(&mut lines, &colliders, [0.0, 1.0, 0.5, 1.0]);
    assert_eq!(lines.0.len(), 2 * edges);
    let [first, second] = [&lines.0[..edges], &lines.0[edges..]];
    for (lines, center) in [(first, place), (second, Vector::Y - place)] {
        for point in lines.as_flattened() {
            let from = (*point - center).abs();
            assert!(
                (from - Vector::new(0.3, 0.2, 0.25)).max_element() < 0.02,
                "{from}"
            );
        }
    }
}
