//! A renderer for the tests of this room: it traces nothing, and ends as it is told to.

use crate::film::Film;
use crate::render::{BackendInfo, KernelContents, RenderError, RenderJob, Renderer, Stats};
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

/// The samples that renderers were asked for, each with the renderer's name, in the order of the runs.
pub type Asked = Arc<Mutex<Vec<(&'static str, Range<u64>)>>>;

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
    /// What it is called in `asked`.
    pub name: &'static str,
    /// What it was asked for.
    pub asked: Asked,
    /// The time that it claims to need for a sample.
    pub per_sample: Duration,
    /// The number of the run whose film has a sample that was rejected.
    pub rejects_in: Option<usize>,
    /// What its kernel leaves out.
    pub leaves_out: Vec<&'static str>,
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
        samples: Range<u64>,
        film: &mut Film,
        _: &AtomicBool,
    ) -> Result<Stats, RenderError> {
        if let Ok(mut asked) = self.asked.lock() {
            asked.push((self.name, samples.clone()));
        }
        std::thread::sleep(self.pause);
        let before = self.runs.fetch_add(1, Ordering::Relaxed);
        if self.cancelled_after.is_some_and(|runs| before >= runs) {
            return Err(RenderError::Cancelled);
        }
        if self.fails_after.is_some_and(|runs| before >= runs) {
            return Err(RenderError::Backend { backend: "fake", reason: "out of memory".to_owned() });
        }
        let count = samples.end - samples.start;
        film.record(samples, u64::from(self.rejects_in == Some(before)))?;
        Ok(Stats { paths: 10 * count, trace: self.per_sample * count as u32, ..Stats::default() })
    }

    fn kernel_contents(&self) -> KernelContents {
        KernelContents { present: format!("kernel of {}", self.name), left_out: self.leaves_out.clone() }
    }
}
