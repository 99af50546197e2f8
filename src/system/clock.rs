//! Time in which the process could run: it stands still while the process is stopped (Ctrl-Z) or the machine is asleep.

use std::ops::Sub;
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::{self, Duration};

/// Longer gaps between two readings count as this much. Readings come every [`BEAT`].
const LONGEST_GAP: Duration = Duration::from_secs(1);

const BEAT: Duration = Duration::from_millis(100);

/// The last reading, and the running time until then.
static LAST: Mutex<Option<(time::Instant, Duration)>> = Mutex::new(None);

/// Like [`std::time::Instant`], in running time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Instant(Duration);

impl Instant {
    pub fn now() -> Instant {
        let mut last = LAST.lock().unwrap_or_else(PoisonError::into_inner);
        let now = time::Instant::now();
        let (before, running) = *last.get_or_insert_with(|| {
            let beat = || loop {
                thread::sleep(BEAT);
                Instant::now();
            };
            // Without the thread, the readings that a render takes must suffice.
            drop(thread::Builder::new().name("clock".to_owned()).spawn(beat));
            (now, Duration::ZERO)
        });
        let running = running + (now - before).min(LONGEST_GAP);
        *last = Some((now, running));
        Instant(running)
    }

    pub fn elapsed(self) -> Duration {
        Instant::now() - self
    }
}

impl Sub for Instant {
    type Output = Duration;

    fn sub(self, earlier: Instant) -> Duration {
        self.0.saturating_sub(earlier.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_passes_without_readings() {
        let (all, running) = (time::Instant::now(), Instant::now());
        thread::sleep(Duration::from_millis(1500));
        let (running, all) = (running.elapsed(), all.elapsed());
        assert!(running <= all && all - running < Duration::from_millis(500), "{running:?} of {all:?}");
    }
}
