//! The bottom bar: progress, speed, error and backend. Each figure has a fixed place, so that nothing moves when
//! numbers change.

use super::facts::Facts;
use super::model::device::Device;
use super::prediction::{prediction, prediction_words};
use super::theme;
use crate::job::render::BackendInfo;
use crate::progressive::{Contribution, Phase, Status, Stop};
use eframe::egui::{self, Align, Layout, RichText, Ui};
use std::borrow::Cow;

pub fn ui(ui: &mut Ui, facts: &Facts) {
    let frame = theme::panel(egui::Margin::symmetric(12, 5));
    egui::Panel::bottom("status").frame(frame).show(ui, |ui| {
        let speed = facts.speed.unwrap_or_else(|| facts.status.paths_per_second());
        let (stop, is_paused, next) = (facts.document().stop, facts.model.is_paused, next_device(facts));
        let seconds_before = facts.seconds_before;
        bar(ui, &Bar { status: &facts.status, stop, is_paused, speed, seconds_before, next });
    });
}

/// What the bar shows.
struct Bar<'a> {
    status: &'a Status,
    stop: Stop,
    is_paused: bool,
    /// Paths per second.
    speed: f64,
    /// Seconds of tracing that the film's samples took before this run, if known.
    seconds_before: Option<f64>,
    /// The chosen device, if it has not traced yet.
    next: Option<Device>,
}

/// The chosen device, if another one has traced the newest samples.
fn next_device(facts: &Facts) -> Option<Device> {
    let chosen = facts.model.remembered.device;
    facts.status.backend.as_ref().filter(|backend| backend.name != chosen.name()).map(|_| chosen)
}

fn bar(ui: &mut Ui, bar: &Bar<'_>) {
    let status = bar.status;
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = egui::vec2(14.0, 3.0);
        for (text, widest, help) in figures(bar) {
            figure(ui, &text, widest, &help);
        }
        rejected(ui, status);
        let room = ui.available_size_before_wrap().x;
        let forms = who(status, bar.next);
        let fitting = forms.iter().find(|words| text_width(ui, words) < room);
        match (fitting, forms.last()) {
            (Some(words), _) => {
                ui.with_layout(Layout::right_to_left(Align::Center), |ui| who_label(ui, words, status));
            }
            (None, Some(shortest)) => who_label(ui, shortest, status),
            (None, None) => {}
        }
    });
}

fn who_label(ui: &mut Ui, who: &str, status: &Status) {
    let mut help = String::from("Which backend traced which part of this picture");
    for part in &status.contributions {
        let BackendInfo { name, device, lanes, threads } = &part.backend;
        help += &format!("\n{name} {device}: {} samples per pixel, {lanes} lanes", part.samples_per_pixel);
        if *name != "gpu" {
            help += &format!(", {}", counted(*threads, "thread"));
        }
    }
    let text = RichText::new(who).color(ui.visuals().weak_text_color());
    ui.add(egui::Label::new(text).extend()).on_hover_text(help);
}

fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

fn text_width(ui: &Ui, text: &str) -> f32 {
    let font = egui::TextStyle::Body.resolve(ui.style());
    ui.painter().layout_no_wrap(text.to_owned(), font, egui::Color32::WHITE).size().x
}

/// A figure, in a place wide enough for its widest text.
fn figure(ui: &mut Ui, text: &str, widest: &str, help: &str) {
    let width = text_width(ui, widest).max(text_width(ui, text));
    let height = ui.text_style_height(&egui::TextStyle::Body);
    let layout = Layout::left_to_right(Align::Center);
    ui.allocate_ui_with_layout(egui::vec2(width, height), layout, |ui| {
        ui.set_min_width(width);
        ui.add(egui::Label::new(text).extend()).on_hover_text(help);
    });
}

const PATHS_HELP: &str = "Millions of paths finished per second, in the last second of tracing";

/// For each figure its text, its widest text, and its help.
fn figures(bar: &Bar<'_>) -> Vec<(String, &'static str, Cow<'static, str>)> {
    let Bar { status, stop, is_paused, speed, seconds_before, .. } = *bar;
    let samples = status.samples_per_pixel;
    // A film that was opened does not say how its samples were traced.
    let has_paths = status.stats.paths > 0;
    let mut figures = vec![
        (phase_word(&status.phase, is_paused), "preparing", "What the tracer is doing".into()),
        (
            match stop.samples {
                Some(planned) => format!("{} of {} spp", grouped(samples), grouped(planned)),
                None => format!("{} spp", grouped(samples)),
            },
            "00 000 spp",
            "Samples per pixel in the film".into(),
        ),
        seconds(status.trace.as_secs_f64(), seconds_before),
        (
            if has_paths { format!("{:.1} Mpaths/s", speed / 1e6) } else { "– Mpaths/s".to_owned() },
            "0000.0 Mpaths/s",
            if has_paths {
                format!("{PATHS_HELP}; {:.1} on average", status.paths_per_second() / 1e6).into()
            } else {
                PATHS_HELP.into()
            },
        ),
        (
            rays_per_path(status),
            "00.00 rays/path",
            "Rays per path, including the camera ray: how long paths are".into(),
        ),
    ];
    // Only the CPU has packets; the film may contain samples of other backends.
    let packets = status.contributions.iter().rev().find(|part| part.backend.name.starts_with("cpu"));
    if let Some((share, part)) = status.lane_occupancy().zip(packets) {
        let lanes = part.backend.lanes;
        figures.push((
            format!("{lanes} lanes {:.0} % full", 100.0 * share),
            "00 lanes 100 % full",
            "Lanes per packet, and the average share of them that were tracing a ray".into(),
        ));
    }
    figures.push((
        error_words(status, stop.noise),
        "error 0.00000, 0.00000 in about 0000 s (0000 to 0000)",
        error_help(status).into(),
    ));
    figures
}

/// The time of tracing: that of this run, and that of a film which was opened.
fn seconds(here: f64, before: Option<f64>) -> (String, &'static str, Cow<'static, str>) {
    let help = "Seconds of tracing, without pauses";
    let (text, help) = match before {
        None => {
            let unknown = "the film that was opened does not say how many it took";
            (format!("over {here:.1} s"), format!("{help}; {unknown}").into())
        }
        Some(before) if before > 0.0 => {
            let help = format!("{help}; {before:.1} of them before this film was opened");
            (format!("{:.1} s", before + here), help.into())
        }
        Some(_) => (format!("{here:.1} s"), help.into()),
    };
    (text, "0000.0 s", help)
}

fn error_help(status: &Status) -> String {
    let uncertainty =
        status.error.map_or_else(String::new, |error| format!(", random deviation {}", error.uncertainty()));
    let doubt = status.doubt.as_ref().map_or_else(String::new, |doubt| format!("\nDoubtful: {doubt}."));
    format!(
        "Error estimated from the two halves of the film{uncertainty}: root of the mean square over pixels and \
         channels, linear radiance; and when the target will be reached, within two standard deviations.\n\
         Compared with references, the estimate was right to within 1 %. It knows nothing of light that no path has \
         found yet.{doubt}"
    )
}

fn phase_word(phase: &Phase, is_paused: bool) -> String {
    match phase {
        Phase::Done(_) if is_paused => "paused",
        Phase::Idle | Phase::Preparing => "preparing",
        Phase::Tracing if is_paused => "paused",
        Phase::Tracing => "tracing",
        Phase::Paused => "paused",
        Phase::Done(_) => "done",
        Phase::Failed(_) => "failed",
    }
    .to_owned()
}

fn rays_per_path(status: &Status) -> String {
    match status.stats.paths {
        0 => "– rays/path".to_owned(),
        paths => format!("{:.2} rays/path", status.stats.rays as f64 / paths as f64),
    }
}

fn error_words(status: &Status, target: Option<f64>) -> String {
    let Some(error) = status.error else { return "error –".to_owned() };
    let now = format!("error {:.5}", error.rmse);
    match (target, prediction(status, target)) {
        (Some(target), Some(prediction)) => {
            format!("{now}, {target} {}", prediction_words(&prediction))
        }
        (Some(target), None) if error.rmse <= target => format!("{now}, below {target}"),
        _ => now,
    }
}

fn rejected(ui: &mut Ui, status: &Status) {
    let text = format!("{} rejected", grouped(status.rejected_samples));
    let mut label = RichText::new(text);
    if status.rejected_samples > 0 {
        label = label.color(ui.visuals().error_fg_color).strong();
    }
    // On a single row.
    ui.add(egui::Label::new(label).extend())
        .on_hover_text("Samples that were left out because they were NaN, infinite or negative");
}

/// Which backends traced how many samples, and which device is next: first the full text, then ever shorter versions.
fn who(status: &Status, next: Option<Device>) -> Vec<String> {
    let traced = traced_by(status);
    let Some(next) = next.filter(|_| !traced.is_empty()) else { return traced };
    let words = if status.phase.is_over() { "is next" } else { "is being prepared" };
    traced.into_iter().map(|traced| format!("{traced}; {} {words}", next.label())).collect()
}

fn traced_by(status: &Status) -> Vec<String> {
    let total: u64 = status.contributions.iter().map(|part| part.samples_per_pixel).sum();
    match status.contributions.as_slice() {
        [] => status.backend.iter().map(short_name).collect(),
        [only] => {
            let (name, threads) = (short_name(&only.backend), counted(only.backend.threads, "thread"));
            if only.backend.name == "gpu" { vec![name] } else { vec![format!("{name}, {threads}"), name] }
        }
        parts => {
            let shares = |name: fn(&BackendInfo) -> String| {
                let share = |part: &Contribution| {
                    let share = 100.0 * part.samples_per_pixel as f64 / total.max(1) as f64;
                    format!("{} {share:.0} %", name(&part.backend))
                };
                parts.iter().map(share).collect::<Vec<_>>().join(" + ")
            };
            vec![shares(short_name), shares(|backend| backend.name.to_owned())]
        }
    }
}

/// A backend with its device, without the adapter's driver details.
fn short_name(backend: &BackendInfo) -> String {
    let device = backend.device.split(" (").next().unwrap_or_default();
    format!("{} {device}", backend.name)
}

/// A number with spaces between groups of thousands.
pub fn grouped(n: u64) -> String {
    let digits = n.to_string();
    let mut text = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push('\u{a0}');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests;
