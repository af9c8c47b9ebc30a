//! The report as Markdown.

use std::fmt::Write;

use crate::report::claims::Verdict;
use crate::report::document::{Block, QUICK, Section, Table};

/// All sections, with a table of verdicts first.
pub(super) fn report(sections: &[Section]) -> String {
    let mut text = String::from("# Report\n");
    let all: Vec<_> = sections.iter().flat_map(|s| &s.verdicts).collect();
    if !all.is_empty() {
        let _ = write!(text, "\n## Claims\n\n{}", verdicts(&all).markdown());
    }
    for section in sections {
        let _ = write!(text, "\n{}", self::section(section));
    }
    text
}

fn section(section: &Section) -> String {
    let mut text = format!(
        "## {}\n\nPaper: {}.\n\n{}\n",
        section.title,
        section.paper,
        section.question.trim()
    );
    if section.is_quick {
        let _ = write!(text, "\n**{QUICK}**\n");
    }
    for block in &section.blocks {
        let _ = match block {
            Block::Text(paragraph) => write!(text, "\n{}\n", paragraph.trim()),
            Block::Table(table) => write!(text, "\n{}:\n\n{}", table.caption, table.markdown()),
            Block::Figure(figure) => write!(
                text,
                "\n![{}]({}/{})\n",
                figure.caption, section.name, figure.file
            ),
        };
    }
    if !section.verdicts.is_empty() {
        let all: Vec<_> = section.verdicts.iter().collect();
        let _ = write!(text, "\n{}", verdicts(&all).markdown());
    }
    let files = section
        .files
        .iter()
        .map(|f| format!("[{f}]({}/{f})", section.name));
    let _ = write!(
        text,
        "\n**How it could mislead.** {}\n\n\
         **Made with** `vps-bench {}`: {}. Records: {}.\n",
        section.misleads.trim(),
        section.command,
        section.made_with.join("; "),
        files.collect::<Vec<_>>().join(", ")
    );
    text
}

/// A row for each claim.
pub(super) fn verdicts(verdicts: &[&Verdict]) -> Table {
    let mut table = Table::new(
        "Verdicts on the claims",
        &["claim", "source", "paper", "here", "holds if", "verdict"],
    );
    for verdict in verdicts {
        let claim = &verdict.claim;
        let mut outcome = format!("**{}**", verdict.outcome.text());
        if !verdict.is_as_expected() {
            outcome += ", otherwise than expected";
        }
        if !verdict.why().is_empty() {
            outcome += &format!(": {}", verdict.why());
        }
        table.push([
            claim.says.clone(),
            claim.source_text().into(),
            claim.with_unit(claim.paper),
            claim.with_unit(verdict.measured),
            claim.range(),
            outcome,
        ]);
    }
    table
}
