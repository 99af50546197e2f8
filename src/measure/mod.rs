//! Measurements: speed (`bench`), error against time (`report`) and extreme scenes (`stress`), with a plain C program
//! as the control. All trace candidates and share progress, tables and JSON.

pub mod baseline;
pub mod bench;
mod candidate;
mod machine;
mod progress;
pub mod report;
pub mod stress;
mod table;

pub use candidate::{Candidate, Source, Stop, Traced};

use crate::cli::JsonTarget;
use crate::cli::terminal;
use anyhow::{Context, Result};
use machine::Machine;
use serde::Serialize;
use std::path::Path;

/// Version of the JSON, incremented when a key is removed or changes meaning.
pub const SCHEMA: u32 = 1;

/// Common start of every measurement's JSON.
#[derive(Serialize)]
struct Envelope<'a, T> {
    schema: u32,
    version: &'static str,
    machine: &'a Machine,
    #[serde(flatten)]
    figures: &'a T,
}

fn write_json(target: &JsonTarget, machine: &Machine, figures: &impl Serialize) -> Result<()> {
    terminal::write_json(&Envelope { schema: SCHEMA, version: machine.version, machine, figures }, target)
}

fn make_directory(directory: &Path) -> Result<()> {
    std::fs::create_dir_all(directory).with_context(|| {
        format!("cannot create the directory {}; choose another with --out", directory.display())
    })
}
