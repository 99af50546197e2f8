//! A card in a corner of the picture: what was kept of windows that ended without being closed.

use super::left::{Left, Part};
use crate::app::places::Place;
use crate::app::theme;
use eframe::egui::{self, Align2, Button, Margin, Rect, RichText, Ui, vec2};

/// The largest width of the card, in points.
const WIDTH: f32 = 300.0;

/// The smallest distance between the card and the edge of the viewport, in points.
const MARGIN: f32 = 12.0;

/// What the user wants to be done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Choice {
    /// Show this part of these files.
    Open(usize, Part),
    /// Delete it.
    Discard(usize, Part),
    /// Close the card; the next window offers everything again.
    Later,
}

/// The state of the card.
#[derive(Default)]
pub struct Card {
    /// What is deleted by the next click.
    doubted: Option<(usize, Part)>,
}

impl Card {
    /// Draws the card in the upper right corner of `over`. `is_busy` while something is being opened.
    pub fn ui(&mut self, ui: &Ui, over: Rect, left: &[Left], is_busy: bool) -> Option<Choice> {
        let [width, height] = [over.width(), over.height()].map(|room| (room - 2.0 * MARGIN).max(80.0));
        let mut choice = None;
        egui::Area::new(egui::Id::unique("recovered pictures"))
            .accessible_name("Recovered pictures")
            .pivot(Align2::RIGHT_TOP)
            .fixed_pos(over.right_top() + vec2(-MARGIN, MARGIN))
            .constrain_to(over)
            .show(ui.ctx(), |ui| {
                let frame = theme::float_frame(ui).inner_margin(Margin::symmetric(16, 12)).corner_radius(8);
                frame.shadow(ui.visuals().window_shadow).show(ui, |ui| {
                    ui.set_width(width.min(WIDTH) - 34.0);
                    egui::ScrollArea::vertical().max_height(height - 26.0).show(ui, |ui| {
                        Place::Recovered.begin(ui);
                        choice = self.content(ui, left, is_busy);
                    });
                });
            });
        match choice {
            Some(Choice::Discard(index, part)) if self.doubted != Some((index, part)) => {
                self.doubted = Some((index, part));
                None
            }
            Some(_) => {
                self.doubted = None;
                choice
            }
            None => None,
        }
    }

    fn content(&self, ui: &mut Ui, left: &[Left], is_busy: bool) -> Option<Choice> {
        let mut choice = None;
        let weak = ui.visuals().weak_text_color();
        ui.label(RichText::new("Recovered pictures").heading().strong());
        ui.add(egui::Label::new("They were not saved when a window ended.").wrap());
        for (index, left) in left.iter().enumerate() {
            for row in left.rows() {
                ui.add_space(6.0);
                ui.add(egui::Label::new(RichText::new(&row.title).strong()).wrap());
                ui.add(egui::Label::new(RichText::new(&row.about).color(weak)).wrap());
                if let Some(fault) = &row.fault {
                    ui.add(egui::Label::new(RichText::new(fault).color(ui.visuals().error_fg_color)).wrap());
                }
                let file = left.path(row.part).display().to_string();
                ui.horizontal_wrapped(|ui| {
                    let label = RichText::new("Open").color(ui.visuals().selection.stroke.color);
                    let open = Button::new(label).fill(theme::accent(ui));
                    let open = ui.add_enabled(row.fault.is_none() && !is_busy, open);
                    let open = open.accessible_name(format!("Open {}", row.title));
                    if open.on_hover_text(format!("Show it in this window: {file}")).clicked() {
                        choice = Some(Choice::Open(index, row.part));
                    }
                    let is_doubted = self.doubted == Some((index, row.part));
                    let word = if is_doubted { "Discard for good" } else { "Discard" };
                    let discard = ui.add_enabled(!is_busy, Button::new(word));
                    let discard = discard.accessible_name(format!("{word}: {}", row.title));
                    if discard.on_hover_text(format!("Delete {file}; asks once more")).clicked() {
                        choice = Some(Choice::Discard(index, row.part));
                    }
                    if is_busy {
                        ui.spinner();
                    }
                });
            }
        }
        ui.add_space(6.0);
        let later = ui.button("Later").accessible_name("Close the recovered pictures");
        if later.on_hover_text("Closes this card; the next window offers them again").clicked() {
            choice = Some(Choice::Later);
        }
        choice
    }
}
