//! The verb `explain` on two meshes made by code.

mod support;

use serde_json::Value;
use vps_build::Mesh;

use crate::support::{Folder, obj, vps_compare};

impl Folder {
    /// A slab with its top at y = 0.1 m, and a cube with edges of 0.5 m.
    fn meshes(&self) -> [String; 2] {
        let slab = Mesh::cuboid([2.0, 0.2, 2.0]).unwrap();
        let cube = Mesh::cuboid([0.5; 3]).unwrap();
        [("slab.obj", slab), ("cube.obj", cube)].map(|(name, mesh)| self.write(name, &obj(&mesh)))
    }

    /// The cube 1 mm deep in the slab, and high above it.
    fn poses(&self) -> String {
        let text = "x_m,y_m,z_m,qx,qy,qz,qw\n0,0.349,0,0,0,0,1\n0,2,0,0,0,0,1\n";
        self.write("poses.csv", text)
    }
}

const SMALL: [&str; 4] = ["--points", "400", "--voxels", "20"];

#[test]
fn the_story_of_a_cube_on_a_slab_adds_up() {
    let folder = Folder::new("story");
    let ([slab, cube], poses) = (folder.meshes(), folder.poses());
    let (csv_path, ply_path) = (folder.path("events.csv"), folder.path("points.ply"));
    let pair = ["explain", &slab, &cube, "--poses", &poses];
    let files = ["--csv", &csv_path, "--ply", &ply_path];
    let (code, json, errors) = vps_compare(&[&pair[..], &SMALL, &files, &["--json"]].concat());
    assert_eq!((code, errors.as_str()), (Some(0), ""));
    let story: Value = serde_json::from_str(&json).unwrap();

    // The comparison finds as many contacts, as deep.
    let rows_path = folder.path("rows.csv");
    let compare = [
        &slab,
        &cube,
        "--poses",
        &poses,
        "--algorithm",
        "vps",
        "--csv",
        &rows_path,
    ];
    let (code, _, errors) = vps_compare(&[&compare[..], &SMALL].concat());
    assert_eq!(code, Some(0), "{errors}");
    let mut reader = csv::Reader::from_path(&rows_path).unwrap();
    let headers = reader.headers().unwrap().clone();
    let row = reader.records().next().unwrap().unwrap();
    let compared = |name: &str| {
        let column = headers.iter().position(|h| h == name).unwrap();
        row[column].parse::<f64>().unwrap()
    };
    let contacts = story["contacts"].as_array().unwrap();
    assert_eq!(contacts.len() as f64, compared("contacts"));
    let depths = contacts
        .iter()
        .map(|c| c["penetration_m"].as_f64().unwrap());
    let deepest = depths.fold(f64::NEG_INFINITY, f64::max);
    assert!((deepest - compared("penetration_m")).abs() < 1e-9);
    for contact in contacts {
        assert!((contact["normal"][1].as_f64().unwrap() - 1.0).abs() < 0.01);
        assert!((contact["position_m"][1].as_f64().unwrap() - 0.099).abs() < 2e-3);
    }

    // Every point has one outcome.
    let shells = story["shells"].as_array().unwrap();
    let mut points = 0;
    for shell in shells {
        let outcomes = shell["outcomes"].as_object().unwrap();
        let sum: u64 = outcomes.values().map(|n| n.as_u64().unwrap()).sum();
        assert_eq!(shell["points"], sum);
        points += sum;
    }
    let kept = |shell: &Value| shell["outcomes"]["kept"].as_u64().unwrap_or(0);
    assert_eq!(shells.iter().map(kept).sum::<u64>(), contacts.len() as u64);

    // The events are those that were counted.
    let mut reader = csv::Reader::from_path(&csv_path).unwrap();
    let headers = reader.headers().unwrap().clone();
    assert_eq!(
        headers.iter().collect::<Vec<_>>().join(","),
        "shell,search,event,level,cluster,point,bound,threshold,penetration_m,reason,x_m,y_m,z_m,\
         nx,ny,nz"
    );
    let rows: Vec<_> = reader.records().map(Result::unwrap).collect();
    let count = |event: &str| rows.iter().filter(|row| &row[2] == event).count() as u64;
    let sum = |key: &str| -> u64 {
        let levels = shells.iter().flat_map(|s| s["levels"].as_array().unwrap());
        levels.map(|level| level[key].as_u64().unwrap()).sum()
    };
    for key in ["bounded", "pruned", "descended"] {
        assert_eq!(count(&format!("cluster_{key}")), sum(key), "{key}");
        assert!(sum(key) > 0, "{key}");
    }
    let tests: u64 = shells.iter().map(|s| s["tests"].as_u64().unwrap()).sum();
    assert_eq!(count("point_tested"), tests);
    assert_eq!(count("contact_kept"), contacts.len() as u64);

    // One vertex a point and two a contact, kept ones in green.
    let ply = std::fs::read_to_string(&ply_path).unwrap();
    let (header, body) = ply.split_once("end_header\n").unwrap();
    let vertices = points as usize + 2 * contacts.len();
    assert!(
        header.contains(&format!("element vertex {vertices}\n")),
        "{header}"
    );
    assert!(header.contains(&format!("element edge {}\n", contacts.len())));
    let lines: Vec<_> = body.lines().collect();
    assert_eq!(lines.len(), vertices + contacts.len());
    let green = lines.iter().filter(|line| line.ends_with(" 40 200 70"));
    assert_eq!(green.count(), 3 * contacts.len());
    let [first, second] = [vertices - 2, vertices - 1];
    assert_eq!(lines[lines.len() - 1], format!("{first} {second}"));

    // The text tells the same, counts first and the contacts at the end.
    let (code, text, errors) = vps_compare(&[&pair[..], &SMALL].concat());
    assert_eq!((code, errors.as_str()), (Some(0), ""));
    let at = |part: &str| text.find(part).unwrap_or_else(|| panic!("{part}: {text}"));
    let counts = at("level  clusters  bounded   pruned  descended");
    let events = at(&format!("\n{} events\n", rows.len()));
    let remain = at(&format!("\n{} contacts remain\n", contacts.len()));
    assert!(counts < events && events < remain && remain < at("other points of "));
}

#[test]
fn bodies_apart_are_pruned_at_the_top() {
    let folder = Folder::new("apart");
    let ([slab, cube], poses) = (folder.meshes(), folder.poses());
    let pair = [
        "explain", &slab, &cube, "--poses", &poses, "--row", "2", "--json",
    ];
    let (code, json, errors) = vps_compare(&[&pair[..], &SMALL].concat());
    assert_eq!((code, errors.as_str()), (Some(0), ""));
    let story: Value = serde_json::from_str(&json).unwrap();
    assert_eq!(story["contacts"].as_array().unwrap().len(), 0);
    assert_eq!(story["pose"][1], 2.0);
    for shell in story["shells"].as_array().unwrap() {
        assert_eq!(shell["tests"], 0);
        assert_eq!(shell["levels"][0]["pruned"], 1);
        assert_eq!(shell["outcomes"]["untested"], shell["points"]);
    }
}

#[test]
fn wrong_input_is_one_line_that_names_it() {
    let folder = Folder::new("errors");
    let ([slab, cube], poses) = (folder.meshes(), folder.poses());
    let word = folder.write("word.csv", "x_m,y_m,z_m,qx,qy,qz,qw\n0,up,0,0,0,0,1\n");
    let fails = |arguments: &[&str], expected: &str| {
        let (code, out, message) = vps_compare(&[&["explain"][..], arguments].concat());
        assert_eq!((code, out.as_str()), (Some(2), ""), "{message}");
        assert_eq!(message.lines().count(), 1, "{message}");
        assert!(message.contains(expected), "{message}");
    };
    let good = [&slab[..], &cube, "--poses", &poses];
    fails(
        &[&good[..], &["--row", "3"]].concat(),
        "--row 3: the poses of ",
    );
    fails(
        &[&good[..], &["--row", "0"]].concat(),
        "--row must be at least 1",
    );
    fails(
        &[&good[..], &["--points", "0"]].concat(),
        "--points must be at least 1",
    );
    fails(
        &[&good[..], &["--prediction=-1"]].concat(),
        "--prediction must be a length",
    );
    fails(
        &[&good[..], &["--scale-b", "0"]].concat(),
        "cube.obj: --scale-b: ",
    );
    fails(&[&slab, &cube, "--poses", &word], "word.csv:2: y_m: `up`");
    fails(
        &[&folder.path("no.obj"), &cube, "--poses", &poses],
        "no.obj: ",
    );
    let in_a_file = format!("{slab}/out.ply");
    let to_file = [&good[..], &SMALL, &["--ply", &in_a_file]].concat();
    fails(&to_file, "slab.obj");
    // Poses are not random here, and what is missing is named.
    let (code, _, message) = vps_compare(&["explain", &slab, &cube]);
    assert_eq!(code, Some(2));
    assert!(message.contains("--poses"), "{message}");
}
