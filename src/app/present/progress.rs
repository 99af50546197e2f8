//! How far the render is on its way to its end.

use crate::app::facts::Facts;
use crate::app::status_bar::grouped;
use crate::app::theme;
use crate::progressive::{Phase, Status, Stop};
use eframe::egui::{Rect, RichText, Role, Sense, Ui, WidgetInfo, vec2};

/// The share that is done, and numbers in words.
#[derive(Debug, PartialEq)]
pub struct Progress {
    /// `0..=1`; `None` without an end.
    share: Option<f32>,
    words: String,
}

impl Progress {
    pub fn of(facts: &Facts) -> Self {
        Progress::from(&facts.status, facts.document().stop, facts.model.is_paused)
    }

    fn from(status: &Status, stop: Stop, is_paused: bool) -> Self {
        let samples = status.samples_per_pixel;
        let seconds = status.trace.as_secs_f64();
        let mut shares = Vec::new();
        let mut words = match stop.samples {
            Some(end) => {
                shares.push(samples as f64 / end.max(1) as f64);
                format!("{} of {} samples per pixel", grouped(samples), grouped(end))
            }
            None => format!("{} samples per pixel", grouped(samples)),
        };
        if let Some(end) = stop.seconds {
            shares.push(seconds / end);
            words += &format!(", {seconds:.0} of {end:.0} s");
        }
        if let Some(end) = stop.noise {
            let error = status.error.map(|error| error.rmse).filter(|_| samples > 0);
            // The error falls with the root of the samples, so its square tells the share of the work.
            shares.push(error.map_or(0.0, |error| (end / error).powi(2)));
            let error = error.map_or_else(|| "–".to_owned(), |error| format!("{error:.4}"));
            words += &format!(", error {error} of {end}");
        }
        let is_done = matches!(status.phase, Phase::Done(_));
        // The first end that is reached counts.
        let share = shares.into_iter().reduce(f64::max).map(|share| share.clamp(0.0, 1.0) as f32);
        let share = if is_done { Some(1.0) } else { share };
        let state = match &status.phase {
            _ if is_paused => "paused: ",
            Phase::Done(_) => "done: ",
            Phase::Failed(_) => "failed: ",
            _ => "",
        };
        Progress { share, words: format!("{state}{words}") }
    }

    /// Draws the bar over the whole width.
    pub fn bar(&self, ui: &mut Ui) {
        let (rect, response) = ui.allocate_exact_size(ui.available_size(), Sense::hover());
        response.widget_info(|| WidgetInfo::labeled(Role::ProgressIndicator, true, &self.words));
        ui.painter().rect_filled(rect, 0.0, ui.visuals().faint_bg_color);
        if let Some(share) = self.share {
            let done = Rect::from_min_size(rect.min, vec2(rect.width() * share, rect.height()));
            ui.painter().rect_filled(done, 0.0, theme::accent(ui));
        }
    }

    /// Shows the numbers.
    pub fn words(&self, ui: &mut Ui, size: f32) {
        ui.label(RichText::new(&self.words).size(size).color(ui.visuals().text_color()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::ErrorEstimate;
    use crate::progressive::EndReason;
    use std::time::Duration;

    fn status(samples: u64, rmse: f64) -> Status {
        Status {
            samples_per_pixel: samples,
            phase: Phase::Tracing,
            trace: Duration::from_secs(3),
            error: Some(ErrorEstimate { rmse, rmse_deviation: 0.0, rel_mse: 0.0 }),
            ..Status::default()
        }
    }

    #[test]
    fn each_end_has_its_share_and_the_first_one_counts() {
        let share = |stop| Progress::from(&status(32, 0.006), stop, false).share;
        assert_eq!(share(Stop::default()), None);
        assert_eq!(share(Stop::at_samples(128)), Some(0.25));
        let noise = Stop { noise: Some(0.003), ..Stop::default() };
        assert_eq!(share(noise), Some(0.25), "half the error takes four times the samples");
        let seconds = Stop { seconds: Some(4.0), ..noise };
        assert_eq!(share(seconds), Some(0.75));
        assert_eq!(share(Stop { noise: Some(0.01), ..noise }), Some(1.0));
    }

    #[test]
    fn the_numbers_are_told() {
        let words = |stop, is_paused| Progress::from(&status(32, 0.006), stop, is_paused).words;
        assert_eq!(words(Stop::at_samples(1280), false), "32 of 1\u{a0}280 samples per pixel");
        let stop = Stop { noise: Some(0.003), seconds: Some(4.0), ..Stop::default() };
        assert_eq!(words(stop, true), "paused: 32 samples per pixel, 3 of 4 s, error 0.0060 of 0.003");
        let mut done = status(0, 0.0);
        done.phase = Phase::Done(EndReason::Samples);
        let done = Progress::from(&done, stop, false);
        assert_eq!(done.share, Some(1.0));
        assert_eq!(done.words, "done: 0 samples per pixel, 3 of 4 s, error – of 0.003");
    }

    #[test]
    fn a_pause_is_told_first_and_an_unknown_error_is_no_progress() {
        let (samples, noise) = (Stop::at_samples(128), Stop { noise: Some(0.003), ..Stop::default() });
        let (done, failed) = (Phase::Done(EndReason::Stopped), Phase::Failed("no memory".to_owned()));
        for (phase, is_paused, share, begin) in [
            (Phase::Idle, false, 0.25, "32 of"),
            (Phase::Preparing, false, 0.25, "32 of"),
            (Phase::Tracing, true, 0.25, "paused: 32 of"),
            (done.clone(), false, 1.0, "done: 32 of"),
            (done, true, 1.0, "paused: 32 of"),
            (failed, false, 0.25, "failed: 32 of"),
        ] {
            let status = Status { phase, ..status(32, 0.006) };
            let found = Progress::from(&status, samples, is_paused);
            assert_eq!(found.share, Some(share), "{found:?}");
            assert!(found.words.starts_with(begin), "{found:?}");
        }
        let told = "32 samples per pixel, error – of 0.003";
        let unknown = Progress::from(&Status { error: None, ..status(32, 0.0) }, noise, false);
        assert_eq!((unknown.share, unknown.words.as_str()), (Some(0.0), told));
        let begun = Progress::from(&status(0, 0.001), noise, false);
        assert_eq!(begun.share, Some(0.0), "an error of no samples says nothing");
        let both = Stop { noise: Some(0.0012), ..samples };
        assert_eq!(
            Progress::from(&status(32, 0.006), both, false).share,
            Some(0.25),
            "the samples end first"
        );
    }
}
