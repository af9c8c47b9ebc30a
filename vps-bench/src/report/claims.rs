//! Claims of the paper, and of this project, judged from the tables of an experiment.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::data::dataframe::rows;
use crate::data::number_format::{fixed, significant};
use crate::data::tables::Tables;

/// A statement that a value, or the ratio of two, lies in a range.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Claim {
    pub(crate) name: String,
    /// The statement.
    pub(crate) says: String,
    /// Its source in the paper; empty for claims of this project.
    #[serde(default)]
    pub(crate) source: String,
    /// The number printed in the paper, comparable to the measured one.
    pub(crate) paper: Option<f64>,
    #[serde(default)]
    pub(crate) unit: String,
    /// The measured value; without it the claim is not comparable.
    pub(crate) value: Option<Cell>,
    /// The divisor, for a claim about a ratio.
    pub(crate) against: Option<Cell>,
    pub(crate) at_least: Option<f64>,
    pub(crate) at_most: Option<f64>,
    /// The expected outcome: `check` fails on any other.
    pub(crate) expect: Outcome,
    /// The reason why it does not hold or is not comparable.
    #[serde(default)]
    pub(crate) why: String,
}

/// A value in a table.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Cell {
    pub(crate) table: String,
    /// Columns and their values, which must match exactly one row.
    pub(crate) row: BTreeMap<String, String>,
    pub(crate) column: String,
}

#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Outcome {
    Holds,
    DoesNotHold,
    NotComparable,
}

/// A judged claim.
#[derive(Clone, Debug)]
pub(crate) struct Verdict {
    pub(crate) claim: Claim,
    pub(crate) measured: Option<f64>,
    pub(crate) outcome: Outcome,
}

impl Outcome {
    /// In words.
    pub(crate) fn text(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::DoesNotHold => "does not hold",
            Self::NotComparable => "not comparable",
        }
    }
}

impl Claim {
    /// Checks that the claim can be judged.
    pub(crate) fn check(&self) -> Result<(), String> {
        let has_range = self.at_least.is_some() || self.at_most.is_some();
        match &self.value {
            None if self.expect != Outcome::NotComparable => {
                Err(format!("claim `{}`: value is missing", self.name))
            }
            None if self.why.is_empty() => Err(format!("claim `{}`: why is missing", self.name)),
            Some(_) if !has_range => Err(format!(
                "claim `{}`: at_least or at_most is missing",
                self.name
            )),
            _ => Ok(()),
        }
    }

    /// Judges the claim; without its values in the tables it is not comparable.
    pub(crate) fn judge(&self, tables: &Tables) -> Verdict {
        let measured = self.value.as_ref().and_then(|value| {
            let value = value.read(tables)?;
            match &self.against {
                None => Some(value),
                Some(against) => Some(value / against.read(tables)?),
            }
        });
        let outcome = match measured {
            None => Outcome::NotComparable,
            Some(value) => {
                let fits = self.at_least.is_none_or(|least| value >= least)
                    && self.at_most.is_none_or(|most| value <= most);
                if fits {
                    Outcome::Holds
                } else {
                    Outcome::DoesNotHold
                }
            }
        };
        Verdict {
            claim: self.clone(),
            measured,
            outcome,
        }
    }

    /// A number with the unit of the claim; integers other than ratios, such as counts, without
    /// digits after the point.
    pub(crate) fn with_unit(&self, value: Option<f64>) -> String {
        let is_whole = self.against.is_none() && value.is_some_and(|v| v.fract() == 0.0);
        let text = if is_whole {
            fixed(value, 0)
        } else {
            significant(value)
        };
        if value.is_none() || self.unit.is_empty() {
            return text;
        }
        format!("{text} {}", self.unit)
    }

    /// The source in words.
    pub(crate) fn source_text(&self) -> &str {
        match self.source.as_str() {
            "" => "this project",
            source => source,
        }
    }

    /// The range in which the claim holds.
    pub(crate) fn range(&self) -> String {
        match (self.at_least, self.at_most) {
            (Some(least), Some(most)) => format!("{} to {}", significant(least), significant(most)),
            (Some(least), None) => format!("at least {}", significant(least)),
            (None, Some(most)) => format!("at most {}", significant(most)),
            (None, None) => "–".into(),
        }
    }
}

impl Cell {
    fn read(&self, tables: &Tables) -> Option<f64> {
        let mut found = rows(tables.get(&self.table)?).filter(|row| row.matches(&self.row));
        match (found.next(), found.next()) {
            (Some(row), None) => row.number(&self.column),
            _ => None,
        }
    }
}

impl Verdict {
    /// Whether the outcome is the expected one.
    pub(crate) fn is_as_expected(&self) -> bool {
        self.outcome == self.claim.expect
    }

    /// The stated reason; empty without one, and if the outcome is not the expected one.
    pub(crate) fn why(&self) -> &str {
        if self.is_as_expected() {
            &self.claim.why
        } else {
            ""
        }
    }
}

#[cfg(test)]
mod tests {
    use polars::df;

    use super::*;

    fn claim(text: &str) -> Claim {
        toml::from_str(text).unwrap()
    }

    #[test]
    fn claims_are_judged_by_their_range() {
        let table = df!("algorithm" => ["a", "b"], "query_us" => [2.0, 20.0]).unwrap();
        let tables = Tables::from([("summary".to_owned(), table)]);
        let ratio = |range: &str| {
            claim(&format!(
                "name = \"n\"\nsays = \"s\"\nexpect = \"holds\"\n{range}\n\
                 value = {{ table = \"summary\", row = {{ algorithm = \"b\" }}, column = \"query_us\" }}\n\
                 against = {{ table = \"summary\", row = {{ algorithm = \"a\" }}, column = \"query_us\" }}\n"
            ))
        };
        let judge = |range: &str| ratio(range).judge(&tables);
        assert_eq!(judge("at_least = 9").measured, Some(10.0));
        assert!(judge("at_least = 9").is_as_expected());
        assert_eq!(judge("at_least = 11").outcome, Outcome::DoesNotHold);
        assert_eq!(
            judge("at_least = 1\nat_most = 9").outcome,
            Outcome::DoesNotHold
        );
        assert!(ratio("").check().is_err());
        assert!(ratio("at_most = 1").check().is_ok());
        let missing = ratio("at_most = 1").judge(&Tables::new());
        assert_eq!(missing.outcome, Outcome::NotComparable);
    }

    #[test]
    fn counts_are_written_as_counts() {
        let text = "name = \"n\"\nsays = \"s\"\nexpect = \"holds\"\nunit = \"of 10\"";
        let of_ten = |value| claim(text).with_unit(value);
        assert_eq!(of_ten(Some(4.0)), "4 of 10");
        assert_eq!(of_ten(Some(0.5)), "0.500 of 10");
        assert_eq!(of_ten(None), "–");
    }
}
