//! `weekender check`: finds the mistake in a picture that a reader's own program has rendered. (All chapters of book 1.)
//!
//! Each mistake that readers are known to make is rendered: by the program's own tracer where a rule, the scene or the
//! camera can express it, otherwise by a plain tracer that follows the book. A picture is right if it differs from ours
//! by noise only; otherwise the mistake whose picture comes nearest is named.

mod compared;
mod details;
mod hypothesis;
mod judge;
mod likeness;
mod mistake;
mod picture;
mod program;
mod tracer;
mod views;
mod words;

pub use compared::Compared;
pub use hypothesis::StudioError;
pub use judge::{Finding, judge};
pub use likeness::stages;
pub use mistake::{About, Mistake};
pub use picture::{Damage, Mine, PIXEL_LIMIT, ReadError};
pub use program::run;
pub use views::pictures;
pub use words::text;
