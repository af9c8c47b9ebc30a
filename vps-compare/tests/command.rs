//! The command on two meshes made by code.

mod support;

use std::collections::HashMap;
use std::fmt::Write;
use std::path::Path;

use glamx::DVec3;
use serde_json::Value;
use vps_build::Mesh;
use vps_compare::Algorithm;

use crate::support::{Folder, obj, vps_compare};

impl Folder {
    /// A cup, open at the top, and a ball.
    fn meshes(&self) -> [String; 2] {
        let cup = vps_build::models::cup(1);
        let ball = Mesh::icosphere(0.25, 2).unwrap();
        [
            self.write("cup.obj", &obj(&cup)),
            self.write("ball.stl", &stl(&ball)),
        ]
    }
}

fn stl(mesh: &Mesh) -> String {
    let mut text = "solid ball\n".to_owned();
    for t in 0..mesh.triangles().len() {
        text += "facet normal 0 0 0\nouter loop\n";
        for v in mesh.corners(t).map(|v| v.as_vec3()) {
            writeln!(text, "vertex {} {} {}", v.x, v.y, v.z).unwrap();
        }
        text += "endloop\nendfacet\n";
    }
    text + "endsolid ball\n"
}

const SMALL: [&str; 8] = [
    "--points", "400", "--voxels", "20", "--repeat", "1", "--parts", "4",
];

/// The keys of the algorithms that are run if none is named, in the order of the table.
fn default_set() -> Vec<&'static str> {
    let all = Algorithm::all().into_iter();
    let default_set = all.filter(|algorithm| algorithm.is_in_default_set());
    default_set.map(|algorithm| algorithm.key()).collect()
}

#[test]
fn random_poses_of_all_algorithms_agree_in_table_csv_and_json() {
    let folder = Folder::new("random");
    let names = default_set();
    let [cup, ball] = folder.meshes();
    let csv_path = folder.path("rows.csv");
    let common = [&cup, &ball, "--random", "12", "--csv", &csv_path];
    let (code, json, errors) = vps_compare(&[&common[..], &SMALL, &["--json"]].concat());
    assert_eq!((code, errors.as_str()), (Some(0), ""));
    let summary: Value = serde_json::from_str(&json).unwrap();
    assert_eq!(summary["poses"], 12);
    // Half of the poses are moved apart from touching, half into it.
    assert_eq!(summary["apart"], 6);
    assert_eq!(summary["overlapping"], 6);
    assert_eq!(summary["mesh_a"]["watertight"], true);

    let mut reader = csv::Reader::from_path(&csv_path).unwrap();
    let columns: Vec<_> = reader
        .headers()
        .unwrap()
        .iter()
        .map(str::to_owned)
        .collect();
    assert_eq!(
        columns.join(","),
        "pose,x_m,y_m,z_m,qx,qy,qz,qw,algorithm,status,contacts,penetration_m,query_ns,\
         exact_penetration_m,exact_uncertainty_m,error_m,answer"
    );
    let rows: Vec<Vec<String>> = reader
        .records()
        .map(|r| r.unwrap().iter().map(str::to_owned).collect())
        .collect();
    assert_eq!(rows.len(), 12 * names.len());
    let column = |name: &str| columns.iter().position(|c| c == name).unwrap();
    let algorithms = summary["algorithms"].as_array().unwrap();
    assert_eq!(algorithms.len(), names.len());
    for (algorithm, &name) in algorithms.iter().zip(&names) {
        assert_eq!(algorithm["algorithm"], name);
        assert_eq!(algorithm["status"], "ok");
        assert_eq!(algorithm["answered"], 12);
        let of_it: Vec<_> = rows
            .iter()
            .filter(|r| r[column("algorithm")] == name)
            .collect();
        let numbers = |name: &str| -> Vec<f64> {
            let texts = of_it.iter().map(|r| &r[column(name)]);
            let texts = texts.filter(|text| !text.is_empty());
            texts.map(|text| text.parse().unwrap()).collect()
        };
        let errors = numbers("error_m");
        assert_eq!(algorithm["compared"], errors.len());
        let worst = errors.iter().copied().fold(0.0, f64::max);
        assert!((algorithm["error_max_m"].as_f64().unwrap() - worst).abs() < 1e-12);
        let mean = numbers("contacts").iter().sum::<f64>() / 12.0;
        assert!((algorithm["contacts_mean"].as_f64().unwrap() - mean).abs() < 1e-9);
        assert!(numbers("query_ns").iter().all(|ns| *ns > 0.0));
        let missed = of_it
            .iter()
            .filter(|r| r[column("answer")] == "missed")
            .count();
        assert_eq!(algorithm["missed"], missed);
        assert!(algorithm["prepare_s"].as_f64().unwrap() > 0.0);
        assert!(algorithm["memory_bytes"].as_u64().unwrap() > 0);
        if name.starts_with("vps") {
            assert_eq!(algorithm["memory_is_estimate"], false);
        }
    }
    // Both shells agree with the triangles to within a voxel; the hull of a cup is not a cup.
    let both = names.iter().position(|name| *name == "vps_both").unwrap();
    let error = algorithms[both]["error_max_m"].as_f64().unwrap();
    assert!(error < 0.1, "{error}");

    let (code, table, errors) = vps_compare(&[&common[..], &SMALL].concat());
    assert_eq!((code, errors.as_str()), (Some(0), ""));
    let header = table.lines().find(|l| l.starts_with("algorithm")).unwrap();
    for column in [
        "prepare_s",
        "memory_KiB",
        "median_us",
        "p99_us",
        "contacts",
        "error_max_m",
    ] {
        assert!(header.contains(column), "{header}");
    }
    for &name in &names {
        let is_row = |l: &&str| l.split_whitespace().next() == Some(name);
        assert_eq!(table.lines().filter(is_row).count(), 1, "{table}");
    }
}

#[test]
fn poses_of_a_file_and_one_algorithm() {
    let folder = Folder::new("poses");
    let ball = Mesh::icosphere(0.5, 3).unwrap();
    let ball = folder.write("ball.obj", &obj(&ball));
    // In another order, and one that is turned.
    let poses = folder.write(
        "poses.csv",
        "qw,qx,qy,qz,x_m,y_m,z_m\n1,0,0,0,1.5,0,0\n1,0,0,0,0,0.98,0\n0.6,0,0.8,0,0,0,-1.01\n",
    );
    let csv_path = folder.path("rows.csv");
    let arguments = [
        &ball,
        &ball,
        "--poses",
        &poses,
        "--algorithm",
        "trimesh",
        "--csv",
        &csv_path,
        "--json",
    ];
    let (code, json, _) = vps_compare(&arguments);
    assert_eq!(code, Some(0));
    let summary: Value = serde_json::from_str(&json).unwrap();
    assert_eq!(summary["algorithms"].as_array().unwrap().len(), 1);
    assert_eq!(summary["seed"], Value::Null);
    assert_eq!(summary["spread_m"], Value::Null);
    let mut reader = csv::Reader::from_path(&csv_path).unwrap();
    let exact: Vec<f64> = reader
        .records()
        .map(|r| r.unwrap()[13].parse().unwrap())
        .collect();
    assert_eq!(exact.len(), 3);
    for (found, expected) in exact.into_iter().zip([-0.5, 0.02, -0.01]) {
        // A ball of faces is a little smaller than a ball.
        assert!((found - expected).abs() < 0.005, "{found}, {expected}");
    }
}

#[test]
fn meshes_far_from_their_origins_are_compared_where_they_are() {
    // As maps have them. Neither 32-bit vertices nor 32-bit poses would do.
    let folder = Folder::new("far");
    let far = |mesh: Mesh, at: DVec3| {
        let vertices: Vec<_> = mesh.vertices().iter().map(|v| *v + at).collect();
        obj(&Mesh::new(&vertices, mesh.triangles()).unwrap())
    };
    let (at_a, at_b) = (DVec3::new(5e5, 5e6, 100.0), DVec3::new(4e5, 6e6, -20.0));
    let a = folder.write("a.obj", &far(Mesh::cuboid([1.0; 3]).unwrap(), at_a));
    let b = folder.write("b.obj", &far(Mesh::icosphere(0.5, 4).unwrap(), at_b));
    let apart = at_a - at_b;
    let row = |x: f64| {
        let [x, y, z] = (apart + DVec3::X * x).to_array();
        format!("{x},{y},{z},0,0,0,1\n")
    };
    let rows = [0.99, 1.01].map(row).concat();
    let poses = folder.write("poses.csv", &format!("x_m,y_m,z_m,qx,qy,qz,qw\n{rows}"));
    let csv_path = folder.path("rows.csv");
    let (code, _, errors) = vps_compare(&[&a, &b, "--poses", &poses, "--csv", &csv_path]);
    assert_eq!((code, errors.as_str()), (Some(0), ""));
    let mut reader = csv::Reader::from_path(&csv_path).unwrap();
    let mut count = 0;
    for row in reader.deserialize() {
        let row: HashMap<String, String> = row.unwrap();
        let number = |name: &str| row[name].parse::<f64>().unwrap();
        let expected = if row["pose"] == "1" { 0.01 } else { -0.01 };
        assert!((number("x_m") - (apart.x + 1.0 - expected)).abs() < 1e-9);
        assert!((number("exact_penetration_m") - expected).abs() < 1e-3);
        // Voxels are thicker than the solid, and a triangle mesh has no depth.
        if !["voxels", "trimesh"].contains(&row["algorithm"].as_str()) {
            assert!(number("error_m") < 2e-3, "{row:?}");
        }
        count += 1;
    }
    assert!(count >= 10);
}

#[test]
fn help_names_all_algorithms_with_their_options() {
    let (code, help, _) = vps_compare(&["--help"]);
    assert_eq!(code, Some(0));
    // Lines are wrapped.
    let help = help.split_whitespace().collect::<Vec<_>>().join(" ");
    for algorithm in Algorithm::all() {
        let line = format!("- {}: {}", algorithm.key(), algorithm.about());
        assert!(help.contains(&line), "{line}");
    }
    assert!(help.contains("VHACD [parts=8, resolution=64, vertices=100]"));
    assert!(help.contains("around their origins; only if it is named"));
}

#[test]
fn options_of_algorithms_are_set_and_those_that_do_not_exist_refused() {
    let folder = Folder::new("set");
    let ball = Mesh::icosphere(0.5, 3).unwrap();
    let ball = folder.write("ball.obj", &obj(&ball));
    let common = [&ball, &ball, "--random", "2", "--json"];
    let sizes = |arguments: &[&str]| -> Vec<Value> {
        let (code, json, errors) = vps_compare(&[&common[..], arguments].concat());
        assert_eq!((code, errors.as_str()), (Some(0), ""));
        let summary: Value = serde_json::from_str(&json).unwrap();
        let algorithms = summary["algorithms"].as_array().unwrap();
        algorithms.iter().map(|a| a["size_b"].clone()).collect()
    };
    let voxels = ["--algorithm", "voxels", "--voxels", "10"];
    let ten = sizes(&voxels);
    assert_eq!(
        sizes(&["--algorithm", "voxels", "--set", "voxels.resolution=10"]),
        ten
    );
    let twenty = sizes(&[&voxels[..], &["--set", "voxels.resolution=20"]].concat());
    assert!(twenty[0]["voxels"].as_u64() > ten[0]["voxels"].as_u64());
    // An algorithm that is not in the default set, with nothing to count.
    assert_eq!(
        sizes(&["--algorithm", "ball"]),
        [Value::Object(Default::default())]
    );
    for (setting, why) in [
        ("voxels.parts=3", "unknown field `parts`"),
        ("hull.parts=3", "no algorithm `hull`"),
    ] {
        let (code, _, message) = vps_compare(&[&common[..], &["--set", setting]].concat());
        assert_eq!(code, Some(2));
        assert_eq!(message.lines().count(), 1, "{message}");
        let start = format!("vps-compare: --set {setting}: ");
        assert!(
            message.starts_with(&start) && message.contains(why),
            "{message}"
        );
    }
}

#[test]
fn a_failed_preparation_is_a_row_with_the_reason() {
    let folder = Folder::new("rows");
    let [cup, ball] = folder.meshes();
    let csv_path = folder.path("rows.csv");
    // More voxels than the builder may take memory for, which parry's algorithms do not mind.
    let arguments = [
        &cup,
        &ball,
        "--random",
        "3",
        "--algorithm",
        "vps",
        "--algorithm",
        "convex_hull",
        "--voxels",
        "60000",
        "--csv",
        &csv_path,
    ];
    let (code, table, errors) = vps_compare(&arguments);
    assert_eq!((code, errors.as_str()), (Some(0), ""));
    assert!(
        table.contains("vps: 0 of 3 answered: cannot build the asset: "),
        "{table}"
    );
    let rows = std::fs::read_to_string(&csv_path).unwrap();
    assert_eq!(rows.matches("cannot build the asset").count(), 3, "{rows}");
    assert_eq!(rows.matches(",convex_hull,ok,").count(), 3, "{rows}");
}

/// The inside of a surface with more holes than faces is a guess.
#[test]
fn of_an_open_mesh_nothing_is_exact_and_nothing_wrong() {
    let folder = Folder::new("open");
    let ball = Mesh::icosphere(0.25, 2).unwrap();
    let crumbs: Vec<_> = ball.triangles().iter().step_by(4).copied().collect();
    let crumbs = Mesh::new(ball.vertices(), &crumbs).unwrap();
    let crumbs = folder.write("crumbs.obj", &obj(&crumbs));
    let ball = folder.write("ball.obj", &obj(&ball));
    let csv_path = folder.path("rows.csv");
    let hull = ["--random", "3", "--algorithm", "convex_hull"];
    let common = [&[&crumbs, &ball, "--csv", &csv_path][..], &hull].concat();
    let (code, table, errors) = vps_compare(&common);
    assert_eq!((code, errors.as_str()), (Some(0), ""));
    let known = "known at 0 of 3 poses: holes of A were left open";
    assert!(table.contains(known), "{table}");
    let row = table.lines().find(|l| l.starts_with("convex_hull"));
    let cells: Vec<_> = row.unwrap().split_whitespace().collect();
    assert_eq!(cells[cells.len() - 3..], ["–"; 3], "{table}");
    assert!(
        !table.contains("inf") && !table.contains("0 + 0"),
        "{table}"
    );

    let (_, json, _) = vps_compare(&[&common[..], &["--json"]].concat());
    let summary: Value = serde_json::from_str(&json).unwrap();
    assert_eq!(summary["exact"], 0);
    assert_eq!(summary["exact_uncertainty_m"], Value::Null);
    assert_eq!(summary["mesh_a"]["open"], true);
    assert_eq!(summary["mesh_b"]["open"], false);
    let hull = &summary["algorithms"][0];
    assert_eq!((&hull["answered"], &hull["judged"]), (&3.into(), &0.into()));
    assert_eq!(hull["error_max_m"], Value::Null);
    let mut reader = csv::Reader::from_path(&csv_path).unwrap();
    for row in reader.records().map(Result::unwrap) {
        assert_eq!((&row[13], &row[14], &row[15]), ("", "", ""));
        assert_eq!(&row[16], "unknown");
    }
}

/// Edges where faces are flat or nearly so take the search for the deepest point long.
#[test]
fn where_the_search_was_given_up_nothing_is_counted() {
    let folder = Folder::new("given-up");
    let roof = folder.write(
        "roof.obj",
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv .5 .5 .01\n\
         f 1 3 2\nf 1 4 3\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n",
    );
    let header = "x_m,y_m,z_m,qx,qy,qz,qw\n";
    let poses = format!("{header}.001,0,0,0,0,0,1\n0,0,1,0,0,0,1\n");
    let poses = folder.write("poses.csv", &poses);
    let hull = ["--algorithm", "convex_hull"];
    let common = [&[&roof, &roof, "--poses", &poses][..], &hull].concat();
    // Within a tolerance of a millimetre it is known all the same.
    for (tolerance, certain) in [("1e-3", 2), ("1e-7", 1)] {
        let options = ["--tolerance", tolerance, "--json"];
        let (code, json, _) = vps_compare(&[&common[..], &options].concat());
        assert_eq!(code, Some(0));
        let summary: Value = serde_json::from_str(&json).unwrap();
        assert_eq!(summary["exact"], certain, "{tolerance}");
        let hull = &summary["algorithms"][0];
        assert_eq!(
            (&hull["answered"], &hull["judged"]),
            (&2.into(), &certain.into())
        );
        assert_eq!(hull["compared"], certain - 1);
        assert!(summary["exact_uncertainty_m"].as_f64().unwrap() < 1e-3);
    }
    let (_, table, _) = vps_compare(&[&common[..], &["--tolerance", "1e-7"]].concat());
    let known =
        "known at 1 of 2 poses: at the others the search for the deepest point was given up";
    assert!(
        table.contains(known) && table.contains("0 + 0 of 1"),
        "{table}"
    );
}

#[test]
fn an_algorithm_that_takes_too_long_is_ended_and_says_so() {
    let folder = Folder::new("time");
    let [cup, ball] = folder.meshes();
    let csv_path = folder.path("rows.csv");
    let arguments = [
        &cup,
        &ball,
        "--random",
        "2",
        "--algorithm",
        "vps",
        "--voxels",
        "600",
        "--time-limit",
        "0.01",
        "--csv",
        &csv_path,
    ];
    let (code, table, errors) = vps_compare(&arguments);
    assert_eq!((code, errors.as_str()), (Some(0), ""));
    let why = "ended after 0.01 s, its --time-limit";
    let line = format!("vps: 0 of 2 answered: {why}");
    assert!(table.contains(&line), "{table}");
    let rows = std::fs::read_to_string(&csv_path).unwrap();
    assert_eq!(rows.matches(why).count(), 2, "{rows}");
}

#[cfg(target_os = "linux")]
#[test]
fn an_algorithm_that_takes_too_much_memory_is_ended_and_says_so() {
    let folder = Folder::new("memory");
    let [cup, ball] = folder.meshes();
    // More than the voxels and points are reckoned to take, and less than the whole process does.
    let arguments = [
        &cup,
        &ball,
        "--random",
        "2",
        "--algorithm",
        "vps",
        "--voxels",
        "100",
        "--memory-limit",
        "13",
    ];
    let (code, table, errors) = vps_compare(&arguments);
    assert_eq!((code, errors.as_str()), (Some(0), ""));
    let line = "vps: 0 of 2 answered: ended at 13 MiB, its --memory-limit";
    assert!(table.contains(line), "{table}");
}

/// Those of the library that builds assets as well, which speaks through this command.
#[test]
fn options_that_messages_recommend_exist() {
    let [help, explain] = [&["--help"][..], &["explain", "--help"]].map(|a| vps_compare(a).1);
    let help = help + &explain;
    let sources = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut found = 0;
    let mut folders = vec![sources.join("src"), sources.join("../vps-build/src")];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                // The other command names its own options.
                if !path.ends_with("vps-build/src/commands") {
                    folders.push(path);
                }
                continue;
            }
            let text = std::fs::read_to_string(&path).unwrap_or_default();
            let code = text.lines().filter(|l| !l.trim_start().starts_with("//"));
            let words = code.flat_map(|l| l.split(|c: char| !c.is_ascii_lowercase() && c != '-'));
            let words = words.filter(|w| !w.starts_with("---"));
            for option in words.filter(|w| w.len() > 2 && w.starts_with("--")) {
                // One is for the command itself.
                let is_known = help.contains(option) || option == "--worker";
                assert!(is_known, "{}: {option}", path.display());
                found += 1;
            }
        }
    }
    assert!(found > 10, "only {found}");
}

#[test]
fn wrong_input_is_one_line_that_names_it() {
    let folder = Folder::new("errors");
    let [cup, ball] = folder.meshes();
    let open = folder.write("open.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let nan = folder.write("nan.obj", "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n");
    let header = "x_m,y_m,z_m,qx,qy,qz,qw\n";
    let poses = |name: &str, text: &str| folder.write(name, text);
    let good = "0,0,0,0,0,0,1\n";
    let missing = poses("missing.csv", "x_m,y_m,z_m,qx,qy,qz\n0,0,0,0,0,0\n");
    let word = poses("word.csv", &format!("{header}{good}0,up,0,0,0,0,1\n"));
    let infinite = poses("infinite.csv", &format!("{header}inf,0,0,0,0,0,1\n"));
    let short = poses("short.csv", &format!("{header}{good}{good}0,0,0\n"));
    let long = poses("long.csv", &format!("{header}0,0,0,0,0,0,2\n"));
    let none = poses("none.csv", header);
    let empty = poses("empty.csv", "");
    let fails = |arguments: &[&str], expected: &str| {
        let (code, out, message) = vps_compare(arguments);
        assert_eq!((code, out.as_str()), (Some(2), ""), "{message}");
        assert_eq!(message.lines().count(), 1, "{message}");
        assert!(message.contains(expected), "{message}");
    };
    fails(&[&folder.path("no.obj"), &ball], "no.obj: ");
    fails(&[&cup, &nan], "nan.obj:2: vertex 2 at (NaN");
    fails(&[&cup, &open], "open.obj: the mesh is a sheet");
    fails(&[&cup, &ball, "--scale-b", "0"], "ball.stl: --scale-b: ");
    fails(&[&cup, &ball, "--scale-a", "1e300"], "cup.obj: ");
    fails(&[&cup, &ball, "--random", "0"], "--random");
    fails(&[&cup, &ball, "--repeat", "0"], "--repeat");
    fails(&[&cup, &ball, "--time-limit", "0"], "--time-limit");
    fails(&[&cup, &ball, "--memory-limit", "0"], "--memory-limit");
    fails(&[&cup, &ball, "--prediction=-1"], "--prediction");
    fails(
        &[&cup, &ball, "--poses", &folder.path("no.csv")],
        "no.csv: ",
    );
    fails(
        &[&cup, &ball, "--poses", &missing],
        "missing.csv:1: the column `qw`",
    );
    fails(&[&cup, &ball, "--poses", &word], "word.csv:3: y_m: `up`");
    fails(
        &[&cup, &ball, "--poses", &infinite],
        "infinite.csv:2: x_m: `inf`",
    );
    fails(&[&cup, &ball, "--poses", &short], "short.csv:4: 3 values");
    fails(
        &[&cup, &ball, "--poses", &long],
        "long.csv:2: qx, qy, qz, qw",
    );
    fails(&[&cup, &ball, "--poses", &none], "none.csv: no pose");
    fails(
        &[&cup, &ball, "--poses", &empty],
        "empty.csv:1: the column `x_m`",
    );
    let in_a_file = format!("{ball}/rows.csv");
    let hull = ["--random", "1", "--algorithm", "convex_hull"];
    let arguments = [&[&cup, &ball, "--csv", &in_a_file][..], &hull].concat();
    fails(&arguments, "ball.stl");
}
