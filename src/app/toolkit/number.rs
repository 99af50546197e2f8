//! Numbers: fields and sliders for them, and how they are written.

use super::theme;
use super::widgets::{About, FIELD, above, named, row, show_tip, tip};
use crate::measure::grouped;
use crate::numbers::rounded;
use eframe::egui::{
    DragValue, Key, Response, Slider, SliderClamping, Stroke, StrokeKind, Ui, response::Flags,
};
use glam::DVec3;
use std::cell::Cell;
use std::ops::RangeInclusive;
use std::time::Duration;

/// How long a number is red that cannot be, seconds.
const REFUSED: f64 = 3.0;

/// A number to type or drag.
pub struct Number<'a> {
    about: About<'a>,
    limits: RangeInclusive<f64>,
    prefix: &'a str,
    suffix: &'a str,
    speed: Option<f64>,
    /// The largest of the numbers that it belongs to: beside that, rounding noise is 0.
    scale: f64,
    is_whole: bool,
}

impl<'a> Number<'a> {
    pub fn new(about: About<'a>, limits: RangeInclusive<f64>) -> Self {
        Number { about, limits, prefix: "", suffix: "", speed: None, scale: 0.0, is_whole: false }
    }

    /// The letter before the number.
    fn letter(self, prefix: &'a str) -> Self {
        Number { prefix, ..self }
    }

    /// The unit after the number.
    pub fn unit(self, suffix: &'a str) -> Self {
        Number { suffix, ..self }
    }

    /// Change for each point that the pointer is dragged; else it depends on the number.
    pub fn speed(self, speed: f64) -> Self {
        Number { speed: Some(speed), ..self }
    }

    pub fn whole(self) -> Self {
        Number { is_whole: true, ..self }
    }

    /// The field alone. A typed number beyond a limit changes nothing: the field is red then, and tells the limits.
    pub fn field(&self, ui: &mut Ui, width: f32, value: &mut f64) -> Response {
        let (before, mut shown, is_refused) = (*value, *value, Cell::new(false));
        // The shown text stands for the exact number, although it has fewer digits.
        let parse = |text: &str| {
            let text: String = text.chars().filter(|c| !c.is_whitespace()).collect();
            if text == self.text(before) {
                return Some(before);
            }
            let number = text.replace('\u{2212}', "-").trim_end_matches(self.suffix.trim()).parse().ok();
            let number = number.filter(|number| self.limits.contains(number));
            is_refused.set(number.is_none());
            number
        };
        let speed = self.speed.unwrap_or(0.01 * before.abs().max(0.1));
        let drag = DragValue::new(&mut shown)
            .speed(if self.is_whole { speed.max(0.1) } else { speed })
            .range(self.limits.clone())
            .clamp_existing_to_range(false)
            .update_while_editing(false)
            .custom_formatter(|n, _| self.text(n))
            .custom_parser(parse)
            .prefix(self.prefix)
            .suffix(self.suffix)
            .clip_text(true);
        let added = ui.add_enabled_ui(self.about.disabled_reason.is_none(), |ui| {
            ui.spacing_mut().button_padding.x = 4.0;
            ui.add_sized([width, ui.spacing().interact_size.y], drag)
        });
        let mut response = added.inner;
        named(&response, self.about.name);
        // The field takes the text of an edit that Escape ended for one in the frame after that.
        let is_cancelled = ui.input(|input| input.key_pressed(Key::Escape)) && response.lost_focus();
        let place = response.id.with("cancelled");
        let was_cancelled = ui.data_mut(|data| data.get_temp(place).unwrap_or(false));
        ui.data_mut(|data| data.insert_temp(place, is_cancelled));
        if shown.is_finite() && !was_cancelled {
            *value = if self.is_whole { shown.round() } else { shown };
        }
        response.flags.set(Flags::CHANGED, *value != before);
        let (place, now) = (response.id.with("refused"), ui.input(|input| input.time));
        if is_refused.get() && !was_cancelled {
            ui.data_mut(|data| data.insert_temp(place, now));
        }
        let left = ui.data(|data| data.get_temp(place)).map_or(0.0, |since: f64| since + REFUSED - now);
        if left > 0.0 && !ui.input(|input| input.pointer.any_down()) {
            let stroke = Stroke::new(1.5, theme::colours(ui).bad);
            ui.painter().rect_stroke(response.rect, 4, stroke, StrokeKind::Inside);
            let [least, most] = [self.limits.start(), self.limits.end()].map(|limit| self.text(*limit));
            show_tip(ui, &response, &format!("From {least} to {most}"));
            ui.ctx().request_repaint_after(Duration::from_secs_f64(left));
            return response;
        }
        tip(ui, response, self.about.help, self.about.disabled_reason)
    }

    /// The field alone, for a whole number.
    pub fn whole_field(self, ui: &mut Ui, width: f32, value: &mut u32) -> Response {
        let mut number = f64::from(*value);
        let response = Number { is_whole: true, ..self }.field(ui, width, &mut number);
        *value = number as u32;
        response
    }

    /// A label at the left and the field at the right.
    pub fn row(&self, ui: &mut Ui, value: &mut f64) -> Response {
        row(ui, self.about, |ui| self.field(ui, FIELD, value))
    }

    /// A row with a slider under it, which covers the usual values `track`.
    pub fn slider(
        &self,
        ui: &mut Ui,
        value: &mut f64,
        track: RangeInclusive<f64>,
        is_logarithmic: bool,
    ) -> Response {
        let response = ui
            .scope(|ui| {
                ui.spacing_mut().item_spacing.y = 0.0;
                let typed = self.row(ui, value);
                let accent = theme::colours(ui).accent;
                ui.visuals_mut().selection.bg_fill = accent;
                ui.spacing_mut().interact_size.y = 20.0;
                ui.spacing_mut().slider_width = ui.available_width();
                let (least, most, before) = (*track.start(), *track.end(), *value);
                let slider = Slider::new(value, track)
                    .show_value(false)
                    .clamping(SliderClamping::Edits)
                    .logarithmic(is_logarithmic)
                    .smallest_positive(most / 100.0);
                let slid = ui.add_enabled(self.about.disabled_reason.is_none(), slider);
                if *value != before {
                    // Assistive technology knows no limits.
                    *value = if value.is_nan() { before } else { value.clamp(least, most) };
                }
                named(&slid, self.about.name);
                typed.union(tip(ui, slid, self.about.help, self.about.disabled_reason))
            })
            .inner;
        ui.add_space(4.0);
        response
    }

    fn text(&self, n: f64) -> String {
        let scale = self.scale.max(n.abs());
        if self.is_whole {
            return with_minus(&format!("{n:.0}"));
        }
        // Three fields side by side have room for six characters.
        let text = compact(rounded(n, scale, 5));
        let is_long = !self.prefix.is_empty() && text.chars().count() > 6;
        if is_long { compact(rounded(n, scale, 4)) } else { text }
    }
}

/// Three coordinates under their name, each within `limits`.
pub fn vector(ui: &mut Ui, about: About<'_>, value: &mut DVec3, limits: RangeInclusive<f64>, speed: f64) {
    ui.scope(|ui| {
        above(ui, about);
        ui.horizontal(|ui| {
            let width = ((ui.available_width() - 16.0) / 3.0).floor();
            let scale = value.abs().max_element();
            for (component, letter) in ["x ", "y ", "z "].into_iter().enumerate() {
                let name = format!("{}, {}", about.name, letter.trim());
                let about = About { name: &name, ..about };
                let number =
                    Number { scale, ..Number::new(about, limits.clone()).speed(speed).letter(letter) };
                number.field(ui, width, &mut value[component]);
            }
        });
    });
}

/// A colour to pick, as the picture shows it in white light.
pub fn colour(ui: &mut Ui, about: About<'_>, albedo: &mut DVec3) {
    let shown = albedo.to_array().map(|n| (255.0 * n.clamp(0.0, 1.0).sqrt()).round() as u8);
    row(ui, about, |ui| {
        ui.spacing_mut().interact_size.x = FIELD;
        let mut picked = shown;
        let response = ui.color_edit_button_srgb(&mut picked);
        named(&response, about.name);
        tip(ui, response, about.help, about.disabled_reason);
        for component in (0..3).filter(|component| picked[*component] != shown[*component]) {
            let light = (f64::from(picked[component]) / 255.0).powi(2);
            albedo[component] = (light * 1e4).round() / 1e4;
        }
    });
}

/// Formats a number in few characters.
pub fn compact(n: f64) -> String {
    let magnitude = n.abs();
    if magnitude == 0.0 {
        return "0".to_owned();
    }
    let exponent = magnitude.log10().floor();
    let trimmed = |text: &str| match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text.to_owned(),
    };
    if !(1e-6..1e7).contains(&magnitude) {
        let text = format!("{n:.2e}");
        let (mantissa, power) = text.split_once('e').unwrap_or((&text, "0"));
        return with_minus(&format!("{}e{power}", trimmed(mantissa)));
    }
    let decimals = if exponent < -2.0 { 2.0 - exponent } else { (4.0 - exponent).clamp(0.0, 4.0) };
    with_minus(&trimmed(&format!("{n:.*}", decimals as usize)))
}

fn with_minus(text: &str) -> String {
    text.replace('-', "\u{2212}")
}

/// A number of samples, in words.
pub fn samples_words(count: u64) -> String {
    format!("{} sample{} per pixel", grouped(count), if count == 1 { "" } else { "s" })
}

/// A point in few characters, as in `13, 2, 3`.
pub fn point_words(point: DVec3) -> String {
    let scale = point.abs().max_element();
    point.to_array().map(|n| compact(rounded(n, scale, 3))).join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_free_of_noise() {
        for (number, expected) in [
            (0.0, "0"),
            (-0.0, "0"),
            (-1.2, "−1.2"),
            (-100.25, "−100.25"),
            (0.1 + 0.2, "0.3"),
            (-5e-4, "−0.0005"),
            (100_000.0, "100000"),
            (-2.5e-12, "−2.5e−12"),
            (1e18, "1e18"),
        ] {
            assert_eq!(compact(number), expected);
        }
        assert_eq!(point_words(DVec3::new(12.974, 2.08e-17, -3.0)), "13, 0, −3");
        assert_eq!(point_words(DVec3::ZERO), "0, 0, 0");
        assert_eq!([1, 2].map(samples_words), ["1 sample per pixel", "2 samples per pixel"]);
        let number = Number::new(About::new("", ""), -9.0..=9.0);
        assert_eq!([-0.695_66, 2.087_12].map(|n| number.text(n)), ["−0.6957", "2.0871"]);
        let beside = Number { scale: 2.0, ..number.letter("x ") };
        assert_eq!([-0.695_66, 2.087_12].map(|n| beside.text(n)), ["−0.696", "2.0871"]);
    }
}
