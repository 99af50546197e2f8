//! The list of stages: a field to search in, chapters as headings, and the extreme scenes.

use super::command::Command;
use super::facts::Facts;
use super::theme;
use super::widgets::{caption, hint, tip};
use crate::measure::stress::{Case, shown_cases};
use crate::stages::Stage;
use eframe::egui::{
    self, Align, ColorImage, Context, Id, Key, Modifiers, Rect, Response, Sense, Stroke, StrokeKind,
    TextStyle, TextureHandle, Ui, WidgetInfo, vec2,
};

/// The width of the list in points.
pub const WIDTH: f32 = 360.0;

/// Size of the small pictures, points.
const PICTURE: egui::Vec2 = vec2(72.0, 40.0);

/// How many rows Page Up and Page Down go on.
const PAGE: usize = 8;

const LAST_HEADING: &str = "Extreme scenes";

/// What was typed, and the chosen row.
#[derive(Clone, Default)]
struct State {
    text: String,
    chosen: usize,
    has_moved: bool,
}

fn place() -> Id {
    Id::unique("list of stages")
}

/// A row of the list.
#[derive(Clone, Copy, PartialEq)]
enum Row {
    Stage(&'static Stage),
    Case(&'static Case),
}

impl Row {
    fn all() -> impl Iterator<Item = Row> {
        let aside = Stage::ALL.iter().filter(|stage| !stage.is_in_book());
        Stage::walk().chain(aside).map(Row::Stage).chain(shown_cases().iter().map(Row::Case))
    }

    fn command(self) -> Command {
        match self {
            Row::Stage(stage) => Command::Stage(stage),
            Row::Case(case) => Command::Extreme(case),
        }
    }

    fn heading(self) -> String {
        match self {
            Row::Stage(stage) if stage.is_in_book() => format!("{} {}", stage.chapter(), stage.chapter_title),
            _ => LAST_HEADING.to_owned(),
        }
    }

    /// The words by which it is found; what is new only if nothing has them in its name.
    fn words(self, is_long: bool) -> String {
        let name = match self {
            Row::Stage(Stage { section, section_title, title, id, .. }) => {
                format!("{section} {section_title} {title} {id}")
            }
            Row::Case(case) => case.title().to_owned(),
        };
        let more = if is_long { self.command().help() } else { "" };
        format!("{name} {} {more}", self.heading()).to_lowercase()
    }
}

fn found(typed: &str) -> Vec<Row> {
    let typed = typed.to_lowercase();
    let having = |is_long| -> Vec<Row> {
        let has = |row: &Row| typed.split_whitespace().all(|word| row.words(is_long).contains(word));
        Row::all().filter(has).collect()
    };
    let by_name = having(false);
    if by_name.is_empty() { having(true) } else { by_name }
}

/// Opens the list at the picture that is shown, or at its end.
pub fn begin(context: &Context, facts: &Facts, is_at_end: bool) {
    let is_first = |row: &Row| match is_at_end {
        true => row.heading() == LAST_HEADING,
        false => facts.is_on(row.command()),
    };
    let chosen = Row::all().position(|row| is_first(&row)).unwrap_or(0);
    context.data_mut(|data| data.insert_temp(place(), State { chosen, has_moved: true, ..State::default() }));
}

/// Draws the list. Arrow keys go through it, typing leaves what has these words, and Enter chooses.
pub fn ui(ui: &mut Ui, commands: &mut Vec<Command>) {
    ui.set_width(WIDTH);
    let mut state: State = ui.data(|data| data.get_temp(place())).unwrap_or_default();
    if !state.text.is_empty() && ui.input_mut(|input| input.consume_key(Modifiers::NONE, Key::Escape)) {
        (state.text, state.chosen) = (String::new(), 0);
    }
    let presses = |key| ui.input_mut(|input| input.count_and_consume_key(Modifiers::NONE, key));
    let down = presses(Key::ArrowDown) + PAGE * presses(Key::PageDown);
    let up = presses(Key::ArrowUp) + PAGE * presses(Key::PageUp);
    let is_enter = presses(Key::Enter) > 0;
    let edit = egui::TextEdit::singleline(&mut state.text)
        .hint_text("Type a number or a word: 9.5, glass, gamma")
        .margin(vec2(8.0, 8.0))
        .desired_width(f32::INFINITY);
    let response = ui.add(edit).accessible_name("Search for a stage");
    response.request_focus();
    if response.changed() {
        (state.chosen, state.has_moved) = (0, true);
    }
    let found = found(&state.text);
    let last = found.len().saturating_sub(1);
    state.chosen = (state.chosen + down).min(last).saturating_sub(up);
    state.has_moved |= up + down > 0;
    let mut run = is_enter.then(|| found.get(state.chosen)).flatten().copied();
    let height = (ui.ctx().content_rect().height() - 140.0).clamp(160.0, 720.0);
    egui::ScrollArea::vertical().max_height(height).min_scrolled_height(height).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        if found.is_empty() {
            hint(ui, "No stage is called that. Press Escape to see all.");
        }
        let mut heading = String::new();
        for (index, row) in found.iter().copied().enumerate() {
            if row.heading() != heading {
                heading = row.heading();
                caption(ui, &format!("  {heading}"));
            }
            let response = row_ui(ui, row, index == state.chosen);
            if index == state.chosen && state.has_moved {
                response.scroll_to_me(Some(Align::Center));
            }
            if response.clicked() {
                run = Some(row);
            }
        }
    });
    // The area has its final size only in its second frame.
    state.has_moved = std::mem::take(&mut state.has_moved) && ui.is_sizing_pass();
    ui.data_mut(|data| data.insert_temp(place(), state));
    if let Some(row) = run {
        commands.push(row.command());
        ui.close();
    }
}

fn row_ui(ui: &mut Ui, row: Row, is_chosen: bool) -> Response {
    let picture = match row {
        Row::Stage(stage) => thumbnail(ui.ctx(), stage),
        Row::Case(_) => None,
    };
    let height = if picture.is_some() { 52.0 } else { 28.0 };
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::click());
    let name = row.command().name();
    response.widget_info(|| WidgetInfo::selected(egui::Role::Button, true, is_chosen, &name));
    if !ui.is_rect_visible(rect) {
        return response;
    }
    let colours = theme::colours(ui);
    let painter = ui.painter();
    if is_chosen || response.hovered() {
        painter.rect_filled(rect, 4, if is_chosen { colours.tint } else { colours.hovered });
    }
    if is_chosen {
        painter.rect_stroke(rect, 4, Stroke::new(1.0, colours.accent), StrokeKind::Inside);
    }
    let [small, body] = [TextStyle::Small, TextStyle::Body].map(|style| style.resolve(ui.style()));
    let text_at = |x: f32, y: f32| rect.left_center() + vec2(x, y);
    match (row, picture) {
        (Row::Stage(stage), Some(picture)) => {
            let place = Rect::from_min_size(rect.left_top() + vec2(8.0, 6.0), PICTURE);
            painter.image(
                picture.id(),
                place,
                Rect::from_min_max(egui::Pos2::ZERO, egui::pos2(1.0, 1.0)),
                egui::Color32::WHITE,
            );
            let color = if is_chosen { colours.text } else { colours.weak };
            let left = egui::Align2::LEFT_CENTER;
            painter.text(text_at(92.0, -9.0), left, stage.section, small, color);
            painter.text(text_at(92.0, 8.0), left, stage.title, body, colours.strong);
        }
        _ => _ = painter.text(text_at(8.0, 0.0), egui::Align2::LEFT_CENTER, name, body, colours.strong),
    }
    tip(ui, response, row.command().help(), None)
}

macro_rules! pictures {
    ($($id:literal)*) => {
        /// The small pictures of the stages by id.
        const PICTURES: &[(&str, &[u8])] =
            &[$(($id, include_bytes!(concat!("../../assets/stages/", $id, ".png")))),*];
    };
}

pictures!(
    "ppm-tiny" "ppm-gradient" "sky" "red-sphere" "normals" "normals-world" "aliased" "antialiased" "diffuse"
    "diffuse-limited" "shadow-acne" "lambertian-linear" "lambertian-gamma" "gamut" "metal" "metal-fuzzy"
    "glass-refract" "glass-tir" "glass-schlick" "hollow-glass" "three-spheres" "fov-wide" "fov-narrow"
    "view-distant" "view-close" "defocus" "book"
);

fn image_of(stage: &Stage) -> Option<ColorImage> {
    let (_, png) = PICTURES.iter().find(|(id, _)| *id == stage.id)?;
    let image = image::load_from_memory(png).ok()?.to_rgb8();
    Some(ColorImage::from_rgb([image.width() as usize, image.height() as usize], image.as_raw()))
}

/// The small picture of a stage, which is loaded once.
fn thumbnail(context: &Context, stage: &Stage) -> Option<TextureHandle> {
    let place = Id::unique(("picture of stage", stage.id));
    let loaded = context.data(|data| data.get_temp(place));
    loaded.or_else(|| {
        let handle = context.load_texture(stage.id, image_of(stage)?, egui::TextureOptions::LINEAR);
        context.data_mut(|data| data.insert_temp(place, handle.clone()));
        Some(handle)
    })
}

/// Opens the list in this frame. `is_at_end` shows the extreme scenes, which come last.
pub fn open(context: &Context, is_at_end: bool) {
    context.data_mut(|data| data.insert_temp(place().with("open"), is_at_end));
}

/// Whether the list is to be opened, and if so, whether at its end.
pub fn take_open(ui: &Ui) -> Option<bool> {
    ui.data_mut(|data| data.remove_temp(place().with("open")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_stage_has_its_picture_and_is_found() {
        for stage in Stage::ALL {
            assert!(image_of(stage).is_some(), "{}", stage.id);
            assert!(found(stage.section).contains(&Row::Stage(stage)), "{}", stage.id);
        }
        assert_eq!(Row::all().count(), Stage::ALL.len() + shown_cases().len());
        assert!(found("schl") == [Row::Stage(Stage::find("glass-schlick").unwrap())]);
        assert!(found("no such words").is_empty());
    }
}
