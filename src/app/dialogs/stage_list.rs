//! The list of stages: a field to search in, chapters as headings, and the extreme scenes.

use super::outcome::Outcome;
use crate::app::commands::{Command, PanelContext, Snapshot};
use crate::app::toolkit::widgets::{caption, choice, tip};
use crate::app::toolkit::{Finder, rank, theme};
use crate::measure::stress::shown_cases;
use crate::stages::Stage;
use eframe::egui::text::LayoutJob;
use eframe::egui::{
    self, Align, Atom, ColorImage, Context, FontSelection, Id, Image, Key, Modifiers, Rect, Response,
    RichText, TextureHandle, Ui, WidgetInfo, vec2,
};

/// The width of the list in points.
const WIDTH: f32 = 360.0;

/// Size of the small pictures, points.
const PICTURE: egui::Vec2 = vec2(72.0, 40.0);

const LAST_HEADING: &str = "Extreme scenes";

/// All rows: the walk through the book, what else is a stage, and the extreme scenes.
fn rows() -> impl Iterator<Item = Command> {
    let aside = Stage::ALL.iter().filter(|stage| !stage.is_in_book());
    Stage::walk().chain(aside).map(Command::Stage).chain(shown_cases().iter().map(Command::Extreme))
}

fn heading_of(row: Command) -> String {
    match row {
        Command::Stage(stage) if stage.is_in_book() => {
            format!("{} {}", stage.chapter(), stage.chapter_title())
        }
        _ => LAST_HEADING.to_owned(),
    }
}

/// The rows that a text finds; by what is new only if nothing has its words in its name.
fn found(typed: &str) -> Vec<Command> {
    let ranked = rows().filter_map(|row| {
        let more = match row {
            Command::Stage(stage) => format!("{} {}", stage.section_title(), stage.id),
            _ => String::new(),
        };
        Some((rank(typed, &row.name(), &format!("{more} {}", heading_of(row)), row.help())?, row))
    });
    let ranked: Vec<_> = ranked.collect();
    let is_named = |(rank, _): &&(usize, Command)| *rank < 5;
    let has_name = ranked.iter().any(|found| is_named(&found));
    ranked.iter().filter(|found| !has_name || is_named(found)).map(|(_, row)| *row).collect()
}

/// The list at the picture that is shown.
pub fn list(snapshot: &Snapshot) -> Finder {
    Finder::at(rows().position(|row| snapshot.is_on(row)).unwrap_or(0))
}

/// Draws the list. Arrow keys go through it, typing leaves what has these words, and Enter chooses.
pub fn ui(finder: &mut Finder, ui: &mut Ui, height: f32, cx: &PanelContext) -> Outcome {
    ui.set_width(WIDTH);
    // Tips stand beside what clips a column.
    let column = Rect::from_min_size(ui.min_rect().min, vec2(WIDTH, f32::INFINITY)).expand(6.0);
    ui.shrink_clip_rect(column);
    if finder.has_text() && ui.input_mut(|input| input.consume_key(Modifiers::NONE, Key::Escape)) {
        *finder = Finder::at(0);
    }
    let words = (
        "Search for a stage",
        "Type a number or a word: 9.5, glass, gamma",
        "No stage is called that. Press Escape to see all.",
    );
    let mut heading = String::new();
    let draw = |ui: &mut Ui, row: &Command, is_chosen| {
        if heading_of(*row) != heading {
            heading = heading_of(*row);
            caption(ui, &format!("  {heading}"));
        }
        row_ui(ui, *row, is_chosen, &cx.snapshot)
    };
    let (found, run) = finder.ui(ui, words, height, found, draw);
    run.map_or(Outcome::Stay, |run| {
        cx.send(found[run]);
        Outcome::Close
    })
}

fn row_ui(ui: &mut Ui, row: Command, is_chosen: bool, snapshot: &Snapshot) -> Response {
    let is_done = matches!(row, Command::Stage(stage) if snapshot.model.remembered.done.contains(stage.id));
    let (id, over, title) = match row {
        Command::Stage(stage) => (stage.id, stage.section, stage.title),
        Command::Extreme(case) => (case.id.as_str(), case.family.title.as_str(), case.title()),
        _ => ("", "", ""),
    };
    let mut words = LayoutJob::default();
    let done = RichText::new(if is_done { "  yours is right\n" } else { "\n" });
    let done = done.small().color(theme::colours(ui).good);
    for text in [RichText::new(over).small().weak(), done, RichText::new(title).strong()] {
        text.append_to(&mut words, ui.style(), FontSelection::Default, Align::Center);
    }
    let picture = thumbnail(ui.ctx(), id).map(|picture| Image::new((picture.id(), PICTURE)));
    let button = match picture {
        Some(picture) => choice(ui, is_chosen, (picture, words, Atom::grow())),
        None => choice(ui, is_chosen, (words, Atom::grow())),
    };
    let button = button.min_size(vec2(ui.available_width(), 52.0));
    let response = ui.add(button.frame_when_inactive(is_chosen));
    response.widget_info(|| WidgetInfo::selected(egui::Role::Button, true, is_chosen, row.name()));
    tip(ui, response, row.help(), None)
}

macro_rules! pictures {
    ($($id:literal)*) => {
        /// The small pictures of stages and extreme scenes by id.
        const PICTURES: &[(&str, &[u8])] =
            &[$(($id, include_bytes!(concat!("../../../assets/stages/", $id, ".png")))),*];
    };
}

pictures!(
    "ppm-tiny" "ppm-gradient" "sky" "red-sphere" "normals" "normals-world" "aliased" "antialiased" "diffuse"
    "diffuse-limited" "shadow-acne" "lambertian-linear" "lambertian-gamma" "gamut" "metal" "metal-fuzzy"
    "glass-refract" "glass-tir" "glass-schlick" "hollow-glass" "three-spheres" "fov-wide" "fov-narrow"
    "view-distant" "view-close" "defocus" "book" "file/soap-bubbles" "file/dust" "file/contact" "file/planet-coast"
    "file/nested" "file/closed-room" "cavity/white-touching-at-1000" "moved/1e5" "scaled/1e-3" "scaled/1e6"
    "lens/marbles-on-a-planet"
);

fn image_of(id: &str) -> Option<ColorImage> {
    let (_, png) = PICTURES.iter().find(|(of, _)| *of == id)?;
    let image = image::load_from_memory(png).ok()?.to_rgb8();
    Some(ColorImage::from_rgb([image.width() as usize, image.height() as usize], image.as_raw()))
}

/// The small picture of a stage or an extreme scene, which is loaded once.
fn thumbnail(context: &Context, id: &str) -> Option<TextureHandle> {
    let place = Id::unique(("small picture", id));
    let loaded = context.data(|data| data.get_temp(place));
    loaded.or_else(|| {
        let handle = context.load_texture(id, image_of(id)?, egui::TextureOptions::LINEAR);
        context.data_mut(|data| data.insert_temp(place, handle.clone()));
        Some(handle)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_stage_has_its_picture_and_is_found() {
        for stage in Stage::ALL {
            assert!(image_of(stage.id).is_some(), "{}", stage.id);
            assert!(found(stage.section).contains(&Command::Stage(stage)), "{}", stage.id);
        }
        for case in shown_cases() {
            assert!(image_of(&case.id).is_some(), "{}", case.id);
        }
        assert_eq!(rows().count(), Stage::ALL.len() + shown_cases().len());
        assert!(found("schl") == [Command::Stage(Stage::find("glass-schlick").unwrap())]);
        assert!(found("no such words").is_empty());
    }
}
