//! The page of an experiment: the tables it shows, and where its figures go.

use std::path::Path;

use polars::prelude::DataFrame;

use crate::config::algorithms::Algorithms;
use crate::data::dataframe::{Row, rows_of};
use crate::data::tables::Tables;
use crate::error::Error;
use crate::figures::figure::Figure;
use crate::report::document::{Block, FigureLink, Table};

/// The page of an experiment.
pub(crate) struct Page<'p> {
    pub(crate) tables: &'p Tables,
    pub(crate) algorithms: &'p Algorithms,
    /// The folder of the experiment, which figures are written into.
    pub(crate) folder: &'p Path,
}

impl<'p> Page<'p> {
    /// The table of a name, or an error that names it.
    pub(crate) fn table(&self, name: &str) -> Result<&'p DataFrame, String> {
        let table = self.tables.get(name);
        table.ok_or_else(|| format!("no table `{name}`"))
    }

    /// The label of an algorithm in `algorithms.toml`.
    pub(crate) fn label(&self, algorithm: &str) -> Result<&'p str, String> {
        Ok(&self.algorithms.get(algorithm)?.label)
    }

    /// Writes a figure as `stem.svg` and `stem.png`, and links to it.
    pub(crate) fn figure(&self, stem: &str, figure: &Figure) -> Result<Block, Error> {
        figure.write(self.folder, stem)?;
        Ok(Block::Figure(FigureLink {
            file: format!("{stem}.svg"),
            caption: figure.title.clone(),
        }))
    }

    /// A row for each algorithm and a column for each case, which is a head and a name in the table
    /// `summary`; a dash where that has no row.
    pub(crate) fn by_case(
        &self,
        caption: &str,
        algorithms: &[String],
        cases: &[(String, String)],
        cell: impl Fn(&Row<'_>) -> String,
    ) -> Result<Block, Error> {
        let summary = self.table("summary")?;
        let heads = cases.iter().map(|(head, _)| head.as_str());
        let head: Vec<_> = ["algorithm"].into_iter().chain(heads).collect();
        let mut table = Table::new(caption, &head);
        for name in algorithms {
            let cells = cases.iter().map(|(_, case)| {
                let row = rows_of(summary, case, name).next();
                row.map_or_else(|| "–".into(), |row| cell(&row))
            });
            table.push([self.label(name)?.to_owned()].into_iter().chain(cells));
        }
        Ok(Block::Table(table))
    }
}
