//! State that the render thread shares with its readers: the status and one picture.

use super::{Phase, Status};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// A film resolved for display.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// The run it belongs to, as [`Status::run`].
    pub run: u64,
    pub width: u32,
    pub height: u32,
    pub samples_per_pixel: u64,
    /// Three bytes a pixel, top row first.
    pub rgb8: Vec<u8>,
}

type Notice = Box<dyn Fn() + Send>;

#[derive(Default)]
pub(super) struct Shared {
    status: Mutex<Status>,
    changed: Condvar,
    picture: Mutex<Option<Picture>>,
    is_picture_wanted: AtomicBool,
    notice: Mutex<Option<Notice>>,
}

impl Shared {
    /// Replaces the status, unless the current one belongs to a later run.
    pub(super) fn publish(&self, status: &Status) {
        let mut mine = lock(&self.status);
        if status.run >= mine.run {
            let is_other_phase = mine.phase != status.phase;
            mine.clone_from(status);
            self.changed.notify_all();
            drop(mine);
            if is_other_phase {
                self.give_notice();
            }
        }
    }

    /// Sets the callback that the render thread calls when a picture is ready or the phase has changed.
    pub(super) fn set_notice(&self, notice: Notice) {
        *lock(&self.notice) = Some(notice);
    }

    fn give_notice(&self) {
        if let Some(notice) = lock(&self.notice).as_ref() {
            notice();
        }
    }

    pub(super) fn status(&self) -> Status {
        lock(&self.status).clone()
    }

    pub(super) fn wait(&self, timeout: Duration) -> Status {
        let status = lock(&self.status);
        if status.phase.is_over() {
            return status.clone();
        }
        let (status, _) = self.changed.wait_timeout(status, timeout).unwrap_or_else(PoisonError::into_inner);
        status.clone()
    }

    /// Records that the render thread has died.
    pub(super) fn died(&self) {
        let phase = Phase::Failed("the render thread failed; its film is lost".to_owned());
        self.publish(&Status { phase, ..self.status() });
    }

    pub(super) fn take_picture(&self) -> Option<Picture> {
        lock(&self.picture).take()
    }

    /// Asks for a picture; returns false if a request was already pending.
    pub(super) fn want_picture(&self) -> bool {
        !self.is_picture_wanted.swap(true, Ordering::AcqRel)
    }

    pub(super) fn is_picture_wanted(&self) -> bool {
        self.is_picture_wanted.load(Ordering::Acquire)
    }

    pub(super) fn put_picture(&self, picture: Picture) {
        let mut slot = lock(&self.picture);
        // Cleared before the picture can be taken: a request that follows is for the next picture.
        self.is_picture_wanted.store(false, Ordering::Release);
        *slot = Some(picture);
        drop(slot);
        self.give_notice();
    }
}

/// Locks `mutex`. The data is consistent after every statement, so a panic of a reader does not corrupt it.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;
    use std::sync::atomic::AtomicU32;

    #[test]
    fn only_phase_changes_notify_and_earlier_runs_are_ignored() {
        let (shared, count) = (Shared::default(), Arc::new(AtomicU32::new(0)));
        let noted = Arc::clone(&count);
        shared.set_notice(Box::new(move || {
            noted.fetch_add(1, Ordering::Relaxed);
        }));
        let published = |run: u64, phase: Phase, samples_per_pixel: u64| {
            shared.publish(&Status { run, phase, samples_per_pixel, ..Status::default() });
            let status = shared.status();
            (status.run, status.samples_per_pixel, count.load(Ordering::Relaxed))
        };
        assert_eq!(published(2, Phase::Tracing, 4), (2, 4, 1));
        assert_eq!(published(2, Phase::Tracing, 8), (2, 8, 1));
        assert_eq!(published(1, Phase::Paused, 16), (2, 8, 1));
        assert_eq!(published(3, Phase::Paused, 0), (3, 0, 2));
    }
}
