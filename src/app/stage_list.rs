//! The list of stages: picture, section and title of each, by chapter.

use super::command::Command;
use super::facts::Facts;
use super::theme;
use super::tips;
use crate::stages::Stage;
use eframe::egui::{
    self, Align, Event, EventFilter, FontId, Id, Key, Modifiers, Rect, Response, RichText, Sense, TextStyle,
    Ui, WidgetInfo, pos2, vec2,
};

/// The width of the list in points.
pub const WIDTH: f32 = 348.0;

/// Space around the picture in its row, points.
/// Size of the small pictures, points.
const SIZE: egui::Vec2 = vec2(64.0, 36.0);

const MARGIN: f32 = 4.0;

/// How many stages Page Up and Page Down go on.
const PAGE: usize = 8;

/// Draws the list. It opens at the current stage and follows it; arrow keys go through it, typing leaves the stages that
/// have these words, and Enter chooses.
pub fn ui(ui: &mut Ui, facts: &Facts, commands: &mut Vec<Command>) {
    let here = facts.document().stage();
    let (has_opened, has_moved) = (has_just_opened(ui), has_moved(ui, here));
    // In a menu, the entries above it take room.
    let above = ui.cursor().top() - ui.min_rect().top();
    let height = (ui.ctx().content_rect().height() - 130.0 - above).clamp(160.0, 720.0);
    let id = ui.scope_id();
    let (typed, has_typed) = typed(ui);
    let is_new = (has_opened || has_moved) && typed.is_empty();
    let found = found(&typed);
    if !typed.is_empty() {
        let words = if found.is_empty() { "No stage has" } else { "Stages with" };
        ui.label(RichText::new(format!("{words} \"{}\"", typed.trim())).small());
    }
    if has_typed && !found.iter().any(|stage| ui.memory(|memory| memory.has_focus(id.with(stage.id)))) {
        let first = found.first().map(|stage| id.with(stage.id));
        ui.memory_mut(|memory| first.into_iter().for_each(|first| memory.request_focus(first)));
    }
    let mut focused = None;
    let area = egui::ScrollArea::vertical().max_height(height).min_scrolled_height(height);
    area.show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 1.0;
        let mut chapter = "";
        for (place, stage) in found.iter().copied().enumerate() {
            if stage.chapter() != chapter {
                chapter = stage.chapter();
                ui.add_space(6.0);
                let heading = format!("{chapter}  {}", stage.chapter_title);
                ui.label(RichText::new(heading).small().color(ui.visuals().weak_text_color()));
                ui.add_space(2.0);
            }
            let response = row(ui, id.with(stage.id), stage, here == Some(stage));
            if is_new && here == Some(stage) {
                response.scroll_to_me(Some(Align::Center));
                response.request_focus();
            }
            if response.gained_focus() {
                response.scroll_to_me(None);
            }
            if response.has_focus() {
                focused = Some((place, stage));
            }
            if response.clicked() {
                commands.push(Command::Stage(stage));
                ui.close();
            }
        }
    });
    if let Some((place, stage)) = focused {
        let filter = EventFilter { vertical_arrows: true, ..EventFilter::default() };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(id.with(stage.id), filter));
        let presses = |key| ui.input_mut(|input| input.count_and_consume_key(Modifiers::NONE, key));
        let down = presses(Key::ArrowDown) + PAGE * presses(Key::PageDown);
        let up = presses(Key::ArrowUp) + PAGE * presses(Key::PageUp);
        let next = (place + down).saturating_sub(up).min(found.len().saturating_sub(1));
        if let Some(next) = found.get(next).filter(|next| next.id != stage.id) {
            ui.memory_mut(|memory| memory.request_focus(id.with(next.id)));
        }
    }
}

/// What has been typed since the list was opened, and whether it has changed in this frame.
fn typed(ui: &Ui) -> (String, bool) {
    let (place, now) = (ui.scope_id().with("typed"), ui.ctx().cumulative_pass_nr());
    let kept: Option<(String, u64)> = ui.data(|data| data.get_temp(place));
    let before = kept.filter(|(_, last)| now <= last + PASSES).map_or_else(String::new, |(text, _)| text);
    let mut text = before.clone();
    ui.input_mut(|input| {
        let mut new = String::new();
        input.events.retain(|event| match event {
            Event::Text(letters) => {
                new.push_str(letters);
                false
            }
            _ => true,
        });
        if !text.is_empty() || !new.trim().is_empty() {
            text.push_str(&new);
            // Between words, Space does not choose the stage.
            input.consume_key(Modifiers::NONE, Key::Space);
        }
        (0..input.count_and_consume_key(Modifiers::NONE, Key::Backspace)).for_each(|_| _ = text.pop());
    });
    let has_changed = text != before;
    ui.data_mut(|data| data.insert_temp(place, (text.clone(), now)));
    (text, has_changed)
}

/// The stages that have all these words in their headings and names, or else in what is new there.
fn found(typed: &str) -> Vec<&'static Stage> {
    let typed = typed.to_lowercase();
    let having = |text: fn(&Stage) -> String| -> Vec<&'static Stage> {
        let has = |stage: &&Stage| {
            let text = text(stage).to_lowercase();
            typed.split_whitespace().all(|word| text.contains(word))
        };
        Stage::ALL.iter().filter(has).collect()
    };
    let by_name = having(|stage| {
        let Stage { section, section_title, chapter_title, title, id, .. } = stage;
        format!("{section} {section_title} {chapter_title} {title} {id}")
    });
    if by_name.is_empty() { having(|stage| stage.what_is_new.to_owned()) } else { by_name }
}

fn row(ui: &mut Ui, id: Id, stage: &'static Stage, is_here: bool) -> Response {
    let size = vec2(ui.available_width(), SIZE.y + 2.0 * MARGIN);
    let (_, rect) = ui.allocate_space(size);
    let response = ui.interact(rect, id, Sense::click());
    let name = Command::Stage(stage).name();
    response.widget_info(|| WidgetInfo::selected(egui::Role::Button, true, is_here, &name));
    if !ui.is_rect_visible(rect) {
        return response;
    }
    let visuals = ui.visuals();
    let (weak, text) = (visuals.weak_text_color(), visuals.strong_text_color());
    let painter = ui.painter();
    if is_here || response.hovered() {
        painter.rect_filled(rect, 5.0, visuals.widgets.hovered.bg_fill);
    }
    if is_here {
        let bar = Rect::from_min_max(rect.min, pos2(rect.left() + 3.0, rect.bottom()));
        painter.rect_filled(bar, 1.5, theme::accent(ui));
    }
    let corner = rect.min + vec2(MARGIN + 4.0, MARGIN);
    let left = corner.x + SIZE.x + 12.0;
    let (small, body) = (TextStyle::Small.resolve(ui.style()), TextStyle::Body.resolve(ui.style()));
    let painter = ui.painter();
    let section =
        painter.layout_no_wrap(stage.section.to_owned(), FontId::new(small.size + 1.0, small.family), weak);
    let title = painter.layout(stage.title.to_owned(), body, text, rect.right() - left - MARGIN);
    let height = section.size().y + title.size().y;
    let top = pos2(left, rect.center().y - 0.5 * height);
    let below = top + vec2(0.0, section.size().y);
    painter.galley(top, section, weak);
    painter.galley(below, title, text);
    tips::explain_in_column(response, rect.x_range(), stage.what_is_new, None)
}

/// The first passes of an area only measure its size.
const PASSES: u64 = 3;

/// Whether this area was hidden a moment ago.
fn has_just_opened(ui: &Ui) -> bool {
    let (id, now) = (ui.scope_id().with("opened"), ui.ctx().cumulative_pass_nr());
    ui.data_mut(|data| {
        let (mut first, last) = data.get_temp(id).unwrap_or((now, now));
        if now > last + PASSES {
            first = now;
        }
        data.insert_temp(id, (first, now));
        now < first + PASSES
    })
}

/// Whether another stage is shown than in the last frame.
fn has_moved(ui: &Ui, here: Option<&'static Stage>) -> bool {
    let (id, now) = (ui.scope_id().with("stage"), here.map(Stage::index));
    ui.data_mut(|data| {
        let before = data.get_temp::<Option<usize>>(id);
        data.insert_temp(id, now);
        before.is_some_and(|before| before != now)
    })
}

/// Opens the list in this frame. `is_at_end` shows the extreme scenes, which come last.
pub fn open(context: &egui::Context, is_at_end: bool) {
    context.data_mut(|data| data.insert_temp(Id::unique("the list of stages"), is_at_end));
}

/// Whether the list is to be opened, and if so, whether at its end.
pub fn take_open(ui: &Ui) -> Option<bool> {
    ui.data_mut(|data| data.remove_temp(Id::unique("the list of stages")))
}

#[cfg(test)]
mod tests;
