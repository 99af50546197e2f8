//! Films that are kept in slots: a thread that reads them, their pictures, and the film on the screen, which is the live
//! one or a kept one.

#[cfg(test)]
pub mod on_screen;
mod picture;
mod subject;
mod thread;

pub use picture::KeptPicture;
pub use subject::{FilmId, Subject};
pub use thread::KeptThread;
