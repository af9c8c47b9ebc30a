//! A body that slides without friction keeps its velocity on level ground of any shape.

// Numbers of rapier are 32-bit or 64-bit.
#![allow(clippy::unnecessary_cast, clippy::useless_conversion)]

mod support;

use support::asset;
use vps_build::{BuildOptions, Mesh, PointCount, Resolution};
use vps_rapier::rapier3d::prelude::*;
use vps_rapier::{Role, VpsShape, VpsShapeBuilder, narrow_phase};

/// A floor of 10 x 1 m, 0.2 m thick, its top at y = 0.
fn floor() -> Mesh {
    let half = Mesh::cuboid([10.0, 0.2, 1.0]).unwrap();
    let to = glamx::DVec3::new(4.5, -0.1, 0.0);
    let vertices: Vec<_> = half.vertices().iter().map(|v| *v + to).collect();
    Mesh::new(&vertices, half.triangles()).unwrap()
}

/// The same of squares of 0.25 m, as vertices and triangles; the top alone if it is open.
fn squares(is_open: bool) -> (Vec<Vector>, Vec<[u32; 3]>) {
    let (nx, nz) = (40_u32, 4_u32);
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    let mut layer = |y: Real, flipped: bool| {
        let first = vertices.len() as u32;
        for z in 0..=nz {
            for x in 0..=nx {
                let (x, z) = (0.25 * x as Real - 0.5, 0.25 * z as Real - 0.5);
                vertices.push(Vector::new(x, y, z));
            }
        }
        let at = |x: u32, z: u32| first + z * (nx + 1) + x;
        for z in 0..nz {
            for x in 0..nx {
                let [a, b, c, d] = [at(x, z), at(x, z + 1), at(x + 1, z + 1), at(x + 1, z)];
                for [a, b, c] in [[a, b, c], [a, c, d]] {
                    triangles.push(if flipped { [a, c, b] } else { [a, b, c] });
                }
            }
        }
        first
    };
    let top = layer(0.0, false);
    if is_open {
        return (vertices, triangles);
    }
    let bottom = layer(-0.2, true);
    let at = |first: u32, x: u32, z: u32| first + z * (nx + 1) + x;
    let mut side = |from: [u32; 2], to: [u32; 2]| {
        let [a, b] = [from, to].map(|[x, z]| at(top, x, z));
        let [c, d] = [from, to].map(|[x, z]| at(bottom, x, z));
        triangles.extend([[a, b, d], [a, d, c]]);
    };
    for x in 0..nx {
        side([x + 1, 0], [x, 0]);
        side([x, nz], [x + 1, nz]);
    }
    for z in 0..nz {
        side([0, z], [0, z + 1]);
        side([nx, z + 1], [nx, z]);
    }
    (vertices, triangles)
}

fn grounds() -> Vec<(&'static str, SharedShape)> {
    // As many points as the body, so that a few more do not decide which of the two is the shell.
    let options = BuildOptions {
        resolution: Resolution::VoxelsAlongLongest(200),
        points: PointCount::About(4000),
        ..BuildOptions::default()
    };
    let vps = VpsShapeBuilder::new(floor())
        .options(options)
        .build()
        .unwrap();
    let trimesh = |is_open, flags| {
        let (vertices, triangles) = squares(is_open);
        SharedShape::trimesh_with_flags(vertices, triangles, flags).unwrap()
    };
    let heights = vps_rapier::rapier3d::parry::utils::Array2::repeat(5, 41, 0.0);
    vec![
        ("VPS, as it comes", vps.clone().into()),
        ("VPS, voxelmap", vps.with_role(Role::Voxelmap).into()),
        ("closed mesh", trimesh(false, TriMeshFlags::empty())),
        ("solid mesh", trimesh(false, TriMeshFlags::ORIENTED)),
        ("open mesh", trimesh(true, TriMeshFlags::FIX_INTERNAL_EDGES)),
        (
            "height field",
            SharedShape::heightfield(heights, Vector::new(10.0, 1.0, 1.0)),
        ),
    ]
}

#[test]
fn bodies_slide_freely_on_level_ground() {
    let block = Mesh::cuboid([0.2, 0.1, 0.2]).unwrap();
    let bodies: [(&str, SharedShape); 2] = [
        ("4000 points", VpsShape::new(asset(&block, 4000)).into()),
        ("300 points", VpsShape::new(asset(&block, 300)).into()),
    ];
    let mut failed = String::new();
    for (ground_name, ground) in grounds() {
        // A height field is centred at its origin.
        let middle = if ground_name == "height field" {
            4.5
        } else {
            0.0
        };
        for (name, shape) in &bodies {
            for i in 0..3 {
                let i = i as Real;
                let mut world = PhysicsWorld {
                    narrow_phase: narrow_phase(),
                    ..PhysicsWorld::default()
                };
                world
                    .integration_parameters
                    .normalized_contact_recycle_distance = 0.002;
                let place = RigidBodyBuilder::fixed().translation(Vector::X * middle);
                world.insert(place, ColliderBuilder::new(ground.clone()).friction(0.0));
                let start = RigidBodyBuilder::dynamic()
                    .translation(Vector::new(0.083 * i, 0.0505, 0.019 * i))
                    .linvel(Vector::new(3.0, 0.0, 0.0));
                let (body, _) =
                    world.insert(start, ColliderBuilder::new(shape.clone()).friction(0.0));
                let (mut up, mut spin): (Real, Real) = (0.0, 0.0);
                for _ in 0..90 {
                    world.step();
                    let body = &world.bodies[body];
                    up = up.max(body.linvel().y.abs());
                    spin = spin.max(body.angvel().length());
                }
                let speed = world.bodies[body].linvel().x;
                if (speed - 3.0).abs() > 0.02 || up > 0.05 || spin > 0.2 {
                    failed += &format!(
                        "{name} on {ground_name}: {speed:.3} m/s, up {up:.3} m/s, {spin:.3} rad/s\n"
                    );
                }
            }
        }
    }
    assert!(failed.is_empty(), "{failed}");
}
