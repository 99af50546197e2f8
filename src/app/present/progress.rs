//! How far the render is on its way to its end.

use crate::app::facts::Facts;
use crate::app::status::grouped;
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
}
