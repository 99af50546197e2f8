//! Keys and mouse.

use super::Outcome;
use crate::app::command::{Command, Group};
use eframe::egui::{self, RichText, Ui};

const MOUSE: [(&str, &str); 10] = [
    ("Drag", "orbit around the point looked at"),
    ("Right drag", "look around"),
    ("Wheel", "move closer or away"),
    ("Ctrl and wheel", "zoom the picture at the pointer"),
    ("Middle drag, Shift and drag", "move the picture"),
    ("Click", "focus on what is there"),
    ("Double click", "look at what is there"),
    ("Alt and click", "list the paths of a pixel, bounce by bounce"),
    ("W A S D, Q E", "fly; with Shift fast"),
    ("F6", "go to the controls with the keyboard"),
];

pub(super) fn ui(ui: &mut Ui, height: f32) -> Outcome {
    ui.heading("Keyboard and mouse");
    ui.add_space(6.0);
    egui::ScrollArea::vertical().max_height(height).min_scrolled_height(height).show(ui, |ui| {
        egui::Grid::new("help").num_columns(2).spacing([24.0, 4.0]).show(ui, |ui| {
            for (keys, what) in MOUSE {
                ui.label(RichText::new(keys).strong());
                ui.label(what);
                ui.end_row();
            }
            for group in Group::ALL {
                let commands = Command::all().into_iter().filter(|command| command.group() == group);
                for (command, shortcut) in commands.filter_map(|c| Some((c, c.shortcut()?))) {
                    ui.label(RichText::new(ui.ctx().format_shortcut(&shortcut)).strong());
                    ui.label(command.name().trim_end_matches('…'));
                    ui.end_row();
                }
            }
        });
    });
    ui.add_space(8.0);
    if ui.button("Close").clicked() { Outcome::Close } else { Outcome::Stay }
}
