//! The content of a report, before it becomes Markdown or HTML.

use crate::report::claims::Verdict;

/// The section of a report on one experiment.
pub(crate) struct Section {
    /// The name of the experiment, and of the folder of its files.
    pub(crate) name: String,
    pub(crate) title: String,
    pub(crate) paper: String,
    pub(crate) question: String,
    /// Whether the run was quick, with few starts.
    pub(crate) is_quick: bool,
    pub(crate) misleads: String,
    pub(crate) blocks: Vec<Block>,
    pub(crate) verdicts: Vec<Verdict>,
    /// Arguments of the command that reproduces it.
    pub(crate) command: String,
    /// Machine and versions, one sentence each.
    pub(crate) made_with: Vec<String>,
    /// The CSV files beside it.
    pub(crate) files: Vec<String>,
}

/// The note on a quick run.
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
    /// Its subject, in a line.
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

    /// Adds a row, which must have as many cells as the head.
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
