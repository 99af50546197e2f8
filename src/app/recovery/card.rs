//! A card in a corner of the picture: what was kept of windows that ended without being closed.

use super::left::{Left, Part};
use crate::app::corner_card::corner_card;
use crate::app::places::Place;
use crate::app::theme;
use eframe::egui::{self, Button, Rect, RichText, Ui};

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
        let mut choice = None;
        corner_card(ui, over, Place::Recovered, "Recovered pictures", |ui| {
            choice = self.content(ui, left, is_busy);
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
