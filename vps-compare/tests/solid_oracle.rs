//! The oracle for two solids, where formulas or samples tell the same.

use glamx::{DPose3, DVec3};
use proptest::prelude::*;
use rapier3d::math::{Pose, Rotation, Vector};
use rapier3d::parry::query::distance;
use rapier3d::parry::shape::SharedShape;
use vps_build::{ExactSolid, Mesh, Sign, models};
use vps_compare::oracle::SolidOracle;

fn oracle(ground: &Mesh, body: &Mesh) -> SolidOracle {
    let solid = |mesh| ExactSolid::new(mesh, Sign::Auto).unwrap();
    SolidOracle::new(solid(ground), solid(body))
}

/// A rotation of its own for each number.
fn turned(i: usize) -> Rotation {
    Rotation::from_scaled_axis(Vector::new(1.0, 0.6, -0.3) * (0.7 * i as f32))
}

#[test]
fn two_balls() {
    let (large, small) = (
        Mesh::icosphere(1.0, 4).unwrap(),
        Mesh::icosphere(0.5, 4).unwrap(),
    );
    let oracle = oracle(&large, &small);
    for i in 0..40 {
        let distance = 0.05 * i as f32;
        let towards = turned(2 * i) * Vector::Y;
        let pose = Pose::from_parts(towards * distance, turned(i));
        let exact = oracle.penetration(&pose);
        // Within the large one the near side of the small one is the deeper.
        let nearest = (f64::from(distance) - 0.5).abs();
        let expected = 1.0 - nearest;
        // A face is at most 0.0024 of the radius below its corners.
        let off = (exact.penetration_m - expected).abs();
        assert!(off < 0.004, "{distance}: {exact:?}, {expected}");
        assert!(exact.uncertainty_m < 0.004, "{distance}: {exact:?}");
        let separation = oracle.separation(&pose);
        assert_eq!(separation, (-exact.penetration_m).max(0.0));
    }
}

/// The search ends before it is sure, and says by how much it may be wrong.
#[test]
fn uncertainties_are_finite() {
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let base = corners.map(|[x, y]| DVec3::new(x, y, 0.0));
    let vertices = [&base[..], &[DVec3::new(0.5, 0.5, 0.01)]].concat();
    let triangles = [
        [0, 2, 1],
        [0, 3, 2],
        [0, 1, 4],
        [1, 2, 4],
        [2, 3, 4],
        [3, 0, 4],
    ];
    let roof = Mesh::new(&vertices, &triangles).unwrap();
    let oracle = oracle(&roof, &roof);
    assert_eq!(oracle.is_open(), [false; 2]);
    let exact = oracle.penetration(&Pose::translation(0.001, 0.0, 0.0));
    // A millimetre aside on a slope of 0.02.
    assert!((exact.penetration_m - 2e-5).abs() < 1e-7, "{exact:?}");
    let uncertainty_m = exact.uncertainty_m;
    assert!(
        uncertainty_m > oracle.tolerance_m() && uncertainty_m < 1e-3,
        "{exact:?}"
    );
}

#[test]
fn two_boxes_face_to_face_are_exact() {
    let (ground, body) = (
        Mesh::cuboid([4.0, 1.0, 4.0]).unwrap(),
        Mesh::cuboid([1.0; 3]).unwrap(),
    );
    let oracle = oracle(&ground, &body);
    for (height, expected) in [(1.5, -0.5), (1.25, -0.25), (0.875, 0.125), (0.75, 0.25)] {
        for turn in [0.0, 0.3, 1.1] {
            let turn = Rotation::from_rotation_y(turn);
            let pose = Pose::from_parts(Vector::new(0.25, height, -0.125), turn);
            let exact = oracle.penetration(&pose);
            let off = (exact.penetration_m - expected).abs();
            assert!(off < 1e-9 && exact.uncertainty_m < 1e-5, "{exact:?}");
        }
    }
    // Face on face, neither in the other.
    let touching = oracle.penetration(&Pose::translation(0.25, 1.0, 0.0));
    assert!(touching.penetration_m.abs() < 1e-9, "{touching:?}");
}

#[test]
fn a_ball_in_a_face_of_a_box_is_as_deep_as_its_lowest_point() {
    let (ground, ball) = (
        Mesh::cuboid([2.0, 2.0, 2.0]).unwrap(),
        Mesh::icosphere(0.25, 3).unwrap(),
    );
    let oracle = oracle(&ground, &ball);
    for i in 0..30 {
        let height = 1.5 - 0.02 * i as f32;
        let pose = Pose::from_parts(Vector::new(0.1, height, 0.2), turned(i));
        // The corners of the ball are on it, and one of them is the lowest.
        let vertices = ball.vertices().iter();
        let heights = vertices.map(|v| (DPose3::from(pose) * *v).y);
        let expected = 1.0 - heights.fold(f64::INFINITY, f64::min);
        let exact = oracle.penetration(&pose);
        assert!(
            (exact.penetration_m - expected).abs() < 1e-6,
            "{exact:?} {expected}"
        );
    }
}

#[test]
fn a_point_deep_within_a_face_is_found() {
    // A thorn of the ground in the middle of a large triangle of the body.
    let thorn = {
        let v = [
            [0.3, 0.0, 0.1],
            [-0.2, 0.0, 0.3],
            [-0.2, 0.0, -0.3],
            [0.0, 0.4, 0.0],
        ];
        let v = v.map(DVec3::from_array);
        Mesh::new(&v, &[[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]]).unwrap()
    };
    let plate = Mesh::cuboid([10.0, 2.0, 10.0]).unwrap();
    let oracle = oracle(&thorn, &plate);
    let exact = oracle.penetration(&Pose::translation(1.3, 1.25, 0.7));
    assert!((exact.penetration_m - 0.15).abs() < 1e-6, "{exact:?}");
    // As a whole within the plate its foot is in the middle.
    let within = oracle.penetration(&Pose::translation(0.0, 0.0, 0.0));
    assert!((within.penetration_m - 1.0).abs() < 1e-6, "{within:?}");
}

/// parry knows the distance of two triangle meshes too, in 32 bits.
#[test]
fn apart_it_is_the_distance_of_the_triangles() {
    let (ground, body) = (models::cup(1), models::spiky_ball(12));
    let [a, b] = [&ground, &body].map(|mesh| {
        let vertices = mesh.vertices().iter().map(|v| v.as_vec3()).collect();
        SharedShape::trimesh(vertices, mesh.triangles().to_vec()).unwrap()
    });
    let oracle = oracle(&ground, &body);
    for i in 0..40 {
        let away = turned(3 * i) * Vector::X * (2.5 + 0.05 * i as f32);
        let pose = Pose::from_parts(away, turned(i));
        let separation = oracle.separation(&pose);
        let expected = distance(&Pose::IDENTITY, &*a, &pose, &*b).unwrap().distance;
        assert!(separation > 0.0);
        let off = (separation - f64::from(expected)).abs();
        assert!(off < 1e-4, "{i}: {separation}, {expected}");
    }
}

/// A bumpy ball: closed, not convex.
fn bumpy() -> impl Strategy<Value = Mesh> {
    let direction = prop::array::uniform3(-1.0..1.0_f64).prop_map(DVec3::from_array);
    let bump = (direction, -0.35..0.35_f64, 1.0..12.0_f64);
    prop::collection::vec(bump, 0..6).prop_map(|bumps| {
        let ball = Mesh::icosphere(0.5, 2).unwrap();
        let moved = |v: &DVec3| {
            let grow = |(d, height, width): &(DVec3, f64, f64)| {
                height * (width * (v.normalize().dot(d.normalize_or_zero()) - 1.0)).exp()
            };
            *v * (1.0 + bumps.iter().map(grow).sum::<f64>()).max(0.2)
        };
        let vertices: Vec<_> = ball.vertices().iter().map(moved).collect();
        Mesh::new(&vertices, ball.triangles()).unwrap()
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]
    /// No point of either surface is deeper than the oracle says, and one is nearly as deep.
    #[test]
    fn samples_of_both_surfaces_agree(
        ground in bumpy(), body in bumpy(), turn in 0..1000_usize, away in 0.4..1.3_f32,
    ) {
        let pose = Pose::from_parts(turned(3 * turn) * Vector::X * away, turned(turn));
        let exact = oracle(&ground, &body).penetration(&pose);
        let body_in_ground = DPose3::from(pose);
        let solid = |mesh| ExactSolid::new(mesh, Sign::Auto).unwrap();
        let mut deepest = f64::NEG_INFINITY;
        for (surface, field, to_field) in [
            (&body, solid(&ground), body_in_ground),
            (&ground, solid(&body), body_in_ground.inverse()),
        ] {
            for t in 0..surface.triangles().len() {
                let [a, b, c] = surface.corners(t);
                for i in 0..=6 {
                    for j in 0..=6 - i {
                        let p = a + (b - a) * f64::from(i) / 6.0 + (c - a) * f64::from(j) / 6.0;
                        deepest = deepest.max(field.penetration(to_field * p, t).penetration_m);
                    }
                }
            }
        }
        prop_assert!(deepest <= exact.penetration_m + exact.uncertainty_m + 1e-6);
        // Samples are no further apart than this.
        prop_assert!(deepest > exact.penetration_m - 0.04, "{} {:?}", deepest, exact);
        prop_assert!(exact.uncertainty_m < 1e-3, "{exact:?}");
    }
}
