//! Answers of other threads: whoever asks keeps the place where its answers arrive.

use eframe::egui::Context;
use std::io;
use std::sync::mpsc::{Receiver, Sender, channel};

/// Where answers of one kind arrive.
pub struct Answers<T> {
    sender: Sender<T>,
    receiver: Receiver<T>,
}

impl<T> Default for Answers<T> {
    fn default() -> Self {
        let (sender, receiver) = channel();
        Answers { sender, receiver }
    }
}

impl<T: Send + 'static> Answers<T> {
    /// Gives one answer, from any thread.
    pub fn answer(&self, context: &Context) -> Answer<T> {
        Answer { sender: self.sender.clone(), context: context.clone() }
    }

    /// Has `work` done on a thread of that name; what it returns arrives here.
    ///
    /// # Errors
    /// If the system gives no thread.
    pub fn ask(
        &self,
        thread: &str,
        context: &Context,
        work: impl FnOnce() -> T + Send + 'static,
    ) -> io::Result<()> {
        let answer = self.answer(context);
        std::thread::Builder::new().name(thread.to_owned()).spawn(move || answer.give(work()))?;
        Ok(())
    }

    /// The oldest answer that has not been taken yet.
    pub fn take(&self) -> Option<T> {
        self.receiver.try_recv().ok()
    }
}

/// The right to give one answer, which wakes the window.
pub struct Answer<T> {
    sender: Sender<T>,
    context: Context,
}

impl<T> Answer<T> {
    /// Gives it.
    pub fn give(self, value: T) {
        // A window that has been closed wants no answer.
        let _ = self.sender.send(value);
        self.wake();
    }

    /// Gives none, and wakes the window.
    pub fn wake(self) {
        self.context.request_repaint();
    }
}
