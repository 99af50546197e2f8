//! Predicts when a render will reach its target, from its error so far.

use crate::numbers::statistics::fit::{Point, Prediction, predict};
use crate::progressive::{NOISE_TARGET_FIRST_SAMPLES, Status};

/// Predictions more than this many seconds ahead are not shown.
pub const FARTHEST: f64 = 1e6;

/// All error estimates, the newest last.
pub fn points(status: &Status) -> Vec<Point> {
    let history = status.history.iter().map(|p| Point { time: p.trace_seconds, error: p.rmse_estimate });
    let now = status.error.map(|error| Point { time: status.trace.as_secs_f64(), error: error.rmse });
    history.chain(now).filter(|point| point.time > 0.0 && point.error > 0.0).collect()
}

/// Predicts in how many seconds the error will reach the target. `None` if it already has, or with too little data.
pub fn prediction(status: &Status, target: Option<f64>) -> Option<Prediction> {
    if status.samples_per_pixel < NOISE_TARGET_FIRST_SAMPLES || status.phase.is_over() {
        return None;
    }
    let error = status.error?;
    // Switching the backend bends the curve, so only the current backend's points are used.
    let backend = status.history.last().map(|point| point.backend);
    let mut history: Vec<Point> = status
        .history
        .iter()
        .rev()
        .take_while(|point| {
            Some(point.backend) == backend && point.samples_per_pixel >= NOISE_TARGET_FIRST_SAMPLES
        })
        .map(|point| Point { time: point.trace_seconds, error: point.rmse_estimate })
        .collect();
    history.reverse();
    let now = Point { time: status.trace.as_secs_f64(), error: error.rmse };
    let from_now = |time: f64| (time - now.time).max(0.0);
    predict(&history, now, target?)
        .map(|found| Prediction { time: from_now(found.time), range: found.range.map(from_now) })
        .filter(|found| found.time < FARTHEST)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::ErrorEstimate;
    use crate::progressive::{HistoryPoint, Phase};
    use std::time::Duration;

    #[test]
    fn the_prediction_counts_from_now_and_tells_its_range() {
        let mut status = Status {
            samples_per_pixel: 100,
            phase: Phase::Tracing,
            trace: Duration::from_secs(10),
            error: Some(ErrorEstimate { rmse: 0.004, rmse_deviation: 0.0, rel_mse: 0.0 }),
            ..Status::default()
        };
        let found = prediction(&status, Some(0.002)).unwrap();
        assert!((found.time - 30.0).abs() < 1e-6, "{found:?}");
        let now = Point { time: 10.0, error: 0.004 };
        let [low, high] = predict(&[], now, 0.002).unwrap().range;
        assert_eq!(found.range, [low - 10.0, high - 10.0]);
        assert!(found.range[0] < 30.0 && found.range[1] > 30.0, "{found:?}");
        assert_eq!(prediction(&status, Some(0.01)), None);
        assert_eq!(prediction(&status, None), None);
        for (samples, is_predicted) in
            [(NOISE_TARGET_FIRST_SAMPLES - 1, false), (NOISE_TARGET_FIRST_SAMPLES, true)]
        {
            status.samples_per_pixel = samples;
            assert_eq!(prediction(&status, Some(0.002)).is_some(), is_predicted, "{samples}");
        }
    }

    fn at(
        backend: &'static str,
        samples_per_pixel: u64,
        trace_seconds: f64,
        rmse_estimate: f64,
    ) -> HistoryPoint {
        HistoryPoint { backend, samples_per_pixel, trace_seconds, rmse_estimate, rel_mse_estimate: 0.0 }
    }

    fn tracing(history: Vec<HistoryPoint>, seconds: f64, rmse: f64) -> Status {
        Status {
            samples_per_pixel: 1000,
            phase: Phase::Tracing,
            trace: Duration::from_secs_f64(seconds),
            error: Some(ErrorEstimate { rmse, rmse_deviation: 0.0, rel_mse: 0.0 }),
            history,
            ..Status::default()
        }
    }

    #[test]
    fn only_the_clear_estimates_of_the_present_backend_count() {
        let now = Point { time: 16.0, error: 0.02 };
        let few = vec![at("gpu", 16, 4.0, 0.05), at("gpu", 200, 12.0, 0.027)];
        let many = [few.clone(), vec![at("gpu", 400, 13.0, 0.026), at("gpu", 800, 14.0, 0.021)]].concat();
        for counted in [few, many] {
            let before = vec![at("gpu", 64, 1.0, 0.9), at("cpu", 128, 2.0, 0.8), at("gpu", 15, 3.0, 0.7)];
            let points: Vec<Point> =
                counted.iter().map(|p| Point { time: p.trace_seconds, error: p.rmse_estimate }).collect();
            let expected = predict(&points, now, 0.01).unwrap();
            let found = prediction(&tracing([before, counted].concat(), now.time, now.error), Some(0.01));
            let from_now = |time: f64| time - now.time;
            let (time, range) = (from_now(expected.time), expected.range.map(from_now));
            assert_eq!(found, Some(Prediction { time, range }));
        }
        let status = tracing(Vec::new(), now.time, now.error);
        assert!(prediction(&status, Some(0.01)).is_some());
        let over = Status { phase: Phase::Failed("the device is gone".to_owned()), ..status.clone() };
        assert_eq!(prediction(&over, Some(0.01)), None);
        assert_eq!(prediction(&Status { error: None, ..status }, Some(0.01)), None);
    }
}
