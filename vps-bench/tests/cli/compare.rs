//! Two folders of reports side by side.

use crate::project::{NAMES, Project, column};

/// Runs twice, into `a` and, after a change, into `b`.
fn run_both(project: &Project, change: impl Fn()) {
    project.succeeds(&["run", "fall", "--quick", "--out", "a"]);
    change();
    project.succeeds(&["run", "fall", "--quick", "--out", "b"]);
}

#[test]
fn times_are_compared_by_algorithm() {
    let project = Project::new("compare");
    // Text columns, and algorithms in only one of the two, are ignored.
    let fall = "experiments/fall.toml";
    run_both(&project, || {
        project.edit(fall, fall, "A box falls", "A box that falls");
        project.edit(fall, fall, "\"trimesh\"]", "]");
    });
    let made_with = project.read("b/fall/made_with.json");
    let processor = made_with.lines().find(|l| l.contains("\"processor\""));
    let other = "\"processor\": \"Another One\",";
    let file = "b/fall/made_with.json";
    project.edit(file, file, processor.unwrap().trim(), other);
    let said = project.succeeds(&["compare", "a", "b"]);
    assert!(
        said.contains("* processor: `") && said.contains("`Another One` in B"),
        "{said}"
    );
    assert!(
        said.contains("| summary | 200hz vps | query_us_mean | "),
        "{said}"
    );
    assert!(
        !said.contains("trimesh") && !said.contains("_max"),
        "{said}"
    );

    let csv = project.succeeds(&["compare", "a", "b", "--csv"]);
    let summaries = ["a", "b"].map(|f| project.read(&format!("{f}/fall/summary.csv")));
    let means = column(&csv, "column");
    let means = means
        .iter()
        .enumerate()
        .filter(|(_, c)| **c == "query_us_mean");
    let means: Vec<_> = means.map(|(i, _)| i).collect();
    assert_eq!(means.len(), NAMES.len() - 1);
    let number = |text: &str| text.parse::<f64>().unwrap();
    for (at, row) in means.into_iter().enumerate() {
        assert_eq!(column(&csv, "row")[row], format!("200hz {}", NAMES[at]));
        let [a, b] = [0, 1].map(|i| number(column(&summaries[i], "query_us_mean")[at]));
        assert_eq!(number(column(&csv, "a")[row]), a);
        assert_eq!(number(column(&csv, "b")[row]), b);
        assert_eq!(number(column(&csv, "b_by_a")[row]), b / a);
    }
}

#[test]
fn runs_that_differ_are_not_compared() {
    let fall = "experiments/fall.toml";
    let algorithms = "experiments/algorithms.toml";
    let project = Project::new("compare-other");
    run_both(&project, || {
        project.edit(fall, fall, "friction = 0.5", "friction = 0.4");
    });
    let expected = [
        "fall cannot be compared: drop.friction is 0.5 in A and 0.4",
        "in B",
    ];
    project.fails(2, &["compare", "a", "b"], &expected);

    run_both(&project, || {
        project.edit(algorithms, algorithms, "points = 800", "points = 700");
    });
    let expected = ["200hz.vps is not the same in A and B: its model, its algorithm's parameters"];
    project.fails(2, &["compare", "a", "b"], &expected);

    project.succeeds(&["run", "fall", "--out", "b"]);
    let expected = ["A is a quick run and B a whole one"];
    project.fails(2, &["compare", "a", "b"], &expected);

    std::fs::create_dir(project.path("empty")).unwrap();
    let expected = ["no experiment was run in both a and empty"];
    project.fails(2, &["compare", "a", "empty"], &expected);
    project.fails(2, &["compare", "a", "none"], &["none: ", "No such file"]);
}
