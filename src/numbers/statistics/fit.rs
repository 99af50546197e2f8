//! Error against time on logarithmic scales: slopes, time to a target, predictions.

/// An error at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Seconds or samples, above 0.
    pub time: f64,
    /// RMSE, above 0.
    pub error: f64,
}

/// The least-squares line through the points' logarithms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PowerLaw {
    /// Exponent of time in the error: -1/2 for independent samples.
    pub slope: f64,
    /// Standard error of the slope, from the points' distances to the line; 0 with two points.
    pub slope_deviation: f64,
    /// Standard deviation of the error's logarithm around the line; 0 with two points.
    scatter: f64,
    /// Sum of squares of the times' logarithms around their mean.
    spread: f64,
}

impl PowerLaw {
    /// `None` with fewer than two different times.
    pub fn through(points: &[Point]) -> Option<Self> {
        let logs = || points.iter().map(|p| (p.time.ln(), p.error.ln()));
        let count = points.len() as f64;
        let mean = |of: fn((f64, f64)) -> f64| logs().map(of).sum::<f64>() / count;
        let (mean_log_time, mean_log_error) = (mean(|p| p.0), mean(|p| p.1));
        let spread: f64 = logs().map(|(t, _)| (t - mean_log_time).powi(2)).sum();
        let both: f64 = logs().map(|(t, e)| (t - mean_log_time) * (e - mean_log_error)).sum();
        if points.len() < 2 || spread.is_nan() || spread <= 0.0 {
            return None;
        }
        let slope = both / spread;
        let squares: f64 =
            logs().map(|(t, e)| (e - mean_log_error - slope * (t - mean_log_time)).powi(2)).sum();
        let scatter = if points.len() > 2 { (squares / (count - 2.0)).sqrt() } else { 0.0 };
        Some(PowerLaw { slope, slope_deviation: scatter / spread.sqrt(), scatter, spread })
    }
}

/// When a target is reached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// In the unit of the points' times.
    pub time: f64,
    /// Whether it lies after the last point.
    pub is_extrapolated: bool,
}

/// When points, ordered by time, fall below the target for good: interpolated between two points on logarithmic scales,
/// otherwise after the last point with the slope of the last [`TAIL`] points. `None` if the error does not fall, or if
/// the first point is already below the target, which leaves the crossing unknown.
pub fn time_to(points: &[Point], target: f64) -> Option<Crossing> {
    let last_above = points.iter().rposition(|point| point.error > target)?;
    let above = points[last_above];
    if let Some(below) = points.get(last_above + 1) {
        let share = (above.error / target).ln() / (above.error / below.error).ln();
        let time = above.time * (below.time / above.time).powf(share);
        return Some(Crossing { time, is_extrapolated: false });
    }
    let law = PowerLaw::through(&points[points.len().saturating_sub(TAIL)..])?;
    // Extrapolate from the last point, not from the fitted line.
    let time = above.time * (target / above.error).powf(1.0 / law.slope);
    (law.slope < 0.0).then_some(Crossing { time, is_extrapolated: true })
}

/// Number of points that determine how a curve continues.
pub const TAIL: usize = 4;

/// When a target will be reached, by the estimates so far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prediction {
    /// The most likely time.
    pub time: f64,
    /// Earliest and latest time, within two deviations.
    pub range: [f64; 2],
}

/// Slopes at which a path tracer's error falls: that of independent samples, and the steepest measured with Sobol
/// points on smooth scenes.
const SLOPES: [f64; 2] = [-0.5, -0.75];

/// Uncertainty of the slope before there are any points.
const PRIOR_SLOPE_DEVIATION: f64 = 0.08;

/// Minimum uncertainty of an estimate's logarithm: that of two halves over a few thousand pixels.
const LEAST_SCATTER: f64 = 0.02;

/// Predicts when the error, `now` at the time `now.time`, falls to the target. `history` holds earlier estimates,
/// oldest first; only the last [`TAIL`] are used.
///
/// The slope is that of the history and `now`, averaged with the slope of independent samples, weighted by their
/// uncertainties. `None` if the target has been reached.
pub fn predict(history: &[Point], now: Point, target: f64) -> Option<Prediction> {
    if now.error <= target || target <= 0.0 || now.time <= 0.0 {
        return None;
    }
    let mut points: Vec<Point> = history
        .iter()
        .copied()
        .filter(|p| p.time > 0.0 && p.error > 0.0 && p.time < 0.9 * now.time)
        .collect();
    points.push(now);
    let tail = &points[points.len().saturating_sub(TAIL)..];
    let (mut slope, mut slope_deviation, mut scatter) = (SLOPES[0], PRIOR_SLOPE_DEVIATION, LEAST_SCATTER);
    if let Some(law) = PowerLaw::through(tail).filter(|_| tail.len() > 2) {
        scatter = law.scatter.max(LEAST_SCATTER);
        let (prior, measured) = (PRIOR_SLOPE_DEVIATION.powi(-2), law.spread / scatter.powi(2));
        slope = (slope * prior + law.slope * measured) / (prior + measured);
        slope_deviation = (prior + measured).sqrt().recip();
    }
    slope = slope.clamp(SLOPES[1], SLOPES[0] + PRIOR_SLOPE_DEVIATION);
    let fall = (now.error / target).ln();
    let log_factor = fall / -slope;
    // d(fall / slope): the uncertainties of the estimate and of the slope.
    let deviation = ((scatter / slope).powi(2) + (log_factor * slope_deviation / slope).powi(2)).sqrt();
    let at = |log: f64| now.time * log.max(0.0).exp();
    Some(Prediction {
        time: at(log_factor),
        range: [at(log_factor - 2.0 * deviation), at(log_factor + 2.0 * deviation)],
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn curve(slope: f64, count: u32) -> Vec<Point> {
        (0..count).map(|i| f64::from(1 << i)).map(|t| Point { time: t, error: 0.1 * t.powf(slope) }).collect()
    }

    #[test]
    fn crossings_interpolate_and_extrapolate() {
        let points = curve(-0.5, 7);
        let within = time_to(&points, 0.02).unwrap();
        assert!((within.time - 25.0).abs() < 1e-9 && !within.is_extrapolated);
        let beyond = time_to(&points, 0.001).unwrap();
        assert!((beyond.time - 1e4).abs() < 1e-6 && beyond.is_extrapolated);
        assert_eq!(time_to(&points, 0.2), None);
    }

    /// The measured slope is weighted by its uncertainty (at least that of a scatter of 0.02) against a slope of -0.5 +-
    /// 0.08.
    #[test]
    fn predicted_slope_is_bounded() {
        // The logarithms of four times, each twice the last, have squares around their mean of 5 ln(2)^2.
        let measured = 5.0 * 2.0_f64.ln().powi(2) / 0.02_f64.powi(2);
        let prior = 1.0 / 0.08_f64.powi(2);
        let mean = |slope: f64| (slope * measured - 0.5 * prior) / (measured + prior);
        let of = |slope: f64| {
            let points = curve(slope, 6);
            let now = points[5];
            let found = predict(&points[..5], now, now.error / 2.0).unwrap();
            (found.time / now.time, found.range.map(|time| time / now.time))
        };
        for (slope, expected) in
            [(-0.6, mean(-0.6)), (-0.45, mean(-0.45)), (-1.5, -0.75), (-0.3, -0.42), (0.0, -0.42)]
        {
            let (factor, [early, late]) = of(slope);
            let log_factor = 2.0_f64.ln() / -expected;
            assert!((factor / log_factor.exp() - 1.0).abs() < 1e-9, "{slope}: {factor}");
            let deviation =
                ((0.02 / expected).powi(2) + (log_factor / expected).powi(2) / (measured + prior)).sqrt();
            assert!((late / (log_factor + 2.0 * deviation).exp() - 1.0).abs() < 1e-9, "{slope}: {late}");
            assert!((early / (log_factor - 2.0 * deviation).exp() - 1.0).abs() < 1e-9, "{slope}: {early}");
        }
        // Only the last four points count.
        let mut points = curve(-0.6, 9);
        let now = points.pop().unwrap();
        let of_last = predict(&points[5..], now, now.error / 2.0);
        assert_eq!(predict(&points, now, now.error / 2.0), of_last);
        assert_ne!(predict(&points[6..], now, now.error / 2.0), of_last);
    }

    #[test]
    fn reached_or_unreachable_target_has_no_prediction() {
        let points = curve(-0.5, 6);
        let now = points[5];
        for (now, target) in [
            (now, now.error),
            (now, 2.0 * now.error),
            (now, 0.0),
            (now, -0.01),
            (Point { time: 0.0, ..now }, 0.5 * now.error),
        ] {
            assert_eq!(predict(&points[..5], now, target), None, "{now:?} {target}");
        }
        // Time 0 has no logarithm.
        let begun = [&[Point { time: 0.0, error: 1.0 }][..], &points[3..5]].concat();
        let target = 0.5 * now.error;
        assert_eq!(predict(&begun, now, target), predict(&points[3..5], now, target));
        // The prediction of a nearly reached target is not in the past.
        let near = predict(&points[..5], now, 0.999 * now.error).unwrap();
        assert!(near.range[0] == now.time && near.time > now.time && near.range[1] > near.time, "{near:?}");
    }

    proptest! {
        #[test]
        fn a_power_law_is_found_again(slope in -1.0..-0.2_f64, scale in 1e-6..1e3_f64) {
            let points: Vec<Point> = (1..7).map(f64::from).map(|t| Point { time: t, error: scale * t.powf(slope) }).collect();
            let law = PowerLaw::through(&points).unwrap();
            prop_assert!((law.slope - slope).abs() < 1e-9);
            prop_assert!(law.scatter < 1e-9, "{}", law.scatter);
        }
    }
}
