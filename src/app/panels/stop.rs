//! Controls for the stop conditions; the first one that is met ends the render.

use super::reset::Reset;
use crate::app::facts::Facts;
use crate::app::model::document::Document;
use crate::app::widgets::{About, check, explained, number, whole_number};
use crate::job::render::SAMPLE_LIMIT;
use crate::progressive::Stop;
use eframe::egui::{Response, Ui, Vec2, vec2};

pub(super) const RESET: Reset = Reset { is_changed, reset };

fn is_changed(document: &Document) -> bool {
    document.stop != document.origin.usual_stop()
}

fn reset(document: &mut Document) {
    document.stop = document.origin.usual_stop();
}

pub(super) fn ui(ui: &mut Ui, stop: &mut Stop, facts: &Facts) {
    let document = facts.document();
    let one_half = (!document.settings.estimate_error)
        .then_some("The error cannot be estimated from a film with one half: switch on Estimate error");
    let usual = document.origin.recipe.samples_per_pixel;

    let mut has_samples = stop.samples.is_some();
    let mut samples = stop.samples.unwrap_or(usual);
    row(
        ui,
        "Samples",
        "Samples per pixel; without a limit the render does not end by itself",
        None,
        &mut has_samples,
        |ui, place| {
            whole_number(ui, place, &mut samples, 1..=SAMPLE_LIMIT, |drag| drag.speed(1.0).suffix(" spp"))
        },
    );
    stop.samples = has_samples.then_some(samples);

    let mut has_seconds = stop.seconds.is_some();
    let mut seconds = stop.seconds.unwrap_or(10.0);
    row(ui, "Time", "Seconds of tracing", None, &mut has_seconds, |ui, place| {
        number(ui, place, &mut seconds, 0.1..=1e6, |drag| drag.speed(0.5).max_decimals(1).suffix(" s"))
    });
    stop.seconds = has_seconds.then_some(seconds);

    let mut has_noise = stop.noise.is_some();
    let mut noise = stop.noise.unwrap_or(Stop::NOISE);
    let help = "Estimated error: root of the mean square over pixels and channels, linear radiance";
    row(ui, "Error", help, one_half, &mut has_noise, |ui, place| {
        number(ui, place, &mut noise, 1e-6..=1.0, |drag| drag.speed(1e-4).max_decimals(6))
    });
    stop.noise = has_noise.then_some(noise);
}

/// A check box with its number beside it.
fn row(
    ui: &mut Ui,
    name: &str,
    help: &str,
    disabled_reason: Option<&str>,
    is_on: &mut bool,
    number: impl FnOnce(&mut Ui, (&str, Vec2)) -> Response,
) {
    ui.columns(2, |columns| {
        let about = About::new(name, help).disabled_if(disabled_reason);
        check(&mut columns[0], about, is_on);
        let is_useful = *is_on && disabled_reason.is_none();
        columns[1].add_enabled_ui(is_useful, |ui| {
            let size = vec2(ui.available_width(), ui.spacing().interact_size.y);
            let response = number(ui, (&format!("{name} limit"), size));
            let about = about.disabled_if(disabled_reason.or(Some("Tick the box beside it first")));
            explained(ui, response, about);
        });
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::tests::{dressed, facts_of};
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;

    #[test]
    fn a_limit_is_switched_on_with_its_usual_value() {
        let facts = facts_of("--stage defocus --size 32x18");
        let usual = facts.document().origin.recipe.samples_per_pixel;
        let draw = move |ui: &mut Ui, stop: &mut Stop| super::ui(ui, stop, &facts);
        let mut harness: Harness<'_, Stop> = dressed([260.0, 200.0]).build_ui_state(draw, Stop::default());
        for (name, expected) in [
            ("Samples", Stop { samples: Some(usual), ..Stop::default() }),
            ("Time", Stop { seconds: Some(10.0), ..Stop::default() }),
            ("Error", Stop { noise: Some(0.002), ..Stop::default() }),
        ] {
            for (is_on, expected) in [(true, expected), (false, Stop::default())] {
                harness.get_by_label(name).click();
                harness.run_steps(3);
                assert_eq!(*harness.state(), expected, "{name}, on: {is_on}");
            }
        }
    }
}
