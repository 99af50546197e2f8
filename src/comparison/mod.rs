//! Programs on pictures: `compare` (equal except for noise?) and `check` (right, or which mistake?).

mod answer;
pub mod check;
pub mod compare;
mod picture;

pub use picture::Picture;
