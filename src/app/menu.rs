//! The menus.

use super::command::{Command, Group, SlotCommand};
use super::facts::Facts;
use super::stage_list;
use super::thumbnails::Thumbnails;
use super::tips;
use eframe::egui::{self, Button, RichText, Ui};

/// Width of a menu in points, narrow enough that names and keys are close together.
pub const MENU_WIDTH: f32 = 300.0;

/// Draws the menus, side by side.
pub fn menus(ui: &mut Ui, thumbnails: &mut Thumbnails, facts: &Facts, commands: &mut Vec<Command>) {
    for group in Group::ALL {
        ui.menu_button(group.name(), |ui| {
            if group == Group::Stage {
                ui.set_width(stage_list::WIDTH);
                stage_menu(ui, thumbnails, facts, commands);
                return;
            }
            ui.set_width(MENU_WIDTH);
            // Low windows scroll it.
            let height = (ui.ctx().content_rect().height() - 60.0).max(100.0);
            egui::ScrollArea::vertical().max_height(height).min_scrolled_height(height).show(ui, |ui| {
                let mut last = None;
                let listed = |command: &Command| command.group() == group && facts.is_listed(*command);
                for command in Command::all().into_iter().filter(listed) {
                    let section = section(command);
                    if last.is_some_and(|last| last != section) {
                        ui.separator();
                    }
                    last = Some(section);
                    item(ui, facts, commands, command);
                    if command == Command::Open {
                        recent(ui, facts, commands);
                    }
                }
            });
        });
    }
}

/// The menu of the files that were opened or saved last.
fn recent(ui: &mut Ui, facts: &Facts, commands: &mut Vec<Command>) {
    let is_empty = facts.recent().next().is_none();
    let menu = ui.add_enabled_ui(!is_empty, |ui| {
        ui.menu_button(format!("{ROOM_FOR_CHECK}Open recent"), |ui| {
            ui.set_width(MENU_WIDTH);
            for command in facts.recent() {
                item(ui, facts, commands, command);
            }
        })
    });
    let response = menu.inner.response.accessible_name("Open recent");
    let column = response.rect.x_range();
    tips::explain_in_column(response, column, "", Some("No file has been opened or saved yet"));
}

/// The section of a command. Commands with the same number are grouped together.
fn section(command: Command) -> u8 {
    match command {
        Command::Save(_) | Command::SaveScene => 1,
        Command::CopyPicture
        | Command::Crop
        | Command::CopyCrop
        | Command::SaveCrop
        | Command::CopyCommand => 2,
        Command::LoadReference | Command::ReferenceSize => 3,
        Command::Quit => 4,
        Command::ResetAll | Command::ViewFrom(_) => 1,
        Command::AddBookmark | Command::FlyBookmarks | Command::SaveFlight => 2,
        Command::Flights => 3,
        Command::NextSphere | Command::PreviousSphere | Command::Deselect => 1,
        Command::FocusSphere | Command::LookAtSphere => 2,
        Command::ResetSpheres => 3,
        Command::Wipe | Command::WipeDifference => 1,
        Command::Fit | Command::ActualSize | Command::ZoomIn | Command::ZoomOut => 2,
        Command::Panels
        | Command::Controls
        | Command::Info
        | Command::Plot
        | Command::Packet
        | Command::Gizmo
        | Command::NextPanel
        | Command::FullScreen
        | Command::Present
        | Command::Blank => 3,
        Command::Theme(_) => 4,
        Command::Slot(command) => match command {
            SlotCommand::Keep | SlotCommand::Swap => 0,
            SlotCommand::LookLive | SlotCommand::Look(_) => 1,
            SlotCommand::Wipe
            | SlotCommand::Difference
            | SlotCommand::OnlyNoise
            | SlotCommand::TakeSize
            | SlotCommand::Open => 2,
            SlotCommand::KeepIn(_) => 3,
            SlotCommand::Delete | SlotCommand::BringBack => 4,
        },
        Command::Device(_) | Command::Extreme(_) => 1,
        Command::Size(_) => 2,
        _ => 0,
    }
}

fn stage_menu(ui: &mut Ui, thumbnails: &mut Thumbnails, facts: &Facts, commands: &mut Vec<Command>) {
    for command in [Command::PreviousStage, Command::NextStage, Command::ShowMe, Command::Book] {
        item(ui, facts, commands, command);
    }
    ui.separator();
    stage_list::ui(ui, thumbnails, facts, commands);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::remembered::Bookmark;
    use crate::app::tests::{dressed, facts_of};

    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;

    use std::path::PathBuf;

    struct Menus {
        facts: Facts,
        thumbnails: Thumbnails,
        commands: Vec<Command>,
    }

    fn opened(size: [f32; 2]) -> Harness<'static, Menus> {
        let mut facts = facts_of("--stage glass-schlick --size 32x18");
        let camera = facts.document().camera;
        facts.model.remembered.recent = ["/of/a.png", "/of/b.exr", "/to/a.png"].map(PathBuf::from).to_vec();
        facts.model.remembered.bookmarks = vec![Bookmark::new("here".to_owned(), &camera)];
        (facts.can_undo, facts.has_pixel, facts.has_paths) = (true, true, true);
        let draw = |ui: &mut Ui, Menus { facts, thumbnails, commands }: &mut Menus| {
            ui.horizontal(|ui| menus(ui, thumbnails, facts, commands));
        };
        let menus = Menus { facts, thumbnails: Thumbnails::default(), commands: Vec::new() };
        dressed(size).build_ui_state(draw, menus)
    }

    /// Clicks what has this name; of several things the uppermost.
    fn press(harness: &mut Harness<'_, Menus>, name: &str) {
        let places = harness.get_all_by_label(name).map(|node| node.rect().center());
        let pos = places.min_by(|a, b| a.y.total_cmp(&b.y)).unwrap();
        harness.event(egui::Event::PointerMoved(pos));
        for pressed in [true, false] {
            let (button, modifiers) = (egui::PointerButton::Primary, egui::Modifiers::NONE);
            harness.event(egui::Event::PointerButton { pos, button, pressed, modifiers });
        }
        harness.run_steps(4);
    }

    #[test]
    fn an_entry_gives_its_command_and_closes_the_menu() {
        let mut harness = opened([1280.0, 800.0]);
        press(&mut harness, "Edit");
        press(&mut harness, "Undo");
        assert_eq!(std::mem::take(&mut harness.state_mut().commands), [Command::Undo]);
        assert!(harness.query_by_label("Undo").is_none());
        press(&mut harness, "File");
        press(&mut harness, "Open recent");
        press(&mut harness, "Open b.exr");
        assert_eq!(std::mem::take(&mut harness.state_mut().commands), [Command::Recent(1)]);
    }
}
