//! The saved cameras: going to them, and putting them in order for a flight.

use crate::app::command::Command;
use crate::app::facts::Facts;
use crate::app::model::remembered::Bookmark;
use crate::app::tips::{self, Side};
use crate::scene::Camera;
use eframe::egui::containers::menu::{MenuButton, MenuConfig};
use eframe::egui::{self, Button, PopupCloseBehavior, RichText, Ui, vec2};

/// The most height that the list takes, in points. Longer lists scroll.
const HEIGHT: f32 = 132.0;

/// The width of a bookmark's menu button, in points.
const MENU: f32 = 28.0;

/// What the user does to the list.
enum Change {
    Swap(usize, usize),
    Forget(usize),
}

pub(super) fn ui(
    ui: &mut Ui,
    camera: &Camera,
    bookmarks: &mut Vec<Bookmark>,
    facts: &Facts,
    commands: &mut Vec<Command>,
) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        for (command, name) in [
            (Command::AddBookmark, "Bookmark"),
            (Command::FlyBookmarks, "Fly"),
            (Command::SaveFlight, "Save path…"),
        ] {
            let disabled_reason = facts.disabled_reason(command);
            let help = match command.keys(ui.ctx()) {
                Some(keys) => format!("{} ({keys})", command.help()),
                None => command.help().to_owned(),
            };
            let response = ui.add_enabled(disabled_reason.is_none(), Button::new(name));
            let response = tips::explain(ui, response, Side::Beside, &help, disabled_reason.as_deref());
            if response.accessible_name(command.name()).clicked() {
                commands.push(command);
            }
        }
    });
    if bookmarks.is_empty() {
        return;
    }
    let count = bookmarks.len();
    let mut change = None;
    egui::ScrollArea::vertical().id_salt("bookmarks").max_height(HEIGHT).auto_shrink([false, true]).show(
        ui,
        |ui| {
            ui.spacing_mut().item_spacing = vec2(4.0, 3.0);
            ui.spacing_mut().button_padding.x = 6.0;
            for (place, bookmark) in bookmarks.iter_mut().enumerate() {
                ui.horizontal(|ui| {
                    let side = ui.spacing().interact_size.y;
                    let is_here = bookmark.camera() == *camera;
                    let name = RichText::new(&bookmark.name);
                    let button = Button::new(if is_here { name.strong() } else { name }).truncate();
                    let size = vec2(ui.available_width() - MENU - 4.0, side);
                    let command = Command::Bookmark(place);
                    let response = ui.add_sized(size, button);
                    let response = tips::beside(ui, response, command.help());
                    if response.accessible_name(facts.name(command)).clicked() {
                        commands.push(command);
                    }
                    let menu = MenuButton::from_button(Button::new("…").min_size(vec2(MENU, side)))
                        .config(MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside));
                    let (response, _) =
                        menu.ui(ui, |ui| entry(ui, (place, count), bookmark, camera, &mut change));
                    let help = "Rename, move or forget this bookmark";
                    tips::beside(ui, response, help).accessible_name(format!("Change {}", bookmark.name));
                });
            }
        },
    );
    match change {
        Some(Change::Swap(a, b)) => bookmarks.swap(a, b),
        Some(Change::Forget(place)) => _ = bookmarks.remove(place),
        None => {}
    }
    ui.add_space(4.0);
}

/// The menu of a bookmark.
fn entry(
    ui: &mut Ui,
    (place, count): (usize, usize),
    bookmark: &mut Bookmark,
    camera: &Camera,
    change: &mut Option<Change>,
) {
    ui.set_width(190.0);
    let edit = egui::TextEdit::singleline(&mut bookmark.name).desired_width(f32::INFINITY).char_limit(60);
    let edit = ui.add(edit).accessible_name("Name of the bookmark");
    if edit.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter)) {
        ui.close();
    }
    let item = |ui: &mut Ui, is_enabled: bool, name: &str, help: &str| {
        let button = Button::new(name).min_size(vec2(ui.available_width(), 0.0));
        let response = ui.add_enabled(is_enabled, button);
        let column = response.rect.x_range();
        let is_clicked = tips::explain_in_column(response, column, help, None).clicked();
        if is_clicked {
            ui.close();
        }
        is_clicked
    };
    if item(ui, place > 0, "Earlier", "Move it one place up: a flight comes to it earlier") {
        *change = Some(Change::Swap(place, place - 1));
    }
    if item(ui, place + 1 < count, "Later", "Move it one place down: a flight comes to it later") {
        *change = Some(Change::Swap(place, place + 1));
    }
    if item(ui, bookmark.camera() != *camera, "Replace", "Save the present camera and lens instead") {
        *bookmark = Bookmark::new(bookmark.name.clone(), camera);
    }
    if item(ui, true, "Forget", "Remove it from the list") {
        *change = Some(Change::Forget(place));
    }
}
