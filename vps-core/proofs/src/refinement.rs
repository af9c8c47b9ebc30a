//! Refined contacts against the exact solids.

use glamx::DVec3;
use proptest::prelude::*;
use vps_build::{Encoding, ExactSolid, Mesh, Sign};
use vps_core::{Contact, Cuboid, DistanceField, HalfSpace, Pose3, Query, Vec3};

use crate::poses::pose;
use crate::support::{asset, bumpy_mesh, cases};

proptest! {
    #![proptest_config(cases(48))]

    /// A refined contact is as deep as its point at least, lies on the surface of the exact solid within
    /// the error of its field, and has the penetration of its place.
    #[test]
    fn refined_contacts_lie_on_the_surface_and_are_no_shallower(
        (mesh, other) in (bumpy_mesh(), bumpy_mesh()), points in 30..400_u32, pose in pose(0.5),
    ) {
        let (shell, other) = (
            asset(&mesh, points, Encoding::Distances(None)),
            asset(&other, 10, Encoding::Distances(None)),
        );
        let exact = ExactSolid::new(&mesh, Sign::default()).unwrap();
        let surface = shell.voxelmap.trilinear();
        let spacing = (mesh.area() / f64::from(points)).sqrt() as f32;
        let fields: [&dyn DistanceField; 3] =
            [&other.voxelmap.trilinear(), &Cuboid::new(Vec3::splat(0.3)), &HalfSpace::new(Vec3::Y)];
        for field in fields {
            let query = Query::new(&shell.tree, field, pose).with_prediction(0.05);
            let mut contacts = Vec::new();
            query.for_each_contact(|c| contacts.push(c));
            for sample in contacts {
                let refined = query.refine(&sample, &surface, spacing);
                prop_assert!(refined.penetration >= sample.penetration);
                prop_assert_eq!(refined.point_index, sample.point_index);
                if refined == sample {
                    continue;
                }
                let at = pose.transform_point(refined.position);
                let there = field.penetration(at, pose.rotation * refined.normal);
                prop_assert!((refined.penetration - there).abs() < 1e-5);
                let off = surface.error_bound() + 0.1 * surface.voxel_size();
                let exact = exact.penetration(refined.position.as_dvec3(), 0).penetration_m;
                prop_assert!(exact.abs() as f32 <= off, "{exact} {off}");
            }
        }
    }
}

/// The deepest of all refined contacts of a coarse shell, and of its points.
fn deepest(ball: &Mesh, points: u32, field: &dyn DistanceField, pose: Pose3) -> [f32; 2] {
    let shell = asset(ball, points, Encoding::Distances(None));
    let spacing = (ball.area() / f64::from(points)).sqrt() as f32;
    let query = Query::new(&shell.tree, field, pose).with_prediction(0.1);
    let sample: Contact = query.deepest().unwrap();
    let refined = query.refine(&sample, &shell.voxelmap.trilinear(), spacing);
    [refined.penetration, sample.penetration]
}

/// A rolling ball of 100 points is as deep as one of 10 000, to within a tenth of a voxel.
#[test]
fn depth_does_not_depend_on_the_number_of_points() {
    let ball = Mesh::icosphere(0.5, 5).unwrap();
    let ground = HalfSpace::new(Vec3::Y);
    let voxel = 1.0 / 18.0;
    let mut coarse: f32 = 0.0;
    for i in 0..40 {
        let turn = glamx::Quat::from_scaled_axis(Vec3::new(0.3, 0.2, 1.0) * (0.05 * i as f32));
        let pose = Pose3::from_parts(Vec3::Y * 0.49, turn);
        let lowest = ball.vertices().iter();
        let lowest = lowest.map(|v| (turn.as_dquat() * *v).dot(DVec3::Y));
        let exact = (-0.49 - lowest.fold(f64::INFINITY, f64::min)) as f32;
        let [refined, sample] = deepest(&ball, 100, &ground, pose);
        assert!(
            (refined - exact).abs() < 0.1 * voxel,
            "{refined}, exact {exact}"
        );
        coarse = coarse.max(exact - sample);
    }
    // Without refinement they are not.
    assert!(coarse > 0.15 * voxel, "{coarse}");
}
