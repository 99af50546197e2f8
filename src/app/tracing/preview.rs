//! How coarse a preview is: as fine as the time from request to picture allows.

use crate::app::model::Document;
use crate::film::HALVES;
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

/// Samples per pixel of a preview of a picture with noise. A quarter of the pixels with four samples each show more than
/// all of them with one: the eye sees noise in each pixel, but does not miss the pixels of a picture that moves.
const SAMPLES: u64 = 4;

/// The longer side of a preview keeps this many pixels as long as it can have fewer samples instead.
const LONGER_SIDE: u32 = 140;

/// The coarsest divisor of previews, and the pixels that the longer side keeps in large pictures in any case.
const DIVISOR: u32 = 8;
const LEAST_SIDE: u32 = 100;

/// Samples per second that are expected of a CPU before anything has been traced.
const USUAL_SPEED: f64 = 3e6;

/// Samples per second of the first preview, as a share of those of a render: passes are short, and a render must end first.
const SHARE: f64 = 0.3;

/// A coarse picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Preview {
    /// The factor by which it is smaller. With 1 it is the picture itself.
    pub divisor: u32,
    /// Samples per pixel when it is first shown, a power of two.
    pub samples: u64,
}

impl Preview {
    /// The picture itself.
    pub const NONE: Preview = Preview { divisor: 1, samples: 1 };
}

/// Chooses previews by the time that earlier ones took.
#[derive(Default)]
pub struct Previews {
    /// Samples per second of the last preview, from request to picture. It includes the cost of drawing the window.
    speed: Option<f64>,
    /// Samples per second of the last render.
    render_speed: Option<f64>,
    /// The preview of the present move.
    moving: Option<Preview>,
}

impl Previews {
    /// Notes the speed of a render.
    pub fn note_speed(&mut self, status: &Status) {
        let speed = status.paths_per_second();
        if speed > 0.0 {
            self.render_speed = Some(speed);
        }
    }

    /// Whether something is moving.
    pub fn is_moving(&self) -> bool {
        self.moving.is_some()
    }

    /// The preview to show while something moves.
    pub fn follow_move(&mut self, document: &Document) -> Preview {
        *self.moving.insert(self.moving.unwrap_or_else(|| self.choose(document)))
    }

    /// Notes that nothing moves.
    pub fn end_move(&mut self) {
        self.moving = None;
    }

    /// The preview to show before the first samples of a picture. `coarser` is the divisor of what is on the screen; each
    /// preview is at least twice as fine.
    pub fn look(&self, document: &Document, coarser: Option<u32>) -> Preview {
        let samples = pixels(document) * HALVES as f64;
        if samples / self.render_speed.unwrap_or(USUAL_SPEED) <= PATIENCE {
            return Preview::NONE;
        }
        let Some(coarser) = coarser else { return self.choose(document) };
        let affordable = self.speed.unwrap_or(USUAL_SPEED) * STEP_SECONDS;
        let step = |divisor| Preview { divisor, samples: most_samples(document) };
        let cost = |step: &Preview| pixels(document) * step.samples as f64 / f64::from(step.divisor).powi(2);
        let is_step = |step: &Preview| 2 * step.divisor <= coarser && cost(step) <= affordable;
        STEPS.map(step).into_iter().find(is_step).unwrap_or(Preview::NONE)
    }

    fn choose(&self, document: &Document) -> Preview {
        let begin = SHARE * self.render_speed.unwrap_or(USUAL_SPEED);
        let affordable = (self.speed.unwrap_or(begin) * SECONDS).max(1.0);
        let with = |samples: u64| {
            let divisor = (pixels(document) * samples as f64 / affordable).sqrt().ceil() as u32;
            Preview { divisor: divisor.clamp(1, coarsest(document)), samples }
        };
        let fine = (longer_side(document) / LONGER_SIDE).max(1);
        let mut preview = with(most_samples(document));
        while preview.samples > 1 && preview.divisor > fine {
            preview = with(preview.samples / 2);
        }
        preview
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
            let limit = coarsest(document);
            if moving.divisor >= limit {
                moving.samples = (moving.samples / 2).max(1);
            }
            moving.divisor = coarser.clamp(moving.divisor, limit.max(moving.divisor));
        }
    }
}

/// Samples per pixel of a preview, if time allows.
fn most_samples(document: &Document) -> u64 {
    if document.rules().shading == Shading::Path { SAMPLES } else { 1 }
}

fn pixels(document: &Document) -> f64 {
    document.size().map(f64::from).into_iter().product()
}

fn longer_side(document: &Document) -> u32 {
    document.size().into_iter().max().unwrap_or(1)
}

fn coarsest(document: &Document) -> u32 {
    DIVISOR.max(longer_side(document) / LEAST_SIDE)
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
        let chosen = previews.choose(&document("book", [1000, 400]));
        assert_eq!(chosen, Preview { divisor: 2, samples: 4 });
        let without_noise = previews.choose(&document("normals", [1000, 400]));
        assert_eq!(without_noise, Preview { divisor: 1, samples: 1 });
    }

    #[test]
    fn a_slow_device_gets_few_samples_before_too_few_pixels() {
        let slow = at_speed(2e5).choose(&document("book", [1024, 576]));
        assert_eq!(slow, Preview { divisor: 8, samples: 1 });
        let less = at_speed(4e5).choose(&document("book", [1024, 576]));
        assert_eq!(less, Preview { divisor: 6, samples: 1 });
        let more = at_speed(1e6).choose(&document("book", [1024, 576]));
        assert_eq!(more, Preview { divisor: 7, samples: 4 });
        let large = at_speed(2e4).choose(&document("book", [3840, 2160]));
        assert_eq!(large, Preview { divisor: 38, samples: 1 }, "100 pixels are left");
    }

    #[test]
    fn within_a_move_previews_only_get_coarser() {
        let (mut previews, document) = (at_speed(8e6), document("book", [1024, 576]));
        let first = previews.follow_move(&document);
        previews.pictured(&document, first.divisor, 1e6, 0.01);
        assert_eq!(previews.follow_move(&document), first, "faster than expected");
        previews.pictured(&document, first.divisor, 1e6, 0.2);
        let second = previews.follow_move(&document);
        assert_eq!((second.divisor, second.samples), (first.divisor * 2, 4));
        for _ in 0..3 {
            previews.pictured(&document, 8, 1e4, 0.2);
        }
        assert_eq!(previews.follow_move(&document), Preview { divisor: 10, samples: 1 });
        previews.pictured(&document, 2, 1e6, 0.2);
        assert_eq!(previews.follow_move(&document).divisor, 10, "a late picture of an earlier preview");
        previews.end_move();
        previews.pictured(&document, 8, 1e6, 0.05);
        assert!(previews.follow_move(&document).divisor < 10, "another move");
    }

    #[test]
    fn only_what_takes_long_is_looked_at_first() {
        let mut previews = Previews::default();
        assert_eq!(previews.look(&document("book", [320, 180]), None), Preview::NONE);
        assert!(previews.look(&document("book", [1600, 900]), None).divisor > 2);
        // Each half of the film needs a sample.
        assert!(previews.look(&document("book", [640, 360]), None).divisor > 1);
        previews.render_speed = Some(1e9);
        assert_eq!(previews.look(&document("book", [1600, 900]), None), Preview::NONE);
    }

    #[test]
    fn a_large_picture_gets_finer_in_steps_as_time_allows() {
        let large = document("book", [2560, 1440]);
        let steps = |speed: f64| {
            let previews = at_speed(speed);
            let mut divisors = vec![20];
            while divisors[divisors.len() - 1] > 1 {
                divisors.push(previews.look(&large, divisors.last().copied()).divisor);
            }
            divisors
        };
        assert_eq!(steps(3e6), [20, 8, 4, 1], "half the size would take more than a second");
        assert_eq!(steps(2e7), [20, 8, 4, 2, 1]);
        assert_eq!(steps(1e5), [20, 1]);
    }
}
