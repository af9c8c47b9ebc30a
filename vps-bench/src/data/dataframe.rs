//! Dataframes, from CSV files and back.

use std::path::{Path, PathBuf};

use polars::prelude::*;
use serde::Serialize;
use vps_build::{FileError, write_atomically};

/// Why a dataframe cannot be read or written.
#[derive(Debug, thiserror::Error)]
pub(crate) enum DataFrameError {
    #[error("{}: {source}", path.display())]
    Csv { path: PathBuf, source: csv::Error },
    #[error("{}: {source}", path.display())]
    Polars { path: PathBuf, source: PolarsError },
    #[error(transparent)]
    File(#[from] FileError),
}

/// Columns of text by name, as they come from a file.
#[derive(Default)]
pub(crate) struct Columns {
    names: Vec<String>,
    values: Vec<Vec<String>>,
}

impl Columns {
    /// Appends the rows of a CSV file, behind the constant columns `same`.
    ///
    /// # Errors
    /// When its columns are not those of the files before.
    pub(crate) fn append(
        &mut self,
        path: &Path,
        same: &[(&str, String)],
    ) -> Result<(), DataFrameError> {
        let csv_error = |source| DataFrameError::Csv {
            path: path.into(),
            source,
        };
        let reader = csv::Reader::from_path(path).map_err(csv_error)?;
        self.append_all(reader, same).map_err(csv_error)
    }

    fn append_all(
        &mut self,
        mut reader: csv::Reader<impl std::io::Read>,
        same: &[(&str, String)],
    ) -> csv::Result<()> {
        let own = reader.headers()?.clone();
        let fixed = same.iter().map(|(name, _)| (*name).to_owned());
        let names: Vec<_> = fixed.chain(own.iter().map(String::from)).collect();
        if self.names.is_empty() {
            self.values = names.iter().map(|_| Vec::new()).collect();
            self.names = names;
        } else if self.names != names {
            let what = format!("has columns {names:?}, the others {:?}", self.names);
            return Err(std::io::Error::other(what).into());
        }
        for record in reader.records() {
            let record = record?;
            let fixed = same.iter().map(|(_, value)| value.as_str());
            for (column, value) in self.values.iter_mut().zip(fixed.chain(&record)) {
                column.push(value.to_owned());
            }
        }
        Ok(())
    }

    /// A dataframe; columns of nothing but numbers become numeric, empty fields missing values.
    pub(crate) fn into_dataframe(self) -> PolarsResult<DataFrame> {
        let rows = self.values.first().map_or(0, Vec::len);
        let columns = self.names.into_iter().zip(self.values);
        let columns = columns.map(|(name, values)| column(&name, &values));
        DataFrame::new(rows, columns.collect())
    }
}

fn column(name: &str, values: &[String]) -> Column {
    let number = |text: &String| {
        if text.is_empty() {
            Some(None)
        } else {
            text.parse::<f64>().ok().map(Some)
        }
    };
    let numbers: Option<Vec<Option<f64>>> = values.iter().map(number).collect();
    match numbers {
        Some(numbers) => Column::new(name.into(), numbers),
        None => Column::new(name.into(), values),
    }
}

/// A dataframe of rows; fields become columns of the same name.
pub(crate) fn of<R: Serialize>(
    rows: impl IntoIterator<Item = R>,
) -> Result<DataFrame, Box<dyn std::error::Error>> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows {
        writer.serialize(row)?;
    }
    let bytes = writer.into_inner()?;
    let mut columns = Columns::default();
    columns.append_all(csv::Reader::from_reader(&*bytes), &[])?;
    Ok(columns.into_dataframe()?)
}

/// Reads a CSV file.
pub(crate) fn read(path: &Path) -> Result<DataFrame, DataFrameError> {
    let mut columns = Columns::default();
    columns.append(path, &[])?;
    columns
        .into_dataframe()
        .map_err(|source| DataFrameError::Polars {
            path: path.into(),
            source,
        })
}

/// Writes a CSV file; all columns must be numbers or text.
pub(crate) fn write(path: &Path, dataframe: &DataFrame) -> Result<(), DataFrameError> {
    let csv_error = |source| DataFrameError::Csv {
        path: path.into(),
        source,
    };
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer
        .write_record(dataframe.get_column_names().into_iter().map(|n| n.as_str()))
        .map_err(csv_error)?;
    for row in 0..dataframe.height() {
        let fields = dataframe.columns().iter().map(|c| text(c, row));
        writer.write_record(fields).map_err(csv_error)?;
    }
    let bytes = writer
        .into_inner()
        .map_err(|e| csv_error(e.into_error().into()))?;
    Ok(write_atomically(path, &bytes)?)
}

/// A value as text; empty if missing.
fn text(column: &Column, row: usize) -> String {
    match column.get(row) {
        Ok(AnyValue::Null) | Err(_) => String::new(),
        Ok(AnyValue::Float64(value)) => format!("{value}"),
        Ok(value) => value.str_value().into_owned(),
    }
}

/// The rows of a dataframe.
pub(crate) fn rows(dataframe: &DataFrame) -> impl Iterator<Item = Row<'_>> {
    (0..dataframe.height()).map(|index| Row { dataframe, index })
}

/// The rows of one case and one algorithm.
pub(crate) fn rows_of<'f>(
    dataframe: &'f DataFrame,
    case: &str,
    algorithm: &str,
) -> impl Iterator<Item = Row<'f>> {
    rows(dataframe).filter(move |r| r.text("case") == case && r.text("algorithm") == algorithm)
}

/// A row of a dataframe.
#[derive(Clone, Copy)]
pub(crate) struct Row<'f> {
    dataframe: &'f DataFrame,
    index: usize,
}

impl<'f> Row<'f> {
    /// The number in a column; `None` if there is none.
    pub(crate) fn number(&self, column: &str) -> Option<f64> {
        let values = self.dataframe.column(column).ok()?;
        values.get(self.index).ok()?.try_extract::<f64>().ok()
    }

    /// The value in a column as text; empty if there is none.
    pub(crate) fn text(&self, column: &str) -> String {
        let values = self.dataframe.column(column);
        values.map_or_else(|_| String::new(), |values| text(values, self.index))
    }

    /// Whether columns hold the wanted values.
    pub(crate) fn matches<'c>(
        &self,
        wanted: impl IntoIterator<Item = (&'c String, &'c String)>,
    ) -> bool {
        wanted
            .into_iter()
            .all(|(column, value)| self.text(column) == *value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dataframe_survives_its_file() {
        let folder = std::env::temp_dir().join(format!("vps-dataframe-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let (a, b) = (folder.join("a.csv"), folder.join("b.csv"));
        let dataframe = df!("what" => ["x", "y, z"], "n" => [Some(1.5), None], "m" => [1.0, 2e-9]);
        let dataframe = dataframe.unwrap();
        write(&a, &dataframe).unwrap();
        let back = read(&a).unwrap();
        assert!(back.equals_missing(&dataframe), "{back}");
        let row = rows(&back).nth(1).unwrap();
        assert_eq!(row.text("what"), "y, z");
        assert_eq!((row.number("n"), row.number("m")), (None, Some(2e-9)));
        assert_eq!((row.number("what"), row.number("none")), (None, None));

        let mut columns = Columns::default();
        columns.append(&a, &[("job", "1".into())]).unwrap();
        columns.append(&a, &[("job", "2".into())]).unwrap();
        std::fs::write(&b, "other\n1\n").unwrap();
        assert!(columns.append(&b, &[("job", "3".into())]).is_err());
        let both = columns.into_dataframe().unwrap();
        assert_eq!(both.height(), 4);
        assert_eq!(rows(&both).nth(2).unwrap().number("job"), Some(2.0));
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
