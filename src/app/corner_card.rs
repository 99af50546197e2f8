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
    let shown = egui::Area::new(egui::Id::unique(title))
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
    let frame = ui.ctx().cumulative_frame_nr();
    ui.ctx().data_mut(|data| data.insert_temp(place_of_card(), (frame, shown.response.rect)));
}

fn place_of_card() -> egui::Id {
    egui::Id::unique("place of a card")
}

/// The place of the card that has been shown in this frame.
pub fn shown_card(context: &egui::Context) -> Option<Rect> {
    let (frame, rect): (u64, Rect) = context.data(|data| data.get_temp(place_of_card()))?;
    (frame == context.cumulative_frame_nr()).then_some(rect)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::tests::dressed;
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;

    /// The height of the room for a card, the number of its lines, and its place.
    struct Shown {
        height: f32,
        lines: usize,
        card: Option<Rect>,
    }

    #[test]
    fn a_card_grows_with_its_content_and_its_room() {
        let draw = |ui: &mut Ui, shown: &mut Shown| {
            let over = Rect::from_min_size(egui::pos2(10.0, 10.0), vec2(400.0, shown.height));
            corner_card(ui, over, Place::FirstSteps, "Card", |ui| {
                (0..shown.lines).for_each(|line| _ = ui.label(format!("line {line}")));
                _ = ui.button("Last");
            });
            shown.card = shown_card(ui.ctx());
        };
        let shown = Shown { height: 600.0, lines: 3, card: None };
        let mut harness: Harness<'_, Shown> = dressed([420.0, 640.0]).build_ui_state(draw, shown);
        // The lower edges of the last button and of the card.
        let edges = |harness: &mut Harness<'_, Shown>| {
            harness.run_steps(8);
            [harness.get_by_label("Last").rect(), harness.state().card.unwrap()].map(|rect| rect.bottom())
        };
        let [low, _] = edges(&mut harness);
        let line = harness.get_by_label("line 1").rect().top() - harness.get_by_label("line 0").rect().top();
        harness.state_mut().lines = 12;
        let [high, card] = edges(&mut harness);
        assert!((high - low - 9.0 * line).abs() < 1.0 && high < card, "{low} {high} {card}");
        harness.state_mut().height = 160.0;
        let [last, low_card] = edges(&mut harness);
        assert!(low_card < 170.0 && last > low_card, "it scrolls: {last} {low_card}");
        harness.state_mut().height = 600.0;
        assert_eq!(edges(&mut harness), [high, card], "it is as high as before");
    }

    #[test]
    fn a_card_has_a_place_as_long_as_it_is_shown() {
        let over = Rect::from_min_size(egui::pos2(10.0, 10.0), vec2(400.0, 300.0));
        // Whether it is shown, and its place.
        let draw = |ui: &mut Ui, (is_shown, place): &mut (bool, Option<Rect>)| {
            if *is_shown {
                corner_card(ui, over, Place::FirstSteps, "Card", |ui| _ = ui.label("one line"));
            }
            *place = shown_card(ui.ctx());
        };
        let mut harness: Harness<'_, (bool, Option<Rect>)> =
            dressed([420.0, 340.0]).build_ui_state(draw, (true, None));
        harness.run_steps(4);
        let (_, place) = *harness.state();
        let place = place.unwrap();
        let corner = over.right_top() + vec2(-MARGIN, MARGIN);
        assert!(place.right_top().distance(corner) < 1.0 && place.width() <= WIDTH + 1.0, "{place}");
        assert!(place.contains_rect(harness.get_by_label("one line").rect()), "{place}");
        harness.state_mut().0 = false;
        harness.run_steps(1);
        assert_eq!(harness.state().1, None);
    }
}
