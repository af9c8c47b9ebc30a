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
    pub(crate) fn new(case: impl Into<String>, algorithm: impl Into<String>, seed: u32) -> Self {
        Self {
            case: case.into(),
            algorithm: algorithm.into(),
            seed,
        }
    }

    /// Every algorithm in every case from every seed, seed by seed.
    pub(crate) fn of_all(seeds: u32, cases: &[String], algorithms: &[String]) -> Vec<Self> {
        let mut jobs = Vec::new();
        for seed in 0..seeds {
            for case in cases {
                jobs.extend(algorithms.iter().map(|a| Self::new(case, a, seed)));
            }
        }
        jobs
    }

    /// The one of `cases` whose name is the job's case.
    ///
    /// # Errors
    /// If none has that name.
    pub(crate) fn find_case<C, N: AsRef<str>>(
        &self,
        cases: impl IntoIterator<Item = C>,
        name: impl Fn(&C) -> N,
    ) -> Result<C, String> {
        let mut cases = cases.into_iter();
        let case = cases.find(|case| name(case).as_ref() == self.case);
        case.ok_or_else(|| format!("no case `{}`", self.case))
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
