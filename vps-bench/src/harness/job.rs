//! Job identifiers and shards.

use serde::{Deserialize, Serialize};

/// One algorithm in one case of an experiment, started from one seed.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub(crate) struct Job {
    /// The case, such as a frequency; like the algorithm a part of the file name.
    pub(crate) case: String,
    pub(crate) algorithm: String,
    pub(crate) seed: u32,
}

impl Job {
    /// One job for each algorithm.
    pub(crate) fn of_each<'a>(
        algorithms: impl IntoIterator<Item = &'a String>,
        case: String,
        seed: u32,
    ) -> impl Iterator<Item = Self> {
        algorithms.into_iter().map(move |algorithm| Self {
            case: case.clone(),
            algorithm: algorithm.clone(),
            seed,
        })
    }

    /// The identifier of the job in its experiment.
    pub(crate) fn id(&self) -> String {
        format!("{}.{}.{}", self.case, self.algorithm, self.seed)
    }
}

/// A part of all jobs: every `count`-th job, from the `index`-th on, counted from 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Shard {
    index: usize,
    count: usize,
}

impl Shard {
    /// The only shard, of all jobs.
    pub(crate) const WHOLE: Self = Self { index: 1, count: 1 };

    /// The number of the shard, from 1.
    pub(crate) fn index(self) -> usize {
        self.index
    }

    /// Whether the job of a number, from 0, belongs to the shard.
    pub(crate) fn contains(self, job: usize) -> bool {
        job % self.count == self.index - 1
    }
}

impl std::str::FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text.split_once('/');
        let numbers = parts.and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
        match numbers {
            Some((index, count)) if 1 <= index && index <= count => Ok(Self { index, count }),
            _ => Err(format!(
                "`{text}` is not like 2/3, the second of three parts"
            )),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_share_all_jobs() {
        let shards: Vec<Shard> = ["1/3", "2/3", "3/3"].map(|s| s.parse().unwrap()).into();
        for job in 0..20 {
            assert_eq!(shards.iter().filter(|s| s.contains(job)).count(), 1);
            assert!(Shard::WHOLE.contains(job));
        }
        for wrong in ["0/3", "4/3", "1", "1/0", "a/b", "1/3/3"] {
            assert!(wrong.parse::<Shard>().is_err(), "{wrong}");
        }
    }
}
