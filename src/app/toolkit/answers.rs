//! Answers of background threads. Each asker owns the slot in which its answers arrive: results, or why there is none.
//! Work that panics, or that no thread can be started for, is answered with an error.

use crate::job::render::panic_text;
use eframe::egui::Context;
use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;
use std::time::Duration;

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
    sender: Sender<Result<T, String>>,
    receiver: Receiver<Result<T, String>>,
    /// Each open question holds another one.
    token: Arc<()>,
}

impl<T> Default for Answers<T> {
    fn default() -> Self {
        let (sender, receiver) = channel();
        Answers { sender, receiver, token: Arc::default() }
    }
}

impl<T: Send + 'static> Answers<T> {
    /// Makes a handle that gives answers from any thread, or none.
    pub fn answer(&mut self, context: &Context) -> Answer<T> {
        let (sender, token) = (self.sender.clone(), Some(Arc::clone(&self.token)));
        Answer { sender, token, context: context.clone(), is_promised: Cell::new(false) }
    }

    /// Makes a handle that gives an answer from any thread. If it is dropped before, the answer is an error.
    pub fn promise(&mut self, context: &Context) -> Answer<T> {
        let answer = self.answer(context);
        answer.is_promised.set(true);
        answer
    }

    /// Runs `work` on a thread of the given name. Its result arrives here.
    pub fn ask(
        &mut self,
        thread: &str,
        context: &Context,
        work: impl FnOnce() -> Result<T, String> + Send + 'static,
    ) {
        self.promise(context).give_from(thread, work);
    }

    /// Whether a question is open.
    pub fn is_open(&self) -> bool {
        Arc::strong_count(&self.token) > 1
    }

    /// Waits for the open questions, and returns the first answer.
    pub fn wait(&mut self) -> Option<Result<T, String>> {
        while self.is_open() {
            thread::sleep(Duration::from_millis(1));
        }
        self.take()
    }

    /// The oldest answer that has not been taken yet.
    pub fn take(&mut self) -> Option<Result<T, String>> {
        self.receiver.try_recv().ok()
    }
}

/// A question that is asked again when `K` has changed, one at a time.
pub struct Query<K, T> {
    /// The key that was asked last.
    pub asked: Option<K>,
    pub answers: Answers<T>,
    /// The newest answer.
    pub answer: Option<T>,
    /// Why the last question has no answer; `None` if it has one or is pending.
    pub fault: Option<String>,
}

impl<K, T> Default for Query<K, T> {
    fn default() -> Self {
        Query { asked: None, answers: Answers::default(), answer: None, fault: None }
    }
}

impl<K: PartialEq, T: Send + 'static> Query<K, T> {
    /// Takes what has been answered. Returns whether there is a new answer.
    pub fn follow(&mut self) -> bool {
        let mut is_new = false;
        while let Some(outcome) = self.answers.take() {
            (is_new, self.fault) = (outcome.is_ok(), outcome.as_ref().err().cloned());
            self.answer = outcome.ok().or(self.answer.take());
        }
        is_new
    }

    /// A permit to answer; `None` if `key` was asked last or a question is pending.
    pub fn ask(&mut self, context: &Context, key: K) -> Option<Answer<T>> {
        if self.answers.is_open() || self.asked.as_ref() == Some(&key) {
            return None;
        }
        self.asked = Some(key);
        Some(self.answers.promise(context))
    }
}

/// The right to give an answer, which wakes the window.
pub struct Answer<T> {
    sender: Sender<Result<T, String>>,
    /// Until it is dropped.
    token: Option<Arc<()>>,
    context: Context,
    /// An answer was promised and not yet given.
    is_promised: Cell<bool>,
}

impl<T> Answer<T> {
    /// Whether the slot of this answer still exists, if no other answer to it is open.
    pub fn is_wanted(&self) -> bool {
        self.token.as_ref().is_some_and(|token| Arc::strong_count(token) > 1)
    }

    /// Gives the answer, or one of several.
    pub fn give(&self, value: Result<T, String>) {
        self.is_promised.set(false);
        // If the window was closed, the answer is dropped.
        let _ = self.sender.send(value);
        self.context.request_repaint();
    }
}

impl<T: Send + 'static> Answer<T> {
    /// Gives the result of `work`, which is done on a thread of the given name.
    pub fn give_from(self, thread: &str, work: impl FnOnce() -> Result<T, String> + Send + 'static) {
        let run = move || {
            let value = caught(work).and_then(|value| value);
            self.give(value);
        };
        // Without a thread the answer is dropped, which gives an error.
        let _ = thread::Builder::new().name(thread.to_owned()).spawn(run);
    }
}

impl<T> Drop for Answer<T> {
    fn drop(&mut self) {
        if self.is_promised.get() {
            let reason =
                if thread::panicking() { "the program failed" } else { "the task did not finish; try again" };
            self.give(Err(reason.to_owned()));
        }
        // The question is over before the window looks.
        drop(self.token.take());
        self.context.request_repaint();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::RawInput;
    use std::sync::atomic::{AtomicU32, Ordering};

    #[test]
    fn every_answer_arrives_and_wakes_the_window() {
        let (context, mut answers) = (Context::default(), Answers::default());
        let wakes = Arc::new(AtomicU32::new(0));
        let count = Arc::clone(&wakes);
        context.set_request_repaint_callback(move |_| _ = count.fetch_add(1, Ordering::Relaxed));
        type Action = fn(Answer<u32>);
        let actions: [(&str, Action); 2] =
            [("given", |answer| answer.give(Ok(1))), ("one of several", |answer| answer.give(Ok(2)))];
        for (name, act) in actions {
            // A frame that asks for no other one.
            for _ in 0..4 {
                context.run_ui(RawInput::default(), |_| {}).textures_delta.clear();
            }
            let before = wakes.load(Ordering::Relaxed);
            act(answers.promise(&context));
            assert!(wakes.load(Ordering::Relaxed) > before, "{name}");
        }
        assert!(!answers.is_open());
        let taken = [answers.take(), answers.take(), answers.take()];
        assert_eq!(taken, [Some(Ok(1)), Some(Ok(2)), None]);
        assert!(!answers.is_open());
        answers.ask("test", &context, || Ok(3));
        assert_eq!(answers.wait(), Some(Ok(3)));
    }

    #[test]
    fn work_that_panics_or_is_dropped_is_answered() {
        let (context, mut answers) = (Context::default(), Answers::<u32>::default());
        answers.ask("test", &context, || panic!("on purpose"));
        assert_eq!(answers.wait(), Some(Err("the program failed (on purpose)".to_owned())));
        drop(answers.promise(&context));
        assert_eq!(answers.take(), Some(Err("the task did not finish; try again".to_owned())));
        let own = answers.promise(&context);
        let fallen = caught::<()>(move || {
            let _own = own;
            panic!("on purpose")
        });
        assert_eq!(fallen, Err("the program failed (on purpose)".to_owned()));
        assert_eq!(answers.take(), Some(Err("the program failed".to_owned())));
        drop(answers.answer(&context));
        assert_eq!(answers.take(), None, "nothing was promised");
    }
}
