//! Reasons to distrust a film or the estimate of its error, in words.

use super::{ErrorEstimate, FIXED_POINT_SCALE, Film, ROUNDING_LIMIT};
use crate::number::Number;

/// The error estimate is doubtful if it effectively rests on fewer pixels than this.
const PIXELS_IN_EFFECT_MIN: f64 = 100.0;

/// It is doubtful only if these are also less than this share of all pixels: small pictures have few pixels.
const DOMINANT_SHARE: f64 = 0.2;

/// A doubtful estimate must be below a target by this many of its standard deviations.
const DEVIATIONS: f64 = 3.0;

/// Rounding matters if it can cost more than this share of the brightness.
const ROUNDING_SHARE: f64 = 0.01;

/// Below this brightness, rounding matters.
const FAINT: f64 = ROUNDING_LIMIT / ROUNDING_SHARE;

/// How films round, and what to do if that matters.
const STEPS: &str = "samples are rounded to multiples of 2^-24 (6e-8)";
const REMEDY: &str = "brighten the values of the sky, and scale the picture afterwards";

/// The light in a film.
enum Light {
    /// There is none.
    None,
    /// The mean of what is not black, linear radiance, is so low that rounding matters.
    Faint(f64),
    /// Rounding does not matter.
    Enough,
}

impl Film {
    /// Whether the error of this film, of which `estimate` is the estimate, is at most `target`, whatever is doubtful: an
    /// estimate that few pixels dominate must be lower, and while no path has found any light, the error may be as large
    /// as `brightest`, the largest radiance that a sample can have.
    pub fn meets(&self, target: f64, estimate: Option<&ErrorEstimate>, brightest: f64) -> bool {
        match estimate {
            Some(found) if self.rests_on_few_pixels(found) => {
                found.rmse + DEVIATIONS * found.rmse_deviation <= target
            }
            Some(found) => found.rmse <= target,
            None => self.has_both_halves() && brightest <= target,
        }
    }

    /// Why this film or the estimate of its error is doubtful, in words: rounding matters, no path has found any light, or
    /// few pixels dominate the estimate. The estimate and its deviation are then most likely too low. `brightest` is the
    /// largest radiance that a sample can have, 0 if the scene has no light.
    pub fn doubt(&self, estimate: Option<&ErrorEstimate>, brightest: f64) -> Option<String> {
        match self.light() {
            Light::None => self.doubt_in_the_dark(brightest),
            Light::Faint(mean) => Some(format!(
                "the picture is so dark that rounding matters: its brightness is {mean:.1e}, and {STEPS}, which can cost \
                 {:.0} % of it; {REMEDY}",
                (100.0 * ROUNDING_LIMIT / mean).min(100.0)
            )),
            Light::Enough => self.doubt_of_few_pixels(estimate?),
        }
    }

    fn doubt_in_the_dark(&self, brightest: f64) -> Option<String> {
        let count = self.sample_count();
        let shown = Number(brightest);
        if count == 0 {
            None
        } else if brightest <= 0.0 {
            Some(
                "the picture is black, because the scene has no light; give the sky values above 0"
                    .to_owned(),
            )
        } else if brightest <= ROUNDING_LIMIT {
            Some(format!(
                "the picture is black, because the brightest light of the scene is {shown} and {STEPS}, so that every \
                 sample becomes 0; {REMEDY}"
            ))
        } else if brightest < FAINT {
            Some(format!(
                "the picture is black: the brightest light of the scene is {shown}, and {STEPS}, so that much of what \
                 paths find becomes 0; {REMEDY}"
            ))
        } else {
            self.has_both_halves().then(|| {
                format!(
                    "no path has found any light in {count} samples per pixel, so the error cannot be estimated; more \
                     samples may find some"
                )
            })
        }
    }

    fn rests_on_few_pixels(&self, estimate: &ErrorEstimate) -> bool {
        let (pixels, all) = (estimate.pixels_in_effect(), self.halves.first().map_or(0, Vec::len));
        pixels < PIXELS_IN_EFFECT_MIN && pixels < DOMINANT_SHARE * all as f64
    }

    fn doubt_of_few_pixels(&self, estimate: &ErrorEstimate) -> Option<String> {
        let (pixels, all) = (estimate.pixels_in_effect(), self.halves.first().map_or(0, Vec::len));
        self.rests_on_few_pixels(estimate).then(|| {
            format!(
                "a few pixels dominate the error estimate: it effectively rests on {pixels:.0} of {all} pixels, but needs \
                 {PIXELS_IN_EFFECT_MIN:.0}; until there are more samples it may be far too low"
            )
        })
    }

    fn light(&self) -> Light {
        let scale = 1.0 / (self.sample_count().max(1) as f64 * FIXED_POINT_SCALE);
        let channels = 3.0 * self.halves.first().map_or(0, Vec::len) as f64;
        let (mut sum, mut lit) = (0.0, 0_u64);
        for pixel in 0..self.halves.first().map_or(0, Vec::len) {
            for channel in self.pixel_sum(pixel).0 {
                sum += channel as f64 * scale;
                lit += u64::from(channel > 0);
            }
            // The mean of what is not black cannot be lower than that of everything.
            if sum >= FAINT * channels {
                return Light::Enough;
            }
        }
        match sum / lit as f64 {
            _ if lit == 0 => Light::None,
            mean if mean < FAINT => Light::Faint(mean),
            _ => Light::Enough,
        }
    }
}
