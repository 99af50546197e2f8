//! A renderer for the tests of this room: it traces nothing, and ends as it is told to.

use crate::film::Film;
use crate::render::{BackendInfo, RenderError, RenderJob, Renderer, Stats};
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Duration;

/// Counts its runs.
#[derive(Default)]
pub struct Fake {
    /// The number of runs so far.
    pub runs: Arc<AtomicUsize>,
    /// The time that a run takes.
    pub pause: Duration,
    /// The number of runs before all others fail.
    pub fails_after: Option<usize>,
    /// The number of runs before all others are cancelled.
    pub cancelled_after: Option<usize>,
}

impl Renderer for Fake {
    fn info(&self) -> BackendInfo {
        BackendInfo { name: "fake", device: "fake".to_owned(), lanes: 1, threads: 1 }
    }

    fn prepare(&mut self, _: &RenderJob, _: &AtomicBool) -> Result<(), RenderError> {
        Ok(())
    }

    fn accumulate(
        &mut self,
        _: &RenderJob,
        _: Range<u64>,
        _: &mut Film,
        _: &AtomicBool,
    ) -> Result<Stats, RenderError> {
        std::thread::sleep(self.pause);
        let before = self.runs.fetch_add(1, Ordering::Relaxed);
        if self.cancelled_after.is_some_and(|runs| before >= runs) {
            return Err(RenderError::Cancelled);
        }
        if self.fails_after.is_some_and(|runs| before >= runs) {
            return Err(RenderError::Backend { backend: "fake", reason: "out of memory".to_owned() });
        }
        Ok(Stats::default())
    }
}
