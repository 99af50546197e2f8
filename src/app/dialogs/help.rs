//! The dialog that lists keys and mouse actions.

use super::outcome::Outcome;
use crate::app::command::{Menu, ROWS};
use eframe::egui::{self, RichText, Ui};

const MOUSE: [(&str, &str); 17] = [
    ("Drag", "orbit around what is there; in the sky, around the point looked at"),
    ("Right drag", "look around"),
    ("Wheel", "move towards what is there, or away"),
    ("Ctrl and wheel", "zoom the picture at the pointer"),
    ("Middle or Shift drag", "move the picture"),
    ("Click", "select a sphere; on the sky: none"),
    ("Drag the selected sphere", "move it; with Ctrl level"),
    ("Drag its handle", "change its radius"),
    ("Ctrl and click", "focus on what is there"),
    ("Double click", "look at what is there"),
    ("Right click", "a menu of what is there"),
    ("T; Alt and click", "list the paths of a pixel"),
    ("W A S D, Q E", "fly; with Shift fast"),
    ("Click an end of the axes", "look from that side; drag them to orbit"),
    ("Shift", "jump to a view or bookmark instead of flying"),
    ("Drop a file", "open a picture, film or scene"),
    ("Escape", "leave a control, the code, a crop, listed paths, a comparison, a view, a slot, full screen"),
];

/// Windows narrower than this many points get only one column.
const TWO_COLUMNS: f32 = 640.0;

const COLUMNS: [&[Option<Menu>]; 2] = [
    &[None, Some(Menu::File), Some(Menu::Edit)],
    &[Some(Menu::View), Some(Menu::Render), Some(Menu::Stage), Some(Menu::Help)],
];

pub(super) fn ui(ui: &mut Ui, height: f32) -> Outcome {
    ui.set_width(ui.available_width());
    ui.heading("Keyboard and mouse");
    ui.add_space(6.0);
    egui::ScrollArea::vertical().max_height(height).auto_shrink([false, true]).show(ui, |ui| {
        if ui.available_width() < TWO_COLUMNS {
            COLUMNS.into_iter().flatten().for_each(|part| section(ui, *part));
        } else {
            ui.columns(COLUMNS.len(), |uis| {
                for (ui, parts) in uis.iter_mut().zip(COLUMNS) {
                    parts.iter().for_each(|part| section(ui, *part));
                }
            });
        }
    });
    ui.add_space(8.0);
    if ui.button("Close").clicked() { Outcome::Close } else { Outcome::Stay }
}

fn section(ui: &mut Ui, group: Option<Menu>) {
    let title = group.map_or("Mouse and flying", Menu::name);
    ui.label(RichText::new(title).small().color(ui.visuals().weak_text_color()));
    egui::Grid::new(title).num_columns(2).min_row_height(0.0).spacing([14.0, 2.0]).show(ui, |ui| {
        let context = ui.ctx().clone();
        let mut row = |keys: &str, what: &str| {
            ui.label(RichText::new(keys).strong());
            ui.add(egui::Label::new(what).wrap());
            ui.end_row();
        };
        match group {
            None => MOUSE.into_iter().for_each(|(keys, what)| row(keys, what)),
            Some(group) => {
                for entry in ROWS.iter().filter(|entry| entry.menu == Some(group)) {
                    if let Some(keys) = entry.command.keys(&context) {
                        row(&keys, entry.name.trim_end_matches('…'));
                    }
                }
            }
        }
    });
    ui.add_space(6.0);
}
