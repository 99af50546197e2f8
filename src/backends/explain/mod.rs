//! Explains recorded paths in text and numbers, and how packets of lanes trace them over time.

mod step;
mod timeline;

pub use step::{Event, Lobe, Step, step, steps};
pub use timeline::{Activity, Timeline, timeline};
