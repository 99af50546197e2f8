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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::document::Document;
    use crate::app::model::origin::Origin;
    use crate::app::model::slots::SlotNumber;
    use crate::app::recovery::{RecoveryFiles, write_film};
    use crate::app::slot_files::Entry;
    use crate::app::tests::dressed;
    use crate::film::Film;
    use crate::progressive::Status;
    use crate::stages::Stage;
    use egui_kittest::Harness;
    use egui_kittest::kittest::{NodeT, Queryable};
    use std::fs::{self, File};
    use std::path::Path;
    use std::time::{Duration, SystemTime};

    /// A film, a film that is damaged beside a changed picture, and two kept pictures: what three windows left.
    fn left_in(directory: &Path) -> Vec<Left> {
        let make_old = |path: &Path, seconds: u64| {
            let file = File::options().write(true).open(path).unwrap();
            file.set_modified(SystemTime::now() - Duration::from_secs(seconds)).unwrap();
        };
        let files = [(); 3].map(|()| RecoveryFiles::claim(directory).unwrap());
        let mut document = Document::new(Origin::of_stage(Stage::find("metal").unwrap()));
        document.give_size([4, 2]);
        let mut film = Film::new(4, 2, 2);
        film.record(0..3, 0).unwrap();
        write_film(files[0].film(), &film, (&document, &Status::default()), Some(0.0)).unwrap();

        fs::write(files[1].film(), "damaged").unwrap();
        let session = serde_json::json!({ "title": "my picture", "is_changed": true });
        files[1].write_note(&serde_json::from_value(session).unwrap()).unwrap();
        make_old(files[1].film(), 130);
        make_old(&files[1].film().with_extension("json"), 130);

        let entries = [(3, "first"), (5, "second")].map(|(place, name)| Entry {
            number: Some(SlotNumber::ALL[place]),
            id: format!("{place}"),
            name: name.to_owned(),
            size: [4, 2],
            samples: 3,
            has_own_size: true,
        });
        files[2].slots().write_list(&entries).unwrap();
        for entry in &entries {
            fs::write(files[2].slots().film(&entry.id), "a film").unwrap();
        }
        make_old(&files[2].slots().path().join("slots.json"), 3 * 3600 + 60);
        drop(files);
        let mut left = Left::all_in(directory);
        left[1].mark(Part::Film, "its file is damaged".to_owned());
        left
    }

    struct Offered {
        card: Card,
        left: Vec<Left>,
        is_busy: bool,
        over: Rect,
        choices: Vec<Choice>,
    }

    fn offered(left: Vec<Left>) -> Harness<'static, Offered> {
        let over = Rect::from_min_max(egui::pos2(20.0, 30.0), egui::pos2(780.0, 890.0));
        let state = Offered { card: Card::default(), left, is_busy: false, over, choices: Vec::new() };
        let draw = |ui: &mut Ui, Offered { card, left, is_busy, over, choices }: &mut Offered| {
            choices.extend(card.ui(ui, *over, left, *is_busy));
        };
        let mut harness = dressed([800.0, 900.0]).build_ui_state(draw, state);
        harness.run_steps(2);
        harness
    }

    #[test]
    fn each_part_is_opened_or_discarded_by_itself() {
        let directory = tempfile::tempdir().unwrap();
        let mut harness = offered(left_in(directory.path()));
        const NOTHING: [Choice; 0] = [];
        let mut click = |name: &str| {
            harness.get_by_label_contains(name).click();
            harness.run_steps(2);
            std::mem::take(&mut harness.state_mut().choices)
        };
        assert_eq!(click("Open 10.5"), [Choice::Open(0, Part::Film)]);
        assert_eq!(click("Open A film"), NOTHING, "it is damaged");
        assert_eq!(click("Open my picture"), [Choice::Open(1, Part::Picture)]);
        assert_eq!(click("Open 2 kept pictures"), [Choice::Open(2, Part::Slots)]);
        assert_eq!(click("Discard: A film"), NOTHING);
        assert_eq!(click("Discard: my picture"), NOTHING, "another one");
        assert_eq!(click("Discard: A film"), NOTHING);
        assert_eq!(click("Discard for good: A film"), [Choice::Discard(1, Part::Film)]);
        assert_eq!(click("Discard: A film"), NOTHING, "it is asked about anew");
        assert_eq!(click("Close the recovered pictures"), [Choice::Later]);
        assert_eq!(click("Discard: A film"), NOTHING, "whatever else is chosen ends the doubt");
        harness.state_mut().is_busy = true;
        harness.run_steps(2);
        for name in ["Open my picture", "Discard: my picture"] {
            assert!(harness.get_by_label(name).accesskit_node().is_disabled(), "{name}");
        }
    }
}
