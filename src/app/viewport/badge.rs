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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::tests::part;
    use eframe::egui::{TextStyle, pos2};
    use std::cell::Cell;

    #[test]
    fn words_stand_below_those_that_they_would_cover() {
        let clip = Rect::from_min_max(pos2(0.0, 0.0), pos2(400.0, 200.0));
        let places = Cell::new([Rect::NOTHING; 4]);
        part([400.0, 200.0], |ui| {
            let (painter, font) = (ui.painter().with_clip_rect(clip), TextStyle::Body.resolve(ui.style()));
            let first = badge(ui, &painter, pos2(20.0, 8.0), Align2::LEFT_TOP, "a title", &font);
            let below = |x: f32, others: &[Rect]| {
                badge_below(ui, &painter, (pos2(x, 8.0), Align2::LEFT_TOP), "sphere 1", &font, others)
            };
            let second = below(20.0, &[first]);
            // The order does not matter.
            let third = below(20.0, &[second, first]);
            places.set([first, second, third, below(300.0, &[first, second, third])]);
        });
        let [first, second, third, aside] = places.get();
        assert_eq!([first.top(), aside.top()], [8.0, 8.0], "nothing is covered");
        for (upper, lower) in [(first, second), (second, third)] {
            assert!((lower.top() - upper.bottom() - GAP).abs() < 0.01, "{upper} {lower}");
        }
    }
}
