//! Plans: the samples of a picture divided into parts that many machines trace, and the commands and files by which
//! shells and schedulers start them.

mod commands;
mod division;
mod manifest;
mod scripts;

pub use commands::Commands;
pub use division::{Division, divide};
pub use manifest::{MANIFEST, Manifest, Part, Plan, PlanError, RESULT};
pub use scripts::{ScriptKind, write_scripts};
