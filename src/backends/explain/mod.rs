//! Explains recorded paths in text and numbers.

mod step;

pub use step::{Event, Lobe, Step, step, steps};
