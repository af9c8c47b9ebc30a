//! Counting with callgrind.

use std::io::ErrorKind;
use std::process::Command;

use super::target::{Target, VERB};

/// Events of a run: instructions, reads and writes, and misses of these three in the first and in the
/// last level of the caches.
pub(super) struct Counts([u64; 9]);

impl Counts {
    pub(super) fn instructions(&self) -> u64 {
        self.0[0]
    }

    pub(super) fn first_level_misses(&self) -> u64 {
        self.0[3..6].iter().sum()
    }

    pub(super) fn last_level_misses(&self) -> u64 {
        self.0[6..].iter().sum()
    }
}

/// Counts a process of this program that executes every query of the target `times` times.
///
/// # Errors
/// If valgrind is not installed or fails.
pub(super) fn count(target: &Target, times: u32) -> Result<Counts, String> {
    let program = std::env::current_exe().map_err(|e| e.to_string())?;
    let target = serde_json::to_string(target).map_err(|e| e.to_string())?;
    let output = Command::new("valgrind")
        .args([
            "--tool=callgrind",
            "--cache-sim=yes",
            "--callgrind-out-file=/dev/null",
            // Nothing else of the process is counted.
            "--toggle-collect=*execute_in*",
        ])
        .arg(program)
        .args([VERB, &times.to_string(), &target])
        .output();
    let output = output.map_err(|error| match error.kind() {
        ErrorKind::NotFound => "unsupported: valgrind is not installed".into(),
        _ => format!("valgrind: {error}"),
    })?;
    let said = String::from_utf8_lossy(&output.stderr);
    let counts = said.lines().find_map(parse);
    let counts = counts.filter(|counts| output.status.success() && counts.instructions() > 0);
    counts.ok_or_else(|| {
        let last = said.lines().last().unwrap_or_default();
        format!("callgrind counted nothing: {last}")
    })
}

/// The counts in a line such as `==1== Collected : 1 2 3 4 5 6 7 8 9`.
fn parse(line: &str) -> Option<Counts> {
    let (_, counts) = line.split_once("Collected : ")?;
    let counts = counts.split_whitespace().map(str::parse);
    let counts: Vec<u64> = counts.collect::<Result<_, _>>().ok()?;
    Some(Counts(counts.try_into().ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_read_from_what_callgrind_says() {
        let counts = parse("==7== Collected : 100 20 30 1 2 3 4 5 6").unwrap();
        assert_eq!(counts.instructions(), 100);
        assert_eq!(counts.first_level_misses(), 6);
        assert_eq!(counts.last_level_misses(), 15);
        for other in [
            "==7== Events    : Ir Dr",
            "==7== Collected : 100",
            "Collected : a b",
        ] {
            assert!(parse(other).is_none(), "{other}");
        }
    }
}
