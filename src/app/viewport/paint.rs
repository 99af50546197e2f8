//! What stands in the picture's place: the picture, what it is compared with, scales, marks and words on it.

use super::{MARK, Zoom};
use crate::app::compare::Mode;
use crate::app::theme;
use crate::app::window::Window;
use crate::heat::{HeatScale, colour_at};
use crate::progressive::Phase;
use eframe::egui::{
    self, Align2, Color32, CornerRadius, FontId, Pos2, Rect, Stroke, TextStyle, TextureOptions, Ui, pos2,
    vec2,
};

const WHOLE: Rect = Rect { min: pos2(0.0, 0.0), max: pos2(1.0, 1.0) };

pub(super) fn paint(window: &mut Window, ui: &Ui, room: Rect, rect: Rect) {
    let painter = ui.painter().with_clip_rect(room);
    let options = |divisor: u32, times: f32| {
        // At 100 % and above a pixel is a square; a preview's are no pixels of the picture.
        if divisor == 1 && times >= 1.0 - 1e-4 { TextureOptions::NEAREST } else { TextureOptions::LINEAR }
    };
    let times = window.viewport.last_times;
    let context = ui.ctx();
    let other = window
        .compare
        .tracer
        .as_mut()
        .and_then(|tracer| tracer.shown_mut())
        .map(|shown| (shown.texture.id(context, options(shown.divisor, times)), shown.document.title()));
    let layer = window.viewport.show.layer().and_then(|layer| window.layers.shown_mut(layer));
    let shown = match layer {
        Some(layer) => Some((layer.texture.id(context, options(layer.divisor, times)), layer.divisor)),
        None => window
            .main
            .shown_mut()
            .map(|shown| (shown.texture.id(context, options(shown.divisor, times)), shown.divisor)),
    };
    // The hole is a point smaller, so that no line stays free between the two.
    let hole = if shown.is_some() { rect.shrink(1.0).intersect(room) } else { Rect::NOTHING };
    fill_around(&painter, room, hole, theme::surround(ui));
    if let Some((texture, _)) = shown {
        painter.image(texture, rect, WHOLE, Color32::WHITE);
    }
    let divisor = shown.map_or(1, |(_, divisor)| divisor);
    let font = TextStyle::Body.resolve(ui.style());
    if window.compare.mode == Some(Mode::Wipe)
        && let Some((texture, title)) = other
    {
        paint_wipe(window, ui, &painter, rect, texture, &title, &font);
    }
    let is_difference = window.compare.mode == Some(Mode::Difference);
    let scale = if is_difference { Some(HeatScale::ERROR) } else { window.viewport.show.scale() };
    if let Some(scale) = scale {
        paint_scale(ui, &painter, rect.intersect(room), &scale);
    }
    if divisor > 1 {
        let text = format!("preview 1/{divisor}");
        badge(ui, &painter, rect.intersect(room).left_top() + vec2(8.0, 8.0), Align2::LEFT_TOP, &text, &font);
    }
    if window.main.shown().is_none() {
        let text = match (&window.invalid, &window.main.status().phase) {
            (Some(reason), _) | (None, Phase::Failed(reason)) => reason.as_str(),
            _ => "preparing…",
        };
        let colour = ui.visuals().weak_text_color();
        painter.text(rect.center(), Align2::CENTER_CENTER, text, font.clone(), colour);
    }
    if let Zoom::Times(times) = window.viewport.zoom {
        let text = format!("{:.0} %", 100.0 * times);
        badge(
            ui,
            &painter,
            rect.intersect(room).right_top() + vec2(-8.0, 8.0),
            Align2::RIGHT_TOP,
            &text,
            &font,
        );
    }
    window.paths.paint(&window.document, ui, &painter, rect);
    paint_mark(window, ui, &painter, rect, &font);
}

/// Fills `room` but for `hole`: where a processor draws, each pixel that is drawn twice is time lost.
fn fill_around(painter: &egui::Painter, room: Rect, hole: Rect, colour: Color32) {
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

fn paint_wipe(
    window: &Window,
    ui: &Ui,
    painter: &egui::Painter,
    rect: Rect,
    texture: egui::TextureId,
    theirs: &str,
    font: &FontId,
) {
    let share = window.compare.divider;
    let x = rect.left() + rect.width() * share;
    let right = Rect::from_min_max(pos2(x, rect.top()), rect.max);
    let uv = Rect::from_min_max(pos2(share, 0.0), pos2(1.0, 1.0));
    painter.image(texture, right, uv, Color32::WHITE);
    painter.vline(x, rect.y_range(), Stroke::new(3.0, Color32::from_black_alpha(120)));
    painter.vline(x, rect.y_range(), Stroke::new(1.5, Color32::WHITE));
    let knob = pos2(x, rect.center().y);
    painter.circle(knob, 9.0, Color32::WHITE, Stroke::new(1.0, Color32::from_black_alpha(120)));
    for side in [-1.0, 1.0] {
        let tip = knob + vec2(6.0 * side, 0.0);
        let back = knob + vec2(2.5 * side, 0.0);
        let points = vec![tip, back + vec2(0.0, -3.5), back + vec2(0.0, 3.5)];
        painter.add(egui::Shape::convex_polygon(points, Color32::from_gray(60), Stroke::NONE));
    }
    let y = rect.top().max(painter.clip_rect().top()) + 8.0;
    // Names that would reach beyond the picture stay within it.
    let painter = &painter.with_clip_rect(rect.intersect(painter.clip_rect()));
    badge(ui, painter, pos2(x - 14.0, y), Align2::RIGHT_TOP, &window.document.title(), font);
    let whose = if window.compare.has_other_camera(&window.document) { ", with its own camera" } else { "" };
    badge(ui, painter, pos2(x + 14.0, y), Align2::LEFT_TOP, &format!("{theirs}{whose}"), font);
}

/// The colours of a heat map with what they mean.
fn paint_scale(ui: &Ui, painter: &egui::Painter, rect: Rect, scale: &HeatScale) {
    const STEPS: usize = 64;
    let font = TextStyle::Small.resolve(ui.style());
    let row = font.size + 4.0;
    let plate = vec2(228.0, 22.0 + 2.0 * row);
    let plate = Rect::from_min_size(rect.left_bottom() + vec2(10.0, -plate.y - 10.0), plate);
    painter.rect_filled(plate, CornerRadius::same(6), ui.visuals().panel_fill.gamma_multiply(0.9));
    let weak = ui.visuals().weak_text_color();
    painter.text(plate.min + vec2(24.0, 5.0), Align2::LEFT_TOP, scale.title, font.clone(), weak);
    let bar = Rect::from_min_size(plate.min + vec2(24.0, 6.0 + row), vec2(plate.width() - 48.0, 9.0));
    for step in 0..STEPS {
        let [red, green, blue] = colour_at((step as f64 + 0.5) / STEPS as f64);
        let left = bar.left() + bar.width() * step as f32 / STEPS as f32;
        let size = vec2(bar.width() / STEPS as f32 + 0.5, bar.height());
        painter.rect_filled(
            Rect::from_min_size(pos2(left, bar.top()), size),
            0.0,
            Color32::from_rgb(red, green, blue),
        );
    }
    for (value, name) in scale.marks {
        let at = pos2(bar.left() + bar.width() * scale.place(*value) as f32, bar.bottom() + 2.0);
        painter.text(at, Align2::CENTER_TOP, name, font.clone(), ui.visuals().text_color());
    }
}

/// What happens to files that are held over the window.
pub(super) fn paint_drop(ui: &Ui, room: Rect) {
    let Some(files) = ui.input(|input| words_for_files(&input.raw.hovered_files)) else { return };
    let painter =
        ui.ctx().layer_painter(egui::LayerId::new(egui::Order::Foreground, egui::Id::unique("drop")));
    painter.rect_filled(room, CornerRadius::ZERO, ui.visuals().panel_fill.gamma_multiply(0.8));
    painter.rect_stroke(
        room.shrink(12.0),
        CornerRadius::same(8),
        Stroke::new(2.0, theme::accent(ui)),
        egui::StrokeKind::Inside,
    );
    let font = TextStyle::Heading.resolve(ui.style());
    painter.text(room.center(), Align2::CENTER_CENTER, files, font, ui.visuals().strong_text_color());
}

fn words_for_files(files: &[egui::HoveredFile]) -> Option<String> {
    let name = files.first()?.path.as_ref().and_then(|path| path.file_name());
    Some(
        name.map_or_else(
            || "Drop to open".to_owned(),
            |name| format!("Drop to open {}", name.to_string_lossy()),
        ),
    )
}

/// Text on a plate, so that it can be read on any picture.
fn badge(ui: &Ui, painter: &egui::Painter, at: Pos2, anchor: Align2, text: &str, font: &FontId) {
    let galley = painter.layout_no_wrap(text.to_owned(), font.clone(), ui.visuals().strong_text_color());
    let mut rect = anchor.anchor_size(at, galley.size() + vec2(14.0, 6.0));
    let clip = painter.clip_rect();
    let (beyond_left, beyond_right) = (clip.left() + 4.0 - rect.left(), rect.right() + 4.0 - clip.right());
    if beyond_left > 0.0 || beyond_right > 0.0 {
        let along = if beyond_left > 0.0 { beyond_left } else { -beyond_right };
        // A row lower, so that it does not cover what stands beside it.
        rect = rect.translate(vec2(along, rect.height() + 4.0));
    }
    painter.rect_filled(rect, CornerRadius::same(5), ui.visuals().panel_fill.gamma_multiply(0.9));
    painter.galley(rect.min + vec2(7.0, 3.0), galley, ui.visuals().strong_text_color());
}

fn paint_mark(window: &mut Window, ui: &Ui, painter: &egui::Painter, rect: Rect, font: &FontId) {
    let Some(mark) = &window.viewport.mark else { return };
    let age = mark.since.elapsed();
    if age > MARK {
        window.viewport.mark = None;
        return;
    }
    let at = rect.min + vec2(mark.place[0] as f32, mark.place[1] as f32) * rect.size();
    painter.circle_stroke(at, 9.0, Stroke::new(3.0, Color32::from_black_alpha(130)));
    painter.circle_stroke(at, 9.0, Stroke::new(1.5, Color32::WHITE));
    painter.circle_filled(at, 1.5, Color32::WHITE);
    badge(ui, painter, at + vec2(14.0, 0.0), Align2::LEFT_CENTER, &mark.text, font);
    ui.ctx().request_repaint_after(MARK - age);
}
