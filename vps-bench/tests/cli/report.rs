//! The report and the verdicts.

use std::fs;
use std::time::SystemTime;

use crate::project::Project;

fn changed(project: &Project, name: &str) -> SystemTime {
    fs::metadata(project.path(name))
        .unwrap()
        .modified()
        .unwrap()
}

#[test]
fn the_report_is_made_from_the_tables_alone() {
    let project = Project::new("report");
    project.succeeds(&["run", "fall", "--quick"]);
    fs::remove_dir_all(project.path("reports/fall/raw")).unwrap();
    project.succeeds(&["report"]);
    for name in ["query_time", "linear_velocity"] {
        for extension in ["svg", "png"] {
            let path = project.path(&format!("reports/fall/{name}.{extension}"));
            assert!(path.metadata().unwrap().len() > 1000);
        }
    }
    let report = project.read("reports/report.md");
    for part in [
        "## Claims",
        "**holds**",
        "| VPS |",
        "fall/query_time.svg",
        "fall/summary.csv",
    ] {
        assert!(report.contains(part), "{part} is missing");
    }
    let html = project.read("reports/report.html");
    for part in [
        "VPS &lt;L = 2&gt;",
        "<code>contacts</code> &amp; others",
        "A box is &lt;simple&gt;.",
        "data:image/svg+xml;base64,",
        "href=\"fall/summary.csv\"",
        "run fall --quick",
        "id=\"fall\"",
    ] {
        assert!(html.contains(part), "{part} is missing");
    }
    // Nothing is loaded from elsewhere.
    for part in ["src=\"http", "href=\"http", "<script", "url("] {
        assert!(!html.contains(part), "{part} is there");
    }
    // The same tables give the same bytes.
    project.succeeds(&["report"]);
    assert_eq!(project.read("reports/report.md"), report);
    assert_eq!(project.read("reports/report.html"), html);
}

#[test]
fn tables_are_put_into_another_file_and_checked() {
    let project = Project::new("splice");
    project.succeeds(&["run", "fall", "--quick"]);
    project.write("page.md", "a <!-- fall -->old<!-- /fall --> b");
    let check = ["report", "--splice", "page.md", "--check"];
    let stale = ["page.md: ", "run `vps-bench report --splice page.md`"];
    // Checking writes nothing.
    project.fails(1, &check, &stale);
    assert!(!project.path("reports/report.md").exists());
    assert!(project.files("reports/fall", "svg").is_empty());
    assert_eq!(
        project.read("page.md"),
        "a <!-- fall -->old<!-- /fall --> b"
    );

    project.succeeds(&["report", "--splice", "page.md"]);
    let page = project.read("page.md");
    assert!(page.starts_with("a <!-- fall -->") && page.ends_with("<!-- /fall --> b"));
    assert!(page.contains("| VPS <L = 2> |") && !page.contains("old"));

    let files = [
        "page.md",
        "reports/report.md",
        "reports/fall/query_time.svg",
    ];
    let before = files.map(|name| changed(&project, name));
    project.succeeds(&check);
    assert_eq!(files.map(|name| changed(&project, name)), before);

    // A report that is not that of the tables, and a file without the marks.
    project.edit(
        "reports/report.md",
        "reports/report.md",
        "A box falls",
        "It falls",
    );
    project.fails(1, &check, &["reports/report.md: "]);
    project.succeeds(&["report"]);
    project.write("page.md", "nothing");
    let marks = ["page.md: ", "<!-- fall -->"];
    project.fails(2, &["report", "--splice", "page.md"], &marks);
}

#[test]
fn a_claim_that_turns_out_otherwise_fails_the_check() {
    let project = Project::new("check");
    project.succeeds(&["run", "fall"]);
    let said = project.succeeds(&["check"]);
    assert!(
        said.contains("fall/stays_above: holds: 0 (at most 0)"),
        "{said}"
    );
    let fall = "experiments/fall.toml";
    project.edit(fall, fall, "at_most = 0", "at_least = 1");
    let expected = ["fall/stays_above: does not hold, but holds was expected"];
    project.fails(1, &["check"], &expected);
    project.succeeds(&["report"]);
    let html = project.read("reports/report.html");
    assert!(html.contains("does not hold") && html.contains("otherwise than expected"));
    // A claim that the project expects not to hold does not fail.
    project.edit(
        fall,
        fall,
        "expect = \"holds\"",
        "expect = \"does_not_hold\"",
    );
    project.succeeds(&["check"]);
    // Of few starts nothing is claimed.
    project.edit(
        fall,
        fall,
        "expect = \"does_not_hold\"",
        "expect = \"holds\"",
    );
    let said = project.succeeds(&["reproduce", "--quick", "--out", "quick"]);
    assert!(
        said.contains("does not hold") && said.contains("a quick run"),
        "{said}"
    );
    project.fails(1, &["reproduce"], &expected);
}
