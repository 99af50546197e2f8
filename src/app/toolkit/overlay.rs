//! Overlays of a picture: titles, and the divider of a wipe.

use super::theme;
use crate::numbers::heat::{HeatScale, colour_at};
use eframe::egui::text::{LayoutJob, TextWrapping};
use eframe::egui::{
    self, Align2, Color32, CornerRadius, FontId, Painter, Pos2, Rect, Stroke, TextStyle, TextureId, Ui, pos2,
    vec2,
};

/// All of a texture.
pub const WHOLE: Rect = Rect { min: pos2(0.0, 0.0), max: pos2(1.0, 1.0) };

/// From an edge of the picture to the words in its corner, in points.
pub const CORNER: f32 = 8.0;

/// Draws a picture over the one at `rect`, left of a divider, and the titles of both.
pub fn wipe(
    ui: &Ui,
    painter: &Painter,
    rect: Rect,
    divider: f32,
    (left, place): (TextureId, Rect),
    titles: [&str; 2],
) {
    let x = rect.lerp_inside(vec2(divider, 0.0)).x;
    let over = painter.with_clip_rect(rect.with_max_x(x).intersect(painter.clip_rect()));
    if place != rect {
        over.rect_filled(rect, 0.0, theme::colours(ui).surround);
    }
    over.image(left, place, WHOLE, Color32::WHITE);
    let seen = rect.intersect(painter.clip_rect());
    if divider < 1.0 {
        paint_divider(painter, seen, x);
    }
    title(ui, painter, seen.with_max_x(x), Align2::LEFT_TOP, titles[0]);
    title(ui, painter, seen.with_min_x(x), Align2::RIGHT_TOP, titles[1]);
}

/// The divider of a wipe, with a round handle.
fn paint_divider(painter: &Painter, rect: Rect, x: f32) {
    const HANDLE: f32 = 24.0;
    painter.vline(x, rect.y_range(), Stroke::new(4.0, Color32::from_black_alpha(120)));
    painter.vline(x, rect.y_range(), Stroke::new(2.0, Color32::WHITE));
    let knob = pos2(x, rect.center().y);
    painter.circle(knob, 0.5 * HANDLE, Color32::WHITE, Stroke::new(1.0, Color32::from_black_alpha(120)));
    painter.text(knob, Align2::CENTER_CENTER, "‹ ›", FontId::proportional(16.0), Color32::from_gray(30));
}

/// A title in a corner of the area, cut or left out if it has no room.
pub fn title(ui: &Ui, painter: &Painter, area: Rect, corner: Align2, text: &str) {
    let area = area.shrink(CORNER);
    if area.is_positive() {
        plate(ui, painter, corner.pos_in_rect(&area), corner, text, area.width());
    }
}

/// Words on a plate, readable on any picture, within the painter's area, and cut to this width.
pub fn plate(ui: &Ui, painter: &Painter, at: Pos2, anchor: Align2, text: &str, width: f32) {
    let font = TextStyle::Small.resolve(ui.style());
    let pad = vec2(0.65, 0.35) * font.size;
    let mut job = LayoutJob::simple_singleline(text.to_owned(), font, ui.visuals().strong_text_color());
    job.wrap = TextWrapping::truncate_at_width((width - 2.0 * pad.x).max(0.0));
    let galley = painter.layout_job(job);
    let (rect, clip) = (anchor.anchor_size(at, galley.size() + 2.0 * pad), painter.clip_rect());
    let inwards = (clip.min - rect.min).max(egui::Vec2::ZERO) - (rect.max - clip.max).max(egui::Vec2::ZERO);
    let rect = rect.translate(inwards);
    let fill = match ui.visuals().dark_mode {
        true => theme::colours(ui).surround.gamma_multiply(0.88),
        false => ui.visuals().panel_fill.gamma_multiply(0.93),
    };
    painter.rect_filled(rect, CornerRadius::same(4), fill);
    painter.galley(rect.center() - 0.5 * galley.size(), galley, Color32::WHITE);
}

/// Draws the legend of a heat map in the lower left corner of `rect`.
pub fn legend(ui: &Ui, painter: &Painter, rect: Rect, scale: &HeatScale) {
    const STEPS: usize = 64;
    let (font, visuals) = (TextStyle::Small.resolve(ui.style()), ui.visuals());
    // The legend is as large as its letters.
    let em = font.size;
    let size = vec2(20.0 * em, 5.0 * em);
    let plate = Rect::from_min_size(rect.left_bottom() + vec2(CORNER, -size.y - CORNER), size);
    painter.rect_filled(plate, CornerRadius::same(4), visuals.panel_fill.gamma_multiply(0.9));
    let title = plate.min + vec2(2.0, 0.5) * em;
    painter.text(title, Align2::LEFT_TOP, scale.title, font.clone(), visuals.weak_text_color());
    let bar = Rect::from_min_size(title + vec2(0.0, 1.5 * em), vec2(size.x - 4.0 * em, em));
    for step in 0..STEPS {
        let [red, green, blue] = colour_at((step as f64 + 0.5) / STEPS as f64);
        let [from, to] = [step, step + 1].map(|step| bar.left() + bar.width() * step as f32 / STEPS as f32);
        let part = Rect::from_x_y_ranges(from..=to + 0.5, bar.y_range());
        painter.rect_filled(part, 0.0, Color32::from_rgb(red, green, blue));
    }
    for (value, name) in scale.marks() {
        let at = pos2(bar.left() + bar.width() * scale.place(value) as f32, bar.bottom() + 0.2 * em);
        painter.text(at, Align2::CENTER_TOP, name, font.clone(), visuals.text_color());
    }
}
