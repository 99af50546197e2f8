//! Controls for panels. Each has a name and a tooltip; a disabled control also shows the reason.

use eframe::egui::{self, DragValue, Response, RichText, Slider, Ui};
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

/// Gives a widget a name for assistive technology.
pub fn named(response: &Response, name: &str) {
    response.ctx.accesskit_node_builder(response.id, |node| node.set_label(name));
}

/// A name with a control below it, which gets the same accessible name.
pub fn control(ui: &mut Ui, about: About<'_>, add: impl FnOnce(&mut Ui) -> Response) -> Response {
    under_name(ui, about, |ui| {
        let response = add(ui);
        named(&response, about.name);
        explained(response, about)
    })
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

/// Adds the tooltip, and the reason if the control is disabled.
pub fn explained(response: Response, about: About<'_>) -> Response {
    let response = response.on_hover_text(about.help);
    match about.disabled_reason {
        Some(reason) => response.on_disabled_hover_text(format!("{}\n\n{reason}", about.help)),
        None => response,
    }
}

/// Lets a control change a number, but rejects NaN and infinities, which users can type.
fn keep_finite(value: &mut f64, change: impl FnOnce(&mut f64) -> Response) -> Response {
    let before = *value;
    let response = change(value);
    if !value.is_finite() {
        *value = before;
    }
    response
}

/// A slider with its number.
pub fn slider(
    ui: &mut Ui,
    about: About<'_>,
    value: &mut f64,
    range: RangeInclusive<f64>,
    change: impl FnOnce(Slider<'_>) -> Slider<'_>,
) -> Response {
    control(ui, about, |ui| {
        let digits = ui.text_style_height(&egui::TextStyle::Body) * 5.0;
        ui.spacing_mut().slider_width =
            (ui.available_width() - digits - ui.spacing().item_spacing.x).max(40.0);
        ui.spacing_mut().interact_size.x = digits;
        keep_finite(value, |value| ui.add(change(Slider::new(value, range))))
    })
}

/// Controls for the three components of a vector.
pub fn vector(ui: &mut Ui, about: About<'_>, value: &mut DVec3, speed: f64) -> Response {
    under_name(ui, about, |ui| {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 4.0;
            let width = (ui.available_width() - 8.0) / 3.0;
            let mut all: Option<Response> = None;
            for (axis, number) in ["x", "y", "z"].into_iter().zip(value.as_mut()) {
                let size = [width, ui.spacing().interact_size.y];
                let response = keep_finite(number, |number| {
                    let drag = DragValue::new(number).speed(speed).max_decimals(4).range(-1e15..=1e15);
                    ui.add_sized(size, drag.custom_formatter(|n, _| compact(n)))
                });
                named(&response, &format!("{} {axis}", about.name));
                let response = explained(response, about);
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

/// A number to type or drag. It changes only when the edit is complete.
pub fn limit(ui: &mut Ui, value: &mut f64, change: impl FnOnce(DragValue<'_>) -> DragValue<'_>) -> Response {
    keep_finite(value, |value| ui.add(change(DragValue::new(value).update_while_editing(false))))
}

/// A whole number to type or drag.
pub fn whole(
    ui: &mut Ui,
    about: About<'_>,
    value: &mut u64,
    range: RangeInclusive<u64>,
    speed: f64,
) -> Response {
    control(ui, about, |ui| {
        let size = [ui.available_width(), ui.spacing().interact_size.y];
        ui.add_sized(size, DragValue::new(value).range(range).speed(speed))
    })
}

/// A check box. What it enables is shown only while it is checked.
pub fn check(ui: &mut Ui, about: About<'_>, value: &mut bool) -> Response {
    let response = ui.add_enabled(about.disabled_reason.is_none(), egui::Checkbox::new(value, about.name));
    explained(response, about)
}

/// Formats a number in few characters.
pub fn compact(n: f64) -> String {
    let magnitude = n.abs();
    if n == 0.0 {
        "0".to_owned()
    } else if !(1e-3..1e5).contains(&magnitude) {
        format!("{n:.2e}")
    } else {
        let decimals = (3.0 - magnitude.log10().floor()).clamp(0.0, 4.0) as usize;
        let text = format!("{n:.decimals$}");
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_stay_short() {
        for (number, text) in [
            (0.0, "0"),
            (1.0, "1"),
            (-2.0, "-2"),
            (0.1, "0.1"),
            (10.126, "10.13"),
            (1000.0, "1000"),
            (1e-9, "1.00e-9"),
            (123456789.0, "1.23e8"),
        ] {
            assert_eq!(compact(number), text);
        }
    }
}
