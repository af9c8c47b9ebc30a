//! Times and instructions in two folders of reports, such as those of two machines, as ratios.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use polars::prelude::{Column, DataFrame, DataType};
use serde::Serialize;
use serde_json::Value;

use crate::data::dataframe::rows;
use crate::data::number_format::significant;
use crate::error::Error;
use crate::report::document::Table;
use crate::report::results::Results;

/// Keys of an experiment's file that change no time: prose, presentation, and the number of jobs,
/// since only jobs in both folders are compared.
const NOT_COMPARED: [&str; 12] = [
    "order",
    "title",
    "paper",
    "question",
    "misleads",
    "claim",
    "show",
    "reference",
    "paper_value",
    "algorithms",
    "frequencies_hz",
    "quick_orientations",
];

/// One time or number of instructions in both folders.
#[derive(Serialize)]
pub(crate) struct Ratio {
    experiment: String,
    table: String,
    /// The text in its row.
    row: String,
    column: String,
    a: f64,
    b: f64,
    b_by_a: f64,
}

/// An experiment that was run in both folders.
pub(crate) struct Comparison {
    name: String,
    /// Differences of the two environments, a line each.
    differences: Vec<String>,
    ratios: Vec<Ratio>,
}

/// Compares every experiment that is in both folders.
///
/// # Errors
/// When there is none, or when the two runs differ in more than the environment; the error says
/// how.
pub(crate) fn compare(a: &Path, b: &Path) -> Result<Vec<Comparison>, Error> {
    let names = experiments(a)?;
    let mut comparisons = Vec::new();
    for name in names {
        if !experiments(b)?.contains(&name) {
            continue;
        }
        let both = [a, b].map(|folder| Results::read(&name, &folder.join(&name)));
        let [Ok(a), Ok(b)] = &both else {
            let error = both.into_iter().find_map(Result::err);
            return Err(error.unwrap_or_else(|| "cannot be read".into()));
        };
        if let Some(why) = difference(a, b) {
            return Err(format!("{name} cannot be compared: {why}").into());
        }
        let environment = &a.made_with.environment;
        comparisons.push(Comparison {
            differences: environment.differences(&b.made_with.environment),
            ratios: ratios(&name, a, b),
            name,
        });
    }
    if comparisons.is_empty() {
        let [a, b] = [a.display(), b.display()];
        return Err(format!("no experiment was run in both {a} and {b}").into());
    }
    Ok(comparisons)
}

/// Names of the experiments that were run.
fn experiments(folder: &Path) -> Result<Vec<String>, Error> {
    let read_error = |e| format!("{}: {e}", folder.display());
    let mut names = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(read_error)? {
        let path = entry?.path();
        if path.join("made_with.json").exists()
            && let Some(name) = path.file_name()
        {
            names.push(name.to_string_lossy().into_owned());
        }
    }
    names.sort();
    Ok(names)
}

/// Why two results are not of the same experiment.
fn difference(a: &Results, b: &Results) -> Option<String> {
    let size = |r: &Results| if r.made_with.quick { "quick" } else { "whole" };
    if size(a) != size(b) {
        return Some(format!("A is a {} run and B a {} one", size(a), size(b)));
    }
    let [of_a, of_b] = [a, b].map(|r| serde_json::to_value(&r.made_with.experiment));
    if let Some(difference) = unequal("", &of_a.ok()?, &of_b.ok()?) {
        return Some(difference);
    }
    // The files agree; models and algorithms they name may still differ.
    let [of_a, of_b] = [a, b].map(starts);
    let both = of_a
        .iter()
        .filter_map(|(label, a)| Some((label, a, of_b.get(label)?)));
    let mut differences = both.filter_map(|(label, a, b)| {
        if a.keys().ne(b.keys()) {
            let [a, b] = [a.len(), b.len()];
            return Some(format!(
                "{label} was started {a} times in A and {b} times in B"
            ));
        }
        let why = "its model, its algorithm's parameters or its settings differ";
        (a != b).then(|| format!("{label} is not the same in A and B: {why}"))
    });
    differences.next()
}

/// The first difference of two settings.
fn unequal(key: &str, a: &Value, b: &Value) -> Option<String> {
    let (Value::Object(of_a), Value::Object(of_b)) = (a, b) else {
        return (a != b).then(|| format!("{key} is {a} in A and {b} in B"));
    };
    let keys = of_a.keys().chain(of_b.keys());
    let mut keys = keys.filter(|key| !NOT_COMPARED.contains(&key.as_str()));
    keys.find_map(|inner| {
        let [a, b] = [of_a, of_b].map(|keys| keys.get(inner).unwrap_or(&Value::Null));
        let separator = if key.is_empty() { "" } else { "." };
        unequal(&format!("{key}{separator}{inner}"), a, b)
    })
}

/// The settings of jobs by seed, for each case and algorithm.
fn starts(results: &Results) -> BTreeMap<String, BTreeMap<String, String>> {
    let mut starts = BTreeMap::<_, BTreeMap<_, _>>::new();
    for row in results.tables.get("jobs").into_iter().flat_map(rows) {
        let label = format!("{}.{}", row.text("case"), row.text("algorithm"));
        let settings = starts.entry(label).or_default();
        settings.insert(row.text("seed"), row.text("settings"));
    }
    starts
}

/// The ratios that differ from 1 by more than a percentage, a line each.
pub(crate) fn beyond(comparisons: &[Comparison], percent: f64) -> Vec<String> {
    let ratios = comparisons.iter().flat_map(Comparison::shown);
    let ratios = ratios.filter(|r| (100.0 * (r.b_by_a - 1.0)).abs() > percent);
    let line = |r: &Ratio| {
        let change = 100.0 * (r.b_by_a - 1.0);
        format!(
            "{}: {}: {} is {} in A and {} in B: {change:+.2} %",
            r.experiment, r.row, r.column, r.a, r.b
        )
    };
    ratios.map(line).collect()
}

/// The ratios of all costs whose rows are in both.
fn ratios(name: &str, a: &Results, b: &Results) -> Vec<Ratio> {
    let mut ratios = Vec::new();
    for (table, of_a) in a.tables.iter().filter(|(table, _)| *table != "jobs") {
        let of_b = b.tables.get(table).and_then(costs);
        let (Some(of_a), Some(of_b)) = (costs(of_a), of_b) else {
            continue;
        };
        for ((row, column), a) in of_a {
            let same = |(other, _): &&((String, String), f64)| other.0 == row && other.1 == column;
            if let Some((_, b)) = of_b.iter().find(same) {
                ratios.push(Ratio {
                    experiment: name.into(),
                    table: table.clone(),
                    row,
                    column,
                    a,
                    b: *b,
                    b_by_a: b / a,
                });
            }
        }
    }
    ratios
}

/// The times and instructions of a table by the text of their row and by column; `None` if several
/// rows have the same text, as in a course over time.
fn costs(table: &DataFrame) -> Option<Vec<((String, String), f64)>> {
    let is_text = |column: &&Column| column.dtype() == &DataType::String;
    let is_cost = |name: &str| {
        name.split('_')
            .any(|part| ["ns", "us", "ms", "instructions"].contains(&part))
    };
    let (texts, numbers): (Vec<_>, Vec<_>) = table.columns().iter().partition(is_text);
    let mut costs = Vec::new();
    let mut known = BTreeSet::new();
    for row in rows(table) {
        let text: Vec<_> = texts.iter().map(|c| row.text(c.name())).collect();
        let text = text.join(" ");
        if !known.insert(text.clone()) {
            return None;
        }
        for column in numbers
            .iter()
            .map(|c| c.name())
            .filter(|name| is_cost(name))
        {
            if let Some(cost) = row.number(column).filter(|cost| *cost > 0.0) {
                costs.push(((text.clone(), column.to_string()), cost));
            }
        }
    }
    Some(costs)
}

/// For people: a Markdown table for each experiment.
pub(crate) fn text(comparisons: &[Comparison]) -> String {
    let mut text = String::new();
    for comparison in comparisons {
        text += &format!("## {}\n\n", comparison.name);
        for difference in &comparison.differences {
            text += &format!("* {difference}\n");
        }
        if comparison.differences.is_empty() {
            text += "* the same processor, compiler and program\n";
        }
        text += &format!("\n{}\n", comparison.table().markdown());
    }
    text
}

/// For machines: a CSV row for each ratio.
pub(crate) fn csv(comparisons: &[Comparison]) -> Result<String, Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for ratio in comparisons.iter().flat_map(|c| &c.ratios) {
        writer.serialize(ratio)?;
    }
    Ok(String::from_utf8(
        writer.into_inner().map_err(|e| e.to_string())?,
    )?)
}

impl Comparison {
    /// Extremes are left out: they depend more on the system than on the algorithm.
    fn shown(&self) -> impl Iterator<Item = &Ratio> {
        let is_extreme = |r: &&Ratio| r.column.ends_with("_min") || r.column.ends_with("_max");
        self.ratios.iter().filter(move |r| !is_extreme(r))
    }

    fn table(&self) -> Table {
        let head = ["table", "row", "column", "A", "B", "B / A"];
        let mut table = Table::new("B against A", &head);
        for ratio in self.shown() {
            table.push([
                ratio.table.clone(),
                ratio.row.clone(),
                ratio.column.clone(),
                significant(ratio.a),
                significant(ratio.b),
                significant(ratio.b_by_a),
            ]);
        }
        table
    }
}

#[cfg(test)]
mod tests {
    use polars::df;
    use serde_json::json;

    use super::*;

    #[test]
    fn settings_that_differ_are_named() {
        let a = json!({ "title": "a", "drop": { "friction": 0.5, "show": [1], "to": [1, 2] } });
        let b = json!({ "title": "b", "drop": { "friction": 0.5, "show": [2], "to": [1, 2] } });
        assert_eq!(unequal("", &a, &b), None);
        let c = json!({ "drop": { "friction": 0.5, "to": [1, 3] } });
        let expected = "drop.to is [1,2] in A and [1,3] in B";
        assert_eq!(unequal("", &a, &c).unwrap(), expected);
        let d = json!({ "rest": {} });
        assert!(
            unequal("", &d, &a)
                .unwrap()
                .starts_with("rest is {} in A and null")
        );
    }

    #[test]
    fn costs_are_those_of_rows_told_apart_by_text() {
        let table = df!(
            "case" => ["x", "x"], "algorithm" => ["a", "b"], "query_us_mean" => [Some(1.5), None],
            "fell" => [1.0, 2.0], "linear_velocity_m_s" => [1.0, 2.0],
            "instructions" => [None, Some(7.0)]
        );
        let key = ("x a".to_owned(), "query_us_mean".to_owned());
        let instructions = (("x b".to_owned(), "instructions".to_owned()), 7.0);
        assert_eq!(costs(&table.unwrap()).unwrap(), [(key, 1.5), instructions]);
        let course = df!("algorithm" => ["a", "a"], "step" => [1.0, 2.0], "query_us" => [1.0, 2.0]);
        assert!(costs(&course.unwrap()).is_none());
    }
}
