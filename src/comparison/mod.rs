//! Programs on pictures: `compare` (equal except for noise?), `check` (right, or which mistake?) and `diff` (one path
//! on two backends).

mod answer;
pub mod check;
pub mod compare;
pub mod diff;
mod picture;

pub use picture::Picture;
