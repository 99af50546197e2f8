//! Evaluates the measurements.

use super::data::{Curve, Data, Measured, Run};
use crate::numbers::statistics::fit::{Crossing, Point, PowerLaw, time_to};
use crate::numbers::statistics::median;
use std::collections::BTreeMap;

/// Slopes are evaluated only from this many samples on: smaller pictures finish before all threads are busy.
const FROM_SAMPLES: u64 = 16;

/// The pictures of a curve at one sample count.
#[derive(Clone, Debug, PartialEq)]
pub struct CurvePoint {
    /// Samples per pixel.
    pub samples: u64,
    /// Median time of tracing and adding to the film.
    pub wall_seconds: f64,
    /// Square root of the mean squared error over all pictures; 0 if they are better than the reference.
    pub rmse: f64,
    /// Smallest and largest RMSE of a single picture.
    pub range: [f64; 2],
    /// Mean relative squared error.
    pub rel_mse: f64,
    /// The RMSE that the pictures' halves predict without a reference, divided by the true one.
    pub estimate_ratio: Option<f64>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct CurveSummary {
    pub curve: Curve,
    /// In ascending order of samples.
    pub points: Vec<CurvePoint>,
    /// Exponent of time in the RMSE, and its standard error.
    pub slope: Option<[f64; 2]>,
    /// `1 / (MSE seconds)` at the last point with an error; NaN without one.
    pub efficiency: f64,
    /// Time to each target.
    pub times: Vec<Option<Crossing>>,
}

/// All curves with runs, in order of their first run, with the times to the errors in `targets`.
pub fn curves(data: &Data, targets: &[f64]) -> Vec<CurveSummary> {
    let keys = distinct(data.runs.iter().map(|run| &run.curve)).into_iter();
    keys.map(|curve| {
        let runs: Vec<&Run> = data.runs.iter().filter(|run| run.curve == *curve).collect();
        CurveSummary::of(curve, &runs, targets)
    })
    .collect()
}

/// Removes duplicates, keeping the first of each.
pub fn distinct<T: PartialEq>(values: impl Iterator<Item = T>) -> Vec<T> {
    values.fold(Vec::new(), |mut found, value| {
        if !found.contains(&value) {
            found.push(value);
        }
        found
    })
}

impl CurveSummary {
    fn of(curve: &Curve, runs: &[&Run], targets: &[f64]) -> Self {
        let mut by_samples: BTreeMap<u64, Vec<&Measured>> = BTreeMap::new();
        for point in runs.iter().flat_map(|run| &run.points) {
            by_samples.entry(point.samples).or_default().push(point);
        }
        // Where timing noise ended some runs early, the longer ones alone do not represent the curve.
        by_samples.retain(|_, points| 2 * points.len() > runs.len());
        let points: Vec<CurvePoint> =
            by_samples.into_iter().map(|(samples, points)| curve_point(samples, &points)).collect();
        // The error of a picture better than its reference is unknown.
        let known = || points.iter().filter(|p| p.rmse > 0.0);
        let errors: Vec<Point> = known().map(|p| Point { time: p.wall_seconds, error: p.rmse }).collect();
        let first = known().position(|p| p.samples >= FROM_SAMPLES).unwrap_or(0);
        CurveSummary {
            curve: curve.clone(),
            slope: PowerLaw::through(&errors[first..]).map(|law| [law.slope, law.slope_deviation]),
            efficiency: known().next_back().map_or(f64::NAN, |p| 1.0 / (p.rmse * p.rmse * p.wall_seconds)),
            times: targets.iter().map(|target| time_to(&errors, *target)).collect(),
            points,
        }
    }
}

fn curve_point(samples: u64, points: &[&Measured]) -> CurvePoint {
    let mean = |of: fn(&Measured) -> f64| points.iter().map(|p| of(p)).sum::<f64>() / points.len() as f64;
    let mse = mean(|p| p.mse).max(0.0);
    let roots = || points.iter().map(|p| p.mse.max(0.0).sqrt());
    CurvePoint {
        samples,
        wall_seconds: median(points.iter().map(|p| p.wall_seconds)).unwrap_or(f64::NAN),
        rmse: mse.sqrt(),
        range: [roots().fold(f64::INFINITY, f64::min), roots().fold(0.0, f64::max)],
        rel_mse: mean(|p| p.rel_mse),
        estimate_ratio: Some((mean(|p| p.mse_estimate.unwrap_or(f64::NAN)) / mse).sqrt())
            .filter(|ratio| ratio.is_finite()),
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{curve, data};
    use super::*;

    /// Runs with a squared error of `mse / samples`, at `seconds` per sample.
    fn runs(backend: &str, sampler: &str, mse: f64, seconds: f64) -> Vec<Run> {
        let point = |seed: u32, samples: u64| {
            // Two seeds are better than the mean, two are worse.
            let mse = mse / samples as f64 * if seed < 2 { 0.5 } else { 1.5 };
            let seconds = seconds * samples as f64;
            Measured {
                samples,
                wall_seconds: seconds,
                mse,
                rel_mse: 2.0 * mse,
                mse_estimate: (samples > 1).then_some(1.21 * mse),
                rejected: 0,
            }
        };
        let run = |seed| Run {
            curve: curve(backend, sampler),
            seed,
            about: backend.to_owned(),
            points: (0..9).map(|power| point(seed, 1 << power)).collect(),
        };
        (0..4).map(run).collect()
    }

    fn one(runs: Vec<Run>, targets: &[f64]) -> CurveSummary {
        curves(&Data { runs, ..data() }, targets).remove(0)
    }

    #[test]
    fn curve_slope_times_and_spread() {
        let found = one(runs("cpu", "sobol", 0.04, 0.01), &[0.01, 0.001]);
        let last = found.points.last().unwrap();
        assert!((last.rmse - 0.2 / 16.0).abs() < 1e-12, "{last:?}");
        assert!(last.range[0] < last.rmse && last.rmse < last.range[1]);
        assert!(
            (last.estimate_ratio.unwrap() - 1.1).abs() < 1e-9 && found.points[0].estimate_ratio.is_none()
        );
        assert!((found.slope.unwrap()[0] + 0.5).abs() < 1e-9);
        let [first, second] = [0, 1].map(|target| found.times[target].unwrap());
        assert!((first.time - 4.0).abs() < 1e-6 && first.is_extrapolated, "{first:?}");
        assert!((second.time - 400.0).abs() < 1e-4 && second.is_extrapolated);
        assert!((found.efficiency - 2500.0).abs() < 1e-6, "{}", found.efficiency);
    }

    #[test]
    fn picture_better_than_reference_has_no_error() {
        let mut better = runs("cpu", "sobol", 0.04, 0.01);
        better.iter_mut().for_each(|run| run.points[8].mse = -1e-6);
        let found = one(better, &[0.01]);
        let last = found.points.last().unwrap();
        assert_eq!(last.rmse, 0.0);
        assert!((found.slope.unwrap()[0] + 0.5).abs() < 1e-9, "{:?}", found.slope);
        assert!((found.times[0].unwrap().time - 4.0).abs() < 1e-6, "{:?}", found.times);
    }

    #[test]
    fn curve_ends_with_most_pictures() {
        let mut some = runs("cpu", "sobol", 1.0, 1.0);
        some[0].points.truncate(5);
        some[1].points.truncate(3);
        let samples: Vec<u64> = one(some, &[]).points.iter().map(|point| point.samples).collect();
        assert_eq!(samples, [1, 2, 4, 8, 16], "half of the pictures are not most of them");
    }
}
