//! The legend of a heat map.

use crate::numbers::heat::{HeatScale, colour_at};
use eframe::egui::{Align2, Color32, CornerRadius, Painter, Rect, TextStyle, Ui, pos2, vec2};

/// The size of the letters for which the legend was laid out, in points.
const LEGEND_FONT: f32 = 11.0;

/// Draws the legend in the lower left corner of `rect`.
pub(super) fn paint_scale(ui: &Ui, painter: &Painter, rect: Rect, scale: &HeatScale) {
    const STEPS: usize = 64;
    let font = TextStyle::Small.resolve(ui.style());
    // The legend is as large as its letters.
    let large = font.size / LEGEND_FONT;
    let row = font.size + 4.0 * large;
    let plate = vec2(228.0 * large, 22.0 * large + 2.0 * row);
    let plate = Rect::from_min_size(rect.left_bottom() + vec2(10.0, -plate.y - 10.0), plate);
    painter.rect_filled(plate, CornerRadius::same(6), ui.visuals().panel_fill.gamma_multiply(0.9));
    let weak = ui.visuals().weak_text_color();
    painter.text(plate.min + vec2(24.0, 5.0) * large, Align2::LEFT_TOP, scale.title, font.clone(), weak);
    let bar = Rect::from_min_size(
        plate.min + vec2(24.0 * large, 6.0 * large + row),
        vec2(plate.width() - 48.0 * large, 9.0 * large),
    );
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
    for (value, name) in scale.marks() {
        let at = pos2(bar.left() + bar.width() * scale.place(value) as f32, bar.bottom() + 2.0);
        painter.text(at, Align2::CENTER_TOP, name, font.clone(), ui.visuals().text_color());
    }
}
