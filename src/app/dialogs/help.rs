//! The dialog that lists keys and mouse actions.

use super::outcome::Outcome;
use crate::app::command::{Menu, ROWS};
use crate::app::theme;
use crate::app::widgets::hint;
use eframe::egui::{self, Frame, Label, RichText, Sides, TextStyle, Ui, vec2};

const MOUSE: [(&str, &str); 16] = [
    ("Orbit around what is there; in the sky, around the point looked at", "Drag"),
    ("Look around", "Right drag"),
    ("Move towards what is there, or away", "Wheel"),
    ("Zoom the picture at the pointer", "Ctrl and wheel"),
    ("Move the picture", "Shift drag"),
    ("Select a sphere; on the sky: none", "Click"),
    ("Move the selected sphere; with Ctrl level", "Drag it"),
    ("Change its radius", "Drag its dot"),
    ("Focus on what is there", "Ctrl and click"),
    ("Look at what is there", "Double click"),
    ("A menu of what is there", "Right click"),
    ("The paths of a pixel", "Alt and click"),
    ("Fly; with Shift fast", "W A S D, Q E"),
    ("Look from that side; drag the axes to orbit", "Click an end"),
    ("Open a picture, film or scene", "Drop a file"),
    ("Leave the innermost: menu, field, path, wipe, view, kept picture", "Escape"),
];

/// Keys and mouse, and the words to search for.
#[derive(Default)]
pub struct Keys {
    text: String,
}

impl Keys {
    pub(super) fn ui(&mut self, ui: &mut Ui, height: f32) -> Outcome {
        ui.heading("Keys and mouse");
        let edit = egui::TextEdit::singleline(&mut self.text)
            .hint_text("Search")
            .margin(vec2(8.0, 8.0))
            .desired_width(f32::INFINITY);
        ui.add(edit).accessible_name("Search");
        let context = ui.ctx().clone();
        let of_menu = |menu: Option<Menu>| -> Vec<(String, String)> {
            let rows = ROWS.iter().filter(|row| row.menu == menu && !row.name.is_empty());
            let with_keys = |row: &_| -> Option<(String, String)> {
                let row: &crate::app::command::Row = row;
                Some((row.name.trim_end_matches('…').to_owned(), row.command.keys(&context)?))
            };
            rows.filter_map(with_keys).collect()
        };
        let mouse = MOUSE.map(|(what, keys)| (what.to_owned(), keys.to_owned())).to_vec();
        let mut groups = vec![("The picture", mouse)];
        let menus = [&Menu::BAR[..2], &[Menu::View, Menu::Show, Menu::Bookmarks], &Menu::BAR[3..]].concat();
        groups.extend(menus.into_iter().map(|menu| (menu.name(), of_menu(Some(menu)))));
        groups.push(("Without a menu", of_menu(None)));
        let typed = self.text.to_lowercase();
        let area = egui::ScrollArea::vertical().max_height(height).min_scrolled_height(height);
        area.auto_shrink(false).show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            let mut is_empty = true;
            for (title, mut rows) in groups {
                rows.retain(|(what, keys)| format!("{title} {what} {keys}").to_lowercase().contains(&typed));
                if rows.is_empty() {
                    continue;
                }
                is_empty = false;
                ui.add_space(8.0);
                ui.label(RichText::new(title).small().color(theme::colours(ui).weak));
                ui.add_space(4.0);
                rows.iter().for_each(|(what, keys)| row(ui, what, keys));
            }
            if is_empty {
                hint(ui, "No key or command is called that.");
            }
        });
        if ui.button("Close").clicked() { Outcome::Close } else { Outcome::Stay }
    }
}

fn row(ui: &mut Ui, what: &str, keys: &str) {
    let sides = Sides::new().height(24.0).shrink_left().truncate();
    sides.show(
        ui,
        |ui| ui.add(Label::new(what)),
        |ui| {
            let cap = Frame::new().fill(theme::colours(ui).raised).corner_radius(4);
            cap.inner_margin(egui::Margin::symmetric(6, 1)).show(ui, |ui| {
                ui.label(RichText::new(keys).text_style(TextStyle::Small));
            });
        },
    );
}
