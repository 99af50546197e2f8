//! Controls for panels. Each has a name and a tooltip; a disabled control also shows the reason.

use super::tips::{self, Side};
use eframe::egui::{
    self, DragValue, Response, RichText, Sense, Slider, SliderClamping, Ui, UiBuilder, Vec2, vec2,
};
use glam::DVec3;
use std::cell::Cell;
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
        explained(ui, response, about)
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
            let slider = Slider::new(value, track).show_value(false).clamping(SliderClamping::Edits);
            let slid = ui.add(change(slider));
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

/// A number to type or drag. A typed number counts when the edit is complete, or after a pause in typing. Until the edit is
/// complete, Escape takes it back. The control keeps its size, however long the text is, and a number beyond the limits is
/// told with [`tell`].
pub fn number(
    ui: &mut Ui,
    (name, size): (&str, Vec2),
    value: &mut f64,
    limits: RangeInclusive<f64>,
    change: impl FnOnce(DragValue<'_>) -> DragValue<'_>,
) -> Response {
    let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
    let layout = egui::Layout::centered_and_justified(egui::Direction::LeftToRight);
    let mut within = ui.new_child(UiBuilder::new().max_rect(rect).layout(layout));
    within.shrink_clip_rect(rect);
    let id = within.next_auto_id();
    let mut typing = Typing::of(&within, id, *value);
    // While a number is typed, the control keeps the number from before: with another one, it would replace the text.
    let before = typing.map_or(*value, |typing| typing.before);
    let mut shown = before;
    let is_given_up = is_given_up(&within, id);
    let is_complete = !within.memory(|memory| memory.has_focus(id));
    if typing.is_some_and(|typing| typing.applied.is_some()) {
        let frame = ui.ctx().cumulative_frame_nr();
        ui.data_mut(|data| data.insert_temp(typed(), frame));
    }
    let (beyond, last) = (Cell::new(None), Cell::new(None));
    let parse = |text: &str| {
        last.set(Some(None));
        let number = if is_given_up { before } else { parsed(text, before)? };
        let kept = number.clamp(*limits.start(), *limits.end());
        last.set(Some(Some(kept)));
        beyond.set((number != kept && is_complete).then_some((number, kept)));
        is_complete.then_some(kept)
    };
    let drag = DragValue::new(&mut shown)
        .range(limits.clone())
        .custom_formatter(|n, _| compact(n))
        .custom_parser(parse)
        .clip_text(true)
        .min_size(size);
    let mut response = within.add(change(drag));
    named(&response, name);
    let now = ui.input(|input| input.time);
    if shown != before || is_complete {
        typing = None;
        if shown == before && last.get().is_none() && !is_given_up {
            // The edit ended while the control was not drawn: what a pause has applied stays.
            shown = *value;
        }
    } else if let Some(last) = last.get() {
        let applied = typing.and_then(|typing| typing.applied);
        typing = Some(Typing { before, applied, last: last.map(|number| (number, now + PAUSE)) });
        ui.ctx().request_repaint_after_secs(PAUSE as f32);
    } else if let Some(Typing { applied, last, .. }) = &mut typing {
        *applied = last.take_if(|(_, due)| now >= *due).map(|(number, _)| number).or(*applied);
        shown = applied.unwrap_or(before);
    }
    if typing.is_none_or(|typing| typing.last.is_none()) && shown.is_finite() && *value != shown {
        *value = shown;
        response.mark_changed();
    }
    Typing::keep(typing, ui, id);
    if let Some((number, kept)) = beyond.get() {
        let (number, kept) = (compact(number), compact(kept));
        tell(ui.ctx(), format!("{name} is {kept}, its limit: {number} is beyond it"));
    }
    response
}

/// A typed number counts after so many seconds without a key.
const PAUSE: f64 = 0.8;

/// A number that is being typed.
#[derive(Clone, Copy)]
struct Typing {
    /// The number from before.
    before: f64,
    /// The number that a pause has applied.
    applied: Option<f64>,
    /// The number that was typed last, if it has not been applied yet, and when it will be, in seconds of the window's
    /// clock.
    last: Option<(f64, f64)>,
}

impl Typing {
    /// What is being typed in the control `id`, unless its `value` has been changed by something else.
    fn of(ui: &Ui, id: egui::Id, value: f64) -> Option<Typing> {
        let typing: Typing = ui.data(|data| data.get_temp(id.with("typing")))?;
        Some(typing).filter(|typing| typing.applied.unwrap_or(typing.before) == value)
    }

    /// Keeps what is being typed until the next frame.
    fn keep(typing: Option<Typing>, ui: &Ui, id: egui::Id) {
        ui.data_mut(|data| match typing {
            Some(typing) => _ = data.insert_temp(id.with("typing"), typing),
            None => data.remove::<Typing>(id.with("typing")),
        });
    }
}

fn typed() -> egui::Id {
    egui::Id::unique("typed into a control")
}

/// Whether the user may still go on to type a number that a pause has applied: what comes of it is the same change.
pub fn is_typing(context: &egui::Context) -> bool {
    let frame: Option<u64> = context.data(|data| data.get_temp(typed()));
    frame == Some(context.cumulative_frame_nr())
}

/// Whether Escape has ended the edit of the number `id` a moment ago. egui sees it in the first of the two frames in which
/// it applies the text.
fn is_given_up(ui: &Ui, id: egui::Id) -> bool {
    const FRAMES: u64 = 2;
    let (place, now) = (id.with("given up"), ui.ctx().cumulative_frame_nr());
    let has_focus = ui.memory(|memory| memory.had_focus_last_frame(id));
    if has_focus && ui.input(|input| input.key_pressed(egui::Key::Escape)) {
        ui.data_mut(|data| data.insert_temp(place, now));
    }
    ui.data(|data| data.get_temp::<u64>(place)).is_some_and(|then| now <= then + FRAMES)
}

/// The number of a text; `before` if the text is what is shown of that.
fn parsed(text: &str, before: f64) -> Option<f64> {
    let text: String = text.chars().filter(|c| !c.is_whitespace()).collect();
    if text == compact(before) {
        return Some(before);
    }
    text.replace('\u{2212}', "-").trim_end_matches('°').parse().ok().filter(|number: &f64| !number.is_nan())
}

fn told() -> egui::Id {
    egui::Id::unique("told by a control")
}

/// Leaves a message for the user.
fn tell(context: &egui::Context, text: String) {
    context.data_mut(|data| data.insert_temp(told(), text));
}

/// Takes the message that a control has left.
pub fn take_told(context: &egui::Context) -> Option<String> {
    context.data_mut(|data| data.remove_temp(told()))
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

/// Like [`number`], for whole numbers up to 2^53, with all their digits.
pub fn whole_number(
    ui: &mut Ui,
    place: (&str, Vec2),
    value: &mut u64,
    range: RangeInclusive<u64>,
    change: impl FnOnce(DragValue<'_>) -> DragValue<'_>,
) -> Response {
    let mut real = *value as f64;
    let limits = *range.start() as f64..=*range.end() as f64;
    let response =
        number(ui, place, &mut real, limits, |drag| change(drag.custom_formatter(|n, _| format!("{n:.0}"))));
    if response.changed() {
        *value = (real.round() as u64).clamp(*range.start(), *range.end());
    }
    response
}

/// A check box. What it enables is shown only while it is checked.
pub fn check(ui: &mut Ui, about: About<'_>, value: &mut bool) -> Response {
    let response = ui.add_enabled(about.disabled_reason.is_none(), egui::Checkbox::new(value, about.name));
    explained(ui, response, about)
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
    use crate::app::tests::{Drawings, dressed, leave};
    use egui_kittest::kittest::Queryable;

    #[test]
    fn a_text_that_was_not_edited_keeps_all_digits() {
        let third = 1.0 / 3.0;
        assert_eq!(parsed(&compact(third), third), Some(third));
        assert_eq!(parsed(" 0.3334 ", third), Some(0.3334));
        assert_eq!(parsed("\u{2212}45°", 1.0), Some(-45.0));
        assert_eq!(parsed("1e30", 1.0), Some(1e30));
        for text in ["", "x", "nan"] {
            assert_eq!(parsed(text, 1.0), None, "{text}");
        }
    }

    #[test]
    fn numbers_stay_short() {
        for (number, text) in [
            (0.0, "0"),
            (1.0, "1"),
            (-2.0, "-2"),
            (0.1, "0.1"),
            (10.126, "10.13"),
            (1000.0, "1000"),
            (123456789.0, "1.23e8"),
            (0.001, "0.001"),
            (0.00099, "9.90e-4"),
            (0.012345, "0.0123"),
            (1.23456, "1.235"),
            (99999.0, "99999"),
            (1e5, "1.00e5"),
        ] {
            assert_eq!(compact(number), text);
        }
    }

    struct Controls {
        numbers: [f64; 2],
        vector: DVec3,
        count: u64,
        is_on: bool,
        reason: Option<&'static str>,
    }

    #[test]
    fn controls_are_drawn_under_their_names_and_tell_why_they_are_disabled() {
        let draw = |ui: &mut Ui, controls: &mut Controls| {
            let Controls { numbers: [first, second], vector: vector_of, count, is_on, reason } = controls;
            let about = |name| About::new(name, "What it is").disabled_if(*reason);
            let ranges = (0.0..=10.0, -100.0..=100.0);
            slider(ui, about("Slider"), first, ranges, "°", |slider| slider.max_decimals(1));
            vector(ui, about("Vector"), vector_of, -5.0..=5.0, 0.01);
            whole(ui, about("Whole"), count, 1..=9, 1.0);
            check(ui, about("Check"), is_on);
            control(ui, about("Control"), |ui| ui.button("press"));
            number(ui, ("Number", vec2(60.0, 22.0)), second, 0.0..=1.0, |drag| drag);
        };
        let vector = DVec3::new(1.5, -2.25, 0.0);
        let controls = Controls { numbers: [2.5, 0.125], vector, count: 7, is_on: true, reason: None };
        let mut harness = dressed([240.0, 330.0]).build_ui_state(draw, controls);
        let mut drawings = Drawings::default();
        drawings.add("enabled", &harness);
        drawings.add_tips(&mut harness);
        for name in ["Slider", "Check", "Control", "Number"] {
            let pos = harness.get_all_by_label(name).last().unwrap().rect().center();
            for pressed in [true, false] {
                let (button, modifiers) = (egui::PointerButton::Primary, egui::Modifiers::NONE);
                harness.event(egui::Event::PointerMoved(pos));
                harness.event(egui::Event::PointerButton { pos, button, pressed, modifiers });
                harness.run_steps(1);
                drawings.add(&format!("{name}, pressed: {pressed}"), &harness);
            }
        }
        leave(&mut harness);
        harness.state_mut().reason = Some("Why it is disabled");
        harness.run_steps(2);
        drawings.add("disabled", &harness);
        drawings.add_tips(&mut harness);
        drawings.keep("widgets");
    }
}
