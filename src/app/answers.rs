//! Answers of background threads. Each asker owns the slot in which its answers arrive. Whoever asks with a substitute for
//! the answer gets one in any case: work that panics, or that no thread can be started for, must not be waited for.

use crate::job::render::panic_text;
use eframe::egui::Context;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;

/// Makes the answer when the work was not done, from the reason in words.
type Substitute<T> = Box<dyn FnOnce(String) -> T + Send>;

/// Does work that may panic.
///
/// # Errors
/// That it panicked, in words.
pub fn caught<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(work))
        .map_err(|payload| format!("the program failed ({})", panic_text(payload.as_ref())))
}

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
    /// Makes a handle that gives one answer, from any thread, or none.
    pub fn answer(&self, context: &Context) -> Answer<T> {
        Answer { sender: self.sender.clone(), context: context.clone(), substitute: None }
    }

    /// Makes a handle that gives one answer, from any thread. If it is dropped before, `substitute` makes the answer from
    /// the reason.
    pub fn answer_or(
        &self,
        context: &Context,
        substitute: impl FnOnce(String) -> T + Send + 'static,
    ) -> Answer<T> {
        let substitute: Substitute<T> = Box::new(substitute);
        Answer { sender: self.sender.clone(), context: context.clone(), substitute: Some(substitute) }
    }

    /// Runs `work` on a thread of the given name. Its result arrives here; if there is none, what `substitute` makes of
    /// the reason.
    pub fn ask(
        &self,
        thread: &str,
        context: &Context,
        work: impl FnOnce() -> T + Send + 'static,
        substitute: impl FnOnce(String) -> T + Send + 'static,
    ) {
        self.answer_or(context, substitute).give_from(thread, work);
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
    substitute: Option<Substitute<T>>,
}

impl<T> Answer<T> {
    /// Gives the answer.
    pub fn give(mut self, value: T) {
        self.substitute = None;
        self.give_one(value);
    }

    /// Gives one of several answers.
    pub fn give_one(&self, value: T) {
        // If the window was closed, nobody receives it.
        let _ = self.sender.send(value);
        self.context.request_repaint();
    }

    /// Wakes the window without giving an answer.
    pub fn wake(mut self) {
        self.substitute = None;
        self.context.request_repaint();
    }

    /// Gives the substitute, if there is one.
    fn fail(mut self, reason: String) {
        if let Some(substitute) = self.substitute.take() {
            self.give_one(substitute(reason));
        }
    }
}

impl<T: Send + 'static> Answer<T> {
    /// Gives the result of `work`, which is done on a thread of the given name.
    pub fn give_from(self, thread: &str, work: impl FnOnce() -> T + Send + 'static) {
        let run = move || match caught(work) {
            Ok(value) => self.give(value),
            Err(reason) => self.fail(reason),
        };
        // Without a thread the answer is dropped, which gives the substitute.
        let _ = thread::Builder::new().name(thread.to_owned()).spawn(run);
    }
}

impl<T> Drop for Answer<T> {
    fn drop(&mut self) {
        if let Some(substitute) = self.substitute.take() {
            let reason =
                if thread::panicking() { "the program failed" } else { "nothing has done it; try again" };
            self.give_one(substitute(reason.to_owned()));
        }
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
                context.run_ui(RawInput::default(), |_| {}).textures_delta.clear();
            }
            let before = wakes.load(Ordering::Relaxed);
            act(answers.answer(&context));
            assert!(wakes.load(Ordering::Relaxed) > before, "{name}");
        }
        assert_eq!([answers.take(), answers.take(), answers.take()], [Some(1), Some(2), None]);
        answers.ask("test", &context, || 3, |_| 4);
        assert_eq!(answers.wait(), Some(3));
    }

    #[test]
    fn work_that_panics_is_answered_with_its_substitute() {
        let (context, answers) = (Context::default(), Answers::<Result<u32, String>>::default());
        answers.ask("test", &context, || panic!("on purpose"), Err);
        assert_eq!(answers.wait(), Some(Err("the program failed (on purpose)".to_owned())));
    }

    #[test]
    fn an_answer_that_is_dropped_is_given_by_its_substitute() {
        let (context, answers) = (Context::default(), Answers::default());
        let answer = || answers.answer_or(&context, Err::<u32, String>);
        drop(answer());
        assert_eq!(answers.take(), Some(Err("nothing has done it; try again".to_owned())));
        let own = answer();
        let fallen = caught::<()>(move || {
            let _own = own;
            panic!("on purpose")
        });
        assert_eq!(fallen, Err("the program failed (on purpose)".to_owned()));
        assert_eq!(answers.take(), Some(Err("the program failed".to_owned())));
        answer().give(Ok(1));
        answer().wake();
        drop(answers.answer(&context));
        assert_eq!([answers.take(), answers.take()], [Some(Ok(1)), None], "once, or not at all");
    }
}
