//! The bar at the bottom: how far, how fast, how good, and by whom. Each figure has a place of its own, so that
//! nothing jumps.

use super::plot;
use super::window::Window;
use crate::progressive::{Phase, Status};
use eframe::egui::{self, Align, Layout, RichText, Ui};
use std::borrow::Cow;

pub fn ui(window: &mut Window, ui: &mut Ui) {
    let frame = egui::Frame::side_top_panel(ui.style()).inner_margin(egui::Margin::symmetric(12, 5));
    egui::Panel::bottom("status").frame(frame).show(ui, |ui| {
        let status = window.main.status().clone();
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing = egui::vec2(14.0, 3.0);
            for (text, widest, help) in figures(&status, window) {
                figure(ui, &text, widest, &help);
            }
            rejected(ui, &status);
            let who = who(&status);
            let room = ui.available_width();
            let width = text_width(ui, &who);
            if room > width + 20.0 {
                ui.with_layout(Layout::right_to_left(Align::Center), |ui| who_label(ui, &who, &status));
            } else {
                who_label(ui, &who, &status);
            }
        });
    });
}

fn who_label(ui: &mut Ui, who: &str, status: &Status) {
    let mut help = String::from("Who traced which part of this picture");
    for part in &status.contributions {
        let backend = &part.backend;
        help += &format!(
            "\n{} {}: {} samples per pixel, {} lanes, {} threads",
            backend.name, backend.device, part.samples_per_pixel, backend.lanes, backend.threads
        );
    }
    ui.label(RichText::new(who).color(ui.visuals().weak_text_color())).on_hover_text(help);
}

fn text_width(ui: &Ui, text: &str) -> f32 {
    let font = egui::TextStyle::Body.resolve(ui.style());
    ui.painter().layout_no_wrap(text.to_owned(), font, egui::Color32::WHITE).size().x
}

/// A figure in the room that its widest text takes.
fn figure(ui: &mut Ui, text: &str, widest: &str, help: &str) {
    let width = text_width(ui, widest).max(text_width(ui, text));
    let height = ui.text_style_height(&egui::TextStyle::Body);
    let layout = Layout::left_to_right(Align::Center);
    ui.allocate_ui_with_layout(egui::vec2(width, height), layout, |ui| {
        ui.set_min_width(width);
        ui.add(egui::Label::new(text).extend()).on_hover_text(help);
    });
}

/// Text, the widest text in its place, and help.
fn figures(status: &Status, window: &Window) -> Vec<(String, &'static str, Cow<'static, str>)> {
    let samples = status.samples_per_pixel;
    let mut figures = vec![
        (phase_word(&status.phase, window), "preparing", "What the tracer is at".into()),
        (
            match window.document.stop.samples {
                Some(planned) => format!("{} of {} spp", grouped(samples), grouped(planned)),
                None => format!("{} spp", grouped(samples)),
            },
            "00 000 spp",
            "Samples per pixel in the film".into(),
        ),
        (
            format!("{:.1} s", status.trace.as_secs_f64()),
            "0000.0 s",
            "Seconds of tracing, pauses left out".into(),
        ),
        (
            format!("{:.1} Mpaths/s", status.paths_per_second() / 1e6),
            "0000.0 Mpaths/s",
            "Million paths finished per second of tracing".into(),
        ),
        (
            rays_per_path(status),
            "00.00 rays/path",
            "Rays per path, the camera's included: how long paths are".into(),
        ),
    ];
    if let Some(share) = status.lane_occupancy() {
        let lanes = status.backend.as_ref().map_or(0, |backend| backend.lanes);
        figures.push((
            format!("{lanes} lanes {:.0} % full", 100.0 * share),
            "00 lanes 100 % full",
            "Lanes of a packet, and how many of them traced a ray on average".into(),
        ));
    }
    figures.push((
        error_words(status, window.document.stop.noise),
        "error 0.00000, 0.00000 in about 0000 s (0000 to 0000)",
        error_help(status).into(),
    ));
    figures
}

fn error_help(status: &Status) -> String {
    let uncertainty =
        status.error.map_or_else(String::new, |error| format!(", {} by chance", error.uncertainty()));
    format!(
        "Error estimated from the two halves of the film{uncertainty}: root of the mean square over pixels and \
         channels, linear radiance; and when the target will be reached, within two deviations.\n\
         Against references the estimate was true within 1 %. What no path has found yet it cannot know."
    )
}

fn phase_word(phase: &Phase, window: &Window) -> String {
    match phase {
        Phase::Done(_) if window.is_paused() => "paused",
        Phase::Idle | Phase::Preparing => "preparing",
        Phase::Tracing if window.is_paused() => "paused",
        Phase::Tracing => "tracing",
        Phase::Paused => "paused",
        Phase::Done(_) => "done",
        Phase::Failed(_) => "failed",
    }
    .to_owned()
}

fn rays_per_path(status: &Status) -> String {
    let rays =
        if status.stats.paths == 0 { 0.0 } else { status.stats.rays as f64 / status.stats.paths as f64 };
    format!("{rays:.2} rays/path")
}

fn error_words(status: &Status, target: Option<f64>) -> String {
    let Some(error) = status.error else { return "error –".to_owned() };
    let now = format!("error {:.5}", error.rmse);
    match (target, plot::prediction(status, target)) {
        (Some(target), Some(prediction)) => {
            format!("{now}, {target} {}", plot::prediction_words(&prediction))
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
    ui.label(label).on_hover_text("Samples that were NaN, infinite or negative and so were left out");
}

/// Who traced how much, in words.
fn who(status: &Status) -> String {
    let total: u64 = status.contributions.iter().map(|part| part.samples_per_pixel).sum();
    match status.contributions.as_slice() {
        [] => status.backend.as_ref().map_or_else(String::new, |b| format!("{} {}", b.name, b.device)),
        [only] => format!("{} {}, {} threads", only.backend.name, only.backend.device, only.backend.threads),
        parts => parts
            .iter()
            .map(|part| {
                let share = 100.0 * part.samples_per_pixel as f64 / total.max(1) as f64;
                format!("{} {} {share:.0} %", part.backend.name, part.backend.device)
            })
            .collect::<Vec<_>>()
            .join(" + "),
    }
}

/// A number with gaps between thousands.
fn grouped(n: u64) -> String {
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
mod tests {
    use super::*;
    use crate::film::ErrorEstimate;
    use std::time::Duration;

    #[test]
    fn the_prediction_follows_the_root_of_the_time() {
        let mut status = Status {
            samples_per_pixel: 100,
            phase: Phase::Tracing,
            trace: Duration::from_secs(1),
            error: Some(ErrorEstimate { rmse: 0.004, rmse_deviation: 0.0, rel_mse: 0.0 }),
            ..Status::default()
        };
        let words = error_words(&status, Some(0.002));
        assert!(words.starts_with("error 0.00400, 0.002 in about 3 s ("), "{words}");
        assert_eq!(error_words(&status, None), "error 0.00400");
        assert_eq!(error_words(&status, Some(0.01)), "error 0.00400, below 0.01");
        status.error = None;
        assert_eq!(error_words(&status, Some(0.01)), "error –");
    }

    #[test]
    fn thousands_are_grouped() {
        assert_eq!(grouped(0), "0");
        assert_eq!(grouped(1234567), "1\u{a0}234\u{a0}567");
    }
}
