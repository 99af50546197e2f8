//! Kept films: a thread that reads them, their pictures, the question whether two differ by noise alone, and the film on
//! the screen, which is the traced one or a kept one.

mod actions;
#[cfg(test)]
pub mod on_screen;
mod picture;
mod subject;
mod thread;
mod verdict;

pub use actions::{KeptActions, Reopened};
pub use picture::KeptPicture;
pub use subject::{FilmId, Subject};
pub use thread::KeptThread;
pub use verdict::Verdict;
