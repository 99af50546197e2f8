//! The frame of a card in a corner of the picture.

use super::places::Place;
use super::theme;
use eframe::egui::{self, Align2, Margin, Rect, RichText, Ui, vec2};

/// The largest width of a card, in points.
const WIDTH: f32 = 300.0;

/// The smallest distance between a card and the edge of the viewport, in points.
const MARGIN: f32 = 12.0;

/// Shows a card in the upper right corner of `over`, under `title`. It scrolls where the viewport is too low for it.
pub fn corner_card(ui: &Ui, over: Rect, place: Place, title: &'static str, content: impl FnOnce(&mut Ui)) {
    const INNER: Margin = Margin::symmetric(16, 12);
    let [width, height] = [over.width(), over.height()].map(|room| (room - 2.0 * MARGIN).max(80.0));
    egui::Area::new(egui::Id::unique(title))
        .accessible_name(title)
        .pivot(Align2::RIGHT_TOP)
        .fixed_pos(over.right_top() + vec2(-MARGIN, MARGIN))
        .constrain_to(over)
        .default_size(vec2(width, height))
        .show(ui.ctx(), |ui| {
            let frame = theme::float_frame(ui).inner_margin(INNER).corner_radius(8);
            frame.shadow(ui.visuals().window_shadow).show(ui, |ui| {
                ui.set_width(width.min(WIDTH) - INNER.sum().x - 2.0);
                // egui offers the height of the last frame, in which there was less to show or less room.
                let height = height - INNER.sum().y - 2.0;
                ui.set_max_height(height);
                egui::ScrollArea::vertical().max_height(height).show(ui, |ui| {
                    place.begin(ui);
                    ui.label(RichText::new(title).heading().strong());
                    content(ui);
                });
            });
        });
}
