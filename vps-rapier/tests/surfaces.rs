//! The field of the triangles near a shape equals that of all triangles, and conforms.

// Numbers of rapier are 32-bit or 64-bit.
#![allow(clippy::unnecessary_cast, clippy::useless_conversion)]

use proptest::prelude::*;
use vps_build::Mesh;
use vps_core::{Aabb, DistanceField, Vec3, conformance};
use vps_rapier::rapier3d::parry::query::PersistentQueryDispatcher;
use vps_rapier::rapier3d::parry::utils::Array2;
use vps_rapier::rapier3d::prelude::*;
use vps_rapier::{ShapeField, VpsDispatcher, VpsShapeBuilder};

const THICKNESS: f32 = 0.08;

/// A hilly ground of squares of 0.1 m around the origin, some of them missing.
fn hills(flags: TriMeshFlags) -> SharedShape {
    let n = 20_u32;
    let height = |x: u32, z: u32| {
        let (x, z) = (x as f32, z as f32);
        // Flat in one quarter.
        if x < 10.0 && z < 10.0 {
            0.0
        } else {
            0.1 * (0.9 * x).sin() * (0.7 * z).cos()
        }
    };
    let at = |x: u32, z: u32| {
        Vector::new(
            0.1 * x as Real - 1.0,
            height(x, z) as Real,
            0.1 * z as Real - 1.0,
        )
    };
    let vertices = (0..=n)
        .flat_map(|z| (0..=n).map(move |x| at(x, z)))
        .collect();
    let index = |x: u32, z: u32| z * (n + 1) + x;
    let mut triangles = Vec::new();
    for z in 0..n {
        for x in (0..n).filter(|x| (x * 7 + z * 3) % 23 != 0) {
            let [a, b, c, d] = [
                index(x, z),
                index(x, z + 1),
                index(x + 1, z + 1),
                index(x + 1, z),
            ];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    SharedShape::trimesh_with_flags(vertices, triangles, flags).unwrap()
}

fn shapes() -> Vec<SharedShape> {
    let heights = (0..15 * 11)
        .map(|i| (0.37 * i as Real).sin() * 0.1)
        .collect();
    let (vertices, triangles) = Ball::new(0.7).to_trimesh(20, 12);
    let ball = SharedShape::trimesh_with_flags(
        vertices,
        triangles,
        TriMeshFlags::ORIENTED | TriMeshFlags::MERGE_DUPLICATE_VERTICES,
    );
    let field = SharedShape::heightfield(Array2::new(15, 11, heights), Vector::new(2.0, 1.0, 2.0));
    vec![
        hills(TriMeshFlags::empty()),
        hills(TriMeshFlags::FIX_INTERNAL_EDGES),
        field.clone(),
        ball.unwrap(),
        SharedShape::compound(vec![
            (
                Pose::translation(0.3, 0.1, 0.0),
                SharedShape::cuboid(0.3, 0.2, 0.4),
            ),
            (Pose::translation(-0.3, 0.0, 0.2), field),
        ]),
    ]
}

fn any(reach: f32) -> impl Strategy<Value = Vec3> {
    let one = move || -reach..reach;
    (one(), one(), one()).prop_map(Vec3::from)
}

proptest! {
    #[test]
    fn nearby_triangles_are_enough(
        which in 0..5_usize, middle in any(1.0), half in any(0.3), inside in any(1.0), reach in 0.08..0.3_f32,
    ) {
        let shape = &shapes()[which];
        let around = Aabb { min: middle - half.abs(), max: middle + half.abs() };
        let all = ShapeField::new(&**shape, THICKNESS);
        let near = ShapeField::near(&**shape, THICKNESS, around, reach);
        let point = middle + half.abs() * inside;
        let (right, told) = (all.penetration(point, Vec3::Y), near.penetration(point, Vec3::Y));
        if right >= -reach {
            prop_assert!((right - told).abs() <= 1e-6, "{right} {told}");
            let [a, b] = [&all, &near].map(|f| f.inward_direction(point));
            prop_assert!((a - b).length() < 1e-3 || right.abs() < 1e-5, "{a} {b}");
        } else {
            prop_assert!(told < -reach + 1e-6, "{right} {told}");
        }
    }

    #[test]
    fn fields_of_triangles_keep_their_promises(
        which in 0..5_usize, center in any(1.2), radius in 0.001..0.4_f32, inside in any(0.57), normal in any(1.0), reach in 0.08..0.3_f32,
    ) {
        let shape = &shapes()[which];
        let around = Aabb { min: center - radius, max: center + radius };
        let normal = normal.normalize_or(Vec3::Y);
        for field in [
            ShapeField::new(&**shape, THICKNESS),
            ShapeField::near(&**shape, THICKNESS, around, reach),
        ] {
            conformance::check(&field, center, radius, inside, normal).unwrap();
        }
    }
}

#[test]
fn flat_ground_is_flat_whatever_it_is_made_of() {
    let hills = hills(TriMeshFlags::empty());
    let field = ShapeField::new(&*hills, THICKNESS);
    // On edges, on corners, on faces; above, on and below.
    for x in [-0.9, -0.85, -0.7, -0.6] {
        for z in [-0.75, -0.7, -0.68] {
            for y in [0.05_f32, 1e-3, 1e-6, 1e-8, 0.0, -1e-8, -1e-6, -1e-3, -0.05] {
                let point = Vec3::new(x, y, z);
                let depth = field.penetration(point, Vec3::Y);
                if (depth + y).abs() > 1e-7 {
                    // A square is missing there.
                    continue;
                }
                assert_eq!(field.inward_direction(point), -Vec3::Y, "{point}");
            }
        }
    }
    assert!((field.penetration(Vec3::new(-0.75, -0.03, -0.72), Vec3::Y) - 0.03).abs() < 1e-6);
}

#[test]
fn beyond_the_border_of_a_sheet_there_is_nothing() {
    let corners = [[-1.0, -1.0], [-1.0, 1.0], [1.0, 1.0], [1.0, -1.0]];
    let corners = corners.map(|[x, z]| Vector::new(x, 0.0, z)).to_vec();
    let sheet = SharedShape::trimesh(corners, vec![[0, 1, 2], [0, 2, 3]]).unwrap();
    let field = ShapeField::new(&*sheet, THICKNESS);
    let depth = |x, y| field.penetration(Vec3::new(x, y, 0.1), Vec3::Y);
    assert!((depth(0.98, -0.02) - 0.02).abs() < 1e-6);
    assert!((depth(1.0, -0.02) - 0.02).abs() < 1e-6);
    assert!((depth(1.02, -0.02) + 0.02_f32.hypot(0.02)).abs() < 1e-6);
    assert!((depth(0.3, -0.1) + 0.1).abs() < 1e-6);
    assert!((depth(0.3, 0.1) + 0.1).abs() < 1e-6);
}

/// A triangle without an area closes the ground where a corner lies on an edge of its neighbour: there is
/// no border.
#[test]
fn triangles_without_an_area_leave_no_border() {
    let corners = [[-1.0, 0.0], [1.0, 0.0], [0.0, -1.0], [0.0, 1.0], [0.2, 0.0]];
    let corners: Vec<_> = corners.map(|[x, z]| Vector::new(x, 0.0, z)).into();
    let ground = vec![[0, 1, 2], [0, 3, 4], [4, 3, 1], [0, 4, 1]];
    let block = VpsShapeBuilder::new(Mesh::cuboid([0.1; 3]).unwrap());
    let block = block.build().unwrap();
    for (triangles, has_border) in [(ground.clone(), false), (ground[..3].to_vec(), true)] {
        let ground = SharedShape::trimesh(corners.clone(), triangles).unwrap();
        let mut steepest: Real = 1.0;
        for i in 0..20 {
            // The seam is just ahead of a face of the block.
            let at = Pose::translation(0.1, 0.049, 0.0499 - 1e-5 * i as Real);
            let mut manifolds: Vec<ContactManifold> = Vec::new();
            let dispatcher = VpsDispatcher::default();
            dispatcher
                .contact_manifolds(&at, &*ground, &block, 0.001, &mut manifolds, &mut None)
                .unwrap();
            assert!(!manifolds.is_empty());
            let normals = manifolds.iter().map(|m| m.local_n1.y);
            steepest = normals.fold(steepest, Real::min);
        }
        assert_eq!(steepest < 0.99, has_border, "{steepest}");
    }
}
