//! `vps-build inspect`: properties of a mesh or an asset.

use std::path::PathBuf;

use clap::Args;
use glamx::DVec3;
use serde_json::json;
use vps_build::{Health, read_asset, read_mesh};
use vps_core::{Asset, Vec3};

use super::Error;

#[derive(Args)]
pub(crate) struct InspectArgs {
    /// A mesh (.obj, .ply, .stl, .off) or an asset (.vps)
    file: PathBuf,
    /// The object of an OBJ file, in place of all
    #[arg(long)]
    object: Option<String>,
    /// Length of a unit of a mesh, in metres
    #[arg(long, default_value_t = 1.0)]
    scale: f64,
    /// Walls thinner than this are counted, in metres [default: a hundredth of the longest side]
    #[arg(long)]
    voxel_size: Option<f64>,
    /// Print the properties as JSON
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &InspectArgs) -> Result<(), Error> {
    let is_asset = args.file.extension().is_some_and(|e| e == "vps");
    let rows = if is_asset {
        asset_rows(&read_asset(&args.file)?)
    } else {
        mesh_rows(args)?
    };
    if args.json {
        let object: serde_json::Map<_, _> = rows
            .into_iter()
            .map(|(name, value, _)| (name.to_owned(), value))
            .collect();
        println!("{}", serde_json::Value::from(object));
        return Ok(());
    }
    for (name, value, remark) in rows {
        let value = value.to_string().replace('"', "");
        println!("{name:<20} {value:<28} {remark}");
    }
    Ok(())
}

type Row = (&'static str, serde_json::Value, &'static str);

fn mesh_rows(args: &InspectArgs) -> Result<Vec<Row>, Error> {
    let mesh = read_mesh(&args.file, args.object.as_deref())?;
    let mesh = mesh
        .scaled(args.scale)
        .map_err(|e| format!("{}: {e}", args.file.display()))?;
    let (low, high) = mesh.bounds();
    let voxel_size = args
        .voxel_size
        .unwrap_or((high - low).max_element() / 100.0);
    if !(voxel_size > 0.0 && voxel_size.is_finite()) {
        return Err(format!("the voxel size must be positive, not {voxel_size}").into());
    }
    let health = Health::of(&mesh, voxel_size);
    let unless = |count: usize, remark: &'static str| if count == 0 { "" } else { remark };
    let volume_remark = if health.volume_m3 < 0.0 {
        "the triangles face inwards"
    } else {
        ""
    };
    let thin_remark = if health.thin_fraction > 0.0 {
        "choose smaller voxels, or expect walls to be filled"
    } else {
        ""
    };
    Ok(vec![
        ("watertight", json!(health.is_watertight()), ""),
        ("vertices", json!(health.vertices), ""),
        ("triangles", json!(health.triangles), ""),
        ("components", json!(health.components), ""),
        ("boundary_edges", json!(health.boundary_edges), ""),
        (
            "boundary_loops",
            json!(health.boundary_loops),
            unless(health.boundary_loops, "holes"),
        ),
        (
            "non_manifold_edges",
            json!(health.non_manifold_edges),
            unless(
                health.non_manifold_edges,
                "three triangles or more at an edge",
            ),
        ),
        (
            "inconsistent_edges",
            json!(health.inconsistent_edges),
            unless(
                health.inconsistent_edges,
                "neighbours that face different ways",
            ),
        ),
        (
            "duplicate_faces",
            json!(health.duplicate_faces),
            unless(health.duplicate_faces, "the same triangle again"),
        ),
        (
            "degenerate_faces",
            json!(health.degenerate_faces),
            unless(health.degenerate_faces, "triangles without an area"),
        ),
        ("low_m", json!(low.to_array()), "lowest corner of the box"),
        ("high_m", json!(high.to_array()), "and highest"),
        ("extents_m", json!(health.extents_m), ""),
        ("area_m2", json!(health.area_m2), ""),
        ("volume_m3", json!(health.volume_m3), volume_remark),
        ("voxel_size_m", json!(voxel_size), ""),
        ("thin_fraction", json!(health.thin_fraction), thin_remark),
    ])
}

fn asset_rows(asset: &Asset<'_>) -> Vec<Row> {
    let (map, tree, mass) = (&asset.voxelmap, &asset.tree, asset.mass);
    let origin = DVec3::from_array(asset.origin);
    // In mesh coordinates.
    let place = |local: Vec3| json!((origin + local.as_dvec3()).to_array());
    let error_bounds = map.error_bounds();
    let clusters: Vec<_> = (1..=tree.level_count())
        .map(|l| tree.level(l).len())
        .collect();
    vec![
        (
            "origin_m",
            json!(asset.origin),
            "of the asset's frame, in the coordinates of the mesh",
        ),
        ("low_m", place(map.solid().min), "lowest corner of the box"),
        ("high_m", place(map.solid().max), "and highest"),
        ("voxels", json!(map.grid().dims()), ""),
        ("voxel_size_m", json!(map.grid().voxel_size()), ""),
        ("sigma_m", json!(map.sigma()), "metres per step of a value"),
        (
            "near_error_m",
            json!(error_bounds.in_band),
            "largest error of a value in the narrow band",
        ),
        ("far_error_m", json!(error_bounds.beyond), "and beyond it"),
        (
            "band_m",
            json!(error_bounds.narrow_band),
            "half width of the narrow band",
        ),
        (
            "dense",
            json!(map.store().is_dense()),
            "whether every voxel is stored",
        ),
        ("map_bytes", json!(map.store().byte_len()), ""),
        ("points", json!(tree.point_count()), ""),
        ("levels", json!(tree.level_count()), ""),
        ("clusters", json!(clusters), "of each level"),
        (
            "tree_bytes",
            json!(tree.byte_len()),
            "points, normals and clusters",
        ),
        (
            "volume_m3",
            json!(mass.volume),
            "of the solid: its mass at density one",
        ),
        ("center_of_mass_m", place(mass.center()), ""),
        (
            "inertia_kg_m2",
            json!(mass.inertia),
            "xx, yy, zz, xy, xz, yz at density one",
        ),
    ]
}
