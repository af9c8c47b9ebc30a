//! Every pair of a VPS shape and another collides, in both orders.

// Numbers of rapier are 32-bit or 64-bit.
#![allow(clippy::unnecessary_cast, clippy::useless_conversion)]

mod support;

use support::asset;
use vps_build::Mesh;
use vps_rapier::rapier3d::parry::query::{
    ContactManifold, DefaultQueryDispatcher, PersistentQueryDispatcher, QueryDispatcher,
};
use vps_rapier::rapier3d::parry::shape::{
    ConvexPolyhedron, Cuboid, Polyline, Segment, Triangle, Voxels,
};
use vps_rapier::rapier3d::parry::utils::Array2;
use vps_rapier::rapier3d::prelude::*;
use vps_rapier::{Manifolds, Role, VpsDispatcher, VpsShape};

const HALF: [f64; 3] = [0.3, 0.2, 0.25];

/// Overlap or distance of the shapes, larger than the spacing of the shell's points.
const OFFSET: Real = 0.03;

fn vector(v: [f64; 3]) -> Vector {
    Vector::from_array(v.map(|c| c as Real))
}

/// Surfaces without an interior of their own.
const OPEN: [&str; 3] = ["sheet of triangles", "height field", "triangle"];

/// A box as a VPS shape.
fn vps_box(half: [f64; 3], points: u32) -> VpsShape {
    let mesh = Mesh::cuboid(half.map(|h| 2.0 * h)).unwrap();
    VpsShape::new(asset(&mesh, points))
}

fn mesh(half: Vector) -> (Vec<Vector>, Vec<[u32; 3]>) {
    Cuboid::new(half).to_trimesh()
}

/// All shapes of parry, of about `size` metres.
fn shapes(size: Real) -> Vec<(&'static str, SharedShape)> {
    let half = Vector::new(0.5, 0.3, 0.4) * size;
    let at = |x: Real, y: Real, z: Real| Vector::new(x, y, z) * size;
    let corners = [
        at(0.5, 0.0, 0.0),
        at(-0.4, 0.1, 0.0),
        at(0.0, 0.5, 0.1),
        at(0.0, -0.4, 0.0),
        at(0.0, 0.1, 0.5),
        at(0.1, 0.0, -0.5),
    ];
    let polyhedron = ConvexPolyhedron::from_convex_hull(&corners).unwrap();
    let (vertices, triangles) = mesh(half);
    let closed =
        SharedShape::trimesh_with_flags(vertices.clone(), triangles, TriMeshFlags::ORIENTED);
    let hills = Array2::new(3, 3, vec![0.0, 0.4, 0.1, 0.3, 0.5, 0.2, 0.1, 0.5, 0.0]);
    let cells = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]].map(|[x, y, z]| IVector::new(x, y, z));
    let voxels = Voxels::new(Vector::splat(0.4 * size), &cells);
    let line = Polyline::new(
        vec![at(-0.5, 0.0, 0.0), at(0.2, 0.3, 0.0), at(0.5, 0.0, 0.2)],
        None,
    );
    let triangle = Triangle::new(at(-0.4, 0.0, 0.1), at(0.5, 0.0, 0.0), at(0.0, 0.1, 0.5));
    let two = SharedShape::compound(vec![
        (Pose::IDENTITY, SharedShape::cuboid(half.x, half.y, half.z)),
        (
            Pose::translation(0.6 * size, 0.0, 0.0),
            SharedShape::ball(0.3 * size),
        ),
    ]);
    vec![
        ("ball", SharedShape::ball(0.5 * size)),
        ("cuboid", SharedShape::cuboid(half.x, half.y, half.z)),
        ("capsule", SharedShape::capsule_y(0.3 * size, 0.2 * size)),
        ("cylinder", SharedShape::cylinder(0.4 * size, 0.3 * size)),
        ("cone", SharedShape::cone(0.4 * size, 0.3 * size)),
        ("convex polyhedron", SharedShape::new(polyhedron)),
        ("closed triangle mesh", closed.unwrap()),
        (
            "sheet of triangles",
            SharedShape::trimesh(vertices, vec![[0, 1, 2], [2, 3, 0]]).unwrap(),
        ),
        (
            "height field",
            SharedShape::heightfield(hills, Vector::splat(size)),
        ),
        ("compound", two),
        ("voxels", SharedShape::new(voxels)),
        (
            "round cuboid",
            SharedShape::round_cuboid(half.x, half.y, half.z, 0.1 * size),
        ),
        (
            "round cylinder",
            SharedShape::round_cylinder(0.4 * size, 0.3 * size, 0.1 * size),
        ),
        (
            "round cone",
            SharedShape::round_cone(0.4 * size, 0.3 * size, 0.1 * size),
        ),
        (
            "round triangle",
            SharedShape::round_triangle(triangle.a, triangle.b, triangle.c, 0.1 * size),
        ),
        (
            "round polyhedron",
            SharedShape::round_convex_hull(&corners, 0.1 * size).unwrap(),
        ),
        ("triangle", SharedShape::new(triangle)),
        (
            "segment",
            SharedShape::new(Segment::new(at(-0.5, 0.0, 0.0), at(0.5, 0.1, 0.0))),
        ),
        ("polyline", SharedShape::new(line)),
    ]
}

/// Pseudorandom numbers in -1..1.
fn scattered() -> impl FnMut() -> Real {
    let mut n = 0_u32;
    move || {
        n = n.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        (n >> 8) as Real / (1 << 23) as Real - 1.0
    }
}

/// Distances of the contacts of a pair, deepest first, after checks of their points and normals.
fn contacts(
    dispatcher: &impl PersistentQueryDispatcher<(), ()>,
    pos12: &Pose,
    [g1, g2]: [&dyn Shape; 2],
    what: &str,
) -> Vec<Real> {
    let mut manifolds: Vec<ContactManifold<(), ()>> = Vec::new();
    let mut workspace = None;
    dispatcher
        .contact_manifolds(pos12, g1, g2, 0.02, &mut manifolds, &mut workspace)
        .unwrap_or_else(|_| panic!("{what} does not collide"));
    let mut distances = Vec::new();
    for manifold in &manifolds {
        let [pos1, pos2] = [manifold.subshape_pos1(), manifold.subshape_pos2()]
            .map(|p| p.copied().unwrap_or(Pose::IDENTITY));
        let (pos1, pos2) = (pos1, *pos12 * pos2);
        let [n1, n2] = [
            pos1.rotation * manifold.local_n1,
            pos2.rotation * manifold.local_n2,
        ];
        assert!((n1 + n2).length() < 1e-3, "{what}: normals {n1} {n2}");
        assert!((n1.length() - 1.0).abs() < 1e-3, "{what}: normal {n1}");
        for point in &manifold.points {
            // Along the normal from the first surface to the second.
            let between = pos2 * point.local_p2 - pos1 * point.local_p1;
            let off = (between.dot(n1) - point.dist).abs();
            assert!(
                off < 0.01,
                "{what}: {between} along {n1} is not {}",
                point.dist
            );
            distances.push(point.dist);
        }
    }
    distances.sort_by(|a, b| a.total_cmp(b));
    distances
}

/// The distance along a direction at which `other` just touches the box, by parry; `None` if it does
/// not meet it.
fn touching(
    exact: &dyn Shape,
    other: &dyn Shape,
    rotation: Rotation,
    direction: Vector,
) -> Option<Real> {
    let at = |t: Real| Pose::from_parts(direction * t, rotation);
    let touches = |t: Real| {
        DefaultQueryDispatcher
            .intersection_test(&at(t), exact, other)
            .is_ok_and(|found| found.intersecting)
    };
    let (mut near, mut far) = (0.0, 3.0);
    while near < far && !touches(near) {
        near += 0.02;
    }
    if near >= far {
        return None;
    }
    while touches(near + 0.02) {
        near += 0.02;
    }
    far = near + 0.02;
    for _ in 0..20 {
        let middle = 0.5 * (near + far);
        *(if touches(middle) { &mut near } else { &mut far }) = middle;
    }
    Some(near)
}

#[test]
fn every_pair_collides() {
    let ours = vps_box(HALF, 3000);
    let exact = Cuboid::new(vector(HALF));
    let in_compound = SharedShape::compound(vec![(Pose::IDENTITY, ours.clone().into())]);
    let dispatchers = [Manifolds::Reduced, Manifolds::Segments(3)].map(|manifolds| VpsDispatcher {
        manifolds,
        ..VpsDispatcher::default()
    });
    let mut next = scattered();
    let (mut met, mut tried) = (0, 0);
    for size in [0.6, 0.1, 0.02] {
        for (name, other) in shapes(size) {
            for pose in 0..24 {
                let mut any = || Vector::new(next(), next(), next()).normalize_or(Vector::X);
                let rotation = Rotation::from_axis_angle(any(), 3.0 * next());
                let direction = Vector::new(next(), next(), next()).normalize_or(Vector::X);
                let what = format!("{name} of {size} m, pose {pose}");
                tried += 1;
                let Some(touch) = touching(&exact, &*other, rotation, direction) else {
                    continue;
                };
                met += 1;
                // The overlap is no deeper than a small shape is large.
                let overlap = OFFSET.min(0.4 * size);
                let inside = Pose::from_parts(direction * (touch - overlap), rotation);
                // It may be a grazed edge, which sampling may miss.
                let by_parry = DefaultQueryDispatcher.contact(&inside, &exact, &*other, 0.0);
                let by_parry = by_parry.ok().flatten().map_or(-overlap, |c| c.dist);
                let is_deep = by_parry < -0.2 * overlap;
                let outside = Pose::from_parts(direction * (touch + OFFSET + 0.02), rotation);
                for dispatcher in dispatchers {
                    let all = dispatcher.chain(DefaultQueryDispatcher);
                    for ours in [&ours as &dyn Shape, &*in_compound] {
                        let forward = contacts(&all, &inside, [ours, &*other], &what);
                        let backward = contacts(&all, &inside.inverse(), [&*other, ours], &what);
                        let deepest = forward.first().copied().unwrap_or(Real::MAX);
                        assert!(
                            !is_deep || deepest < 0.0,
                            "{what}: {deepest}, {by_parry} by parry"
                        );
                        // Deep inside, which contacts push against the others may differ a little.
                        let other_way = backward.first().copied().unwrap_or(Real::MAX);
                        let off = (deepest - other_way).abs();
                        assert!(
                            off < 1e-4 || deepest < -0.02,
                            "{what}: {forward:?}, {backward:?} the other way"
                        );
                        let found = all.intersection_test(&inside, ours, &*other).unwrap();
                        assert_eq!(found.intersecting, deepest <= 0.0, "{what}: {deepest}");
                        assert!(all.distance(&inside, &*other, ours).is_ok());
                        // An open surface is thick enough to hold a body that is through it.
                        let is_open = OPEN.contains(&name);
                        let apart = contacts(&all, &outside, [ours, &*other], &what);
                        assert!(
                            is_open || apart.iter().all(|&d| d > -0.005),
                            "{what} is apart: {apart:?}"
                        );
                    }
                }
            }
        }
    }
    assert!(2 * met > tried, "{met} of {tried}");
}

/// The shapes the test above leaves out: a half-space, which is unbounded, and VPS shapes, which parry
/// does not know.
#[test]
fn half_spaces_and_vps_shapes_collide() {
    let ours = vps_box(HALF, 3000);
    let others: [(&str, SharedShape, Real); 4] = [
        ("half-space", SharedShape::halfspace(-Vector::X), 0.0),
        ("VPS shape", vps_box(HALF, 2000).into(), 0.3),
        // The large one has few points, and the small one fits between them.
        ("small VPS shape", vps_box([0.02; 3], 5000).into(), 0.02),
        (
            "VPS shape for both",
            vps_box(HALF, 5000).with_role(Role::Both).into(),
            0.3,
        ),
    ];
    let all = VpsDispatcher::default().chain(DefaultQueryDispatcher);
    for (name, other, reach) in others {
        let at = |offset: Real| Pose::translation(0.3 + reach + offset, 0.013, -0.007);
        for ours in [&ours as &dyn Shape, &vps_box(HALF, 60)] {
            let inside = contacts(&all, &at(-0.01), [ours, &*other], name);
            assert!((inside[0] + 0.01).abs() < 0.002, "{name}: {inside:?}");
            let backward = contacts(&all, &at(-0.01).inverse(), [&*other, ours], name);
            assert!(
                (inside[0] - backward[0]).abs() < 1e-4,
                "{name}: {inside:?} {backward:?}"
            );
            let apart = contacts(&all, &at(0.01), [ours, &*other], name);
            assert!((apart[0] - 0.01).abs() < 0.002, "{name}: {apart:?}");
        }
    }
}

/// A ball, a pin and a small box come to rest on a VPS shape whose points are further apart than
/// they are wide.
#[test]
fn small_bodies_do_not_slip_through() {
    let ground = vps_box([0.5, 0.1, 0.5], 60);
    assert!(ground.spacing() > 0.1);
    let small = vps_box([0.03; 3], 300);
    let bodies: [(&str, SharedShape, Real); 6] = [
        ("ball", SharedShape::ball(0.03), 0.03),
        ("pin", SharedShape::capsule_x(0.05, 0.01), 0.01),
        ("cylinder", SharedShape::cylinder(0.02, 0.04), 0.02),
        ("box", SharedShape::cuboid(0.03, 0.03, 0.03), 0.03),
        ("cone", SharedShape::cone(0.03, 0.03), 0.03),
        ("VPS box", small.into(), 0.03),
    ];
    let mut world = PhysicsWorld {
        narrow_phase: vps_rapier::narrow_phase(),
        ..PhysicsWorld::default()
    };
    world.insert(
        RigidBodyBuilder::fixed(),
        ColliderBuilder::new(ground.into()),
    );
    let handles = bodies.map(|(name, shape, reach)| {
        let x = reach * 3.0 + 0.1 * world.bodies.len() as Real - 0.4;
        let start = RigidBodyBuilder::dynamic().translation(Vector::new(x, 0.2, 0.03));
        let collider = ColliderBuilder::new(shape).density(500.0);
        (name, world.insert(start, collider).0, reach)
    });
    for _ in 0..180 {
        world.step();
    }
    for (name, handle, reach) in handles {
        let y = world.bodies[handle].translation().y;
        assert!((y - 0.1 - reach).abs() < 0.004, "{name} at {y}");
    }
}
