//! Answers of background threads. Each asker owns the slot in which its answers arrive.

use eframe::egui::Context;
use std::io;
use std::sync::mpsc::{Receiver, Sender, channel};

/// The slot in which answers of one kind arrive.
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
    /// Makes a handle that gives one answer, from any thread.
    pub fn answer(&self, context: &Context) -> Answer<T> {
        Answer { sender: self.sender.clone(), context: context.clone() }
    }

    /// Runs `work` on a thread of the given name. Its result arrives here.
    ///
    /// # Errors
    /// If the system cannot start a thread.
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

    /// Waits for an answer that has been asked for.
    pub fn wait(&self) -> Option<T> {
        self.receiver.recv().ok()
    }

    /// The oldest answer that has not been taken yet.
    pub fn take(&self) -> Option<T> {
        self.receiver.try_recv().ok()
    }
}

/// The right to give an answer, which wakes the window.
pub struct Answer<T> {
    sender: Sender<T>,
    context: Context,
}

impl<T> Answer<T> {
    /// Gives the answer.
    pub fn give(self, value: T) {
        // If the window was closed, nobody receives it.
        let _ = self.sender.send(value);
        self.wake();
    }

    /// Gives one of several answers.
    pub fn give_one(&self, value: T) {
        let _ = self.sender.send(value);
        self.context.request_repaint();
    }

    /// Wakes the window without giving an answer.
    pub fn wake(self) {
        self.context.request_repaint();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::RawInput;
    use std::sync::Arc;
    use std::sync::atomic::{AtomicU32, Ordering};

    #[test]
    fn every_answer_arrives_and_wakes_the_window() {
        let (context, answers) = (Context::default(), Answers::default());
        let wakes = Arc::new(AtomicU32::new(0));
        let count = Arc::clone(&wakes);
        context.set_request_repaint_callback(move |_| _ = count.fetch_add(1, Ordering::Relaxed));
        type Action = fn(Answer<u32>);
        let actions: [(&str, Action); 3] = [
            ("given", |answer| answer.give(1)),
            ("one of several", |answer| answer.give_one(2)),
            ("none", |answer| answer.wake()),
        ];
        for (name, act) in actions {
            // A frame that asks for no other one.
            for _ in 0..4 {
                let _ = context.run_ui(RawInput::default(), |_| {});
            }
            let before = wakes.load(Ordering::Relaxed);
            act(answers.answer(&context));
            assert!(wakes.load(Ordering::Relaxed) > before, "{name}");
        }
        assert_eq!([answers.take(), answers.take(), answers.take()], [Some(1), Some(2), None]);
        answers.ask("test", &context, || 3).unwrap();
        assert_eq!(answers.wait(), Some(3));
    }
}
