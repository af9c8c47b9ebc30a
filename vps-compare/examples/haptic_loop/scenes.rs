//! Tools, solids and the poses of the device.

use std::f32::consts::{FRAC_PI_2, PI, TAU};
use std::path::Path;

use glamx::{DVec2, DVec3};
use vps_build::{BuildOptions, Density, Mesh, PointCount, Resolution, build, read_mesh};
use vps_core::{Asset, CouplingOptions, DistanceField, Pose3, Quat, Tool, Vec3};

use crate::{DT, Error};

/// Cycles until the device is where it began.
const LOOP: usize = 10_000;

/// A tool and a solid that rests.
pub(crate) struct Scene {
    pub(crate) name: &'static str,
    /// What it shows.
    pub(crate) about: &'static str,
    /// How the voxelmap is stored.
    pub(crate) store: &'static str,
    /// The pointshell.
    pub(crate) tool: Asset<'static>,
    /// The voxelmap, in the world.
    pub(crate) solid: Asset<'static>,
    /// Of a contact, in N/m³.
    pub(crate) stiffness: f32,
    pub(crate) coupling: Coupling,
    /// The device, cycle by cycle; it ends where it began.
    pub(crate) device: Vec<Pose3>,
}

/// What a virtual coupling is made of.
#[derive(Clone, Copy)]
pub(crate) struct Coupling {
    pub(crate) tool: Tool,
    pub(crate) options: CouplingOptions,
}

const STORES: [(&str, Density); 2] = [("dense", Density::Dense), ("sparse", Density::Sparse)];

/// Every scene with both kinds of voxelmap.
pub(crate) fn all() -> Result<Vec<Scene>, Error> {
    let mut scenes = Vec::new();
    let bunny = bunny()?;
    let stylus = shell(&stylus_mesh()?, STYLUS_POINTS)?;
    for (store, density) in STORES {
        let solid = map(&bunny, 0.002_56, density)?;
        scenes.push(Scene {
            name: "stylus",
            about: "A stylus of 8 mm probes the bunny, 0.27 m wide, voxels of 2.56 mm: it goes round, \
                    tapping twice a second up to 5 mm into it, then lies on its side",
            store,
            device: around(&solid),
            coupling: coupling(&stylus, 0.02),
            tool: stylus.clone(),
            solid,
            stiffness: 2e9,
        });
    }
    let (peg, block) = (shell(&peg_mesh()?, PEG_POINTS)?, block_mesh()?);
    for (store, density) in STORES {
        scenes.push(Scene {
            name: "peg",
            about: "A peg of 19 mm and a blind hole of 20 mm, 30 mm deep, voxels of 0.5 mm: on the face \
                    beside the hole, into it, pressed on its floor and twisted, pushed around in \
                    it, tilted until it jams, and out",
            store,
            device: into_hole(),
            coupling: coupling(&peg, 0.05),
            tool: peg.clone(),
            solid: map(&block, 0.000_5, density)?,
            stiffness: 1e9,
        });
    }
    Ok(scenes)
}

fn bunny() -> Result<Mesh, Error> {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../.cache/models/bunny.obj");
    let bunny = read_mesh(&file, None)
        .map_err(|error| format!("{error}: `just fetch` brings the bunny"))?;
    Ok(bunny.scaled(0.135)?)
}

fn shell(mesh: &Mesh, points: u32) -> Result<Asset<'static>, Error> {
    let options = BuildOptions {
        points: PointCount::About(points),
        ..BuildOptions::default()
    };
    Ok(build(mesh, &options, &|_| ())?.asset)
}

fn map(mesh: &Mesh, voxel_size: f64, density: Density) -> Result<Asset<'static>, Error> {
    let options = BuildOptions {
        resolution: Resolution::VoxelSize(voxel_size),
        points: PointCount::About(10),
        density,
        ..BuildOptions::default()
    };
    Ok(build(mesh, &options, &|_| ())?.asset)
}

/// 1000 N/m and 2 N m/rad, as desktop devices bear.
fn coupling(tool: &Asset<'_>, mass: f32) -> Coupling {
    let tool = Tool::of(&tool.mass, mass);
    let options = CouplingOptions::critically_damped(&tool, 1000.0, 2.0);
    Coupling { tool, options }
}

const STYLUS_POINTS: u32 = 2000;
/// In metres, as all that follow.
const STYLUS_RADIUS: f64 = 0.004;
const STYLUS_LENGTH: f64 = 0.12;

/// A capsule along the z axis, the centre of its tip at the origin.
fn stylus_mesh() -> Result<Mesh, Error> {
    let arc = |middle: f64, from: f64| {
        (0..=8).map(move |i| {
            let angle = from + std::f64::consts::FRAC_PI_2 * f64::from(i) / 8.0;
            DVec2::new(0.0, middle) + STYLUS_RADIUS * DVec2::from_angle(angle)
        })
    };
    let tip = arc(0.0, -std::f64::consts::FRAC_PI_2);
    let mut profile: Vec<_> = tip.chain(arc(STYLUS_LENGTH, 0.0)).collect();
    profile[0].x = 0.0;
    profile[17].x = 0.0;
    revolved(&profile, 32)
}

const PEG_POINTS: u32 = 4000;

/// Along the z axis, the middle of its end at the origin.
fn peg_mesh() -> Result<Mesh, Error> {
    let profile = [
        (0.0, 0.0),
        (0.0085, 0.0),
        (0.0095, 0.001),
        (0.0095, 0.06),
        (0.0, 0.06),
    ];
    revolved(&profile.map(|(x, y)| DVec2::new(x, y)), 96)
}

/// Height of the block's face.
const FACE: f32 = 0.04;
/// Height of the hole's floor.
const FLOOR: f32 = 0.01;

/// A round block around the z axis, its hole open towards +z.
fn block_mesh() -> Result<Mesh, Error> {
    let (face, floor) = (f64::from(FACE), f64::from(FLOOR));
    let profile = [
        (0.0, 0.0),
        (0.03, 0.0),
        (0.03, face),
        (0.01, face),
        (0.01, floor),
        (0.0, floor),
    ];
    revolved(&profile.map(|(x, y)| DVec2::new(x, y)), 96)
}

/// The solid that a closed profile of distances from the z axis and heights, counter-clockwise and
/// beginning and ending on the axis, makes around it.
fn revolved(profile: &[DVec2], segments: u32) -> Result<Mesh, Error> {
    let rings = profile.len() as u32;
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for i in 0..segments {
        let angle = std::f64::consts::TAU * f64::from(i) / f64::from(segments);
        let next = (i + 1) % segments;
        for (j, at) in (0..).zip(profile) {
            vertices.push(DVec3::new(at.x * angle.cos(), at.x * angle.sin(), at.y));
            let corner = |i: u32, j: u32| i * rings + j;
            if j > 0 && j + 1 < rings {
                triangles.push([corner(i, j - 1), corner(next, j), corner(i, j)]);
                triangles.push([corner(i, j), corner(next, j), corner(next, j + 1)]);
            }
        }
    }
    Ok(Mesh::new(&vertices, &triangles)?)
}

/// Round the bunny, whose surface is looked for along rays towards its middle.
fn around(solid: &Asset<'_>) -> Vec<Pose3> {
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
            let mut way = reach;
            while way > 0.0 && field.signed_distance(middle + outward(i) * way) > 0.0 {
                way -= 2e-4;
            }
            way
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

/// Follows values that repeat themselves by 30 ms.
fn smooth(values: &[f32]) -> Vec<f32> {
    let mut value = values[0];
    let mut follow = |target: &f32| {
        value += (target - value) * DT / 0.03;
        value
    };
    values.iter().for_each(|v| _ = follow(v));
    values.iter().map(follow).collect()
}

/// Where the end of the peg is to be, by the share of the loop.
struct Key {
    share: f32,
    /// From the axis of the hole, and height, in metres.
    aside: f32,
    height: f32,
    /// Radius of circles around that, one a second, in metres.
    circle: f32,
    /// How far it is tilted to and fro, in radians, 1.5 times a second.
    tilt: f32,
    /// How far it is turned about its axis, in radians.
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

/// On the face, into the hole, and out.
fn into_hole() -> Vec<Pose3> {
    let pose = |i: usize| {
        let (time, share) = (i as f32 * DT, i as f32 / LOOP as f32);
        let next = KEYS
            .iter()
            .position(|k| k.share > share)
            .unwrap_or(KEYS.len() - 1);
        let (from, to) = (&KEYS[next - 1], &KEYS[next]);
        let way = step(share, from.share, to.share);
        let at = |of: fn(&Key) -> f32| of(from) + (of(to) - of(from)) * way;
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

/// From 0 to 1 between two places, smoothly.
fn step(x: f32, from: f32, to: f32) -> f32 {
    let share = ((x - from) / (to - from)).clamp(0.0, 1.0);
    0.5 - 0.5 * (PI * share).cos()
}
