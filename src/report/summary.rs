//! Summarises the runs of a curve, and compares curves.

use super::data::{Curve, Data, Measured, Run};
use crate::statistics::fit::{Crossing, Point, PowerLaw, time_to};
use crate::statistics::median;
use serde::Serialize;
use std::collections::BTreeMap;

/// The slope is fitted from this many samples on: smaller pictures finish before all threads are at work.
const SLOPE_FROM_SAMPLES: u64 = 16;

/// The pictures of a curve at one number of samples.
#[derive(Clone, Debug, PartialEq)]
pub struct CurvePoint {
    /// Samples per pixel.
    pub samples: u64,
    /// Number of pictures.
    pub seeds: usize,
    /// Median seconds of tracing.
    pub trace_seconds: f64,
    /// Median seconds of tracing and adding to the film.
    pub wall_seconds: f64,
    /// Median seconds on the device's own clock; `None` if it has none.
    pub device_seconds: Option<f64>,
    /// Square root of the mean squared error over all pictures; 0 if they are better than the reference.
    pub rmse: f64,
    /// Smallest and largest RMSE of a single picture.
    pub range: [f64; 2],
    /// Mean relative squared error.
    pub rel_mse: f64,
    /// Mean FLIP.
    pub flip: f64,
    /// Square root of the ratio of the mean estimated squared error to the true one; `None` if either is missing.
    pub estimate_ratio: Option<f64>,
}

/// A curve of the plot.
#[derive(Clone, Debug, PartialEq)]
pub struct CurveSummary {
    /// Scene, backend and sampler.
    pub curve: Curve,
    /// Full name of the backend.
    pub about: String,
    /// Ordered by the number of samples.
    pub points: Vec<CurvePoint>,
    /// Exponent of the seconds in the RMSE, and its standard error.
    pub slope: Option<[f64; 2]>,
    /// `1 / (MSE seconds)` at the last point that has an error; NaN if there is none.
    pub efficiency: f64,
    /// Seconds until each target is reached.
    pub times: Vec<Option<Crossing>>,
}

impl CurveSummary {
    fn of(curve: &Curve, runs: &[&Run], targets: &[f64]) -> Self {
        let mut by_samples: BTreeMap<u64, Vec<&Measured>> = BTreeMap::new();
        for point in runs.iter().flat_map(|run| &run.points) {
            by_samples.entry(point.samples).or_default().push(point);
        }
        // If noise of the machine ended some runs early, the longer runs alone do not represent the curve.
        by_samples.retain(|_, points| 2 * points.len() > runs.len());
        let points: Vec<CurvePoint> =
            by_samples.into_iter().map(|(samples, points)| curve_point(samples, &points)).collect();
        // The error of a picture that is better than its reference is unknown.
        let known = || points.iter().filter(|p| p.rmse > 0.0);
        let errors: Vec<Point> = known().map(|p| Point { time: p.wall_seconds, error: p.rmse }).collect();
        let first = known().position(|p| p.samples >= SLOPE_FROM_SAMPLES).unwrap_or(0);
        CurveSummary {
            curve: curve.clone(),
            about: runs.first().map_or_else(String::new, |run| run.about.clone()),
            slope: PowerLaw::through(&errors[first..]).map(|law| [law.slope, law.slope_deviation]),
            efficiency: known().next_back().map_or(f64::NAN, |p| 1.0 / (p.rmse * p.rmse * p.wall_seconds)),
            times: targets.iter().map(|target| time_to(&errors, *target)).collect(),
            points,
        }
    }
}

fn curve_point(samples: u64, points: &[&Measured]) -> CurvePoint {
    let count = points.len() as f64;
    let mean = |of: fn(&Measured) -> f64| points.iter().map(|p| of(p)).sum::<f64>() / count;
    let median_of = |of: fn(&Measured) -> f64| median(points.iter().map(|p| of(p))).unwrap_or(f64::NAN);
    let mse = mean(|p| p.mse).max(0.0);
    let estimates: Option<Vec<f64>> = points.iter().map(|p| p.mse_estimate).collect();
    let device: Option<Vec<f64>> = points.iter().map(|p| p.device_seconds).collect();
    let roots = || points.iter().map(|p| p.mse.max(0.0).sqrt());
    CurvePoint {
        samples,
        seeds: points.len(),
        trace_seconds: median_of(|p| p.trace_seconds),
        wall_seconds: median_of(|p| p.wall_seconds),
        device_seconds: device.and_then(median),
        rmse: mse.sqrt(),
        range: [roots().fold(f64::INFINITY, f64::min), roots().fold(0.0, f64::max)],
        rel_mse: mean(|p| p.rel_mse),
        flip: mean(|p| p.flip),
        estimate_ratio: estimates
            .filter(|_| mse > 0.0)
            .map(|all| (all.iter().sum::<f64>() / count / mse).sqrt()),
    }
}

/// All curves that have runs, in the order of their first run.
pub fn summaries(data: &Data, targets: &[f64]) -> Vec<CurveSummary> {
    let mut curves: Vec<&Curve> = Vec::new();
    for run in &data.runs {
        if !curves.contains(&&run.curve) {
            curves.push(&run.curve);
        }
    }
    curves
        .into_iter()
        .map(|curve| {
            let runs: Vec<&Run> = data.runs.iter().filter(|run| run.curve == *curve).collect();
            CurveSummary::of(curve, &runs, targets)
        })
        .collect()
}

/// Compares the samplers on one backend.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SamplerRatio {
    /// The scene.
    pub scene: String,
    /// The backend.
    pub backend: String,
    /// Samples per pixel.
    pub samples: u64,
    /// Squared error of independent samples relative to that of Sobol points.
    pub at_equal_samples: f64,
    /// The same at equal time: how many times as long independent samples take.
    pub at_equal_time: f64,
}

/// Compares `sobol` with `independent` at every number of samples that both have.
pub fn sampler_ratios(curves: &[CurveSummary]) -> Vec<SamplerRatio> {
    let mut ratios = Vec::new();
    for sobol in curves.iter().filter(|c| c.curve.sampler == "sobol") {
        let other = curves.iter().find(|c| {
            c.curve.sampler == "independent"
                && (&c.curve.scene, &c.curve.backend) == (&sobol.curve.scene, &sobol.curve.backend)
        });
        let Some(independent) = other else { continue };
        for point in sobol.points.iter().filter(|p| p.rmse > 0.0) {
            let Some(other) = independent.points.iter().find(|p| p.samples == point.samples) else {
                continue;
            };
            let at_equal_samples = (other.rmse / point.rmse).powi(2);
            ratios.push(SamplerRatio {
                scene: sobol.curve.scene.clone(),
                backend: sobol.curve.backend.clone(),
                samples: point.samples,
                at_equal_samples,
                at_equal_time: at_equal_samples * other.wall_seconds / point.wall_seconds,
            });
        }
    }
    ratios
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The runs of a curve whose squared error is `mse / samples`, at `seconds` per sample.
    pub fn runs(backend: &str, sampler: &str, mse: f64, seconds: f64) -> Vec<Run> {
        let curve = Curve { scene: "s".to_owned(), backend: backend.to_owned(), sampler: sampler.to_owned() };
        (0..4)
            .map(|seed| Run {
                curve: curve.clone(),
                seed,
                about: backend.to_owned(),
                prepare_seconds: 0.0,
                points: (0..9)
                    .map(|power| {
                        let samples = 1_u64 << power;
                        // Two seeds are better than the mean, and two are worse.
                        let mse = mse / samples as f64 * if seed < 2 { 0.5 } else { 1.5 };
                        let seconds = seconds * samples as f64;
                        Measured {
                            samples,
                            trace_seconds: seconds,
                            wall_seconds: seconds,
                            device_seconds: None,
                            mse,
                            rel_mse: 2.0 * mse,
                            flip: 0.1,
                            mse_estimate: (samples > 1).then_some(1.21 * mse),
                            rejected: 0,
                        }
                    })
                    .collect(),
            })
            .collect()
    }

    #[test]
    fn a_curve_has_its_slope_its_times_and_its_spread() {
        let data_runs = runs("cpu", "sobol", 0.04, 0.01);
        let all: Vec<&Run> = data_runs.iter().collect();
        let found = CurveSummary::of(&data_runs[0].curve, &all, &[0.01, 0.001]);
        let last = found.points.last().unwrap();
        assert!((last.rmse - 0.2 / 16.0).abs() < 1e-12 && last.seeds == 4, "{last:?}");
        assert!(last.range[0] < last.rmse && last.rmse < last.range[1]);
        assert!((last.estimate_ratio.unwrap() - 1.1).abs() < 1e-9);
        assert_eq!(found.points[0].estimate_ratio, None);
        assert!((found.slope.unwrap()[0] + 0.5).abs() < 1e-9);
        let [first, second] = [0, 1].map(|target| found.times[target].unwrap());
        assert!((first.time - 4.0).abs() < 1e-6 && first.is_extrapolated, "{first:?}");
        assert!((second.time - 400.0).abs() < 1e-4 && second.is_extrapolated);
        assert!((found.efficiency - 2500.0).abs() < 1e-6, "{}", found.efficiency);
    }

    #[test]
    fn a_picture_that_is_better_than_the_reference_has_no_error_to_go_by() {
        let mut better = runs("cpu", "sobol", 0.04, 0.01);
        for run in &mut better {
            run.points[8].mse = -1e-6;
        }
        let all: Vec<&Run> = better.iter().collect();
        let found = CurveSummary::of(&better[0].curve, &all, &[0.01]);
        let last = found.points.last().unwrap();
        assert_eq!((last.rmse, last.estimate_ratio), (0.0, None));
        assert!((found.slope.unwrap()[0] + 0.5).abs() < 1e-9, "{:?}", found.slope);
        assert!((found.times[0].unwrap().time - 4.0).abs() < 1e-6, "{:?}", found.times);
        assert!((found.efficiency - 2500.0).abs() < 1e-6, "{}", found.efficiency);
    }

    #[test]
    fn samplers_are_compared_at_equal_samples_and_at_equal_time() {
        let all = [runs("cpu", "sobol", 0.01, 0.012), runs("cpu", "independent", 0.04, 0.01)].concat();
        let of = |sampler: &str| {
            let some: Vec<&Run> = all.iter().filter(|run| run.curve.sampler == sampler).collect();
            CurveSummary::of(&some[0].curve, &some, &[0.01])
        };
        let ratios = sampler_ratios(&[of("sobol"), of("independent")]);
        assert_eq!(ratios.len(), 9);
        assert!(ratios.iter().all(|r| (r.at_equal_samples - 4.0).abs() < 1e-9));
        assert!(ratios.iter().all(|r| (r.at_equal_time - 4.0 / 1.2).abs() < 1e-9));
    }

    #[test]
    fn a_point_has_more_than_half_of_the_pictures() {
        let mut some = runs("cpu", "sobol", 0.04, 0.01);
        let last = |runs: &[Run]| {
            let all: Vec<&Run> = runs.iter().collect();
            let found = CurveSummary::of(&runs[0].curve, &all, &[]);
            found.points.last().map(|point| (point.samples, point.seeds))
        };
        some[0].points.pop();
        assert_eq!(last(&some), Some((256, 3)));
        some[1].points.pop();
        assert_eq!(last(&some), Some((128, 4)));
    }
}
