//! Checks whether the error estimates of pictures are accurate.

use super::data::{Curve, Data, Measured};
use serde::Serialize;
use std::collections::BTreeMap;

/// An estimate counts as accurate if its ratio to the true error differs from 1 by at most this.
pub const TOLERANCE: f64 = 0.05;

/// Pictures with fewer samples are not checked, because no stop condition uses their estimates.
const FROM_SAMPLES: u64 = 16;

/// Estimated and true errors of a curve's pictures at one number of samples.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Calibration {
    /// The curve.
    #[serde(flatten)]
    pub curve: Curve,
    /// Samples per pixel.
    pub samples: u64,
    /// Number of pictures.
    pub seeds: usize,
    /// Square root of the mean estimated squared error.
    pub predicted_rmse: f64,
    /// Square root of the mean squared error.
    pub actual_rmse: f64,
    /// Predicted over actual RMSE.
    pub ratio: f64,
    /// Standard deviation of the ratio, by the jackknife; NaN if one picture outweighs all others.
    pub deviation: f64,
}

impl Calibration {
    /// Whether the ratio is 1 to within [`TOLERANCE`].
    pub fn holds(&self) -> bool {
        (self.ratio - 1.0).abs() <= TOLERANCE
    }

    fn of(curve: &Curve, samples: u64, pairs: &[[f64; 2]]) -> Option<Self> {
        let count = pairs.len() as f64;
        let [predicted, actual] = [0, 1].map(|side| pairs.iter().map(|pair| pair[side]).sum::<f64>());
        let left_out = || pairs.iter().map(|pair| ((predicted - pair[0]) / (actual - pair[1])).sqrt());
        let mean = left_out().sum::<f64>() / count;
        let squares: f64 = left_out().map(|ratio| (ratio - mean).powi(2)).sum();
        let is_sound = pairs.len() > 1 && predicted > 0.0 && actual > 0.0;
        is_sound.then(|| Calibration {
            curve: curve.clone(),
            samples,
            seeds: pairs.len(),
            predicted_rmse: (predicted / count).sqrt(),
            actual_rmse: (actual / count).sqrt(),
            ratio: (predicted / actual).sqrt(),
            deviation: (squares * (count - 1.0) / count).sqrt(),
        })
    }
}

/// Estimated and true squared error of each picture, by curve and number of samples.
type Pairs<'a> = BTreeMap<(&'a Curve, u64), Vec<[f64; 2]>>;

/// One entry for each curve with error estimates and each number of samples from 16 on.
pub fn calibration(data: &Data) -> Vec<Calibration> {
    let mut pairs: Pairs<'_> = BTreeMap::new();
    for run in &data.runs {
        for Measured { samples, mse, mse_estimate, .. } in &run.points {
            if let (Some(estimate), FROM_SAMPLES..) = (mse_estimate, *samples) {
                pairs.entry((&run.curve, *samples)).or_default().push([*estimate, *mse]);
            }
        }
    }
    let rows = pairs.iter().filter_map(|((curve, samples), pairs)| Calibration::of(curve, *samples, pairs));
    rows.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ratio_has_its_deviation() {
        let curve = Curve { scene: "s".into(), backend: "cpu".into(), sampler: "sobol".into() };
        let of = |pairs: &[[f64; 2]]| Calibration::of(&curve, 16, pairs);
        let even = of(&[[1.21, 1.0]; 4]).unwrap();
        assert!((even.ratio - 1.1).abs() < 1e-12 && even.deviation < 1e-12 && !even.holds(), "{even:?}");
        // The relative error of the mean of n values with relative deviation d is d over the root of n, that of its
        // root half.
        let pairs: Vec<[f64; 2]> = (0..24).map(|k| [if k % 2 == 0 { 0.9 } else { 1.1 }, 1.0]).collect();
        let uneven = of(&pairs).unwrap();
        let expected = 0.5 * 0.1 / f64::sqrt(23.0);
        assert!(uneven.holds() && (uneven.deviation / expected - 1.0).abs() < 0.02, "{uneven:?}");
        assert_eq!(of(&[[1.0, 1.0]]), None);
        // Without an error or an estimate there is no ratio.
        assert_eq!(of(&[[0.0, 1.0], [0.0, 2.0]]), None);
        assert_eq!(of(&[[1.0, 0.0], [2.0, 0.0]]), None);
    }

    #[test]
    fn a_ratio_is_that_of_the_roots_of_the_means() {
        let curve = Curve { scene: "s".into(), backend: "cpu".into(), sampler: "sobol".into() };
        let found = Calibration::of(&curve, 64, &[[1.0, 2.0], [3.0, 6.0], [5.0, 8.0]]).unwrap();
        // Without one of the pictures, the sums are 8 of 14, 6 of 10 and 4 of 8.
        let ratios = [8.0 / 14.0, 6.0 / 10.0, 4.0 / 8.0].map(f64::sqrt);
        let mean = ratios.iter().sum::<f64>() / 3.0;
        let squares: f64 = ratios.iter().map(|ratio| (ratio - mean) * (ratio - mean)).sum();
        assert_eq!((found.curve, found.samples, found.seeds), (curve, 64, 3));
        for (value, expected) in [
            (found.predicted_rmse, 3.0_f64.sqrt()),
            (found.actual_rmse, (16.0_f64 / 3.0).sqrt()),
            (found.ratio, 0.75),
            (found.deviation, (squares * 2.0 / 3.0).sqrt()),
        ] {
            assert!((value - expected).abs() < 1e-12, "{value} {expected}");
        }
    }

    #[test]
    fn a_ratio_may_be_off_by_the_tolerance() {
        let curve = Curve { scene: "s".into(), backend: "cpu".into(), sampler: "sobol".into() };
        let holds = |ratio: f64| {
            let pairs = [[ratio * ratio, 1.0]; 2];
            Calibration::of(&curve, 16, &pairs).unwrap().holds()
        };
        let ratios = [0.949, 0.951, 1.0, 1.049, 1.051];
        assert_eq!(ratios.map(holds), [false, true, true, true, false]);
    }
}
