//! Penetration and separation against parry's exact projection on the mesh.

use proptest::prelude::*;
use rapier3d::parry::query::PointQuery;
use rapier3d::parry::shape::{TriMesh, TriMeshFlags};
use std::sync::LazyLock;
use vps_build::{BuildOptions, Mesh, PointCount, Resolution, build, models};
use vps_core::{Asset, DistanceField, Pose3, Quat, Query, Vec3};

struct Shape {
    name: &'static str,
    asset: Asset<'static>,
    exact: TriMesh,
}

static SHAPES: LazyLock<Vec<Shape>> = LazyLock::new(|| {
    let shapes: [(&str, Mesh); 5] = [
        ("torus", models::torus(40)),
        ("trefoil knot", models::trefoil_knot(32)),
        ("gear", models::gear(12)),
        ("cup", models::cup(32)),
        ("spiky ball", models::spiky_ball(12)),
    ];
    shapes
        .into_iter()
        .map(|(name, mesh)| {
            let options = BuildOptions {
                resolution: Resolution::VoxelsAlongLongest(40),
                margin: 12,
                points: PointCount::About(600),
                ..BuildOptions::default()
            };
            let vertices = mesh.vertices().iter().map(|v| v.as_vec3()).collect();
            Shape {
                name,
                asset: build(&mesh, &options, &|_| ()).unwrap().asset,
                exact: TriMesh::with_flags(
                    vertices,
                    mesh.triangles().to_vec(),
                    TriMeshFlags::ORIENTED,
                )
                .unwrap(),
            }
        })
        .collect()
});

impl Shape {
    /// Positive inside.
    fn exact_penetration(&self, point: Vec3) -> f32 {
        let projection = self.exact.project_local_point(point, false);
        let distance = projection.point.distance(point);
        if projection.is_inside {
            distance
        } else {
            -distance
        }
    }
}

fn direction() -> impl Strategy<Value = Vec3> {
    prop::array::uniform3(-1.0..1.0_f32).prop_map(|v| Vec3::from_array(v).normalize_or(Vec3::Y))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(
        256 * std::env::var("VPS_TEST_TIMES").map_or(1, |t| t.parse::<u32>().unwrap())
    ))]

    #[test]
    fn penetration_and_separation_are_within_their_error(
        shell in 0..5_usize, field in 0..5_usize,
        axis in direction(), angle in 0.0..6.3_f32, toward in direction(), distance in 0.0..1.6_f32,
    ) {
        let (shell, field) = (&SHAPES[shell], &SHAPES[field]);
        let pose = Pose3::from_parts(toward * distance, Quat::from_axis_angle(axis, angle));
        let tree = &shell.asset.tree;
        let sampled = field.asset.voxelmap.trilinear();
        let at = |point: usize| pose.transform_point(tree.point(point));
        let exact: Vec<f32> = (0..tree.point_count())
            .map(|i| field.exact_penetration(at(i)))
            .collect();
        let deepest = (0..exact.len()).max_by(|&a, &b| exact[a].total_cmp(&exact[b])).unwrap();
        let found = Query::new(tree, &sampled, pose).closest().unwrap();
        // The contact found is deeper than its exact depth by no more than its error bound, and
        // shallower than the exact deepest by no more than the error bound there.
        let rounding = 1e-5;
        let over = found.penetration - exact[deepest];
        let what = || format!("{} in {}: {over} m over {}", shell.name, field.name, exact[deepest]);
        prop_assert!(over <= sampled.error_bound_at(at(found.point_index as usize)) + rounding, "{}", what());
        prop_assert!(-over <= sampled.error_bound_at(at(deepest)) + rounding, "{}", what());
        // Each contact by itself.
        let mut off: Option<(u32, f32, f32)> = None;
        Query::new(tree, &sampled, pose).for_each_contact(|contact| {
            let error = (contact.penetration - exact[contact.point_index as usize]).abs();
            let bound = sampled.error_bound_at(at(contact.point_index as usize)) + rounding;
            if error > bound {
                off = Some((contact.point_index, error, bound));
            }
        });
        prop_assert_eq!(off, None, "{}", what());
    }

    /// Compares all samplings with the mesh's own projection of any point.
    #[test]
    fn samplings_are_within_their_error(
        shape in 0..5_usize, at in prop::array::uniform3(-0.6..0.6_f32), normal in direction(),
    ) {
        let shape = &SHAPES[shape];
        let map = &shape.asset.voxelmap;
        let point = Vec3::from_array(at);
        let exact = shape.exact_penetration(point);
        let beyond = map.error_bounds().beyond;
        // Away from the surface values may be further off than error bounds say.
        let voxels = 4.0 * map.grid().voxel_size();
        let far = if exact.abs() + voxels > map.error_bounds().narrow_band { 4.0 * beyond } else { 0.0 };
        prop_assume!(map.grid().bounds().contains(point));
        for field in [&map.local() as &dyn DistanceField, &map.linear(), &map.trilinear()] {
            let off = (field.penetration(point, normal) - exact).abs();
            prop_assert!(off <= field.error_bound() + far + 1e-5, "{}: {off}", shape.name);
        }
    }
}
