//! The menus, read from the table of commands.

use super::command::{Command, Menu, ROWS};
use super::facts::Facts;
use super::tips;
use eframe::egui::{self, Button, RichText, Ui};

/// Width of the menus, points.
pub const MENU_WIDTH: f32 = 248.0;

/// All menus of the bar.
pub fn menus(ui: &mut Ui, facts: &Facts, commands: &mut Vec<Command>) {
    for menu in Menu::BAR {
        ui.menu_button(menu.name(), |ui| {
            ui.set_width(MENU_WIDTH);
            entries(ui, menu, facts, commands);
        });
    }
}

/// The entries of a menu, with its submenus where they belong.
fn entries(ui: &mut Ui, menu: Menu, facts: &Facts, commands: &mut Vec<Command>) {
    if menu == Menu::View {
        submenu(ui, Menu::Show, facts, commands);
    }
    for row in ROWS.iter().filter(|row| row.menu == Some(menu)) {
        if row.has_line {
            ui.separator();
        }
        item(ui, facts, commands, row.command);
        match row.command {
            Command::Open => recent(ui, facts, commands),
            Command::ActualSize => submenu(ui, Menu::Bookmarks, facts, commands),
            Command::FullScreen => submenu(ui, Menu::Theme, facts, commands),
            _ => {}
        }
    }
    if menu == Menu::Bookmarks {
        for command in facts.bookmarks() {
            item(ui, facts, commands, command);
        }
    }
}

fn submenu(ui: &mut Ui, menu: Menu, facts: &Facts, commands: &mut Vec<Command>) {
    ui.menu_button(format!("{ROOM_FOR_CHECK}{}", menu.name()), |ui| {
        ui.set_width(MENU_WIDTH);
        entries(ui, menu, facts, commands);
    });
}

fn recent(ui: &mut Ui, facts: &Facts, commands: &mut Vec<Command>) {
    let is_empty = facts.recent().next().is_none();
    ui.add_enabled_ui(!is_empty, |ui| {
        ui.menu_button(format!("{ROOM_FOR_CHECK}Open recent"), |ui| {
            ui.set_width(MENU_WIDTH);
            for command in facts.recent() {
                item(ui, facts, commands, command);
            }
        })
    });
}
/// Where a menu item that is on has a check mark.
const ROOM_FOR_CHECK: &str = "      ";

/// A menu item for a command.
pub fn item(ui: &mut Ui, facts: &Facts, commands: &mut Vec<Command>, command: Command) -> egui::Response {
    let disabled_reason = facts.disabled_reason(command);
    let is_on = facts.is_on(command);
    let button = line(ui, command, format!("{ROOM_FOR_CHECK}{}", facts.name(command)), false);
    let mut response = ui.add_enabled(disabled_reason.is_none(), button).accessible_name(facts.name(command));
    if is_on {
        let middle = response.rect.left_center() + egui::vec2(12.0, 0.0);
        let mark = [[-4.0, 0.0], [-1.0, 3.0], [4.5, -4.0]].map(|[x, y]| middle + egui::vec2(x, y));
        let stroke = egui::Stroke::new(1.5, ui.visuals().strong_text_color());
        ui.painter().line(mark.to_vec(), stroke);
        response
            .ctx
            .accesskit_node_builder(response.id, |node| node.set_toggled(egui::accesskit::Toggled::True));
    }
    let help = facts.path(command).map(|path| path.display().to_string());
    let help = help.as_deref().unwrap_or(command.help());
    let column = response.rect.x_range();
    response = tips::explain_in_column(response, column, help, disabled_reason.as_deref());
    if response.clicked() {
        commands.push(command);
        ui.close();
    }
    response
}

/// A line with a command's name and keys.
pub fn line(ui: &Ui, command: Command, name: String, is_chosen: bool) -> Button<'static> {
    let visuals = ui.visuals();
    let colour = if is_chosen { visuals.selection.stroke.color } else { visuals.weak_text_color() };
    let button = Button::selectable(is_chosen, name);
    let button = match command.keys(ui.ctx()) {
        Some(keys) => button.shortcut_text(RichText::new(keys).color(colour)),
        None => button,
    };
    button.min_size(egui::vec2(ui.available_width(), 0.0))
}
