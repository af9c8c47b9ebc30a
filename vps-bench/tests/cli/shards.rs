//! Parts of an experiment on several machines.

use crate::project::{Project, column, copy_files};

/// Columns of times, which no two runs have in common.
fn holds_times(name: &str) -> bool {
    name.contains("_us") || name.ends_with("_s") && name != "linear_velocity_m_s"
}

/// Both tables must be the same except for times.
fn assert_same(a: &str, b: &str) {
    let heads = a.lines().next().unwrap();
    assert_eq!(heads, b.lines().next().unwrap());
    let compared = heads.split(',').filter(|name| !holds_times(name));
    let mut count = 0;
    for name in compared {
        assert!(column(a, name) == column(b, name), "{name} differs");
        count += 1;
    }
    assert!(count >= 4, "{heads}");
}

#[test]
fn shards_merged_by_copying_are_the_whole() {
    let project = Project::new("shards");
    project.succeeds(&["run", "fall", "--out", "whole"]);
    for (shard, out) in [("1/2", "first"), ("2/2", "second")] {
        let said = project.succeeds(&["run", "fall", "--shard", shard, "--out", out]);
        assert!(
            said.contains("4 jobs run, 0 kept, 4 left to others"),
            "{said}"
        );
        assert!(!project.path(out).join("fall/made_with.json").exists());
        let from = project.path(out).join("fall/raw");
        copy_files(&from, &project.path("merged/fall/raw"));
    }
    let said = project.succeeds(&["run", "fall", "--out", "merged"]);
    assert!(said.contains("0 jobs run, 8 kept, tables in"), "{said}");
    for table in ["jobs", "summary", "course"] {
        let read = |out: &str| project.read(&format!("{out}/fall/{table}.csv"));
        assert_same(&read("whole"), &read("merged"));
    }
}

#[test]
fn records_of_another_processor_are_refused() {
    let project = Project::new("machine");
    project.succeeds(&["run", "fall", "--quick"]);
    let made_with = project.read("reports/fall/made_with.json");
    let line = made_with.lines().find(|l| l.contains("\"processor\""));
    let other = "\"processor\": \"Another One\",";
    let record = "reports/fall/raw/200hz.hull.0.json";
    project.edit(record, record, line.unwrap().trim(), other);
    let expected = [
        "200hz.vps.0 and 200hz.hull.0 cannot stand in one table",
        "processor is `",
        "`Another One`",
    ];
    project.fails(2, &["run", "fall", "--quick"], &expected);
}

#[test]
fn a_part_is_reproduced_without_a_report() {
    let project = Project::new("part");
    let said = project.succeeds(&["reproduce", "--shard", "1/2"]);
    assert!(said.contains("4 left to others"), "{said}");
    assert!(!project.path("reports/report.md").exists());
    project.succeeds(&["reproduce", "--shard", "2/2"]);
    assert!(project.path("reports/report.md").exists());
}
