//! What the command prints, kept in `snapshots`. After a change look at the difference, and accept it
//! with `INSTA_UPDATE=always cargo test -p vps-build --test messages`.

use std::path::Path;
use std::process::Command;

use insta::assert_snapshot;

/// A command line in a folder and its output.
fn session(folder: &Path, arguments: &str) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_vps-build"))
        .args(arguments.split_whitespace())
        .current_dir(folder)
        .output()
        .unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    let (out, errors) = (text(output.stdout), text(output.stderr));
    let code = output.status.code().unwrap();
    format!("$ vps-build {arguments}\n{out}{errors}[{code}]\n")
}

/// The text with the last number before ` s` of each line, a time, left out.
fn without_times(text: &str) -> String {
    let lines = text.lines().map(|line| match line.strip_suffix(" s") {
        Some(line) => format!("{}TIME s\n", line.trim_end_matches(|c| c != ' ')),
        None => format!("{line}\n"),
    });
    lines.collect()
}

const BOX: &str = "OFF\n8 6 0\n0 0 0\n0.3 0 0\n0 0.2 0\n0.3 0.2 0\n0 0 0.1\n0.3 0 0.1\n\
    0 0.2 0.1\n0.3 0.2 0.1\n4 0 4 6 2\n4 1 3 7 5\n4 0 1 5 4\n4 2 6 7 3\n4 0 2 3 1\n4 4 5 7 6\n";

#[test]
fn help() {
    let folder = tempfile::tempdir().unwrap();
    assert_snapshot!("help", session(folder.path(), "--help"));
    for command in ["build", "inspect", "export", "sample", "completions"] {
        let help = session(folder.path(), &format!("{command} --help"));
        assert_snapshot!(format!("help_{command}"), help);
    }
}

#[test]
fn a_mesh_is_inspected_built_and_inspected_again() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("box.off"), BOX).unwrap();
    // Without its first face, and with the second one turned.
    let open = BOX.replace("8 6 0", "8 5 0").replace("4 0 4 6 2\n", "");
    let open = open.replace("4 1 3 7 5", "4 5 7 3 1");
    std::fs::write(folder.path().join("open.off"), open).unwrap();
    let lines = [
        "inspect box.off",
        "inspect open.off",
        "build box.off -o box.vps --voxels 20 --points 200",
        "build open.off -o open.vps --voxels 3 --points 50 --encoding layers",
        "inspect box.vps",
    ];
    let text: String = lines.map(|line| session(folder.path(), line)).concat();
    assert_snapshot!("small_run", without_times(&text));
}

#[test]
fn errors() {
    let folder = tempfile::tempdir().unwrap();
    let meshes = [
        ("box.off", BOX.to_owned()),
        ("nan.off", BOX.replace("0.3 0.2 0\n", "0.3 nan 0\n")),
        ("range.off", BOX.replace("4 4 5 7 6", "4 4 5 7 8")),
        ("sheet.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n".into()),
        ("empty.obj", String::new()),
        ("other.vps", "no asset".into()),
        ("points.csv", "x,y\n0,0\n".into()),
    ];
    for (name, text) in meshes {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let lines = [
        "build nan.off -o out.vps",
        "build range.off -o out.vps",
        "build sheet.obj -o out.vps",
        "build empty.obj -o out.vps",
        "build box.txt -o out.vps",
        "build box.off -o out.vps --voxel-size 0",
        "build box.off -o out.vps --voxel-size 1e-5",
        "build box.off -o out.vps --voxels few",
        "build box.off -o out.vps --precision 9",
        "build box.off -o out.vps --encoding floats --precision 3",
        "build box.off -o out.vps --scale 0",
        "build box.off -o out.vps -k 1",
        "build box.off -o out.vps --spacing=-1",
        "build box.off -o out.vps --points 100 --spacing 0.1",
        "build box.off",
        "inspect other.vps",
        "sample other.vps --points points.csv",
    ];
    assert_snapshot!(
        "errors",
        lines.map(|line| session(folder.path(), line)).concat()
    );
}
