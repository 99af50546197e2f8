//! Small pictures, on which many hypotheses are tried: the reader's picture in linear values, which noise does not bias, and
//! the difference of each hypothesis to a base, from the same random numbers.

use super::hypothesis::{Hypothesis, Rendered, Studio};
use super::written::{Seen, reduced};
use anyhow::Result;

/// Samples per pixel of a base, of its variations, and of those that the plain tracer renders.
const SAMPLES: [u64; 3] = [256, 64, 8];

/// A base on a small picture.
pub struct Screen<'s, 'a> {
    studio: &'s mut Studio<'a>,
    pub base: Hypothesis,
    factor: u32,
    /// The reader's picture, and that of the base, linear; none of the reader's values is above `most`.
    values: Vec<[f64; 3]>,
    most: f64,
    mean: Vec<[f64; 3]>,
    /// Variance of their difference.
    noise: Vec<[f64; 3]>,
    /// The base with few samples, by each tracer.
    own: [Option<Rendered>; 2],
}

impl<'s, 'a> Screen<'s, 'a> {
    /// `samples` is the number that the reader's noise tells.
    pub fn new(
        studio: &'s mut Studio<'a>,
        base: &Hypothesis,
        seen: &Seen,
        factor: u32,
        samples: Option<f64>,
    ) -> Result<Self> {
        let few = if base.steps.is_some() { 2 * SAMPLES[1] } else { SAMPLES[0] };
        let rendered = small(studio, base, factor, few)?;
        let theirs = samples.unwrap_or(1e3) * f64::from(factor * factor);
        let noise = rendered.variance.iter().zip(&rendered.error);
        let noise = noise.map(|(one, own)| [0, 1, 2].map(|c| one[c] / theirs + own[c])).collect();
        Ok(Screen {
            values: reduced(&seen.values, seen.size[0] as usize, factor as usize),
            mean: rendered.mean(),
            most: base.written.linear(255, 0, 1)[0],
            noise,
            base: base.clone(),
            own: [None, None],
            studio,
            factor,
        })
    }

    /// The weight of each value, 0 where it is not known: equal in displayed values, or, near the truth, that of its noise.
    pub fn weights(&self, is_far: bool) -> Vec<f64> {
        let all = self.values.as_flattened().iter().zip(self.noise.as_flattened());
        all.map(|(value, noise)| {
            if !value.is_finite() {
                return 0.0;
            }
            // The square of four bytes, or of a third, at this value: rounding may be the same all over a smooth sky.
            let byte = 4.0 * value.max(0.02) / 65_536.0;
            if is_far { 1.0 / (16.0 * byte) } else { 1.0 / (noise + 0.1 * byte) }
        })
        .collect()
    }

    /// The difference of a hypothesis to the base; `half` is one of its halves, with independent noise.
    fn difference(&mut self, of: &Hypothesis, half: Option<usize>) -> Result<Vec<[f64; 3]>> {
        let is_plain = of.steps.is_some()
            && !(of.steps.is_some() == self.base.steps.is_some() && of.rows.len() == self.base.rows.len());
        let (mut base, mut own) = (self.base.clone(), of.clone());
        if is_plain {
            base.plain();
        } else {
            (base.steps, own.steps) = (None, None);
        }
        let samples = SAMPLES[if is_plain { 2 } else { 1 }];
        let at_base = &mut self.own[usize::from(is_plain)];
        if at_base.is_none() {
            *at_base = Some(small(self.studio, &base, self.factor, samples)?);
        }
        let there = small(self.studio, &own, self.factor, samples)?;
        let Some(here) = at_base else { return Ok(Vec::new()) };
        let picture = |of: &Rendered| half.map_or_else(|| of.mean(), |half| of.halves[half].clone());
        let pixels = picture(&there).into_iter().zip(picture(here));
        Ok(pixels.map(|(there, here)| [0, 1, 2].map(|c| there[c] - here[c])).collect())
    }

    /// What is left of the reader's picture, 0 where it is not known.
    pub fn rest(&mut self, of: &Hypothesis, half: Option<usize>) -> Result<Vec<f64>> {
        let difference = self.difference(of, half)?;
        let all =
            self.values.as_flattened().iter().zip(self.mean.as_flattened()).zip(difference.as_flattened());
        let rest = all.map(|((value, mean), more)| value - (mean + more).clamp(0.0, self.most));
        Ok(rest.map(|x| if x.is_finite() { x } else { 0.0 }).collect())
    }

    /// The mean square of what is left beyond noise, in bytes.
    pub fn excess(&mut self, of: &Hypothesis) -> Result<f64> {
        let [a, b] = [self.rest(of, Some(0))?, self.rest(of, Some(1))?];
        let weights = self.weights(true);
        let (mut sum, mut count) = (0.0, 1e-9);
        for (index, weight) in weights.iter().enumerate().filter(|(_, weight)| **weight > 0.0) {
            sum += 16.0 * weight * (a[index] * b[index] - self.noise.as_flattened()[index]);
            count += 1.0;
        }
        Ok(sum / count)
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
