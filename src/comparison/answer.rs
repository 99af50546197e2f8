//! The output of the programs on pictures: text for people, JSON for programs, and an exit code.

use crate::cli::terminal::{print_beside, write_figures};
use crate::system::failure::{BAD_INPUT, FAILED};
use anyhow::Result;
use serde::Serialize;
use std::fmt::Write;
use std::path::Path;
use std::process::ExitCode;

/// The answer to "are these two the same?" The worst comes last.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    Same,
    Unclear,
    Different,
}

impl Verdict {
    pub fn exit_code(self) -> ExitCode {
        match self {
            Verdict::Same => ExitCode::SUCCESS,
            Verdict::Different => ExitCode::from(FAILED),
            Verdict::Unclear => ExitCode::from(BAD_INPUT),
        }
    }
}

/// Labelled lines in aligned columns.
pub fn lines<'a>(lines: impl IntoIterator<Item = (&'a str, String)>) -> String {
    let lines: Vec<(&str, String)> = lines.into_iter().collect();
    let width = lines.iter().map(|(label, _)| label.len()).max().unwrap_or(0) + 1;
    lines.iter().fold(String::new(), |mut text, (label, content)| {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{label:<width$} {content}");
        text
    })
}

/// Prints `text` (to standard error if JSON takes standard output) and writes `figures` as JSON.
pub fn deliver(json: Option<&Path>, text: &str, schema: u32, figures: &impl Serialize) -> Result<()> {
    print_beside(json, text)?;
    json.map_or(Ok(()), |target| write_figures(schema, figures, target))
}
