//! Small pictures, on which many hypotheses are tried: the reader's picture in linear values, which noise does not bias, and
//! the difference of each hypothesis to a base, from the same random numbers.

use super::hypothesis::{Hypothesis, Rendered, Studio};
use super::written::{Seen, reduced};
use anyhow::Result;

/// Samples per pixel of a base, by the program's own tracer and by the plain one.
const SAMPLES: [u64; 2] = [1024, 128];

/// A base on a small picture.
pub struct Screen {
    pub base: Hypothesis,
    factor: u32,
    /// The reader's picture, and that of the base, linear; none of the reader's values is above `most`.
    values: Vec<[f64; 3]>,
    most: f64,
    mean: Vec<[f64; 3]>,
    /// Variance of their difference.
    noise: Vec<[f64; 3]>,
    /// The base as it is rendered for differences: whether by the plain tracer, and the number of samples.
    own: Vec<((bool, u64), Rendered)>,
}

impl Screen {
    /// `samples` is the number that the reader's noise tells.
    pub fn new(
        studio: &mut Studio,
        base: &Hypothesis,
        seen: &Seen,
        factor: u32,
        samples: Option<f64>,
    ) -> Result<Self> {
        let rendered = small(studio, base, factor, SAMPLES[usize::from(base.steps.is_some())])?;
        let theirs = samples.unwrap_or(1e3) * f64::from(factor * factor);
        let noise = rendered.variance.iter().zip(&rendered.error);
        let noise = noise.map(|(one, own)| [0, 1, 2].map(|c| one[c] / theirs + own[c])).collect();
        Ok(Screen {
            values: reduced(&seen.values, seen.size[0] as usize, factor as usize),
            mean: rendered.mean(),
            most: base.written.linear(255, 0, 1)[0],
            noise,
            base: base.clone(),
            own: Vec::new(),
            factor,
        })
    }

    /// The weight of each value, 0 where it is not known: equal in displayed values, or, near the truth, that of its noise.
    pub fn weights(&self, is_far: bool) -> Vec<f64> {
        let all =
            self.values.as_flattened().iter().zip(self.mean.as_flattened()).zip(self.noise.as_flattened());
        all.map(|((value, mean), noise)| {
            if !value.is_finite() {
                return 0.0;
            }
            // The square of four bytes, or of a third, at these values: rounding may be the same all over a smooth sky.
            let byte = (value.max(0.02).sqrt() + mean.clamp(0.02, 1.0).sqrt()).powi(2) / 65_536.0;
            if is_far { 1.0 / (16.0 * byte) } else { 1.0 / (noise + 0.1 * byte) }
        })
        .collect()
    }

    /// What a picture with `samples` per pixel leaves of the reader's, 0 where that is not known.
    pub fn rest(&mut self, studio: &mut Studio, of: &Hypothesis, samples: u64) -> Result<Vec<f64>> {
        let [here, there] = self.both(studio, of, samples)?;
        Ok(self.left(&here.mean(), &there.mean()))
    }

    /// The same by each half of the picture, which have independent noise.
    pub fn halves(&mut self, studio: &mut Studio, of: &Hypothesis, samples: u64) -> Result<[Vec<f64>; 2]> {
        let [here, there] = self.both(studio, of, samples)?;
        Ok([0, 1].map(|half| self.left(&here.halves[half], &there.halves[half])))
    }

    /// The base and a hypothesis, with the same random numbers.
    fn both(&mut self, studio: &mut Studio, of: &Hypothesis, samples: u64) -> Result<[Rendered; 2]> {
        let is_plain =
            of.steps.is_some() && !(self.base.steps.is_some() && of.rows.len() == self.base.rows.len());
        let (mut base, mut own) = (self.base.clone(), of.clone());
        if is_plain {
            base.plain();
        } else {
            (base.steps, own.steps) = (None, None);
        }
        let key = (is_plain, samples);
        let here = match self.own.iter().find(|(known, _)| *known == key) {
            Some((_, here)) => here.clone(),
            None => {
                let here = small(studio, &base, self.factor, samples)?;
                self.own.push((key, here.clone()));
                here
            }
        };
        Ok([here, small(studio, &own, self.factor, samples)?])
    }

    /// What the picture of a base leaves that changes from `here` to `there`.
    fn left(&self, here: &[[f64; 3]], there: &[[f64; 3]]) -> Vec<f64> {
        let [values, mean, here, there] =
            [&self.values[..], &self.mean, here, there].map(|pixels| pixels.as_flattened());
        let rest = |at: usize| values[at] - (mean[at] + there[at] - here[at]).clamp(0.0, self.most);
        (0..values.len()).map(rest).map(|x| if x.is_finite() { x } else { 0.0 }).collect()
    }

    /// The mean square of what the base leaves if it is as bright as fits best, in bytes.
    pub fn brightened(&self) -> f64 {
        let pairs = self.values.as_flattened().iter().zip(self.mean.as_flattened());
        // A value at the top of its range is only a lower bound.
        let known = || {
            pairs
                .clone()
                .zip(self.weights(true))
                .filter(|((value, _), weight)| **value < 0.98 * self.most && *weight > 0.0)
        };
        let sum = |of: &dyn Fn(f64, f64) -> f64| {
            known().map(|((value, mean), weight)| weight * of(*value, *mean)).sum::<f64>()
        };
        let factor = sum(&|value, mean| value * mean) / sum(&|_, mean| mean * mean);
        16.0 * sum(&|value, mean| (value - factor * mean).powi(2)) / known().count() as f64
    }

    /// The mean square of what is left beyond noise, in bytes, and its deviation.
    pub fn excess(&mut self, studio: &mut Studio, of: &Hypothesis, samples: u64) -> Result<[f64; 2]> {
        let [a, b] = self.halves(studio, of, samples)?;
        let weights = self.weights(true);
        let known = weights.iter().enumerate().filter(|(_, weight)| **weight > 0.0);
        let of_value =
            |(at, weight): (usize, &f64)| 16.0 * weight * (a[at] * b[at] - self.noise.as_flattened()[at]);
        let values: Vec<f64> = known.map(of_value).collect();
        let count = values.len() as f64 + 1e-9;
        let mean = values.iter().sum::<f64>() / count;
        Ok([mean, values.iter().map(|x| (x - mean).powi(2)).sum::<f64>().sqrt() / count])
    }
}

/// A hypothesis as a small picture.
pub fn small(studio: &mut Studio, of: &Hypothesis, factor: u32, samples: u64) -> Result<Rendered> {
    // Without antialiasing, a small render has coarser edges than a reduced one.
    if of.is_exact() {
        let whole = studio.render(of, 1, 1, None)?;
        return Ok(whole.reduced(of.size()[0] as usize, factor as usize));
    }
    studio.render(of, factor, samples, None)
}
