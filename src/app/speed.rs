//! The present speed of a render, as opposed to its average.

use crate::job::render::BackendInfo;
use crate::progressive::Status;
use std::collections::VecDeque;

/// The speed is that of the last seconds of tracing, this many.
const SPAN: f64 = 1.0;

/// Measures the speed.
#[derive(Default)]
pub struct Speed {
    run: u64,
    backend: Option<BackendInfo>,
    /// Seconds of tracing and finished paths, as reported since the last change of the backend.
    reported: VecDeque<(f64, u64)>,
}

impl Speed {
    /// Notes the newest figures.
    pub fn follow(&mut self, status: &Status) {
        let now = (status.trace.as_secs_f64(), status.stats.paths);
        if self.run != status.run || self.backend != status.backend {
            (self.run, self.backend) = (status.run, status.backend.clone());
            self.reported.clear();
        }
        if self.reported.back() != Some(&now) {
            self.reported.push_back(now);
        }
        // The oldest report stays until the next is old enough, so that the span is covered.
        while self.reported.get(1).is_some_and(|(seconds, _)| now.0 - seconds >= SPAN) {
            self.reported.pop_front();
        }
    }

    /// Paths per second of tracing with the present backend; `None` before it has traced.
    pub fn paths_per_second(&self) -> Option<f64> {
        let ((before, fewer), (now, paths)) = (self.reported.front()?, self.reported.back()?);
        (now > before).then(|| paths.saturating_sub(*fewer) as f64 / (now - before))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::render::Stats;
    use std::time::Duration;

    fn status(name: &'static str, seconds: f64, paths: u64) -> Status {
        let backend = BackendInfo { name, device: String::new(), lanes: 1, threads: 1 };
        Status {
            run: 1,
            backend: Some(backend),
            trace: Duration::from_secs_f64(seconds),
            stats: Stats { paths, ..Stats::default() },
            ..Status::default()
        }
    }

    #[test]
    fn only_the_last_second_counts() {
        let mut speed = Speed::default();
        for step in 0..=20_u64 {
            let paths = if step <= 10 { 1000 * step } else { 10_000 + 10 * (step - 10) };
            speed.follow(&status("cpu", 0.1 * step as f64, paths));
        }
        assert!((speed.paths_per_second().unwrap() - 100.0).abs() < 1e-6);
        assert!(speed.reported.len() < 15);
    }
}
