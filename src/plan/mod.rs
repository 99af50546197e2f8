//! Plans: the samples of a picture, or the frames of an animation, divided into parts that many machines trace, and the
//! commands and files by which shells and schedulers start them.

mod any;
mod commands;
mod division;
mod error;
mod files;
mod frames;
mod manifest;
mod samples;
mod scripts;

pub use any::AnyPlan;
pub use commands::Commands;
pub use division::{Division, divide};
pub use error::PlanError;
pub use files::PlanFiles;
pub use frames::{FramePart, Frames};
pub use manifest::{MANIFEST, Manifest, Plan, Work};
pub use samples::{Part, Samples};
pub use scripts::{ScriptKind, check_scripts, write_scripts};
