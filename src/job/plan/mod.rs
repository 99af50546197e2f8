//! Plans: the samples of a picture, divided into parts that many machines trace, and the commands and files by which
//! shells and schedulers start them.

mod division;
mod manifest;
mod scripts;

pub use manifest::{MANIFEST, Manifest, Part, Plan};
pub use scripts::{Commands, Format, scripts};
