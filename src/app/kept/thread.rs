//! A thread for work on kept films, which may take longer than a frame.

use crate::app::answers::caught;
use std::sync::OnceLock;
use std::sync::mpsc::{SendError, Sender, channel};

type Work = Box<dyn FnOnce() + Send>;

/// A thread that starts with the first work and does one piece of work after the other.
#[derive(Default)]
pub struct KeptThread {
    sender: OnceLock<Option<Sender<Work>>>,
}

impl KeptThread {
    /// Has `work` done. Without a thread, it is done here and now.
    pub fn run(&self, work: impl FnOnce() + Send + 'static) {
        let work: Work = Box::new(work);
        match self.sender.get_or_init(start) {
            Some(sender) => {
                if let Err(SendError(work)) = sender.send(work) {
                    let _ = caught(work);
                }
            }
            None => _ = caught(work),
        }
    }
}

fn start() -> Option<Sender<Work>> {
    let (sender, orders) = channel::<Work>();
    // Whoever asked learns of a panic from the answer that never came.
    let work = move || orders.iter().for_each(|work| _ = caught(work));
    std::thread::Builder::new().name("slots".to_owned()).spawn(work).is_ok().then_some(sender)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::thread;

    /// The thread that does the next piece of work.
    fn worker(of: &KeptThread) -> thread::ThreadId {
        let (answer, answers) = channel();
        of.run(move || answer.send(thread::current().id()).unwrap());
        answers.recv().unwrap()
    }

    #[test]
    fn work_that_panics_does_not_end_the_thread() {
        let kept = KeptThread::default();
        let first = worker(&kept);
        kept.run(|| panic!("on purpose"));
        assert_eq!(worker(&kept), first);
    }
}
