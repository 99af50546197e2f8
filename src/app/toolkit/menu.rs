//! The menus, read from the table of commands.

use super::widgets::{named, tip};
use crate::app::commands::{Command, MENUS, PanelContext, ROWS, Snapshot};
use eframe::egui::accesskit::Toggled;
use eframe::egui::containers::menu::SubMenuButton;
use eframe::egui::{Atom, Button, IdSalt, Response, RichText, Stroke, Ui, vec2};

/// Width of the menus, points.
pub const MENU_WIDTH: f32 = 248.0;

/// All menus of the bar.
pub fn menus(ui: &mut Ui, cx: &PanelContext) {
    for menu in MENUS {
        let response = ui.menu_button(menu, |ui| entries(ui, menu, cx)).response;
        named(&response, menu);
    }
}

/// The entries of a menu, with its submenus where they belong.
fn entries(ui: &mut Ui, menu: &str, cx: &PanelContext) {
    ui.set_width(MENU_WIDTH);
    if menu == "View" {
        submenu(ui, "Show", |ui| entries(ui, "Show", cx));
    }
    for row in ROWS.iter().filter(|row| row.menu == Some(menu)) {
        if row.has_line {
            ui.separator();
        }
        item(ui, cx, row.command);
        match row.command {
            Command::Open => {
                ui.add_enabled_ui(cx.recent().next().is_some(), |ui| {
                    submenu(ui, "Open recent", |ui| places(ui, cx, cx.recent()));
                });
            }
            Command::ActualSize => {
                submenu(ui, "Bookmarks", |ui| {
                    entries(ui, "Bookmarks", cx);
                    places(ui, cx, cx.bookmarks());
                });
            }
            Command::FullScreen => {
                ui.separator();
                submenu(ui, "Theme", |ui| entries(ui, "Theme", cx));
            }
            _ => {}
        }
    }
}

fn places(ui: &mut Ui, cx: &PanelContext, all: impl Iterator<Item = Command>) {
    ui.set_width(MENU_WIDTH);
    for command in all {
        item(ui, cx, command);
    }
}

/// All names begin behind the place of a tick.
fn gutter() -> Atom<'static> {
    Atom::custom(IdSalt::new("gutter"), vec2(16.0, 16.0))
}

fn submenu(ui: &mut Ui, name: &str, content: impl FnOnce(&mut Ui)) {
    ui.scope(|ui| {
        ui.spacing_mut().button_padding = vec2(4.0, 4.0);
        SubMenuButton::new((gutter(), name)).ui(ui, content);
    });
}

/// A menu entry for a command.
pub fn item(ui: &mut Ui, cx: &PanelContext, command: Command) -> Response {
    let response = entry(ui, cx, command, &cx.name(command), false);
    let path = cx.path(command).map(|path| path.display().to_string());
    let help = path.as_deref().unwrap_or(command.help());
    let response = tip(ui, response, help, cx.disabled_reason(command).as_deref());
    if response.clicked() {
        cx.send(command);
        ui.close();
    }
    response
}

/// A line with a command's name, a tick if it is on, and its keys at the right.
pub fn entry(ui: &mut Ui, snapshot: &Snapshot, command: Command, name: &str, is_chosen: bool) -> Response {
    let button = Button::selectable(is_chosen, (gutter(), name)).min_size(vec2(ui.available_width(), 24.0));
    let button = match command.keys(ui.ctx()) {
        Some(keys) => button.shortcut_text(RichText::new(keys).small()),
        None => button.right_text(""),
    };
    let is_usable = snapshot.disabled_reason(command).is_none();
    let scope = ui.scope(|ui| {
        ui.spacing_mut().button_padding = vec2(4.0, 4.0);
        ui.add_enabled(is_usable, button)
    });
    let response = scope.inner.accessible_name(name);
    if snapshot.is_on(command) {
        let middle = response.rect.left_center() + vec2(12.0, 0.0);
        let tick = [[-4.0, 0.0], [-1.0, 3.0], [4.5, -4.0]].map(|[x, y]| middle + vec2(x, y));
        ui.painter().line(tick.to_vec(), Stroke::new(1.5, ui.visuals().strong_text_color()));
    }
    if let Some(is_on) = snapshot.switch(command) {
        response.ctx.accesskit_node_builder(response.id, |node| node.set_toggled(Toggled::from(is_on)));
    }
    response
}
