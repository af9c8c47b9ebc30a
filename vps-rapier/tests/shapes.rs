//! How shapes are built, loaded, scaled and measured.

// Numbers of rapier are 32-bit or 64-bit.
#![allow(clippy::unnecessary_cast, clippy::useless_conversion)]

use std::path::PathBuf;

use vps_build::{BuildOptions, Mesh, PointCount, Resolution, models};
use vps_rapier::rapier3d::parry::query::QueryDispatcher;
use vps_rapier::rapier3d::parry::shape::Cuboid;
use vps_rapier::rapier3d::prelude::*;
use vps_rapier::{Role, ShapeError, VpsShape, VpsShapeBuilder};

fn options() -> BuildOptions {
    BuildOptions {
        resolution: Resolution::VoxelsAlongLongest(20),
        points: PointCount::About(300),
        ..BuildOptions::default()
    }
}

/// A folder of a test, removed on drop.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        Self(std::env::temp_dir().join(format!("vps-{name}-{}", std::process::id())))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

#[test]
fn a_shape_is_built_from_triangles_in_the_background_and_kept() {
    let folder = Folder::new("kept");
    let (vertices, triangles) = Cuboid::new(Vector::new(0.3, 0.2, 0.1)).to_trimesh();
    let make = || {
        VpsShapeBuilder::from_triangles(&vertices, &triangles)
            .unwrap()
            .options(options())
            .role(Role::Voxelmap)
            .cached_in(&folder.0)
    };
    let first = make().build_in_background().wait().unwrap();
    assert_eq!(first.role(), Role::Voxelmap);
    let half = first.compute_local_aabb().half_extents();
    assert!((half - Vector::new(0.3, 0.2, 0.1)).length() < 1e-5);
    let file = first.file().unwrap().to_path_buf();
    let read = VpsShape::from_file(&file).unwrap();
    assert_eq!(read.asset().tree.points(), first.asset().tree.points());
    // The asset in the file is used, not built again.
    let sphere = VpsShapeBuilder::new(models::torus(16))
        .options(options())
        .build()
        .unwrap();
    vps_build::write_asset(&file, sphere.asset()).unwrap();
    let again = make().build().unwrap();
    assert_eq!(again.asset().tree.points(), sphere.asset().tree.points());
}

#[test]
fn invalid_meshes_are_errors() {
    let corner = Vector::ZERO;
    let error = VpsShapeBuilder::from_triangles(&[corner; 3], &[[0, 1, 3]]).unwrap_err();
    assert!(matches!(error, ShapeError::Mesh(_)), "{error}");
    let missing = Folder::new("missing");
    let missing = &missing.0;
    let error = VpsShape::from_file(missing).err().unwrap();
    assert!(
        error.to_string().contains(&*missing.to_string_lossy()),
        "{error}"
    );
    let error = VpsShapeBuilder::from_mesh_file(missing, None).unwrap_err();
    assert!(
        error.to_string().contains(&*missing.to_string_lossy()),
        "{error}"
    );
}

#[test]
fn a_mesh_far_from_its_origin_is_refused() {
    let (vertices, triangles) = Cuboid::new(Vector::new(0.3, 0.2, 0.1)).to_trimesh();
    let built = |at: Real| {
        let moved: Vec<_> = vertices.iter().map(|v| *v + Vector::X * at).collect();
        let builder = VpsShapeBuilder::from_triangles(&moved, &triangles).unwrap();
        builder.options(options()).build()
    };
    assert!(built(10.0).is_ok());
    let error = built(1e5).err().unwrap();
    assert!(matches!(error, ShapeError::Far(..)), "{error}");
}

#[test]
fn a_scaled_shape_is_larger_all_over() {
    let mesh = Mesh::cuboid([0.6, 0.4, 0.5]).unwrap();
    let shape = VpsShapeBuilder::new(mesh)
        .options(options())
        .build()
        .unwrap();
    for factor in [0.001, 0.37, 40.0] {
        let scaled = shape.scale_dyn(Vector::splat(factor), 0).unwrap();
        let half = scaled.compute_local_aabb().half_extents() / factor;
        assert!(
            (half - Vector::new(0.3, 0.2, 0.25)).length() < 1e-5,
            "{half}"
        );
        let mass = scaled.mass_properties(1.0).mass() / factor.powi(3);
        assert!((mass - 0.12).abs() < 1e-4, "{mass}");
        let ray = Ray::new(Vector::new(0.05, 2.0, 0.02) * factor, -Vector::Y);
        let hit = scaled.cast_local_ray(&ray, Real::MAX, true).unwrap() / factor;
        assert!((hit - 1.8).abs() < 0.005, "{hit}");
    }
    assert!(shape.scale_dyn(Vector::new(1.0, 2.0, 1.0), 0).is_none());
    assert!(shape.scale_dyn(Vector::splat(-1.0), 0).is_none());
}

#[test]
fn a_shape_is_as_thick_as_where_it_is_thin() {
    let thickness = |mesh: &Mesh| {
        let shape = VpsShapeBuilder::new(mesh.clone()).options(options());
        shape.build().unwrap().thickness()
    };
    let cube = Mesh::cuboid([1.0; 3]).unwrap();
    assert!((thickness(&cube) - 1.0).abs() < 0.05);
    let plate = Mesh::cuboid([1.0, 0.1, 1.0]).unwrap();
    assert!((thickness(&plate) - 0.1).abs() < 0.03);
    let rod = Mesh::cuboid([0.1, 3.0, 0.1]).unwrap();
    assert!((thickness(&rod) - 0.1).abs() < 0.05);
    // The teeth of a gear are thinner than its wheel.
    let gear = thickness(&models::gear(12));
    assert!(gear > 0.05 && gear < 0.5, "{gear}");
}

#[test]
fn the_wall_of_a_cup_is_found_between_the_points_of_a_coarse_shell() {
    let shape = |mesh: Mesh, points| {
        let points = PointCount::About(points);
        let options = BuildOptions {
            points,
            ..options()
        };
        VpsShapeBuilder::new(mesh).options(options).build().unwrap()
    };
    let block = shape(Mesh::cuboid([3.0; 3]).unwrap(), 400);
    let cup = shape(models::cup(48), 3000);
    let extents = cup.compute_local_aabb().half_extents() * 2.0;
    // The cup is large, its wall is thin.
    assert!(extents.min_element() as f32 > 2.0 * block.spacing());
    assert!(cup.thickness() < block.spacing());
    let dispatcher = vps_rapier::VpsDispatcher::default();
    for turned in [0.0, 0.7, 1.9, 3.0] {
        // Its side reaches 0.02 m into the upper face.
        let rotation = Rotation::from_rotation_y(turned as Real);
        let low = cup.compute_aabb(&rotation.into()).mins.y;
        let above = Pose::from_parts(Vector::Y * (1.5 - low - 0.02), rotation);
        let found = dispatcher.contact(&above, &block, &cup, 0.0).unwrap();
        let depth = -found.expect("a contact").dist;
        assert!((depth - 0.02).abs() < 0.015, "{depth} at {turned}");
    }
}
