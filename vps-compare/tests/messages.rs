//! What the command prints, kept in `snapshots`. After a change look at the difference, and accept it
//! with `INSTA_UPDATE=always cargo test -p vps-compare --test messages`.

use std::path::Path;
use std::process::Command;

use insta::assert_snapshot;

/// A command line in a folder and its output.
fn session(folder: &Path, arguments: &str) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_vps-compare"))
        .args(arguments.split_whitespace())
        .current_dir(folder)
        .output()
        .unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    let (out, errors) = (text(output.stdout), text(output.stderr));
    // A slow machine gets lines of a log.
    let errors = errors.split_inclusive('\n');
    let errors: String = errors.filter(|line| !line.contains(" (after ")).collect();
    let code = output.status.code().unwrap();
    format!("$ vps-compare {arguments}\n{out}{errors}[{code}]\n")
}

/// A box with a corner at the origin and another one at (x, y, z).
fn obj_box(x: f64, y: f64, z: f64) -> String {
    let corner = |i: u32| {
        let [x, y, z] = [(x, 1), (y, 2), (z, 4)].map(|(edge, bit)| match i & bit {
            0 => 0.0,
            _ => edge,
        });
        format!("v {x} {y} {z}\n")
    };
    let faces = "f 1 5 7 3\nf 2 4 8 6\nf 1 2 6 5\nf 3 7 8 4\nf 1 3 4 2\nf 5 6 8 7\n";
    (0..8).map(corner).collect::<String>() + faces
}

/// The text with the cells of the table between bars, and times and sizes in it left out.
fn without_measurements(text: &str) -> String {
    let mut is_table = false;
    let lines = text.lines().map(|line| {
        let is_header = line.starts_with("algorithm ");
        is_table = (is_table || is_header) && !line.is_empty();
        if !is_table {
            return format!("{line}\n");
        }
        let cells = line.split("  ").map(str::trim);
        let mut cells: Vec<_> = cells.filter(|cell| !cell.is_empty()).collect();
        if !is_header {
            // Seconds to prepare, memory, and the median and the 99th percentile of a query.
            cells[2..6].fill("MEASURED");
        }
        format!("{}\n", cells.join(" | "))
    });
    lines.collect()
}

#[test]
fn help() {
    let folder = tempfile::tempdir().unwrap();
    assert_snapshot!("help", session(folder.path(), "--help"));
}

#[test]
fn a_small_comparison() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("plate.obj", &obj_box(1.0, 1.0, 0.1));
    write("bar.obj", &obj_box(0.1, 0.2, 0.5));
    // A centimetre deep, 1 cm apart, and far away.
    let poses = "0.4,0.4,0.09,0,0,0,1\n0.4,0.4,0.11,0,0,0,1\n0.4,0.4,3,0,0,0,1\n";
    write("poses.csv", &format!("x_m,y_m,z_m,qx,qy,qz,qw\n{poses}"));
    let algorithms = "--algorithm vps --algorithm convex_hull --algorithm trimesh";
    let sizes = "--points 400 --voxels 30 --repeat 1";
    let arguments = format!("plate.obj bar.obj --poses poses.csv {algorithms} {sizes}");
    let text = session(folder.path(), &arguments);
    assert_snapshot!("small_comparison", without_measurements(&text));
}

#[test]
fn errors() {
    let folder = tempfile::tempdir().unwrap();
    let header = "x_m,y_m,z_m,qx,qy,qz,qw\n";
    let files = [
        ("box.obj", obj_box(1.0, 1.0, 1.0)),
        (
            "nan.obj",
            obj_box(1.0, 1.0, 1.0).replace("v 1 1 1", "v 1 1 nan"),
        ),
        ("sheet.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n".into()),
        ("word.csv", format!("{header}0,up,0,0,0,0,1\n")),
        ("long.csv", format!("{header}0,0,0,0,0,0,2\n")),
        ("missing.csv", "x_m,y_m,z_m\n0,0,0\n".into()),
        ("none.csv", header.into()),
    ];
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let lines = [
        "box.obj",
        "box.obj nan.obj",
        "sheet.obj box.obj",
        "box.txt box.obj",
        "box.obj box.obj --random 0",
        "box.obj box.obj --prediction=-1",
        "box.obj box.obj --time-limit 0",
        "box.obj box.obj --scale-a 0",
        "box.obj box.obj --random 3 --poses none.csv",
        "box.obj box.obj --algorithm sphere",
        "box.obj box.obj --poses word.csv",
        "box.obj box.obj --poses long.csv",
        "box.obj box.obj --poses missing.csv",
        "box.obj box.obj --poses none.csv",
    ];
    assert_snapshot!(
        "errors",
        lines.map(|line| session(folder.path(), line)).concat()
    );
}
