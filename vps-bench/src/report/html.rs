//! The report as one self-contained HTML file: figures are embedded, and there are no scripts.

use std::path::Path;

use base64::prelude::{BASE64_STANDARD, Engine};
use maud::{DOCTYPE, Markup, PreEscaped, html};

use crate::error::Error;
use crate::report::claims::{Outcome, Verdict};
use crate::report::document::{Block, FigureLink, QUICK, Section, Table};

const STYLE: &str = include_str!("report.css");

/// All sections, with a table of verdicts first; figures are read from `folder`, where the report will
/// lie.
pub(super) fn report(sections: &[Section], folder: &Path) -> Result<String, Error> {
    let mut parts = Vec::new();
    for section in sections {
        parts.push(self::section(section, folder)?);
    }
    let all: Vec<_> = sections
        .iter()
        .flat_map(|s| s.verdicts.iter().map(move |v| (s, v)))
        .collect();
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                title { "Report" }
                style { (PreEscaped(STYLE)) }
            }
            body {
                header {
                    h1 { "Report" }
                    @if !all.is_empty() {
                        p { (count(&all.iter().map(|(_, v)| *v).collect::<Vec<_>>())) }
                    }
                }
                nav aria-label="Contents" {
                    h2 { "Contents" }
                    ol {
                        @if !all.is_empty() { li { a href="#all-claims" { "Claims" } } }
                        @for section in sections {
                            li { a href={ "#" (section.name) } { (section.title) } }
                        }
                    }
                }
                main {
                    @if !all.is_empty() {
                        section id="all-claims" {
                            h2 { "Claims" }
                            (claims(&all, true))
                        }
                    }
                    @for part in &parts { (part) }
                }
            }
        }
    };
    Ok(page.into_string())
}

/// The number of claims by outcome.
fn count(verdicts: &[&Verdict]) -> String {
    let of = |outcome| verdicts.iter().filter(|v| v.outcome == outcome).count();
    let otherwise = verdicts.iter().filter(|v| !v.is_as_expected()).count();
    let [holds, fails, unknown] = [
        of(Outcome::Holds),
        of(Outcome::DoesNotHold),
        of(Outcome::NotComparable),
    ];
    let expected = match otherwise {
        0 => "All as expected.".into(),
        n => format!("Otherwise than expected: {n}."),
    };
    let all = verdicts.len();
    format!(
        "Claims: {all}. Hold: {holds}. Do not hold: {fails}. Not comparable: {unknown}. {expected}"
    )
}

fn section(section: &Section, folder: &Path) -> Result<Markup, Error> {
    let mut blocks = Vec::new();
    for block in &section.blocks {
        blocks.push(match block {
            Block::Text(text) => prose(text),
            Block::Table(table) => self::table(table),
            Block::Figure(link) => figure(link, &section.name, folder)?,
        });
    }
    let verdicts: Vec<_> = section.verdicts.iter().map(|v| (section, v)).collect();
    Ok(html! {
        section id=(section.name) {
            h2 { (section.title) }
            p class="source" { "Paper: " (section.paper) }
            div class="question" { (prose(&section.question)) }
            @if section.is_quick { p class="quick" { (QUICK) } }
            @for block in &blocks { (block) }
            @if !verdicts.is_empty() {
                div class="verdicts" {
                    h3 { "Verdicts" }
                    (claims(&verdicts, false))
                }
            }
            h3 { "How it could mislead" }
            (prose(&section.misleads))
            h3 { "Make it again" }
            pre { code { "cargo run --locked --release -p vps-bench -- " (section.command) } }
            p {
                "Tables: "
                @for (i, file) in section.files.iter().enumerate() {
                    @if i > 0 { ", " }
                    a href={ (section.name) "/" (file) } { (file) }
                }
            }
            h3 { "Made with" }
            ul { @for line in &section.made_with { li { (line) } } }
        }
    })
}

/// Paragraphs; text between backticks is code.
fn prose(text: &str) -> Markup {
    html! {
        @for paragraph in text.split("\n\n").map(str::trim).filter(|p| !p.is_empty()) {
            p {
                @for (i, part) in paragraph.split('`').enumerate() {
                    @if i % 2 == 1 { code { (part) } } @else { (part) }
                }
            }
        }
    }
}

/// A table in a box of its own, which scrolls if the table is wider than the page.
fn table(table: &Table) -> Markup {
    // Columns of numbers are aligned; a dash is a missing number.
    let is_number = |column: usize| {
        let starts =
            |cell: &String| cell.starts_with(|c: char| c.is_ascii_digit() || "-–".contains(c));
        column > 0
            && table
                .rows
                .iter()
                .all(|row| row.get(column).is_some_and(starts))
    };
    let class = |column: usize| {
        let is_printed = table.head[column].starts_with("paper");
        match (is_number(column), is_printed) {
            (true, true) => "number printed",
            (true, false) => "number",
            (false, true) => "printed",
            (false, false) => "words",
        }
    };
    let classes: Vec<_> = (0..table.head.len()).map(class).collect();
    html! {
        figure {
            figcaption { (table.caption) }
            div class="scroll" tabindex="0" role="region" aria-label=(table.caption) {
                table {
                    thead {
                        tr {
                            @for (head, class) in table.head.iter().zip(&classes) {
                                th scope="col" class=(class) { (head) }
                            }
                        }
                    }
                    tbody {
                        @for row in &table.rows {
                            tr {
                                @for (i, (cell, class)) in row.iter().zip(&classes).enumerate() {
                                    @if i == 0 { th scope="row" { (cell) } }
                                    @else { td class=(class) { (cell) } }
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}

/// An embedded figure, which opens alone when it is clicked.
fn figure(link: &FigureLink, name: &str, folder: &Path) -> Result<Markup, Error> {
    let path = folder.join(name).join(&link.file);
    let bytes = std::fs::read(&path).map_err(|e| format!("{}: {e}", path.display()))?;
    let kind = match path.extension().and_then(|e| e.to_str()) {
        Some("svg") => "image/svg+xml",
        Some("png") => "image/png",
        _ => return Err(format!("{}: neither SVG nor PNG", path.display()).into()),
    };
    let data = BASE64_STANDARD.encode(bytes);
    Ok(html! {
        figure {
            div class="scroll paper" tabindex="0" role="region" aria-label=(link.caption) {
                a href={ (name) "/" (link.file) } {
                    img alt=(link.caption) src={ "data:" (kind) ";base64," (data) };
                }
            }
            figcaption { (link.caption) }
        }
    })
}

/// A row for each claim; with its experiment if there are several.
fn claims(verdicts: &[(&Section, &Verdict)], with_experiment: bool) -> Markup {
    let row = |section: &Section, verdict: &Verdict| {
        let claim = &verdict.claim;
        html! {
            tr {
                th scope="row" {
                    (claim.says)
                    @if with_experiment {
                        " " a class="from" href={ "#" (section.name) } { (section.title) }
                    }
                }
                td data-head="source" { (claim.source_text()) }
                td data-head="paper" class="printed" { (claim.with_unit(claim.paper)) }
                td data-head="here" { strong { (claim.with_unit(verdict.measured)) } }
                td data-head="holds if" { (claim.range()) }
                td data-head="verdict" {
                    div {
                        (outcome(verdict))
                        @if !verdict.why().is_empty() { p class="why" { (verdict.why()) } }
                    }
                }
            }
        }
    };
    html! {
        table class="claims" {
            thead {
                tr {
                    @for head in ["claim", "source", "paper", "here", "holds if", "verdict"] {
                        th scope="col" { (head) }
                    }
                }
            }
            tbody { @for (section, verdict) in verdicts { (row(section, verdict)) } }
        }
    }
}

/// The outcome in colour and in words.
fn outcome(verdict: &Verdict) -> Markup {
    let (class, sign) = match verdict.outcome {
        Outcome::Holds => ("outcome holds", "✓"),
        Outcome::DoesNotHold => ("outcome fails", "✗"),
        Outcome::NotComparable => ("outcome unknown", "○"),
    };
    html! {
        span class=(class) { span aria-hidden="true" { (sign) " " } (verdict.outcome.text()) }
        @if !verdict.is_as_expected() {
            " " span class="otherwise" { "otherwise than expected" }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_escaped_and_backticks_are_code() {
        let text = prose("a < `b > c`\n\nd\n").into_string();
        assert_eq!(text, "<p>a &lt; <code>b &gt; c</code></p><p>d</p>");
    }

    #[test]
    fn numbers_and_printed_values_are_marked() {
        let mut numbers = Table::new("t", &["what", "µs", "paper: µs", "size"]);
        numbers.push(["a", "1.5", "–", "2 points"].map(String::from));
        numbers.push(["b", "–", "-3", "none"].map(String::from));
        let text = table(&numbers).into_string();
        assert!(text.contains("<th scope=\"row\">a</th>"));
        assert!(text.contains("<td class=\"number\">1.5</td>"));
        assert!(text.contains("<td class=\"number printed\">-3</td>"));
        assert!(text.contains("<td class=\"words\">2 points</td>"));
    }

    #[test]
    fn a_figure_that_is_missing_is_named() {
        let link = FigureLink {
            file: "none.svg".into(),
            caption: String::new(),
        };
        let error = figure(&link, "fall", Path::new("nowhere")).unwrap_err();
        assert!(error.to_string().starts_with("nowhere/fall/none.svg: "));
    }
}
