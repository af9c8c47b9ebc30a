//! What the command prints, kept in `snapshots`. After a change look at the difference, and accept it
//! with `INSTA_UPDATE=always cargo test --release -p vps-bench --test cli messages`.

use insta::assert_snapshot;

use crate::project::Project;

/// A command line in a project and its output.
fn session(project: &Project, arguments: &str) -> String {
    let said = project.bench(&arguments.split_whitespace().collect::<Vec<_>>());
    let code = said.code.unwrap();
    format!(
        "$ vps-bench {arguments}\n{}{}[{code}]\n",
        said.out, said.errors
    )
}

#[test]
fn help() {
    let project = Project::new("messages-help");
    assert_snapshot!("help", session(&project, "--help"));
    for command in [
        "list",
        "fetch",
        "run",
        "report",
        "check",
        "compare",
        "reproduce",
    ] {
        let help = session(&project, &format!("{command} --help"));
        assert_snapshot!(format!("help_{command}"), help);
    }
}

/// The claim of the project counts bodies, so that its verdict holds no time.
#[test]
fn a_small_run_and_its_verdicts() {
    let project = Project::new("messages-run");
    let lines = ["list", "run fall", "run fall", "report", "check"];
    let text = lines.map(|line| session(&project, line)).concat();
    assert_snapshot!("small_run", text);
    let report = project.read("reports/report.md");
    let (claims, _) = report.split_once("\n## A box falls").unwrap();
    assert_snapshot!("claims_in_markdown", claims);
    let page = project.read("reports/report.html");
    let (_, claims) = page.split_once("<section id=\"all-claims\">").unwrap();
    let (claims, _) = claims.split_once("</section>").unwrap();
    // A tag a line, so that a difference is readable.
    assert_snapshot!("claims_in_html", claims.replace("><", ">\n<"));
}

#[test]
fn errors() {
    let project = Project::new("messages-errors");
    let fall = "experiments/fall.toml";
    for (name, old, new) in [
        ("key", "mass_kg", "weight"),
        ("value", "mass_kg = 1.0", "mass_kg = -1.0"),
        ("algorithm", "\"vps_l2\"", "\"vps_l9\""),
        ("range", "at_most = 0\n", ""),
    ] {
        project.edit(fall, &format!("experiments/{name}.toml"), old, new);
    }
    let lines = [
        "run missing",
        "run key",
        "run value",
        "run algorithm",
        "run range",
        "run fall --shard 3/2",
        "run fall --scale 2",
        "run fall --model none.obj",
        "report",
        "check fall",
        "compare a b",
    ];
    let text = lines.map(|line| session(&project, line)).concat();
    assert_snapshot!("errors", text);
}
