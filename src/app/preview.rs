//! How coarse a preview is: as fine as the time from request to picture allows.

use super::model::Document;
use crate::progressive::Status;
use crate::stages::Shading;

/// Target latency of a preview in seconds, from input to display.
const SECONDS: f64 = 0.05;

/// If a preview took longer than this many seconds, the next one is coarser.
const SECONDS_LIMIT: f64 = 0.07;

/// A picture whose first samples would take longer than this many seconds is shown as a preview first.
const PATIENCE: f64 = 0.1;

/// The divisors by which a picture gets finer after a move, if each takes no longer than so many seconds.
const STEPS: [u32; 3] = [8, 4, 2];
const STEP_SECONDS: f64 = 0.4;

/// Samples per pixel of a preview of a picture with noise, except the coarsest. A quarter of the pixels with four samples
/// each show more than all of them with one: the eye sees noise in each pixel, but does not miss the pixels of a picture
/// that moves.
const SAMPLES: u64 = 4;

/// The coarsest divisor of previews, and the pixels that the longer side keeps in large pictures in any case.
const DIVISOR: u32 = 8;
const LEAST_SIDE: u32 = 100;

/// Samples per second that are expected of a CPU before anything has been traced.
const USUAL_SPEED: f64 = 3e6;

/// Samples per second of the first preview, as a share of those of a render: passes are short, and a render must end first.
const SHARE: f64 = 0.3;

/// Chooses previews by the time that earlier ones took. A preview is the factor by which it is smaller; with 1 it is the
/// picture itself.
#[derive(Default)]
pub struct Previews {
    /// Samples per second of the last preview, from request to picture. It includes the cost of drawing the window.
    speed: Option<f64>,
    /// Samples per second of the last render.
    render_speed: Option<f64>,
    /// The preview of the present move, if something moves.
    pub moving: Option<u32>,
}

impl Previews {
    /// Notes the speed of a render.
    pub fn note_speed(&mut self, status: &Status) {
        let speed = status.paths_per_second();
        if speed > 0.0 {
            self.render_speed = Some(speed);
        }
    }

    /// The preview to show while something moves.
    pub fn follow_move(&mut self, document: &Document) -> u32 {
        *self.moving.insert(self.moving.unwrap_or_else(|| self.choose(document)))
    }

    /// The preview to show before the first samples of a picture. `coarser` is the preview on the screen; each one is at
    /// least twice as fine.
    pub fn look(&self, document: &Document, coarser: Option<u32>) -> u32 {
        let samples = pixels(document) * document.settings.half_count() as f64;
        if samples / self.render_speed.unwrap_or(USUAL_SPEED) <= PATIENCE {
            return 1;
        }
        let Some(coarser) = coarser else { return self.choose(document) };
        let affordable = self.speed.unwrap_or(USUAL_SPEED) * STEP_SECONDS;
        let is_step = |divisor: &u32| 2 * divisor <= coarser && cost(document, *divisor) <= affordable;
        STEPS.into_iter().find(is_step).unwrap_or(1)
    }

    /// The finest preview that can be afforded.
    fn choose(&self, document: &Document) -> u32 {
        let begin = SHARE * self.render_speed.unwrap_or(USUAL_SPEED);
        let affordable = self.speed.unwrap_or(begin) * SECONDS;
        let coarsest = coarsest(document);
        (1..coarsest).find(|divisor| cost(document, *divisor) <= affordable).unwrap_or(coarsest)
    }

    /// Notes that the first picture of a preview has come, with `samples` samples of all pixels together, after this many
    /// seconds.
    pub fn pictured(&mut self, document: &Document, divisor: u32, samples: f64, seconds: f64) {
        let seconds = seconds.max(1e-3);
        self.speed = Some(samples / seconds);
        // During a move, previews only get coarser: getting finer again would make them flicker.
        if let Some(moving) = &mut self.moving
            && seconds > SECONDS_LIMIT
        {
            let coarser = (f64::from(divisor) * (seconds / SECONDS).sqrt()).ceil() as u32;
            *moving = coarser.min(coarsest(document)).max(*moving);
        }
    }
}

/// Samples per pixel of a preview when it is first shown, a power of two.
pub fn samples_of(document: &Document, divisor: u32) -> u64 {
    let has_noise = document.rules().shading == Shading::Path;
    if divisor < coarsest(document) && has_noise { SAMPLES } else { 1 }
}

fn pixels(document: &Document) -> f64 {
    document.size().map(f64::from).into_iter().product()
}

/// Samples of all pixels of a preview.
fn cost(document: &Document, divisor: u32) -> f64 {
    pixels(document) * samples_of(document, divisor) as f64 / f64::from(divisor).powi(2)
}

/// The coarsest preview of a document.
fn coarsest(document: &Document) -> u32 {
    DIVISOR.max(document.size().into_iter().max().unwrap_or(1) / LEAST_SIDE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::Origin;

    use crate::stages::Stage;

    fn document(id: &str, size: [u32; 2]) -> Document {
        let mut document = Document::new(Origin::of_stage(Stage::find(id).unwrap()));
        document.give_size(size);
        document
    }

    fn at_speed(speed: f64) -> Previews {
        Previews { speed: Some(speed), ..Previews::default() }
    }

    #[test]
    fn noise_costs_pixels_and_not_samples() {
        // 400,000 samples in the time of a preview.
        let previews = at_speed(8e6);
        let noisy = document("book", [1000, 400]);
        assert_eq!((previews.choose(&noisy), samples_of(&noisy, 2)), (2, 4));
        let normals = document("normals", [1000, 400]);
        assert_eq!((previews.choose(&normals), samples_of(&normals, 2)), (1, 1));
    }

    #[test]
    fn a_slow_device_gets_few_samples_before_too_few_pixels() {
        let chosen = |speed: f64, size| {
            let document = document("book", size);
            let divisor = at_speed(speed).choose(&document);
            (divisor, samples_of(&document, divisor))
        };
        assert_eq!(chosen(2e5, [1024, 576]), (10, 1));
        assert_eq!(chosen(1e6, [1024, 576]), (7, 4));
        assert_eq!(chosen(2e4, [3840, 2160]), (38, 1), "100 pixels are left");
    }

    #[test]
    fn within_a_move_previews_only_get_coarser() {
        let (mut previews, document) = (at_speed(8e6), document("book", [1024, 576]));
        let first = previews.follow_move(&document);
        previews.pictured(&document, first, 1e6, 0.01);
        assert_eq!(previews.follow_move(&document), first, "faster than expected");
        previews.pictured(&document, first, 1e6, 0.2);
        assert_eq!(previews.follow_move(&document), first * 2);
        for _ in 0..3 {
            previews.pictured(&document, 8, 1e4, 0.2);
        }
        assert_eq!(previews.follow_move(&document), 10);
        previews.pictured(&document, 2, 1e6, 0.2);
        assert_eq!(previews.follow_move(&document), 10, "a late picture of an earlier preview");
        previews.moving = None;
        previews.pictured(&document, 8, 1e6, 0.05);
        assert!(previews.follow_move(&document) < 10, "another move");
    }

    #[test]
    fn only_what_takes_long_is_looked_at_first() {
        let mut previews = Previews::default();
        assert_eq!(previews.look(&document("book", [320, 180]), None), 1);
        assert!(previews.look(&document("book", [1600, 900]), None) > 2);
        // Each half of the film needs a sample.
        let mut between = document("book", [640, 360]);
        assert!(between.settings.estimate_error && previews.look(&between, None) > 1);
        between.settings.estimate_error = false;
        assert_eq!(previews.look(&between, None), 1);
        previews.render_speed = Some(1e9);
        assert_eq!(previews.look(&document("book", [1600, 900]), None), 1);
    }

    #[test]
    fn a_large_picture_gets_finer_in_steps_as_time_allows() {
        let large = document("book", [2560, 1440]);
        let steps = |speed: f64| {
            let previews = at_speed(speed);
            let mut divisors = vec![20];
            while divisors[divisors.len() - 1] > 1 {
                divisors.push(previews.look(&large, divisors.last().copied()));
            }
            divisors
        };
        assert_eq!(steps(3e6), [20, 8, 4, 1], "half the size would take more than a second");
        assert_eq!(steps(2e7), [20, 8, 4, 2, 1]);
        assert_eq!(steps(1e5), [20, 1]);
    }

    #[test]
    fn the_coarsest_preview_leaves_a_hundred_pixels_or_an_eighth() {
        for (size, divisor) in [([1000, 400], 10), ([700, 400], 8), ([100, 900], 9), ([80, 60], 8)] {
            assert_eq!(coarsest(&document("book", size)), divisor, "{size:?}");
        }
    }
}
