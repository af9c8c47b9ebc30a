//! Scripted poses of the device, cycle by cycle.

use std::f32::consts::{FRAC_PI_2, PI, TAU};

use vps_core::{Asset, DistanceField, Pose3, Quat, Vec3};

use super::meshes::{FACE, FLOOR, STYLUS_LENGTH, STYLUS_RADIUS};
use super::real_time::DT;

/// Cycles until the device is where it began.
const LOOP: usize = 10_000;

/// Round a solid, whose surface is searched along rays towards its middle: tapping twice a second up to
/// 5 mm into it, then lying on its side.
pub(super) fn around(solid: &Asset<'_>) -> Vec<Pose3> {
    let field = solid.voxelmap.trilinear();
    let bounds = solid.voxelmap.solid();
    let (middle, reach) = (bounds.center(), 0.5 * bounds.extents().length());
    let outward = |i: usize| {
        let turn = i as f32 / LOOP as f32;
        let (azimuth, height) = (TAU * turn, 0.4 * (3.0 * TAU * turn).sin());
        Vec3::new(azimuth.cos(), height, azimuth.sin()).normalize()
    };
    let surface: Vec<f32> = (0..LOOP)
        .map(|i| {
            let mut distance = reach;
            while distance > 0.0 && field.signed_distance(middle + outward(i) * distance) > 0.0 {
                distance -= 2e-4;
            }
            distance
        })
        .collect();
    let surface = smooth(&smooth(&surface));
    let pose = |i: usize| {
        let (time, share) = (i as f32 * DT, i as f32 / LOOP as f32);
        let outward = outward(i);
        // Away at first and at last.
        let away = 0.03 * (1.0 - step(share, 0.0, 0.05) + step(share, 0.95, 1.0));
        let depth = 0.002 + 0.003 * (2.0 * TAU * time).sin() - away;
        let flat = step(share, 0.7, 0.75) - step(share, 0.9, 0.95);
        let across = outward.any_orthonormal_vector();
        let tilt = flat * FRAC_PI_2 + 0.3 * (1.0 - flat) * (0.5 * TAU * time).sin();
        let axis = outward * tilt.cos() + across * tilt.sin();
        let touching = middle + outward * (surface[i] + STYLUS_RADIUS as f32 - depth);
        let tip = touching - axis * (0.5 * flat * STYLUS_LENGTH as f32);
        Pose3::from_parts(tip, Quat::from_rotation_arc(Vec3::Z, axis))
    };
    (0..LOOP).map(pose).collect()
}

/// Periodic values, filtered with a time constant of 30 ms.
fn smooth(values: &[f32]) -> Vec<f32> {
    let mut value = values[0];
    let mut follow = |target: &f32| {
        value += (target - value) * DT / 0.03;
        value
    };
    values.iter().for_each(|v| _ = follow(v));
    values.iter().map(follow).collect()
}

/// The pose of the peg's end at a fraction of the loop.
struct Key {
    share: f32,
    /// Distance from the axis of the hole, and height, in metres.
    aside: f32,
    height: f32,
    /// Radius of circles around that place, one a second, in metres.
    circle: f32,
    /// Amplitude of its tilt in radians, 1.5 times a second.
    tilt: f32,
    /// Its turn about its axis in radians.
    twist: f32,
}

const fn key(share: f32, aside: f32, height: f32, circle: f32, tilt: f32, twist: f32) -> Key {
    Key {
        share,
        aside,
        height,
        circle,
        tilt,
        twist,
    }
}

const KEYS: [Key; 14] = [
    key(0.0, 0.006, FACE + 0.01, 0.0, 0.0, 0.0),
    key(0.08, 0.006, FACE - 0.003, 0.0, 0.0, 0.0),
    key(0.22, 0.0, FACE - 0.003, 0.0, 0.0, 0.0),
    key(0.4, 0.0, FLOOR, 0.0, 0.02, 0.0),
    key(0.45, 0.0, FLOOR - 0.006, 0.0, 0.0, 0.0),
    key(0.5, 0.0, FLOOR - 0.006, 0.0, 0.0, 0.8),
    key(0.55, 0.0, FLOOR - 0.006, 0.0, 0.0, -0.8),
    key(0.6, 0.0, FLOOR + 0.004, 0.003, 0.0, 0.0),
    key(0.75, 0.0, FLOOR + 0.004, 0.003, 0.0, 0.0),
    key(0.78, 0.0, FLOOR + 0.002, 0.0, 0.15, 0.0),
    key(0.88, 0.0, FLOOR + 0.002, 0.0, 0.15, 0.0),
    key(0.9, 0.0, FLOOR + 0.002, 0.0, 0.0, 0.0),
    key(0.97, 0.0, FACE + 0.01, 0.0, 0.0, 0.0),
    key(1.0, 0.006, FACE + 0.01, 0.0, 0.0, 0.0),
];

/// On the face beside the hole, into it, pressed on its floor and twisted, pushed around in it, tilted
/// until it jams, and out.
pub(super) fn into_hole() -> Vec<Pose3> {
    let pose = |i: usize| {
        let (time, share) = (i as f32 * DT, i as f32 / LOOP as f32);
        let next = KEYS
            .iter()
            .position(|k| k.share > share)
            .unwrap_or(KEYS.len() - 1);
        let (from, to) = (&KEYS[next - 1], &KEYS[next]);
        let progress = step(share, from.share, to.share);
        let at = |of: fn(&Key) -> f32| of(from) + (of(to) - of(from)) * progress;
        let (sin, cos) = (TAU * time).sin_cos();
        let circle = at(|k| k.circle);
        let end = Vec3::new(
            at(|k| k.aside) + circle * cos,
            circle * sin,
            at(|k| k.height),
        );
        let tilt = at(|k| k.tilt) * (1.5 * TAU * time).sin();
        let turn = Quat::from_rotation_x(tilt) * Quat::from_rotation_z(at(|k| k.twist));
        Pose3::from_parts(end, turn)
    };
    (0..LOOP).map(pose).collect()
}

/// A smooth step from 0 to 1 between two places.
fn step(x: f32, from: f32, to: f32) -> f32 {
    let share = ((x - from) / (to - from)).clamp(0.0, 1.0);
    0.5 - 0.5 * (PI * share).cos()
}
