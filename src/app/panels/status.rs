//! The bar at the bottom: one sentence about the render, a line for its progress, and details on request.

use super::plot::prediction;
use crate::app::commands::{Command, PanelContext, Snapshot};
use crate::app::toolkit::number::{compact, samples_words};
use crate::app::toolkit::theme;
use crate::app::toolkit::widgets::{command_button, small, tip};
use crate::denoise::DenoisedError;
use crate::film::Film;
use crate::job::render::BackendInfo;
use crate::measure::grouped;
use crate::numbers::rounded;
use crate::progressive::describe::{counted, seconds as time};
use crate::progressive::{EndReason, Phase};
use eframe::egui::{
    self, Align, Button, Id, Label, Layout, Margin, PopupCloseBehavior, RectAlign, Response, RichText, Sides,
    Stroke, Ui, accesskit::Live,
};

const HEIGHT: f32 = 32.0;

/// Least time between two readings of the sentence by assistive technology, seconds.
const READ_SECONDS: f64 = 5.0;

const ERROR_HELP: &str = "How far a pixel usually is from the finished picture, in per cent of white; estimated from \
                          the two halves of the samples";

const TERMS: &str = "A path is one random way of light, followed back from the camera ray by ray. Error is the usual \
                     distance from the finished picture, in per cent of white.";

/// Draws the bar. `offered` is the size at which a scaled picture can be rendered.
pub fn ui(ui: &mut Ui, cx: &PanelContext, offered: Option<[u32; 2]>) {
    let panel =
        egui::Panel::bottom("status").exact_size(HEIGHT).frame(theme::panel(Margin::symmetric(16, 4)));
    let shown = panel.show(ui, |ui| {
        let sides = Sides::new().height(ui.available_height()).shrink_left().truncate();
        sides.show(ui, |ui| sentence_ui(ui, cx, offered), |ui| details(ui, cx));
    });
    if let Some(share) = share(cx) {
        let rect = shown.response.rect;
        let colours = theme::colours(ui);
        let color = if cx.model.is_paused { colours.weak } else { colours.accent };
        let end = rect.left() + rect.width() * share as f32;
        ui.painter().hline(rect.left()..=end, rect.top() + 1.0, Stroke::new(2.0, color));
    }
}

/// The sentence, and what the user can do about the picture.
fn sentence_ui(ui: &mut Ui, cx: &PanelContext, offered: Option<[u32; 2]>) {
    let sentence = sentence(cx);
    let is_fault = cx.invalid.is_some() || matches!(cx.status.phase, Phase::Failed(_));
    let color = if is_fault { theme::colours(ui).bad } else { ui.visuals().text_color() };
    let response = ui.label(RichText::new(&sentence).color(color));
    announce(&response, &sentence);
    let doubt = cx.status.doubt.as_ref().map_or_else(String::new, |doubt| format!(". {doubt}"));
    tip(ui, response, &format!("{ERROR_HELP}{doubt}"), None);
    left_out(ui, cx.status.rejected_samples);
    if let Some([width, height]) = offered {
        ui.label("This picture is scaled.");
        let name = format!("Render at {width} × {height}");
        command_button(ui, cx, Command::RenderAtSize, &name);
    }
}

/// Tells assistive technology the sentence, but not at each change.
fn announce(response: &Response, sentence: &str) {
    let (place, now) = (Id::unique("status announced"), response.ctx.input(|input| input.time));
    let last: Option<(String, f64)> = response.ctx.data(|data| data.get_temp(place));
    let told = match last {
        Some((told, at)) if now < at + READ_SECONDS => told,
        _ => {
            response.ctx.data_mut(|data| data.insert_temp(place, (sentence.to_owned(), now)));
            sentence.to_owned()
        }
    };
    response.ctx.accesskit_node_builder(response.id, |node| {
        node.set_value(told);
        node.set_live(Live::Polite);
    });
}

fn left_out(ui: &mut Ui, count: u64) {
    if count > 0 {
        let words = format!("{} left out", counted(count, "sample"));
        let response = ui.label(RichText::new(words).color(theme::colours(ui).warn));
        tip(ui, response, "They were not numbers, so they would spoil their pixels", None);
    }
}

/// The state of the render in one sentence.
pub fn sentence(snapshot: &Snapshot) -> String {
    let (status, stop) = (&*snapshot.status, snapshot.document().stop);
    if let Some(reason) = &snapshot.invalid {
        return format!("Not rendered: {reason}");
    }
    let view = &snapshot.model.view;
    if view.is_hidden() {
        let [[title, _], _] = snapshot.model.side_names();
        let kept = view.kept_partner().filter(|kept| kept.document.is_some()).map(|kept| kept.samples());
        let samples = kept.or(snapshot.other.as_ref().map(|other| other.samples_per_pixel));
        let samples = samples.map_or_else(String::new, |count| format!(", {}", samples_words(count)));
        return format!("{title}{samples}. Escape returns to the picture");
    }
    let count = status.samples_per_pixel;
    let raw = status.error.map(|raw| percent(raw.rmse, raw.rmse_deviation));
    let error = match (raw, denoised_error(snapshot)) {
        (Some(raw), Some(Ok(error))) => {
            // Both to the first digit of the deviation.
            let of = error.rmse_deviation();
            let [rmse, deviation] = [error.rmse(), of].map(|error| rounded(100.0 * error, 100.0 * of, 1));
            let of = view.denoised_of(status.run).map_or(count, |denoised| denoised.film.sample_count());
            let of = if of == count { String::new() } else { format!(" at {}", grouped(of)) };
            format!(", denoised{of}: error {} ± {} % (raw {raw})", compact(rmse), compact(deviation))
        }
        (Some(raw), Some(Err(reason))) => format!(", error {raw} (not denoised: {reason})"),
        (Some(raw), None) => format!(", error {raw}"),
        (None, _) => String::new(),
    };
    let samples = samples_words(count);
    match &status.phase {
        Phase::Failed(reason) => format!("Stopped at {samples}: {reason}"),
        _ if let Some(play) = &snapshot.model.playing => {
            format!("Frame {} of {}; Escape stops", play.frame + 1, snapshot.document().frame_count())
        }
        _ if snapshot.is_coarse && snapshot.is_moving => "A coarse picture while you move".to_owned(),
        _ if (snapshot.is_coarse || count == 0) && snapshot.has_picture => "Refining".to_owned(),
        _ if snapshot.is_coarse || count == 0 => "Starting".to_owned(),
        _ if snapshot.model.is_paused && snapshot.is_held => {
            format!("Paused after a first look: {samples}")
        }
        _ if snapshot.model.is_paused => format!("Paused at {samples}{error}"),
        Phase::Done(_) if !snapshot.document().is_random() => {
            "Done: nothing in this picture depends on chance".to_owned()
        }
        Phase::Done(reason) => {
            let seconds = snapshot.seconds_before.unwrap_or_default() + status.trace.as_secs_f64();
            let taken =
                snapshot.seconds_before.map_or_else(String::new, |_| format!(" in {}", time(seconds)));
            let word = if *reason == EndReason::Stopped { "Stopped" } else { "Done" };
            format!("{word}: {samples}{taken}{error}")
        }
        _ => match stop.samples {
            Some(end) => {
                let left = time(status.seconds_per_sample() * end.saturating_sub(count) as f64);
                let samples = format!("{} of {}", grouped(count), samples_words(end));
                format!("{samples}{error}; done in about {left}")
            }
            None => format!("{samples}{error}{}", ending(snapshot)),
        },
    }
}

/// The error of the denoised picture of the traced film, or why there is none, if it is to be shown.
fn denoised_error(snapshot: &Snapshot) -> Option<Result<DenoisedError, &str>> {
    let view = &snapshot.model.view;
    let (run, found) = view.denoised.as_ref().filter(|_| view.shows_denoised())?;
    let outcome = found.as_ref().map(|denoised| denoised.error).map_err(String::as_str);
    (*run == snapshot.status.run && outcome != Err("")).then_some(outcome)
}

/// When a render without a number of samples will end.
fn ending(snapshot: &Snapshot) -> String {
    let (status, stop) = (&*snapshot.status, snapshot.document().stop);
    let goal = stop.noise.map(|goal| format!("{} %", compact(100.0 * goal)));
    if let Some(goal) = goal.as_ref().filter(|_| matches!(denoised_error(snapshot), Some(Ok(_)))) {
        // Nothing tells when the denoised picture will be so good.
        format!("; until {goal}")
    } else if let Some((goal, found)) = goal.zip(prediction(status, stop.noise)) {
        format!("; {goal} in about {}", time(found.time))
    } else if let Some(end) = stop.seconds {
        format!("; done in {}", time((end - status.elapsed.as_secs_f64()).max(0.0)))
    } else {
        String::new()
    }
}

/// How much of the work is done, `0..=1`; none without an end.
pub fn share(snapshot: &Snapshot) -> Option<f64> {
    let (status, stop) = (&*snapshot.status, snapshot.document().stop);
    if status.phase.is_over() || status.samples_per_pixel == 0 || snapshot.is_coarse {
        return None;
    }
    let of_samples = stop.samples.map(|end| status.samples_per_pixel as f64 / end.max(1) as f64);
    let of_time = stop.seconds.map(|end| status.elapsed.as_secs_f64() / end);
    // The error falls with the root of the samples; that of a denoised picture is not followed.
    let is_raw = denoised_error(snapshot).is_none();
    let of_error = stop.noise.zip(status.error).filter(|_| is_raw);
    let of_error = of_error.map(|(end, error)| (end / error.rmse).powi(2));
    [of_samples, of_time, of_error].into_iter().flatten().reduce(f64::max).map(|share| share.clamp(0.0, 1.0))
}

fn details(ui: &mut Ui, cx: &PanelContext) {
    let response = ui.add(Button::new("Details"));
    egui::Popup::from_toggle_button_response(&response)
        .close_behavior(PopupCloseBehavior::CloseOnClickOutside)
        .align(RectAlign::TOP_END)
        .gap(8.0)
        .show(|ui| {
            ui.set_width(304.0);
            egui::Frame::new().inner_margin(12).show(ui, |ui| {
                ui.label(RichText::new("Details").strong());
                for (name, value) in figures(cx) {
                    ui.horizontal(|ui| {
                        small(ui, name);
                        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                            ui.add(Label::new(RichText::new(value).small()).wrap());
                        });
                    });
                }
                command_button(ui, cx, Command::DeleteFilms, "Delete");
                small(ui, TERMS);
            });
        });
    tip(ui, response, "Speed, memory, and what these mean", None);
}

fn figures(snapshot: &Snapshot) -> Vec<(&'static str, String)> {
    let status = &*snapshot.status;
    let unknown = || "–".to_owned();
    let speed = status.paths_per_second() / 1e6;
    // A film that was opened does not say how its samples were traced.
    let has_paths = status.stats.paths > 0;
    let rays = status.stats.rays as f64 / status.stats.paths.max(1) as f64;
    let settings = snapshot.document().settings;
    let bytes = Film::bytes(settings.width, settings.height);
    vec![
        ("Speed", if has_paths { format!("{speed:.1} million paths per second") } else { unknown() }),
        ("Rays per path", if has_paths { format!("{rays:.1} on average") } else { unknown() }),
        ("Processor", status.backend.as_ref().map_or_else(unknown, processor)),
        ("Memory of this picture", format!("{:.1} MB", bytes as f64 / 1e6)),
        (
            "Kept films",
            format!("{}, {:.0} MB of 2,000", snapshot.films.count, snapshot.films.bytes as f64 / 1e6),
        ),
    ]
}

fn processor(BackendInfo { name, device, threads, .. }: &BackendInfo) -> String {
    // Without the adapter's driver.
    let device = device.split(" (").next().unwrap_or_default();
    let threads = || counted(*threads as u64, "thread");
    match *name {
        "gpu" => format!("GPU, {device}"),
        "cpu" => format!("CPU, {}, {device}", threads()),
        name => format!("{name}, {}, {device}", threads()),
    }
}

/// An error in per cent of white, with the digits that it is sure of, two at most.
fn percent(error: f64, deviation: f64) -> String {
    let digits = if deviation > 0.1 * error { 1 } else { 2 };
    format!("{} %", compact(rounded(100.0 * error, 100.0 * error, digits)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::tests::snapshot_of;
    use crate::film::ErrorEstimate;
    use crate::progressive::Status;
    use std::sync::Arc;

    #[test]
    fn the_bar_tells_how_far_the_render_is() {
        let mut snapshot = snapshot_of("--stage metal --size 32x18");
        let status = Status {
            samples_per_pixel: 100,
            phase: Phase::Tracing,
            error: Some(ErrorEstimate { rmse: 0.004, rmse_deviation: 0.0, rel_mse: 0.0 }),
            ..Status::default()
        };
        snapshot.model.document.stop.noise = Some(0.002);
        for (phase, is_coarse, expected) in [
            (Phase::Tracing, false, Some(0.25)),
            (Phase::Tracing, true, None),
            (Phase::Done(EndReason::NoiseTarget), false, None),
        ] {
            (snapshot.status, snapshot.is_coarse) = (Arc::new(Status { phase, ..status.clone() }), is_coarse);
            assert_eq!(share(&snapshot), expected);
        }
    }

    #[test]
    fn errors_have_as_many_digits_as_are_known() {
        let errors = [(0.00123, 0.0), (0.00123, 0.001), (0.0456, 0.0), (0.3, 0.0)];
        let words = errors.map(|(error, deviation)| percent(error, deviation));
        assert_eq!(words, ["0.12 %", "0.1 %", "4.6 %", "30 %"]);
    }
}
