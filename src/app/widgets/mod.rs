//! Controls for panels. Each has a name and a tooltip; a disabled control also shows the reason.

mod number;

pub use number::{compact, is_typing, named, number, take_told, whole_number};

use super::tips::{self, Side};
use eframe::egui::{self, Response, RichText, Slider, SliderClamping, Ui, vec2};
use glam::DVec3;
use std::ops::RangeInclusive;

/// A control's name, its tooltip with the unit, and the reason if it is disabled.
#[derive(Clone, Copy)]
pub struct About<'a> {
    pub name: &'a str,
    pub help: &'a str,
    pub disabled_reason: Option<&'a str>,
}

impl<'a> About<'a> {
    pub fn new(name: &'a str, help: &'a str) -> Self {
        About { name, help, disabled_reason: None }
    }

    pub fn disabled_if(self, reason: Option<&'a str>) -> Self {
        About { disabled_reason: reason, ..self }
    }
}

/// A name with a control below it, which gets the same accessible name.
pub fn control(ui: &mut Ui, about: About<'_>, add: impl FnOnce(&mut Ui) -> Response) -> Response {
    under_name(ui, about, |ui| {
        let response = add(ui);
        named(&response, about.name);
        explained(ui, response, about)
    })
}

/// A value in a list that a [`control`] opens. Choosing it closes the list, with the keyboard, too.
pub fn choice<T: PartialEq>(ui: &mut Ui, chosen: &mut T, value: T, text: impl Into<egui::WidgetText>) {
    if ui.selectable_label(*chosen == value, text.into()).clicked() {
        *chosen = value;
        ui.close();
    }
}

/// A name with controls below it that have names and tooltips of their own.
pub fn under_name(ui: &mut Ui, about: About<'_>, add: impl FnOnce(&mut Ui) -> Response) -> Response {
    ui.spacing_mut().item_spacing.y = 3.0;
    let is_useful = about.disabled_reason.is_none();
    let response = ui
        .add_enabled_ui(is_useful, |ui| {
            ui.add(egui::Label::new(RichText::new(about.name).small().color(ui.visuals().weak_text_color())));
            add(ui)
        })
        .inner;
    ui.add_space(5.0);
    response
}

/// Adds the tooltip beside the panel, with the reason if the control is disabled.
pub fn explained(ui: &Ui, response: Response, about: About<'_>) -> Response {
    tips::explain(ui, response, Side::Beside, about.help, about.disabled_reason)
}

/// A slider with its number. The slider covers the usual values `track`; the number takes any within `limits`.
pub fn slider(
    ui: &mut Ui,
    about: About<'_>,
    value: &mut f64,
    (track, limits): (RangeInclusive<f64>, RangeInclusive<f64>),
    suffix: &str,
    change: impl FnOnce(Slider<'_>) -> Slider<'_>,
) -> Response {
    under_name(ui, about, |ui| {
        ui.horizontal(|ui| {
            let digits = ui.text_style_height(&egui::TextStyle::Body) * 5.0;
            ui.spacing_mut().slider_width =
                (ui.available_width() - digits - ui.spacing().item_spacing.x).max(40.0);
            let speed = 0.002 * (track.end() - track.start()).min(value.abs().max(0.1) * 5.0);
            let before = *value;
            let slider = Slider::new(value, track.clone()).show_value(false).clamping(SliderClamping::Edits);
            let slid = ui.add(change(slider));
            if *value != before {
                // Assistive technology knows no limits.
                *value = if value.is_nan() { before } else { value.clamp(*track.start(), *track.end()) };
            }
            named(&slid, about.name);
            let size = vec2(digits, ui.spacing().interact_size.y);
            let typed =
                number(ui, (about.name, size), value, limits, |drag| drag.speed(speed).suffix(suffix));
            explained(ui, slid, about).union(explained(ui, typed, about))
        })
        .inner
    })
}

/// Controls for the three components of a vector, each within `limits`.
pub fn vector(
    ui: &mut Ui,
    about: About<'_>,
    value: &mut DVec3,
    limits: RangeInclusive<f64>,
    speed: f64,
) -> Response {
    under_name(ui, about, |ui| {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 4.0;
            let size = vec2((ui.available_width() - 8.0) / 3.0, ui.spacing().interact_size.y);
            let mut all: Option<Response> = None;
            for (axis, component) in ["x", "y", "z"].into_iter().zip(value.as_mut()) {
                let name = format!("{} {axis}", about.name);
                let response = number(ui, (&name, size), component, limits.clone(), |drag| drag.speed(speed));
                let response = explained(ui, response, about);
                all = Some(match all {
                    Some(earlier) => earlier.union(response),
                    None => response,
                });
            }
            all
        })
        .inner
        .unwrap_or_else(|| ui.label(""))
    })
}

/// A whole number to type or drag.
pub fn whole(
    ui: &mut Ui,
    about: About<'_>,
    value: &mut u64,
    range: RangeInclusive<u64>,
    speed: f64,
) -> Response {
    under_name(ui, about, |ui| {
        let size = vec2(ui.available_width(), ui.spacing().interact_size.y);
        let response = whole_number(ui, (about.name, size), value, range, |drag| drag.speed(speed));
        explained(ui, response, about)
    })
}

/// A check box. What it enables is shown only while it is checked.
pub fn check(ui: &mut Ui, about: About<'_>, value: &mut bool) -> Response {
    let response = ui.add_enabled(about.disabled_reason.is_none(), egui::Checkbox::new(value, about.name));
    explained(ui, response, about)
}
