//! How a render that has ended can go on.

use super::Document;
use crate::job::render::SAMPLE_LIMIT;
use crate::progressive::{EndReason, Phase, Status, Stop};
use crate::stages::Shading;

impl Document {
    /// Whether the picture depends on random numbers.
    pub fn is_random(&self) -> bool {
        self.rules().antialiasing || self.rules().shading == Shading::Path
    }

    /// The next end after the one that a render has reached; `None` while it is rendered, or if more samples would
    /// change nothing.
    pub fn further(&self, status: &Status) -> Option<Stop> {
        let Phase::Done(reason) = status.phase else { return None };
        if !self.is_random() || status.samples_per_pixel >= SAMPLE_LIMIT {
            return None;
        }
        let stop = self.stop;
        match reason {
            EndReason::NoiseTarget => {
                let reached = status.error.map_or(f64::INFINITY, |error| error.rmse).min(stop.noise?);
                let halves = std::iter::successors(stop.noise, |noise| Some(noise / 2.0));
                let next = halves.take_while(|noise| *noise > 1e-6).find(|noise| *noise < 0.55 * reached);
                next.map(|noise| Stop { noise: Some(noise), ..stop })
            }
            EndReason::Samples => {
                let samples = stop.samples?.max(status.samples_per_pixel).saturating_mul(2).min(SAMPLE_LIMIT);
                Some(Stop { samples: Some(samples), ..stop })
            }
            EndReason::TimeLimit => {
                let seconds = 2.0 * stop.seconds?.max(status.elapsed.as_secs_f64().floor());
                Some(Stop { seconds: Some(seconds), ..stop })
            }
            EndReason::Stopped => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::Origin;
    use crate::film::ErrorEstimate;
    use crate::stages::Stage;

    fn done(reason: EndReason, rmse: f64) -> Status {
        Status {
            phase: Phase::Done(reason),
            samples_per_pixel: 100,
            error: Some(ErrorEstimate { rmse, rmse_deviation: 0.0, rel_mse: 0.0 }),
            ..Status::default()
        }
    }

    #[test]
    fn a_render_goes_on_to_the_next_end_of_its_kind() {
        let mut document = Document::new(Origin::of_stage(Stage::find("book").unwrap()));
        let further = document.further(&done(EndReason::NoiseTarget, 0.00195)).unwrap();
        assert_eq!(further.noise, Some(0.001));
        document.stop = Stop::at_samples(100);
        let further = document.further(&done(EndReason::Samples, 0.01)).unwrap();
        assert_eq!(further.samples, Some(200));
        document.stop = Stop { seconds: Some(10.0), ..Stop::default() };
        assert_eq!(document.further(&done(EndReason::TimeLimit, 0.01)).unwrap().seconds, Some(20.0));
        // The last pass ended after the limit.
        let elapsed = std::time::Duration::from_secs_f64(12.7);
        let late = Status { elapsed, ..done(EndReason::TimeLimit, 0.01) };
        let further = document.further(&late).unwrap();
        assert_eq!(further.seconds, Some(24.0));
        assert_eq!(document.further(&Status { phase: Phase::Tracing, ..Status::default() }), None);
        let tiny = Document::new(Origin::of_stage(Stage::find("ppm-tiny").unwrap()));
        assert_eq!(tiny.further(&done(EndReason::Samples, 0.0)), None, "nothing in it is random");
    }

    #[test]
    fn the_next_end_lies_beyond_what_was_reached() {
        let samples = Stop::at_samples;
        let noise = |noise: f64| Stop { noise: Some(noise), ..Stop::default() };
        let after = |samples_per_pixel| Status { samples_per_pixel, ..done(EndReason::Samples, 0.01) };
        let unknown = Status { error: None, ..done(EndReason::NoiseTarget, 0.0) };
        for (stop, status, expected) in [
            // The last pass went on after the end, or a stop was chosen that lies further ahead.
            (samples(60), after(100), Some(samples(200))),
            (samples(300), after(100), Some(samples(600))),
            (samples(SAMPLE_LIMIT - 1), after(SAMPLE_LIMIT - 1), Some(samples(SAMPLE_LIMIT))),
            (samples(SAMPLE_LIMIT), after(SAMPLE_LIMIT), None),
            (noise(0.002), unknown, Some(noise(0.001))),
            (noise(0.002), done(EndReason::NoiseTarget, 0.01), Some(noise(0.001))),
            (noise(0.002), done(EndReason::NoiseTarget, 1e-6), None),
            (samples(100), done(EndReason::Stopped, 0.01), None),
            // There is no such end by now.
            (Stop::default(), after(100), None),
            (Stop::default(), done(EndReason::NoiseTarget, 0.01), None),
            (Stop::default(), done(EndReason::TimeLimit, 0.01), None),
        ] {
            let mut document = Document::new(Origin::of_stage(Stage::find("book").unwrap()));
            document.stop = stop;
            assert_eq!(document.further(&status), expected, "{stop:?} {:?}", status.phase);
        }
    }
}
