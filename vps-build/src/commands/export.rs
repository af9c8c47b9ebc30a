//! `vps-build export`: parts of an asset as a PLY file, for viewers.

use std::fmt::Write;
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use glamx::DVec3;
use vps_build::{Mesh, read_asset, write_atomically};
use vps_core::{PointSphereTree, Vec3, Voxelmap};

use super::Error;

#[derive(Args)]
pub(crate) struct ExportArgs {
    /// The asset
    file: PathBuf,
    /// The part of it to export
    #[arg(long)]
    what: What,
    /// Level of the tree, 1 being the top: its parent points, or its balls [default: all points,
    /// coloured by the highest level they stand for; the balls of the leaves]
    #[arg(long)]
    level: Option<u32>,
    /// The PLY file
    #[arg(short, long, value_name = "OUT.ply")]
    output: PathBuf,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum What {
    /// Points of the shell with their inward normals
    Points,
    /// Balls of a level of the tree
    Spheres,
    /// Voxels the surface passes through
    Voxels,
    /// Where the field is zero
    Surface,
}

pub(crate) fn run(args: &ExportArgs) -> Result<(), Error> {
    let asset = read_asset(&args.file)?;
    let levels = asset.tree.level_count();
    if let Some(level) = args.level {
        if !(1..=levels).contains(&level) {
            return Err(format!("the tree has levels 1 to {levels}, not {level}").into());
        }
        if !matches!(args.what, What::Points | What::Spheres) {
            return Err("--level is for points and spheres".into());
        }
    }
    let origin = DVec3::from_array(asset.origin);
    let drawing = match args.what {
        What::Points => points(&asset.tree, args.level),
        What::Spheres => spheres(&asset.tree, args.level.unwrap_or(levels))?,
        What::Voxels => voxels(&asset.voxelmap),
        What::Surface => surface(&asset.voxelmap),
    };
    Ok(write_atomically(
        &args.output,
        drawing.ply(origin).as_bytes(),
    )?)
}

/// Coloured vertices, with faces or with normals.
#[derive(Default)]
struct Drawing {
    vertices: Vec<(Vec3, [u8; 3])>,
    normals: Vec<Vec3>,
    faces: Vec<Vec<u32>>,
}

impl Drawing {
    /// An ASCII PLY file in mesh coordinates. `origin` is that of the local frame.
    fn ply(&self, origin: DVec3) -> String {
        let mut text = String::from("ply\nformat ascii 1.0\n");
        let _ = writeln!(text, "element vertex {}", self.vertices.len());
        let kind = if origin == DVec3::ZERO {
            "float"
        } else {
            "double"
        };
        for axis in ["x", "y", "z"] {
            let _ = writeln!(text, "property {kind} {axis}");
        }
        if !self.normals.is_empty() {
            text += "property float nx\nproperty float ny\nproperty float nz\n";
        }
        text += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
        let _ = writeln!(text, "element face {}", self.faces.len());
        text += "property list uchar uint vertex_indices\nend_header\n";
        for (i, (p, [r, g, b])) in self.vertices.iter().enumerate() {
            if origin == DVec3::ZERO {
                let _ = write!(text, "{} {} {} ", p.x, p.y, p.z);
            } else {
                let p = origin + p.as_dvec3();
                let _ = write!(text, "{} {} {} ", p.x, p.y, p.z);
            }
            if let Some(n) = self.normals.get(i) {
                let _ = write!(text, "{} {} {} ", n.x, n.y, n.z);
            }
            let _ = writeln!(text, "{r} {g} {b}");
        }
        for face in &self.faces {
            let _ = write!(text, "{}", face.len());
            for v in face {
                let _ = write!(text, " {v}");
            }
            text.push('\n');
        }
        text
    }
}

/// Colours that differ most for consecutive numbers.
fn color(n: u32) -> [u8; 3] {
    let hue = (f64::from(n) * 0.618_034).fract() * 6.0;
    let channel = |shift: f64| {
        let distance = ((hue + shift) % 6.0 - 3.0).abs() - 1.0;
        (60.0 + 180.0 * distance.clamp(0.0, 1.0)) as u8
    };
    [channel(0.0), channel(4.0), channel(2.0)]
}

fn points(tree: &PointSphereTree<'_>, level: Option<u32>) -> Drawing {
    // The highest level at which a point is a parent point; below the leaves if none.
    let mut highest = vec![tree.level_count() + 1; tree.point_count()];
    for l in (1..=tree.level_count()).rev() {
        for cluster in tree.level(l) {
            highest[cluster.parent_point() as usize] = l;
        }
    }
    let chosen: Vec<usize> = match level {
        Some(level) => {
            let parents = tree.level(level).iter().map(|c| c.parent_point() as usize);
            parents.collect()
        }
        None => (0..tree.point_count()).collect(),
    };
    Drawing {
        vertices: chosen
            .iter()
            .map(|&i| (tree.point(i), color(highest[i])))
            .collect(),
        normals: chosen.iter().map(|&i| tree.normal(i)).collect(),
        faces: Vec::new(),
    }
}

fn spheres(tree: &PointSphereTree<'_>, level: u32) -> Result<Drawing, Error> {
    let ball = Mesh::icosphere(1.0, 2)?;
    let mut drawing = Drawing::default();
    for (n, cluster) in tree.level(level).iter().enumerate() {
        let first = drawing.vertices.len() as u32;
        let center = cluster.center();
        let on_ball = |v: &DVec3| (center + v.as_vec3() * cluster.radius(), color(n as u32));
        drawing.vertices.extend(ball.vertices().iter().map(on_ball));
        let faces = ball
            .triangles()
            .iter()
            .map(|t| t.map(|v| v + first).to_vec());
        drawing.faces.extend(faces);
    }
    Ok(drawing)
}

/// The visible faces of the voxels nearest to the surface.
fn voxels(map: &Voxelmap<'_>) -> Drawing {
    let grid = map.grid();
    let half = 0.5 * grid.voxel_size();
    let dims = grid.dims();
    let is_near = |voxel: [i64; 3]| {
        let in_grid = (0..3).all(|a| (0..i64::from(dims[a])).contains(&voxel[a]));
        in_grid && map.center_penetration(voxel.map(|c| c as u32)).abs() <= half
    };
    let mut drawing = Drawing::default();
    for z in 0..dims[2] {
        for y in 0..dims[1] {
            for x in 0..dims[0] {
                let voxel = [x, y, z];
                let signed = voxel.map(i64::from);
                if !is_near(signed) {
                    continue;
                }
                for axis in 0..3 {
                    for side in [-1, 1] {
                        let mut next = signed;
                        next[axis] += side;
                        if !is_near(next) {
                            face_of_voxel(
                                &mut drawing,
                                grid.center(voxel),
                                axis,
                                side as f32 * half,
                            );
                        }
                    }
                }
            }
        }
    }
    drawing
}

/// The square `offset` metres from a voxel's centre along an axis, facing away from it.
fn face_of_voxel(drawing: &mut Drawing, center: Vec3, axis: usize, offset: f32) {
    let mut out = Vec3::ZERO;
    out[axis] = offset;
    let (mut a, mut b) = (Vec3::ZERO, Vec3::ZERO);
    a[(axis + 1) % 3] = offset.abs();
    b[(axis + 2) % 3] = offset;
    let first = drawing.vertices.len() as u32;
    let red = [200, 60, 50];
    let corners = [a + b, b - a, -a - b, a - b].map(|c| (center + out + c, red));
    drawing.vertices.extend(corners);
    drawing.faces.push((first..first + 4).collect());
}

fn surface(map: &Voxelmap<'_>) -> Drawing {
    let mesh = map.surface_mesh();
    let grey = [180, 180, 190];
    Drawing {
        vertices: mesh.vertices.iter().map(|&v| (v, grey)).collect(),
        faces: mesh.squares.iter().map(|s| s.to_vec()).collect(),
        ..Drawing::default()
    }
}
