//! What a report says, before it becomes Markdown or HTML.

use crate::claims::Verdict;

/// The part of a report on one experiment.
pub(crate) struct Section {
    /// Of the experiment; also the folder of its files.
    pub(crate) name: String,
    pub(crate) title: String,
    pub(crate) paper: String,
    pub(crate) question: String,
    /// Whether few starts were run.
    pub(crate) is_quick: bool,
    pub(crate) misleads: String,
    pub(crate) blocks: Vec<Block>,
    pub(crate) verdicts: Vec<Verdict>,
    /// Arguments of the command that makes it again.
    pub(crate) command: String,
    /// What was run and on what, one sentence each.
    pub(crate) made_with: Vec<String>,
    /// The CSV files beside it.
    pub(crate) files: Vec<String>,
}

/// What is said of a quick run.
pub(crate) const QUICK: &str =
    "A quick run of few starts: numbers are rough, verdicts do not count.";

/// A piece of a section.
pub(crate) enum Block {
    /// A paragraph of plain text.
    Text(String),
    Table(Table),
    Figure(FigureLink),
}

/// A table of text.
#[derive(Clone, Debug)]
pub(crate) struct Table {
    /// What it shows, in a line.
    pub(crate) caption: String,
    pub(crate) head: Vec<String>,
    pub(crate) rows: Vec<Vec<String>>,
}

/// A figure that was written as `stem.svg` or `stem.png` into the folder of the experiment.
#[derive(Clone, Debug)]
pub(crate) struct FigureLink {
    pub(crate) file: String,
    pub(crate) caption: String,
}

impl Table {
    pub(crate) fn new(caption: impl Into<String>, head: &[&str]) -> Self {
        Self {
            caption: caption.into(),
            head: head.iter().map(|h| (*h).to_owned()).collect(),
            rows: Vec::new(),
        }
    }

    /// Adds a row with as many cells as there are heads.
    pub(crate) fn push(&mut self, cells: impl IntoIterator<Item = String>) {
        let row: Vec<_> = cells.into_iter().collect();
        debug_assert_eq!(row.len(), self.head.len());
        self.rows.push(row);
    }

    /// As Markdown, without the caption.
    pub(crate) fn markdown(&self) -> String {
        let line = |cells: &[String]| format!("| {} |\n", cells.join(" | ").replace('\n', " "));
        let rule = format!("|{}\n", "---|".repeat(self.head.len()));
        let rows: String = self.rows.iter().map(|row| line(row)).collect();
        line(&self.head) + &rule + &rows
    }
}

/// Digits in groups of three.
pub(crate) fn grouped(digits: &str) -> String {
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(' ');
        }
        text.push(digit);
    }
    text
}

/// Three significant digits; a dash for what is no number.
pub(crate) fn short(value: impl Into<Option<f64>>) -> String {
    match value.into() {
        // Less than the last digit that would be written.
        Some(value) if value.abs() < 5e-10 => "0".into(),
        Some(value) if value.is_finite() => {
            let magnitude = value.abs().max(1e-12).log10().floor() as i32;
            let digits = (2 - magnitude).clamp(0, 9) as usize;
            format!("{value:.digits$}")
        }
        _ => "–".into(),
    }
}

/// A value with a number of digits after the point; a dash for what is no number.
pub(crate) fn fixed(value: impl Into<Option<f64>>, digits: usize) -> String {
    match value.into() {
        Some(value) if value.is_finite() => format!("{value:.digits$}"),
        _ => "–".into(),
    }
}
