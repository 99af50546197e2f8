//! The dialog that lists keys and mouse actions.

use super::outcome::Outcome;
use crate::app::commands::{ROWS, Row};
use crate::app::toolkit::theme;
use crate::app::toolkit::widgets::caption;
use eframe::egui::{Context, Frame, Margin, RichText, ScrollArea, Sides, Ui};

const GROUPS: [&str; 8] = ["The picture", "Camera", "File", "Edit", "View", "Render", "Stage", "Other"];

/// From this width on there are two columns, points.
const TWO_COLUMNS: f32 = 640.0;

/// Mouse actions, and keys that belong to no single command: group, words and keys.
const MOUSE: [(&str, &str, &str); 17] = [
    ("The picture", "Zoom at the pointer", "Ctrl and wheel"),
    ("The picture", "Move the picture", "Shift drag"),
    ("The picture", "Select a sphere; on the sky: none", "Click"),
    ("The picture", "Move the selected sphere on its level; with Ctrl anywhere", "Drag it"),
    ("The picture", "Change its radius", "Drag its dot"),
    ("The picture", "A menu of what is there", "Right click"),
    ("The picture", "The paths of a pixel", "Alt and click"),
    ("Camera", "Orbit around what is there; in the sky, around Look at", "Drag"),
    ("Camera", "Look around", "Right drag"),
    ("Camera", "Move towards what is there, or away", "Wheel"),
    ("Camera", "Focus on what is there", "Ctrl and click"),
    ("Camera", "Look at what is there", "Double click"),
    ("Camera", "Fly; with Shift fast", "W A S D, Q E"),
    ("The picture", "Move the divider of a wipe", "Drag it"),
    ("Other", "Larger or smaller text", "Ctrl+Plus, Ctrl+−"),
    ("Other", "Open a picture, film or scene", "Drop a file"),
    ("Other", "Leave the innermost: menu, field, path, wipe, view, kept picture", "Escape"),
];

/// The group of a command: its menu in the bar.
fn group(row: &Row) -> &'static str {
    match row.menu {
        Some("Show" | "Bookmarks" | "Theme") => "View",
        None | Some("Help") => "Other",
        Some(menu) => menu,
    }
}

fn rows(title: &str, context: &Context) -> Vec<(String, String)> {
    let mouse = MOUSE.iter().filter(|(group, ..)| *group == title);
    let named = ROWS.iter().filter(|row| !row.name.is_empty() && group(row) == title);
    let with_keys = |row: &Row| Some((row.name.trim_end_matches('…').to_owned(), row.command.keys(context)?));
    let mouse = mouse.map(|(_, what, keys)| ((*what).to_owned(), (*keys).to_owned()));
    mouse.chain(named.filter_map(with_keys)).collect()
}

/// Draws the dialog.
pub(super) fn ui(ui: &mut Ui, height: f32) -> Outcome {
    ui.heading("Keys and mouse");
    let area = ScrollArea::vertical().max_height(height).min_scrolled_height(height);
    area.auto_shrink(false).show(ui, |ui| {
        let (count, half) = if ui.available_width() < TWO_COLUMNS { (1, GROUPS.len()) } else { (2, 4) };
        ui.spacing_mut().item_spacing.x = 24.0;
        ui.columns(count, |columns| {
            for (ui, groups) in columns.iter_mut().zip(GROUPS.chunks(half)) {
                ui.spacing_mut().item_spacing.y = 0.0;
                for title in groups {
                    caption(ui, title);
                    rows(title, ui.ctx()).iter().for_each(|(what, keys)| row_ui(ui, what, keys));
                }
            }
        });
    });
    if ui.button("Close").clicked() { Outcome::Close } else { Outcome::Stay }
}

fn row_ui(ui: &mut Ui, what: &str, keys: &str) {
    Sides::new().height(24.0).shrink_left().truncate().show(
        ui,
        |ui| ui.label(what),
        |ui| {
            let cap = Frame::new().fill(theme::colours(ui).raised).corner_radius(4);
            cap.inner_margin(Margin::symmetric(6, 1)).show(ui, |ui| ui.label(RichText::new(keys).small()));
        },
    );
}
