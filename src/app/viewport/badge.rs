//! Words over the picture.

use eframe::egui::{Align2, CornerRadius, FontId, Painter, Pos2, Rect, Ui, vec2};

/// Space between two rows of words, points.
const GAP: f32 = 4.0;

/// Text on a background plate, readable on any picture. Returns its place.
pub(super) fn badge(ui: &Ui, painter: &Painter, at: Pos2, anchor: Align2, text: &str, font: &FontId) -> Rect {
    badge_below(ui, painter, (at, anchor), text, font, &[])
}

/// The same, but below the words at these places that it would cover.
pub(super) fn badge_below(
    ui: &Ui,
    painter: &Painter,
    (at, anchor): (Pos2, Align2),
    text: &str,
    font: &FontId,
    others: &[Rect],
) -> Rect {
    let galley = painter.layout_no_wrap(text.to_owned(), font.clone(), ui.visuals().strong_text_color());
    let mut rect = anchor.anchor_size(at, galley.size() + vec2(14.0, 6.0));
    let clip = painter.clip_rect();
    let (beyond_left, beyond_right) = (clip.left() + 4.0 - rect.left(), rect.right() + 4.0 - clip.right());
    if beyond_left > 0.0 || beyond_right > 0.0 {
        let along = if beyond_left > 0.0 { beyond_left } else { -beyond_right };
        // One row lower, so that it does not cover its neighbour.
        rect = rect.translate(vec2(along, rect.height() + GAP));
    }
    // Each step leads below one of them.
    for _ in others {
        if let Some(other) = others.iter().find(|other| other.intersects(rect)) {
            rect = rect.translate(vec2(0.0, other.bottom() + GAP - rect.top()));
        }
    }
    painter.rect_filled(rect, CornerRadius::same(5), ui.visuals().panel_fill.gamma_multiply(0.9));
    painter.galley(rect.min + vec2(7.0, 3.0), galley, ui.visuals().strong_text_color());
    rect
}
