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

pub use candidate::{Candidate, Traced};
pub use table::grouped;

use crate::system::terminal::write_figures;
use anyhow::Result;
use machine::Machine;
use serde::Serialize;
use std::path::Path;

/// Version of the JSON, incremented when a key is removed or changes meaning.
pub const SCHEMA: u32 = 3;

/// Figures of a machine.
#[derive(Serialize)]
struct Measured<'a, T> {
    machine: &'a Machine,
    #[serde(flatten)]
    figures: &'a T,
}

fn write_json(target: &Path, machine: &Machine, figures: &impl Serialize) -> Result<()> {
    write_figures(SCHEMA, &Measured { machine, figures }, target)
}
