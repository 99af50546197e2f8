//! Kept films: their pictures, the question whether one differs from the traced picture by noise alone, and the film on
//! the screen, which is the traced one or a kept one.

mod actions;
mod picture;
mod subject;
#[cfg(test)]
pub mod tests;
mod verdict;

pub use actions::KeptActions;
pub use picture::KeptPicture;
pub use subject::{FilmId, Query, Subject};
pub use verdict::Verdict;

use super::answers::caught;
use std::sync::LazyLock;
use std::sync::mpsc::{SendError, Sender, channel};

type Work = Box<dyn FnOnce() + Send>;

/// Does work on a kept film, which may take longer than a frame, after the work that was asked for before.
pub fn run(work: impl FnOnce() + Send + 'static) {
    static WORKER: LazyLock<Sender<Work>> = LazyLock::new(|| {
        let (sender, receiver) = channel::<Work>();
        // Whoever asked learns of a panic from the answer that never came.
        let work = move || receiver.iter().for_each(|work| _ = caught(work));
        // Without a thread, sending fails.
        let _ = std::thread::Builder::new().name("kept".to_owned()).spawn(work);
        sender
    });
    if let Err(SendError(work)) = WORKER.send(Box::new(work)) {
        let _ = caught(work);
    }
}
