//! Records are kept as long as their inputs are the same.

use std::fs;

use crate::project::{Project, STEPS, column};

#[test]
fn records_are_kept_until_an_input_changes() {
    let project = Project::new("resume");
    project.succeeds(&["run", "fall", "--quick"]);
    let runs = |expected: &str| {
        let said = project.succeeds(&["run", "fall", "--quick"]);
        assert!(said.contains(expected), "{expected}: {said}");
    };
    let summary = project.read("reports/fall/summary.csv");
    runs("0 jobs run, 4 kept");
    assert_eq!(project.read("reports/fall/summary.csv"), summary);

    // A run that was ended in the middle: of two jobs one has no record, one not even rows.
    let raw = project.files("reports/fall/raw", "json");
    fs::remove_file(&raw[0]).unwrap();
    fs::remove_file(&raw[1]).unwrap();
    fs::remove_file(raw[1].with_extension("csv")).unwrap();
    let expected = ["200hz.hull.0 is run again: ", "200hz.hull.0.json: missing"];
    let said = project.warns(&["run", "fall", "--quick"], &expected);
    assert!(said.contains("2 jobs run, 2 kept"), "{said}");

    // Presentation and claims change no job.
    let fall = "experiments/fall.toml";
    project.edit(fall, fall, "measured_s = [0.4", "measured_s = [0.3");
    project.edit(fall, fall, "A box falls", "A box that falls");
    runs("0 jobs run, 4 kept");
    let queries = project.read("reports/fall/summary.csv");
    assert_eq!(column(&queries, "queries"), ["60"; 4]);

    // An algorithm's parameter changes its own jobs, and those of the algorithms like it.
    let algorithms = "experiments/algorithms.toml";
    project.edit(algorithms, algorithms, "segments = 2", "segments = 3");
    runs("1 jobs run, 3 kept");
    project.edit(algorithms, algorithms, "points = 800", "points = 700");
    runs("2 jobs run, 2 kept");

    // The world, and the bytes of the model, change all.
    project.edit(fall, fall, "friction = 0.5", "friction = 0.4");
    runs("4 jobs run, 0 kept");
    project.edit("box.obj", "box.obj", "v -0.1 -0.05", "v -0.11 -0.05");
    runs("4 jobs run, 0 kept");
}

#[test]
fn a_filter_runs_what_it_names() {
    let project = Project::new("filter");
    let run = |filter: &str| project.succeeds(&["run", "fall", "--filter", filter]);
    let said = run("/200hz.hull.");
    assert!(
        said.contains("2 jobs run, 0 kept, 6 left to others"),
        "{said}"
    );
    assert!(!project.path("reports/fall/made_with.json").exists());
    let said = run(".1");
    assert!(
        said.contains("3 jobs run, 2 kept, 3 left to others"),
        "{said}"
    );
    let said = run("");
    assert!(said.contains("3 jobs run, 5 kept, tables in"), "{said}");
    assert!(project.path("reports/fall/made_with.json").exists());
}

#[test]
fn a_job_with_a_damaged_record_is_run_again_and_that_is_said() {
    let project = Project::new("broken");
    let quick = ["run", "fall", "--quick"];
    project.succeeds(&quick);
    let again = |expected: &str| {
        let job = "fall/200hz.hull.0 is run again: ";
        let said = project.warns(&quick, &[job, expected]);
        assert!(said.contains("1 jobs run, 3 kept"), "{said}");
        let said = project.succeeds(&quick);
        assert!(said.contains("0 jobs run, 4 kept"), "{said}");
    };
    let json = "reports/fall/raw/200hz.hull.0.json";
    project.write(json, "{ \"job\": ");
    again("200hz.hull.0.json: EOF");
    // Rows that are cut at the end of a line, none at all, and one digit that is another.
    let csv = "reports/fall/raw/200hz.hull.0.csv";
    let cut = |rows: usize| {
        let text = project.read(csv);
        let lines = text.split_inclusive('\n').take(1 + rows);
        project.write(csv, &lines.collect::<String>());
    };
    cut(STEPS - 1);
    again("0.csv: 119 rows that are not the 120 that were written");
    cut(0);
    again("0.csv: 0 rows that are not the 120 that were written");
    let text = project.read(csv);
    let digit = text.rfind(|c: char| c.is_ascii_digit()).unwrap();
    let other = if text[digit..].starts_with('1') {
        "2"
    } else {
        "1"
    };
    let text = format!("{}{other}{}", &text[..digit], &text[digit + 1..]);
    project.write(csv, &text);
    again("0.csv: 120 rows that are not the 120 that were written");
    fs::remove_file(project.path(csv)).unwrap();
    again("0.csv: missing");
}

#[test]
fn of_two_runs_into_one_folder_the_second_refuses() {
    let project = Project::new("lock");
    let quick = ["run", "fall", "--quick"];
    project.succeeds(&quick);
    let lock = project.path("reports/fall/raw/.lock");
    // The lock of a process that has ended does not keep others out.
    fs::write(&lock, "4711\n").unwrap();
    let file = fs::File::open(&lock).unwrap();
    file.try_lock().unwrap();
    let expected = ["raw: another run writes there (process 4711)", "--out"];
    project.fails(2, &quick, &expected);
    let elsewhere = [&quick[..], &["--out", "other"]].concat();
    let said = project.succeeds(&elsewhere);
    assert!(said.contains("4 jobs run, 0 kept"), "{said}");
    drop(file);
    let said = project.succeeds(&quick);
    assert!(said.contains("0 jobs run, 4 kept"), "{said}");
}
