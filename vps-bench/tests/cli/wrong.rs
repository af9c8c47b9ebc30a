//! Input that cannot be used: one line that says where and what.

use std::fs;
use std::path::Path;

use crate::project::{BOX, Project};

#[test]
fn errors_are_one_line() {
    let project = Project::new("wrong");
    let missing = ["experiments/missing.toml", "No such file"];
    project.fails(2, &["run", "missing"], &missing);
    let wrong = |old: &str, new: &str, expected: &[&str]| {
        let fall = "experiments/fall.toml";
        project.edit(fall, "experiments/wrong.toml", old, new);
        project.fails(2, &["run", "wrong"], expected);
    };
    wrong("mass_kg", "weight", &["wrong.toml:11: ", "`weight`"]);
    wrong("seed = 7", "seed = ", &["wrong.toml:23: "]);
    wrong(
        "mass_kg = 1.0",
        "mass_kg = -1.0",
        &["wrong.toml: ", "drop.mass_kg", "-1"],
    );
    wrong("[0.4, 0.6]", "[0.4, 0.9]", &["drop.measured_s", "0.6"]);
    wrong("[200]", "[0]", &["drop.frequencies_hz"]);
    wrong("\"vps_l2\"", "\"hull\"", &["`hull` stands twice"]);
    wrong(
        "\"vps_l2\"",
        "\"vps_l9\"",
        &["wrong: no algorithm `vps_l9` in", "algorithms.toml"],
    );
    wrong(
        "algorithm = \"hull\"",
        "algorithm = \"none\"",
        &["`none` is not one of"],
    );
    wrong(
        "[[claim]]",
        "[fly]\n[[claim]]",
        &["wrong.toml:32: ", "`fly`"],
    );
    wrong(
        "at_most = 0\n",
        "",
        &["claim `stays_above`", "at_least or at_most is missing"],
    );
    wrong(
        "expect = \"holds\"",
        "expect = \"true\"",
        &["wrong.toml:", "`true`"],
    );
    let words = "order = 1\ntitle = \"\"\npaper = \"\"\nquestion = \"\"\nmisleads = \"\"\n";
    project.write("experiments/wrong.toml", words);
    let expected = [
        "wrong.toml: exactly one table of these is needed: ",
        "[drop]",
    ];
    project.fails(2, &["run", "wrong"], &expected);
    assert!(!project.path("reports").exists());
}

#[test]
fn algorithms_that_make_no_sense_are_named() {
    let project = Project::new("wrong-algorithm");
    let algorithms = "experiments/algorithms.toml";
    let right = project.read(algorithms);
    let wrong = |old: &str, new: &str, expected: &[&str]| {
        project.write(algorithms, &right);
        project.edit(algorithms, algorithms, old, new);
        project.fails(2, &["run", "fall"], expected);
    };
    wrong(
        "points = 800",
        "pints = 800",
        &["algorithms.toml:", "`pints`"],
    );
    wrong("#0072b2", "blue", &["algorithms.toml: [vps]: ", "blue"]);
    wrong(
        "like = \"vps\"",
        "like = \"wps\"",
        &["[vps_l2]: like: `wps`"],
    );
    wrong("segments = 2", "segments = 0", &["[vps_l2]: segments"]);
    assert!(!project.path("reports").exists());
}

#[test]
fn models_that_cannot_be_used_are_named() {
    let project = Project::new("wrong-model");
    let fails = |arguments: &[&str], expected: &[&str]| {
        let arguments = [&["run", "fall", "--model"], arguments].concat();
        project.fails(2, &arguments, expected);
    };
    fails(&["none.obj"], &["none.obj", "models.toml"]);
    project.write("nan.obj", &BOX.replace("v 0.1 0.05 0.15", "v 0.1 inf 0.15"));
    fails(&["nan.obj"], &["nan.obj:8:", "inf"]);
    project.write("flat.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    fails(&["flat.obj"], &["flat.obj", "not closed"]);
    fails(&["box.obj", "--scale", "0"], &["scale"]);
    assert!(!project.path("reports").exists());
}

/// Of this command: options of cargo and git stand in the sources as well.
#[test]
fn options_that_messages_recommend_exist() {
    let project = Project::new("options");
    let commands = ["run", "report", "compare", "reproduce"];
    let help = commands.map(|command| project.succeeds(&[command, "--help"]));
    let others = ["--locked", "--release", "--porcelain"];
    let sources = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut found = 0;
    for folder in [sources.clone(), sources.join("report")] {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            // Properties of a style sheet are not options.
            if path.extension().is_none_or(|e| e != "rs") {
                continue;
            }
            let text = fs::read_to_string(&path).unwrap();
            let code = text.lines().filter(|l| !l.trim_start().starts_with("//"));
            let words = code.flat_map(|l| l.split(|c: char| !c.is_ascii_lowercase() && c != '-'));
            let words = words.filter(|w| !w.starts_with("---"));
            for option in words.filter(|w| w.len() > 2 && w.starts_with("--")) {
                let is_known = help.iter().any(|help| help.contains(option));
                let is_other = others.contains(&option);
                assert!(is_known || is_other, "{}: {option}", path.display());
                found += 1;
            }
        }
    }
    assert!(found > 4, "only {found}");
}

#[test]
fn arguments_that_make_no_sense_are_refused() {
    let project = Project::new("wrong-arguments");
    let shard = project.bench(&["run", "fall", "--shard", "3/2"]);
    assert_eq!(shard.code, Some(2));
    assert!(shard.errors.contains("`3/2` is not like 2/3"));
    let scale = project.bench(&["run", "fall", "--scale", "2"]);
    assert_eq!(scale.code, Some(2));
    assert!(scale.errors.contains("--model"));
    project.fails(2, &["report"], &["no experiment has been run"]);
    let named = ["made_with.json", "has the experiment been run?"];
    project.fails(2, &["report", "fall"], &named);
    project.fails(2, &["check", "fall"], &named);
}
