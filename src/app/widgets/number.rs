//! Numbers to type or drag. What is typed counts when it is complete; what cannot be is told.

use eframe::egui::response::Flags;
use eframe::egui::{self, DragValue, Response, Sense, Ui, UiBuilder, Vec2};
use std::cell::Cell;
use std::ops::RangeInclusive;

/// Gives a widget a name for assistive technology.
pub fn named(response: &Response, name: &str) {
    response.ctx.accesskit_node_builder(response.id, |node| node.set_label(name));
}

/// A number to type or drag. A typed number counts when the edit is complete, or after a pause in typing. Until the edit is
/// complete, Escape takes it back. The control keeps its size, however long the text is. The user is told what is not a
/// number or beyond the limits. A number that nobody changes stays as it is, even beyond the limits.
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
    if within.is_enabled() {
        // Tab leaves a control when it asks for the focus, as `DragValue` does below: too late to know that the text is
        // complete.
        let layer = within.layer_id();
        within.memory_mut(|memory| memory.interested_in_focus(id, layer));
    }
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
        // What is shown may be beyond the limits.
        let kept = number
            .and_then(|number| if number == before { Some(before) } else { within_limits(number, &limits) });
        last.set(Some(kept));
        if is_complete {
            refusal.set(refused(text, (number, kept), &limits, before));
        }
        kept.filter(|kept| is_complete && *kept != before)
    };
    let drag = DragValue::new(&mut shown)
        .range(limits.clone())
        .clamp_existing_to_range(false)
        .custom_formatter(|n, _| compact(n))
        .custom_parser(parse)
        .clip_text(true)
        .min_size(size);
    let mut response = within.add(change(drag));
    named(&response, name);
    let (least, most) = (*limits.start(), *limits.end());
    if shown != before {
        // Arrow keys and assistive technology know no limits.
        shown = shown.clamp(least, most);
    }
    // Nor does a drag or assistive technology make a limit of 0 that only stands for "above 0".
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
    let is_changed =
        typing.is_none_or(|typing| typing.last.is_none()) && shown.is_finite() && *value != shown;
    if is_changed {
        *value = shown;
    }
    response.flags.set(Flags::CHANGED, is_changed);
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
mod tests;
