//! Queries about a compound with VPS shapes give what the same queries about its parts give.

// Numbers of rapier are 32-bit or 64-bit.
#![allow(clippy::unnecessary_cast, clippy::useless_conversion)]

mod support;

use support::asset;
use vps_build::{Mesh, models};
use vps_rapier::rapier3d::parry::query::{
    ClosestPoints, DefaultQueryDispatcher, NonlinearRigidMotion, QueryDispatcher, ShapeCastHit,
    ShapeCastOptions,
};
use vps_rapier::rapier3d::prelude::*;
use vps_rapier::{VpsDispatcher, VpsShape};

/// Tolerance between two computations of the same value, in metres and seconds.
const SAME: Real = 1e-3;

fn vps(mesh: &Mesh) -> SharedShape {
    VpsShape::new(asset(mesh, 2000)).into()
}

/// A ring and a box, and a ball of parry between them.
fn parts() -> Vec<(Pose, SharedShape)> {
    let ring = vps(&models::torus(24));
    let block = vps(&Mesh::cuboid([0.4, 0.6, 0.5]).unwrap());
    let turned = Rotation::from_rotation_x(0.7);
    vec![
        (Pose::from_parts(Vector::new(-0.7, 0.1, 0.0), turned), ring),
        (Pose::translation(0.1, -0.3, 0.2), SharedShape::ball(0.2)),
        (
            Pose::from_parts(Vector::new(0.8, 0.0, -0.2), turned.inverse()),
            block,
        ),
    ]
}

/// Shapes that meet the compound.
fn others() -> Vec<(&'static str, SharedShape)> {
    let half = SharedShape::cuboid(0.2, 0.1, 0.3);
    let two = SharedShape::compound(vec![
        (Pose::translation(0.0, 0.3, 0.0), half.clone()),
        (
            Pose::translation(0.0, -0.3, 0.1),
            vps(&Mesh::icosphere(0.2, 3).unwrap()),
        ),
    ]);
    vec![
        ("ball", SharedShape::ball(0.25)),
        ("cuboid", half),
        ("VPS knot", vps(&models::trefoil_knot(16))),
        ("compound", two),
    ]
}

/// Poses of the other shape: far away, close by, and in parts of the compound.
fn poses() -> Vec<Pose> {
    let mut n = 0_u32;
    let mut next = || {
        n = n.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        (n >> 8) as Real / (1 << 23) as Real - 1.0
    };
    let mut any = |reach: Real| Vector::new(next(), next(), next()) * reach;
    (0..40)
        .map(|i| {
            let place = any(0.8 + 0.05 * i as Real);
            Pose::from_parts(place, Rotation::from_scaled_axis(any(3.0)))
        })
        .collect()
}

fn all() -> impl QueryDispatcher {
    VpsDispatcher::default().chain(DefaultQueryDispatcher)
}

/// Calls `ask` for every pose of every other shape, with the compound first and the other second.
fn for_each_pair(mut ask: impl FnMut(&str, &Pose, &[(Pose, SharedShape)], [&dyn Shape; 2])) {
    let parts = parts();
    let compound = SharedShape::compound(parts.clone());
    for (name, other) in others() {
        for (number, pose) in poses().iter().enumerate() {
            let what = format!("{name}, pose {number}");
            ask(&what, pose, &parts, [&*compound, &*other]);
        }
    }
}

#[test]
fn distances_and_contacts_are_those_of_the_parts() {
    let all = all();
    let (mut met, mut apart) = (0, 0);
    for_each_pair(|what, pose, parts, [compound, other]| {
        let of_parts = |ask: &dyn Fn(&Pose, &dyn Shape) -> Real| {
            let each = parts
                .iter()
                .map(|(at, part)| ask(&at.inv_mul(pose), &**part));
            each.fold(Real::INFINITY, Real::min)
        };
        let touches = parts.iter().any(|(at, part)| {
            let found = all.intersection_test(&at.inv_mul(pose), &**part, other);
            found.unwrap().intersecting
        });
        let back = pose.inverse();
        let found = all.intersection_test(pose, compound, other).unwrap();
        assert_eq!(found.intersecting, touches, "{what}");
        let found = all.intersection_test(&back, other, compound).unwrap();
        assert_eq!(found.intersecting, touches, "{what}, the other way");
        *(if touches { &mut met } else { &mut apart }) += 1;

        let distance = of_parts(&|p, part| all.distance(p, part, other).unwrap().distance);
        let found = all.distance(pose, compound, other).unwrap().distance;
        let back_found = all.distance(&back, other, compound).unwrap().distance;
        for found in [found, back_found] {
            assert!(
                (found - distance).abs() < SAME,
                "{what}: {found}, parts {distance}"
            );
        }

        let within = 0.3;
        let contact = of_parts(&|p, part| {
            let found = all.contact(p, part, other, within).unwrap();
            found.map_or(Real::INFINITY, |c| c.dist)
        });
        let found = all.contact(pose, compound, other, within).unwrap();
        let back_found = all.contact(&back, other, compound, within).unwrap();
        let back_found = back_found.map(|c| c.flipped());
        for found in [found, back_found] {
            let dist = found.map_or(Real::INFINITY, |c| c.dist);
            let is_same = dist == contact || (dist - contact).abs() < SAME;
            assert!(is_same, "{what}: contact {dist}, parts {contact}");
            if let Some(c) = found {
                let between = *pose * c.point2 - c.point1;
                let normals = c.normal1 + pose.rotation * c.normal2;
                assert!(normals.length() < SAME, "{what}: {c:?}");
                assert!(
                    (between.dot(c.normal1) - c.dist).abs() < SAME,
                    "{what}: {c:?}"
                );
            }
        }

        let found = all.closest_points(pose, compound, other, within).unwrap();
        let mut back_found = all.closest_points(&back, other, compound, within).unwrap();
        back_found.flip();
        for found in [found, back_found] {
            match found {
                ClosestPoints::Intersecting => assert!(touches, "{what}"),
                ClosestPoints::WithinMargin(p1, p2) => {
                    let between = (*pose * p2 - p1).length();
                    let is_same = !touches && (between - distance).abs() < SAME;
                    assert!(is_same, "{what}: {between}, parts {distance}");
                }
                ClosestPoints::Disjoint => {
                    assert!(distance > within - SAME, "{what}: parts {distance}");
                }
            }
        }
    });
    assert!(met > 20 && apart > 20, "{met} met, {apart} apart");
}

/// The hit of the part that is met first, in the frame of the compound.
fn first(hits: impl Iterator<Item = (u32, Pose, Option<ShapeCastHit>)>) -> Option<ShapeCastHit> {
    let hits = hits.filter_map(|(number, at, hit)| {
        let mut hit = hit?.transform1_by(&at);
        hit.subshape1 = number;
        Some(hit)
    });
    hits.min_by(|a, b| a.time_of_impact.total_cmp(&b.time_of_impact))
}

fn assert_same(what: &str, found: Option<ShapeCastHit>, expected: Option<ShapeCastHit>) {
    let times = [found, expected].map(|hit| hit.map_or(Real::INFINITY, |h| h.time_of_impact));
    let is_same = times[0] == times[1] || (times[0] - times[1]).abs() < SAME;
    assert!(is_same, "{what}: {found:?}, parts {expected:?}");
    if let (Some(found), Some(expected)) = (found, expected)
        && found.subshape1 == expected.subshape1
    {
        let off = found.witness1.distance(expected.witness1);
        assert!(off < 0.02, "{what}: {found:?}, parts {expected:?}");
        let off = found.normal1.distance(expected.normal1);
        assert!(off < 0.1, "{what}: {found:?}, parts {expected:?}");
    }
}

#[test]
fn casts_meet_the_part_that_is_first() {
    let all = all();
    let (mut hits, mut misses) = (0, 0);
    for_each_pair(|what, pose, parts, [compound, other]| {
        // Towards a point in the middle, for a time that is too short for some.
        let displacement = Vector::new(0.2, -0.1, 0.0) - pose.translation;
        for stop_at_penetration in [false, true] {
            let options = ShapeCastOptions {
                target_distance: 0.02,
                stop_at_penetration,
                ..ShapeCastOptions::with_max_time_of_impact(0.4)
            };
            let expected = first((0..).zip(parts).map(|(number, (at, part))| {
                let (pose, displacement) = (at.inv_mul(pose), at.rotation.inverse() * displacement);
                let hit = all.cast_shapes(&pose, displacement, &**part, other, options);
                (number, *at, hit.unwrap())
            }));
            *(if expected.is_some() {
                &mut hits
            } else {
                &mut misses
            }) += 1;
            let found = all.cast_shapes(pose, displacement, compound, other, options);
            assert_same(what, found.unwrap(), expected);
            let (back, reverse) = (pose.inverse(), -(pose.rotation.inverse() * displacement));
            let found = all.cast_shapes(&back, reverse, other, compound, options);
            assert_same(what, found.unwrap().map(ShapeCastHit::swapped), expected);
        }
    });
    assert!(hits > 40 && misses > 10, "{hits} hits, {misses} misses");
}

#[test]
fn turning_casts_meet_the_part_that_is_first() {
    let all = all();
    let (mut hits, mut misses) = (0, 0);
    for_each_pair(|what, pose, parts, [compound, other]| {
        let still = NonlinearRigidMotion::constant_position(Pose::IDENTITY);
        let displacement = Vector::new(0.2, -0.1, 0.0) - pose.translation;
        let moving = NonlinearRigidMotion::new(
            *pose,
            Vector::ZERO,
            displacement,
            Vector::new(0.5, 1.0, 0.0),
        );
        for stop in [false, true] {
            let expected = first((0..).zip(parts).map(|(number, (at, part))| {
                let still = still.prepend(*at);
                let hit =
                    all.cast_shapes_nonlinear(&still, &**part, &moving, other, 0.0, 0.4, stop);
                (number, *at, hit.unwrap())
            }));
            *(if expected.is_some() {
                &mut hits
            } else {
                &mut misses
            }) += 1;
            let ask = |one: (&NonlinearRigidMotion, &dyn Shape),
                       two: (&NonlinearRigidMotion, &dyn Shape)| {
                all.cast_shapes_nonlinear(one.0, one.1, two.0, two.1, 0.0, 0.4, stop)
                    .unwrap()
            };
            let found = ask((&still, compound), (&moving, other));
            assert_same(what, found, expected);
            let found = ask((&moving, other), (&still, compound));
            assert_same(what, found.map(ShapeCastHit::swapped), expected);
        }
    });
    assert!(hits > 40 && misses > 10, "{hits} hits, {misses} misses");
}
