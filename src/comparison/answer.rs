//! The output of the programs on pictures: text for people, JSON for programs, and an exit code.

use crate::system::failure::{BAD_INPUT, FAILED};
use crate::system::terminal::{print_beside, write_figures};
use anyhow::Result;
use serde::Serialize;
use serde_json::{Value, json};
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

/// Prints `text` (to standard error if JSON takes standard output) and writes `figures` as JSON.
pub fn deliver(json: Option<&Path>, text: &str, schema: u32, figures: &impl Serialize) -> Result<()> {
    print_beside(json, text)?;
    json.map_or(Ok(()), |target| write_figures(schema, figures, target))
}

/// The fields of `figures`, and those of the object `more`.
pub fn extended(figures: &impl Serialize, more: Value) -> Value {
    let mut figures = json!(figures);
    if let (Some(figures), Value::Object(more)) = (figures.as_object_mut(), more) {
        figures.extend(more);
    }
    figures
}
