//! Files: a written asset is read back unchanged, and damage is noticed.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crate::support::asset;
use glamx::DVec3;
use proptest::prelude::*;
use vps_build::{Encoding, Mesh, mass_properties, read_asset, read_mesh, write_asset};
use vps_core::{Asset, DistanceField, FormatError};

/// Bytes at an address that is a multiple of 8.
fn aligned(bytes: &[u8]) -> Vec<u64> {
    let mut words = vec![0_u64; bytes.len().div_ceil(8)];
    bytemuck::cast_slice_mut::<u64, u8>(&mut words)[..bytes.len()].copy_from_slice(bytes);
    words
}

fn parse(bytes: &[u8]) -> Result<(), FormatError> {
    let words = aligned(bytes);
    Asset::from_bytes(&bytemuck::cast_slice(&words)[..bytes.len()]).map(|_| ())
}

fn small() -> Asset<'static> {
    asset(
        &Mesh::cuboid([0.3, 0.2, 0.1]).unwrap(),
        60,
        Encoding::Distances(None),
    )
}

struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("vps-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

#[test]
fn an_asset_comes_back_as_it_was() {
    let folder = Folder::new("round-trip");
    let path = folder.0.join("deep").join("asset.vps");
    let asset = small();
    write_asset(&path, &asset).unwrap();
    let back = read_asset(&path).unwrap();
    assert!(back.to_bytes() == asset.to_bytes());
    assert_eq!(back.mass, asset.mass);
    assert_eq!(
        std::fs::read_dir(path.parent().unwrap()).unwrap().count(),
        1
    );
}

/// Misaligned bytes are refused, whatever their content. One step of 8 further they are read.
#[test]
fn bytes_must_lie_at_a_multiple_of_8() {
    let bytes = small().to_bytes();
    let mut words = vec![0_u64; bytes.len() / 8 + 3];
    let buffer: &mut [u8] = bytemuck::cast_slice_mut(&mut words);
    for offset in 0..=8 {
        let place = &mut buffer[offset..offset + bytes.len()];
        place.copy_from_slice(&bytes);
        let read = Asset::from_bytes(place).map(|_| ());
        let expected = if offset % 8 == 0 {
            Ok(())
        } else {
            Err(FormatError::Alignment)
        };
        assert_eq!(read, expected, "{offset}");
    }
}

#[test]
fn other_files_are_refused() {
    let good = small().to_bytes();
    assert_eq!(parse(&good), Ok(()));
    assert_eq!(parse(b""), Err(FormatError::Foreign));
    assert_eq!(parse(&[b'x'; 500]), Err(FormatError::Foreign));
    let mut newer = good.clone();
    newer[8] = 9;
    assert_eq!(parse(&newer), Err(FormatError::Version(9)));
    let mut long = good.clone();
    long.push(0);
    assert!(matches!(parse(&long), Err(FormatError::Length { .. })));
    // A header with a count beyond all limits.
    let mut huge = good;
    huge[24..32].fill(0xff);
    assert!(matches!(parse(&huge), Err(FormatError::Length { .. })));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]
    #[test]
    fn damage_is_noticed(
        at in any::<prop::sample::Index>(), bit in 0..8_u32, cut in any::<prop::sample::Index>(),
    ) {
        let good = small().to_bytes();
        let mut flipped = good.clone();
        let at = at.index(good.len());
        flipped[at] ^= 1 << bit;
        prop_assert!(parse(&flipped).is_err());
        prop_assert!(parse(&good[..cut.index(good.len())]).is_err());
    }
}

fn output(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_vps-build"));
    command.args(arguments).output().unwrap()
}

/// Exit status and standard error.
fn vps_build(arguments: &[&str]) -> (Option<i32>, String) {
    let output = output(arguments);
    (
        output.status.code(),
        String::from_utf8(output.stderr).unwrap(),
    )
}

#[test]
fn options_that_messages_recommend_exist() {
    let help = ["build", "inspect", "export", "sample"].map(|command| {
        let output = output(&[command, "--help"]);
        String::from_utf8(output.stdout).unwrap()
    });
    let sources = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut found = 0;
    let mut folders = vec![sources];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let text = std::fs::read_to_string(&path).unwrap_or_default();
            let code = text.lines().filter(|l| !l.trim_start().starts_with("//"));
            let words = code.flat_map(|l| l.split(|c: char| !c.is_ascii_lowercase() && c != '-'));
            let words = words.filter(|w| !w.starts_with("---"));
            for option in words.filter(|w| w.len() > 2 && w.starts_with("--")) {
                let is_known = help.iter().any(|help| help.contains(option));
                assert!(is_known, "{}: {option}", path.display());
                found += 1;
            }
        }
    }
    assert!(found > 2, "only {found}");
}

#[test]
fn the_command_builds_and_complains_in_one_line() {
    let folder = Folder::new("command");
    let path = |name: &str| folder.0.join(name).to_str().unwrap().to_owned();
    let tetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    std::fs::write(path("good.obj"), tetrahedron).unwrap();
    std::fs::write(path("nan.obj"), tetrahedron.replace("v 0 1 0", "v 0 nan 0")).unwrap();
    std::fs::write(path("range.obj"), tetrahedron.replace("f 1 3 2", "f 1 3 8")).unwrap();
    std::fs::write(path("open.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    std::fs::write(path("empty.obj"), "").unwrap();
    let out = path("out.vps");
    let fails = |mesh: &str, options: &[&str], expected: &str| {
        let mesh = path(mesh);
        let (code, message) = vps_build(&[&["build", &mesh, "-o", &out], options].concat());
        assert_eq!(code, Some(2), "{message}");
        assert_eq!(message.lines().count(), 1, "{message}");
        assert!(
            message.contains(&mesh) && message.contains(expected),
            "{message}"
        );
    };
    fails("missing.obj", &[], "No such file");
    fails(
        "nan.obj",
        &[],
        "nan.obj:3: vertex 3 at (0.0, NaN, 0.0) is not finite",
    );
    fails("range.obj", &[], "range.obj:5: ");
    fails("empty.obj", &[], "no triangles");
    fails("open.obj", &[], "sheet");
    fails("good.obj", &["--voxel-size", "1e-5"], "MiB");
    fails("good.obj", &["--voxel-size", "0"], "voxel size");
    fails("good.obj", &["--scale", "0"], "scale");
    fails("good.obj", &["--precision", "9"], "do not fit 16 bits");
    fails("good.obj", &["-k", "1"], "branching");
    fails("good.obj", &["--spacing=-1"], "spacing");
    fails("good.obj", &["--spacing", "1e-9"], "points");
    assert!(!folder.0.join("out.vps").exists());
    let (code, message) = vps_build(&["build", &path("good.obj"), "-o", &out, "--voxels", "20"]);
    assert_eq!((code, message.as_str()), (Some(0), ""));
    assert!(
        read_asset(&folder.0.join("out.vps"))
            .unwrap()
            .tree
            .point_count()
            > 100
    );
    // Five meshes and one asset. No incomplete file is left.
    assert_eq!(std::fs::read_dir(&folder.0).unwrap().count(), 6);
}

#[test]
fn inspect_reports_on_meshes_and_assets() {
    let folder = Folder::new("inspect");
    let path = |name: &str| folder.0.join(name).to_str().unwrap().to_owned();
    // A closed box, and one with a hole, a duplicate triangle and a reversed one.
    let box_mesh = Mesh::cuboid([0.3, 0.2, 0.1]).unwrap();
    let mut good = String::from("OFF\n8 12 0\n");
    for v in box_mesh.vertices() {
        good += &format!("{} {} {}\n", v.x, v.y, v.z);
    }
    let face = |[a, b, c]: [u32; 3]| format!("3 {a} {b} {c}\n");
    let faces: Vec<_> = box_mesh.triangles().iter().map(|&t| face(t)).collect();
    let [a, b, c] = box_mesh.triangles()[4];
    let mut bad_faces = faces.clone();
    bad_faces.remove(11);
    bad_faces[4] = face([a, c, b]);
    bad_faces.push(faces[0].clone());
    std::fs::write(path("good.off"), good.clone() + &faces.concat()).unwrap();
    std::fs::write(path("bad.off"), good + &bad_faces.concat()).unwrap();
    let json = |name: &str| {
        let output = output(&["inspect", &path(name), "--json"]);
        assert_eq!(output.status.code(), Some(0));
        serde_json::from_slice::<serde_json::Value>(&output.stdout).unwrap()
    };
    let good = json("good.off");
    assert_eq!(good["watertight"], true);
    assert!((good["volume_m3"].as_f64().unwrap() - 0.006).abs() < 1e-6);
    let bad = json("bad.off");
    assert_eq!(bad["watertight"], false);
    assert_eq!(
        (&bad["boundary_loops"], &bad["duplicate_faces"]),
        (&1.into(), &1.into())
    );
    assert!(bad["inconsistent_edges"].as_u64().unwrap() > 0);
    let text = output(&["inspect", &path("bad.off")]).stdout;
    assert!(String::from_utf8(text).unwrap().contains("holes"));

    let asset = small();
    write_asset(&folder.0.join("small.vps"), &asset).unwrap();
    let inspected = json("small.vps");
    assert_eq!(inspected["points"], asset.tree.point_count());
    assert_eq!(inspected["voxels"][0], asset.voxelmap.grid().dims()[0]);
    let (code, message) = vps_build(&["inspect", &path("none.vps")]);
    assert_eq!(code, Some(2));
    assert!(
        message.contains("none.vps") && message.lines().count() == 1,
        "{message}"
    );
}

#[test]
fn samples_are_within_their_stated_error() {
    let folder = Folder::new("sample");
    let path = |name: &str| folder.0.join(name).to_str().unwrap().to_owned();
    write_asset(&folder.0.join("small.vps"), &small()).unwrap();
    // In, on and around the box, and far outside of the grid.
    let mut points = String::from("x,y,z\n");
    for i in 0..60 {
        let at = 0.01 * f64::from(i) - 0.25;
        points += &format!("{at},{},{}\n", 0.6 * at, 0.3 * at + 0.02);
        points += &format!("{},{},{at}\n", 9.0 * at, -20.0 * at);
    }
    std::fs::write(path("in.csv"), points).unwrap();
    let sample = |points: &str| {
        vps_build(&[
            "sample",
            &path("small.vps"),
            "--points",
            &path(points),
            "-o",
            &path("out.csv"),
        ])
    };
    assert_eq!(sample("in.csv"), (Some(0), String::new()));
    let exact = vps_core::Cuboid::new(vps_core::Vec3::new(0.15, 0.1, 0.05));
    let text = std::fs::read_to_string(path("out.csv")).unwrap();
    let mut lines = text.lines();
    let header =
        "x,y,z,penetration_m,gradient_x,gradient_y,gradient_z,error_bound_m,overestimate_bound_m";
    assert_eq!(lines.next(), Some(header));
    let mut inside = 0;
    for line in lines {
        let v: Vec<f32> = line.split(',').map(|c| c.parse().unwrap()).collect();
        let expected = -exact.signed_distance(vps_core::Vec3::new(v[0], v[1], v[2]));
        assert!((v[3] - expected).abs() <= v[7], "{line}: exact {expected}");
        // The solid never seems further away than it is.
        assert!(v[3] >= expected - v[8], "{line}: exact {expected}");
        inside += i32::from(v[3] > 0.0);
    }
    assert!(inside > 5 && text.lines().count() == 121);
    std::fs::write(path("bad.csv"), "x,y,z\n0,0,0\n1,nan,0\n").unwrap();
    std::fs::write(path("short.csv"), "x,y\n0,0\n").unwrap();
    for (name, expected) in [
        ("bad.csv", "row 2"),
        ("short.csv", "missing field `z`"),
        ("no.csv", "os error 2"),
    ] {
        let (code, message) = sample(name);
        assert_eq!(code, Some(2));
        assert!(
            message.contains(name) && message.contains(expected),
            "{message}"
        );
        assert_eq!(message.lines().count(), 1, "{message}");
    }
}

#[test]
fn exports_are_meshes_again() {
    let folder = Folder::new("export");
    let path = |name: &str| folder.0.join(name).to_str().unwrap().to_owned();
    let asset = small();
    write_asset(&folder.0.join("small.vps"), &asset).unwrap();
    let export = |options: &[&str]| {
        vps_build(
            &[
                &["export", &path("small.vps"), "-o", &path("out.ply")],
                options,
            ]
            .concat(),
        )
    };
    let vertices = || {
        let text = std::fs::read_to_string(path("out.ply")).unwrap();
        let line = text
            .lines()
            .find(|l| l.starts_with("element vertex"))
            .unwrap();
        line.rsplit(' ').next().unwrap().parse::<usize>().unwrap()
    };
    assert_eq!(export(&["--what", "surface"]).0, Some(0));
    let surface = read_mesh(&folder.0.join("out.ply"), None).unwrap();
    assert_eq!(surface.open_edges(), 0);
    let volume = mass_properties(&surface).unwrap().volume;
    // Corners and edges of the box are cut by up to a voxel.
    assert!((volume / 0.006 - 1.0).abs() < 0.1, "{volume}");
    assert_eq!(export(&["--what", "voxels"]).0, Some(0));
    let voxels = read_mesh(&folder.0.join("out.ply"), None).unwrap();
    assert!(voxels.triangles().len() > 1000);
    assert_eq!(export(&["--what", "points"]).0, Some(0));
    assert_eq!(vertices(), asset.tree.point_count());
    for level in 1..=asset.tree.level_count() {
        let level_text = level.to_string();
        assert_eq!(
            export(&["--what", "points", "--level", &level_text]).0,
            Some(0)
        );
        assert_eq!(vertices(), asset.tree.level(level).len());
        assert_eq!(
            export(&["--what", "spheres", "--level", &level_text]).0,
            Some(0)
        );
        let balls = read_mesh(&folder.0.join("out.ply"), None).unwrap();
        assert_eq!(balls.triangles().len(), 320 * asset.tree.level(level).len());
    }
    let (code, message) = export(&["--what", "points", "--level", "99"]);
    assert_eq!(code, Some(2));
    assert!(message.contains("levels 1 to"), "{message}");
}

/// Six quads of a box.
fn obj_box(low: DVec3, high: DVec3) -> String {
    let mut text = String::new();
    for i in 0..8 {
        let pick = |axis: usize| {
            if i >> axis & 1 == 1 {
                high[axis]
            } else {
                low[axis]
            }
        };
        text += &format!("v {} {} {}\n", pick(0), pick(1), pick(2));
    }
    text + "f 1 5 7 3\nf 2 4 8 6\nf 1 2 6 5\nf 3 7 8 4\nf 1 3 4 2\nf 5 6 8 7\n"
}

/// A wall of 20 cm on maps in metres. Nothing is lost to 32-bit coordinates, and input and output
/// are in the coordinates of the map.
#[test]
fn far_from_its_origin_a_mesh_is_built_as_well() {
    let folder = Folder::new("far");
    let path = |name: &str| folder.0.join(name).to_str().unwrap().to_owned();
    let extents = DVec3::new(3.0, 0.2, 2.0);
    for at in [
        DVec3::ZERO,
        DVec3::new(5e5, 4e5, 100.0),
        DVec3::new(-5e6, 5e6, 5e6),
    ] {
        std::fs::write(path("wall.obj"), obj_box(at, at + extents)).unwrap();
        let options = ["--voxel-size", "0.05", "--points", "500", "--json"];
        let mesh = path("wall.obj");
        let built = output(&[&["build", &mesh, "-o", &path("wall.vps")], &options[..]].concat());
        let built: serde_json::Value = serde_json::from_slice(&built.stdout).unwrap();
        let three = |value: &serde_json::Value| {
            DVec3::from_array([0, 1, 2].map(|i| value[i].as_f64().unwrap()))
        };
        let origin = three(&built["origin_m"]);
        assert_eq!(origin == DVec3::ZERO, at == DVec3::ZERO);
        let inspected = output(&["inspect", &path("wall.vps"), "--json"]).stdout;
        let inspected: serde_json::Value = serde_json::from_slice(&inspected).unwrap();
        assert_eq!(three(&inspected["origin_m"]), origin);
        assert!((inspected["volume_m3"].as_f64().unwrap() - 1.2).abs() < 1e-4);
        for (key, place) in [
            ("center_of_mass_m", at + extents * 0.5),
            ("low_m", at),
            ("high_m", at + extents),
        ] {
            let found = three(&inspected[key]);
            assert!(found.distance(place) < 1e-5, "{key}: {found}, not {place}");
        }
        // In the middle, beside it, and at a corner.
        let points = [
            extents * 0.5,
            DVec3::new(1.5, -0.1, 1.0),
            DVec3::new(0.0, 0.0, 0.0),
        ];
        let mut text = String::from("x,y,z\n");
        for p in points {
            let p = at + p;
            text += &format!("{},{},{}\n", p.x, p.y, p.z);
        }
        std::fs::write(path("in.csv"), text).unwrap();
        let (code, message) = vps_build(&[
            "sample",
            &path("wall.vps"),
            "--points",
            &path("in.csv"),
            "-o",
            &path("out.csv"),
        ]);
        assert_eq!((code, message.as_str()), (Some(0), ""));
        let text = std::fs::read_to_string(path("out.csv")).unwrap();
        for (line, expected) in text.lines().skip(1).zip([0.1, -0.1, 0.0]) {
            let v: Vec<f64> = line.split(',').map(|c| c.parse().unwrap()).collect();
            assert!((v[3] - expected).abs() <= v[7], "{line}: {expected}");
        }
        for what in ["surface", "voxels", "points", "spheres"] {
            let ply = path("out.ply");
            let export = vps_build(&["export", &path("wall.vps"), "--what", what, "-o", &ply]);
            assert_eq!(export.0, Some(0));
            if what != "points" {
                let (low, high) = read_mesh(folder.0.join("out.ply").as_path(), None)
                    .unwrap()
                    .bounds();
                let off = (low - at)
                    .abs()
                    .max((high - at - extents).abs())
                    .max_element();
                assert!(off < 1.0, "{what}: {low} {high}");
            }
        }
    }
}

/// Small files with large counts cost little memory, and each fault is one line.
#[test]
fn damaged_files_are_told_in_one_line_or_built() {
    let folder = Folder::new("damaged");
    let path = |name: &str| folder.0.join(name).to_str().unwrap().to_owned();
    let good = obj_box(DVec3::ZERO, DVec3::ONE);
    let far = |vertex: &str| good.replacen("v 1 1 1\n", vertex, 1);
    let ply = "ply\nformat binary_little_endian 1.0\nelement vertex 999999999\nproperty float x\n\
               property float y\nproperty float z\nelement face 999999999\n\
               property list uchar int vertex_indices\nend_header\n0123456789abcdef";
    for (name, text, expected) in [
        // Needles, and faces much smaller than the bounding box.
        ("needles.obj", far("v 1 1 1e10\n"), None),
        ("far.obj", far("v 1 1 999999999999\n"), Some("")),
        ("further.obj", far("v 1 1 1e31\n"), Some("further.obj:8: ")),
        ("tiny.obj", far("v 1 1 1e-320\n"), None),
        ("count.ply", ply.into(), Some("999999999")),
        (
            "sheet.obj",
            "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nf 1 2 3 4\nf 4 3 2 1\n".into(),
            Some("sheet"),
        ),
        ("empty.stl", String::new(), Some("empty")),
    ] {
        std::fs::write(path(name), text).unwrap();
        let out = path("out.vps");
        let options = ["-o", &out, "-q", "--voxels", "20", "--points", "200"];
        let mesh = path(name);
        let (code, message) = vps_build(&[&["build", &mesh], &options[..]].concat());
        match (code, expected) {
            (Some(0), None) => assert_eq!(message, ""),
            (Some(2), _) => {
                assert_eq!(message.lines().count(), 1, "{name}: {message}");
                let expected = expected.unwrap_or_default();
                assert!(
                    message.contains(name) && message.contains(expected),
                    "{name}: {message}"
                );
            }
            _ => panic!("{name}: {code:?} {message}"),
        }
    }
}
