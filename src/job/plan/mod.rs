//! Plans: the samples of a picture, or the frames of an animation, divided into parts that many machines trace, and the
//! commands and files by which shells and schedulers start them.

mod division;
mod manifest;
mod scripts;

pub use division::{Division, divide};
pub use manifest::{FramePart, Frames, MANIFEST, Manifest, Part, Plan, Samples, Work};
pub use scripts::{Commands, Format, scripts};
