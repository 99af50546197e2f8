//! Numbers to type or drag. What is typed counts when it is complete; what cannot be is told.

use eframe::egui::{self, DragValue, Response, Sense, Ui, UiBuilder, Vec2};
use std::cell::Cell;
use std::ops::RangeInclusive;

/// Gives a widget a name for assistive technology.
pub fn named(response: &Response, name: &str) {
    response.ctx.accesskit_node_builder(response.id, |node| node.set_label(name));
}

/// A number to type or drag. A typed number counts when the edit is complete, or after a pause in typing. Until the edit is
/// complete, Escape takes it back. The control keeps its size, however long the text is. The user is told what is not a
/// number or beyond the limits.
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
    let (refusal, last) = (Cell::new(None), Cell::new(None));
    let parse = |text: &str| {
        let number = if is_given_up { Some(before) } else { parsed(text, before) };
        let kept = number.and_then(|number| within_limits(number, &limits));
        last.set(Some(kept));
        if is_complete {
            refusal.set(refused(text, (number, kept), &limits, before));
        }
        kept.filter(|_| is_complete)
    };
    let drag = DragValue::new(&mut shown)
        .range(limits.clone())
        .custom_formatter(|n, _| compact(n))
        .custom_parser(parse)
        .clip_text(true)
        .min_size(size);
    let mut response = within.add(change(drag));
    named(&response, name);
    // Nor does a drag or assistive technology make a limit of 0 that only stands for "above 0".
    let least = *limits.start();
    if stands_for_zero(least) && shown == least && last.get() != Some(Some(least)) {
        shown = before;
    }
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
    if let Some(reason) = refusal.take() {
        tell(ui.ctx(), format!("{name} {reason}"));
    }
    response
}

/// A lower limit below this only keeps out 0, where its arithmetic ends: nobody means the limit itself.
const TINY: f64 = 1e-8;

fn stands_for_zero(least: f64) -> bool {
    0.0 < least && least < TINY
}

/// What becomes of a typed number: the nearest limit if it is beyond one; `None` if it is refused.
fn within_limits(number: f64, limits: &RangeInclusive<f64>) -> Option<f64> {
    let (least, most) = (*limits.start(), *limits.end());
    (number >= least || !stands_for_zero(least)).then(|| number.clamp(least, most))
}

/// Why a typed text is not taken as it is, if so: the `number` that it is, and what was made of that.
fn refused(
    text: &str,
    (number, kept): (Option<f64>, Option<f64>),
    limits: &RangeInclusive<f64>,
    before: f64,
) -> Option<String> {
    let (text, before_words) = (text.trim(), compact(before));
    let Some(number) = number else {
        let pointed = text.replace(',', ".");
        let remedy = match parsed(&pointed, before) {
            Some(_) => format!("; decimals need a point, as in {pointed}"),
            None => String::new(),
        };
        let start: String = text.chars().take(30).collect();
        return (!text.is_empty())
            .then(|| format!("stays {before_words}: \u{201c}{start}\u{201d} is not a number{remedy}"));
    };
    let (least, most, typed) = (*limits.start(), *limits.end(), digits(number));
    let limit = if number > most {
        format!("at most {}", digits(most))
    } else if number <= 0.0 && stands_for_zero(least) {
        "above 0".to_owned()
    } else {
        format!("at least {}", digits(least))
    };
    match kept {
        Some(kept) if kept == number => None,
        Some(kept) => Some(format!("must be {limit}, not {typed}; it is {} now", digits(kept))),
        None => Some(format!("must be {limit}, not {typed}; it stays {before_words}")),
    }
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

/// A number with all its digits, as a power of ten where that is much shorter.
fn digits(n: f64) -> String {
    const LONG: usize = 9;
    let [usual, power] = [format!("{n}"), format!("{n:e}")];
    if usual.len() > LONG && power.len() < usual.len() { power } else { usual }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::tests::dressed;
    use eframe::egui::{Event, Key, vec2};
    use egui_kittest::Harness;
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
    /// A number that is typed into a control with these limits, and what is told about it.
    fn typed(before: f64, limits: RangeInclusive<f64>, text: &str) -> (f64, Option<String>) {
        let draw = move |ui: &mut Ui, number: &mut f64| {
            super::number(ui, ("Radius", vec2(60.0, 22.0)), number, limits.clone(), |drag| drag);
        };
        let mut harness: Harness<'_, f64> = dressed([100.0, 50.0]).build_ui_state(draw, before);
        harness.get_by_label("Radius").focus();
        harness.run_steps(3);
        for letter in text.chars() {
            harness.event(Event::Text(letter.to_string()));
            harness.run_steps(2);
        }
        harness.key_press(Key::Enter);
        harness.run_steps(3);
        (*harness.state(), take_told(&harness.ctx))
    }

    #[test]
    fn what_cannot_be_is_told_with_its_limit() {
        let radius = 1e-18..=1e18;
        for (text, expected, told) in [
            ("0", 0.5, Some("Radius must be above 0, not 0; it stays 0.5")),
            ("-3", 0.5, Some("Radius must be above 0, not -3; it stays 0.5")),
            ("1e-30", 0.5, Some("Radius must be at least 1e-18, not 1e-30; it stays 0.5")),
            ("1e-18", 1e-18, None),
            ("1e40", 1e18, Some("Radius must be at most 1e18, not 1e40; it is 1e18 now")),
            ("abc", 0.5, Some("Radius stays 0.5: \u{201c}abc\u{201d} is not a number")),
            (
                "1,5",
                0.5,
                Some(
                    "Radius stays 0.5: \u{201c}1,5\u{201d} is not a number; decimals need a point, as in 1.5",
                ),
            ),
            ("2.5", 2.5, None),
            (" ", 0.5, None),
        ] {
            assert_eq!(typed(0.5, radius.clone(), text), (expected, told.map(str::to_owned)), "{text}");
        }
        let (kept, told) = typed(759.0, 1.0..=16384.0, "100000");
        assert_eq!(kept, 16384.0);
        assert_eq!(told.as_deref(), Some("Radius must be at most 16384, not 100000; it is 16384 now"));
        let (kept, told) = typed(4.0, 1.0..=9.0, "0");
        assert_eq!((kept, told.as_deref()), (1.0, Some("Radius must be at least 1, not 0; it is 1 now")));
    }

    #[test]
    fn a_limit_that_stands_for_zero_is_not_reached_without_typing() {
        for (limits, expected) in [(1e-18..=9.0, 0.5), (0.0..=9.0, 0.0), (1e-6..=9.0, 1e-6)] {
            let draw = move |ui: &mut Ui, number: &mut f64| {
                super::number(ui, ("Radius", vec2(60.0, 22.0)), number, limits.clone(), |drag| drag);
            };
            let mut harness: Harness<'_, f64> = dressed([100.0, 50.0]).build_ui_state(draw, 0.5);
            harness.get_by_label("Radius").set_value_accesskit(0.0);
            harness.run_steps(2);
            assert_eq!(*harness.state(), expected);
        }
    }

    #[test]
    fn numbers_in_messages_have_all_their_digits() {
        for (number, text) in [
            (100_000.0, "100000"),
            (0.1, "0.1"),
            (1e18, "1e18"),
            (-1e-12, "-1e-12"),
            (4294967295.0, "4294967295"),
        ] {
            assert_eq!(digits(number), text);
        }
    }
}
