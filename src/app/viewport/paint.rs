//! Draws the viewport: the picture, the second picture, and words over them.

use super::placement::Placement;
use crate::app::commands::Snapshot;
use crate::app::model::{Document, Mode, Show, laid_over};
use crate::app::toolkit::overlay::{WHOLE, legend, plate, title, wipe};
use crate::app::toolkit::{Texture, theme};
use crate::app::tools::paths::Paths;
use crate::numbers::heat::HeatScale;
use crate::progressive::Phase;
use eframe::egui::{
    self, Align2, Color32, CornerRadius, Painter, Rect, Stroke, TextStyle, TextureOptions, Ui, pos2, vec2,
};

/// From this many screen pixels per pixel on, pixels are drawn as squares.
const SQUARES: f32 = 8.0;

/// The pictures to draw.
pub struct Pictures<'a> {
    /// The picture or a layer of it, and whether it is always smooth: previews and pictures of another size are.
    pub main: Option<(&'a Texture, bool)>,
    /// The picture at the other side of a wipe.
    pub second: Option<(&'a Texture, bool)>,
    /// Paths to draw over the picture.
    pub paths: &'a Paths,
    /// The difference of the two is known.
    pub has_difference: bool,
    /// The column and row of places to mark in the other picture.
    pub places: &'a [[u32; 2]],
    /// The titles of the two pictures of a comparison, the other one first.
    pub titles: [&'a str; 2],
}

/// Draws the picture at `rect`, within `room`.
pub(super) fn paint(
    ui: &Ui,
    [room, rect]: [Rect; 2],
    (placement, divider): (&Placement, f32),
    pictures: Pictures<'_>,
    document: &Document,
    snapshot: &Snapshot,
) {
    let painter = ui.painter().with_clip_rect(room);
    let times = placement.times;
    let id = |texture: &Texture, is_smooth: bool| {
        // Smooth until pixels are large, except where each is one of the screen's.
        let is_square = !is_smooth && ((times - 1.0).abs() < 1e-4 || times >= SQUARES);
        texture.id(ui.ctx(), if is_square { TextureOptions::NEAREST } else { TextureOptions::LINEAR })
    };
    let Pictures { main, second, paths, has_difference, places, titles } = pictures;
    // The hole is one point smaller, so that no gap stays between picture and background.
    let hole = if main.is_some() { rect.shrink(1.0).intersect(room) } else { Rect::NOTHING };
    fill_around(&painter, room, hole, theme::colours(ui).surround);
    let view = &snapshot.model.view;
    if let Some((texture, is_smooth)) = main {
        painter.image(id(texture, is_smooth), rect, WHOLE, Color32::WHITE);
    }
    let corners = rect.intersect(room);
    let size_of_other = second.map_or(document.size(), |(texture, _)| texture.size());
    let [corner, size] = laid_over(document.size(), size_of_other).map(|[x, y]| vec2(x as f32, y as f32));
    let place = Rect::from_min_size(rect.min + corner * rect.size(), size * rect.size());
    let is_difference = view.mode() == Some(Mode::Difference) && has_difference;
    match (view.mode(), second) {
        (Some(mode @ (Mode::Wipe | Mode::Flip)), Some((texture, is_smooth))) => {
            let left = (id(texture, is_smooth), place);
            let divider = if mode == Mode::Flip { 1.0 } else { divider };
            wipe(ui, &painter, rect, divider, left, titles);
        }
        _ if is_difference => {
            let words = format!("Difference of {} and {}", titles[0], titles[1]);
            title(ui, &painter, corners, Align2::LEFT_TOP, &words);
        }
        _ => {}
    }
    mark(&painter, place, size_of_other, places);
    let scale = if is_difference { Some(HeatScale::DIFFERENCE) } else { view.show().scale(&view.tone) };
    if let Some(scale) = scale {
        legend(ui, &painter, corners, &scale);
    } else if view.tone.exposure != 0.0 && view.show() == Show::Picture {
        let text = format!("Exposure {:+.1}", view.tone.exposure).replace('-', "\u{2212}");
        title(ui, &painter, corners, Align2::LEFT_BOTTOM, &text);
    }
    if main.is_none() {
        let text = match (&snapshot.invalid, &snapshot.status.phase) {
            (Some(reason), _) | (None, Phase::Failed(reason)) => reason.as_str(),
            _ => "Starting",
        };
        let (font, colour) = (TextStyle::Body.resolve(ui.style()), ui.visuals().weak_text_color());
        painter.text(rect.center(), Align2::CENTER_CENTER, text, font, colour);
    }
    if !view.is_hidden() {
        paths.paint(document, ui, &painter, rect);
    }
}

/// Draws a frame around places of a picture of `size` pixels.
fn mark(painter: &Painter, rect: Rect, size: [u32; 2], places: &[[u32; 2]]) {
    /// Its side, pixels of the picture.
    const SIDE: f32 = 10.0;
    let scale = rect.width() / size[0] as f32;
    for [x, y] in places {
        let middle = rect.min + vec2(*x as f32 + 0.5, *y as f32 + 0.5) * scale;
        let frame = Rect::from_center_size(middle, egui::Vec2::splat(SIDE * scale));
        for (width, colour) in [(3.0, Color32::from_black_alpha(140)), (1.0, Color32::WHITE)] {
            painter.rect_stroke(frame, 2.0, Stroke::new(width, colour), egui::StrokeKind::Outside);
        }
    }
}

/// Fills `room` except for `hole`: software rendering pays for each pixel that is drawn twice.
fn fill_around(painter: &Painter, room: Rect, hole: Rect, colour: Color32) {
    if !hole.is_positive() {
        painter.rect_filled(room, 0.0, colour);
        return;
    }
    for rect in [
        Rect { max: pos2(room.right(), hole.top()), ..room },
        Rect { min: pos2(room.left(), hole.bottom()), ..room },
        Rect { min: pos2(room.left(), hole.top()), max: pos2(hole.left(), hole.bottom()) },
        Rect { min: pos2(hole.right(), hole.top()), max: pos2(room.right(), hole.bottom()) },
    ] {
        painter.rect_filled(rect, 0.0, colour);
    }
}

/// Shows what will happen to files that are dragged over the window.
pub(super) fn paint_drop(ui: &Ui, room: Rect) {
    let Some(file) = ui.input(|input| input.raw.hovered_files.first().cloned()) else { return };
    let name = file.path.as_ref().and_then(|path| path.file_name()).unwrap_or_default();
    let text = format!("Drop to open {}", name.to_string_lossy());
    let layer = egui::LayerId::new(egui::Order::Foreground, egui::Id::unique("drop"));
    let painter = ui.ctx().layer_painter(layer);
    painter.rect_filled(room, 0.0, ui.visuals().panel_fill.gamma_multiply(0.8));
    let edge = Stroke::new(2.0, theme::colours(ui).accent);
    painter.rect_stroke(room.shrink(12.0), CornerRadius::same(8), edge, egui::StrokeKind::Inside);
    plate(ui, &painter, room.center(), Align2::CENTER_CENTER, text.trim_end(), room.width());
}
