//! The top bar: menus, stage, device, pause and save.

use super::command::{Command, Group, SlotCommand};
use super::facts::Facts;
use super::model::device::Device;
use super::model::further::Further;
use super::stage_list;
use super::theme;
use super::thumbnails::Thumbnails;
use crate::output::OutputFormat;
use eframe::egui::{self, Align, Button, Layout, RichText, Ui};

/// Width of a menu in points, narrow enough that names and keys are close together.
pub const MENU_WIDTH: f32 = 300.0;

pub fn ui(
    ui: &mut Ui,
    is_narrow: bool,
    thumbnails: &mut Thumbnails,
    facts: &Facts,
    commands: &mut Vec<Command>,
) {
    let frame = theme::panel(egui::Margin::symmetric(10, 6));
    egui::Panel::top("menu").frame(frame).show(ui, |ui| {
        let height = ui.spacing().interact_size.y + 2.0;
        ui.horizontal(|ui| {
            ui.set_min_height(height);
            ui.scope(|ui| {
                egui::containers::menu::menu_style(ui.style_mut());
                ui.spacing_mut().item_spacing.x = 2.0;
                ui.spacing_mut().button_padding.x = 5.0;
                menus(ui, thumbnails, facts, commands);
            });
            if !is_narrow {
                ui.add_space(12.0);
                stage_bar(ui, true, thumbnails, facts, commands);
                ui.with_layout(Layout::right_to_left(Align::Center), |ui| buttons(ui, facts, commands));
            }
        });
        if is_narrow {
            ui.horizontal_wrapped(|ui| {
                stage_bar(ui, false, thumbnails, facts, commands);
                ui.separator();
                devices(ui, facts, commands);
                // Another button would begin another row.
                match facts.further() {
                    Some(further) => go_on(ui, "Go on", &further, commands),
                    None => pause(ui, facts, commands),
                }
                save(ui, commands);
            });
        }
    });
}

fn menus(ui: &mut Ui, thumbnails: &mut Thumbnails, facts: &Facts, commands: &mut Vec<Command>) {
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
                let place = facts.path(command).map(|path| path.display().to_string()).unwrap_or_default();
                item(ui, facts, commands, command).on_hover_text(place);
            }
        })
    });
    let response = menu.inner.response.accessible_name("Open recent");
    response.on_disabled_hover_text("No file has been opened or saved yet");
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
        Command::LoadReference => 3,
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
            SlotCommand::Wipe | SlotCommand::Difference | SlotCommand::OnlyNoise | SlotCommand::Open => 2,
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
    let mut response = ui.add_enabled(disabled_reason.is_none(), button).on_hover_text(command.help());
    response = response.accessible_name(facts.name(command));
    if is_on {
        let middle = response.rect.left_center() + egui::vec2(12.0, 0.0);
        let mark = [[-4.0, 0.0], [-1.0, 3.0], [4.5, -4.0]].map(|[x, y]| middle + egui::vec2(x, y));
        let stroke = egui::Stroke::new(1.5, ui.visuals().strong_text_color());
        ui.painter().line(mark.to_vec(), stroke);
        response
            .ctx
            .accesskit_node_builder(response.id, |node| node.set_toggled(egui::accesskit::Toggled::True));
    }
    if let Some(reason) = disabled_reason {
        response = response.on_disabled_hover_text(reason);
    }
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

fn stage_bar(
    ui: &mut Ui,
    is_wide: bool,
    thumbnails: &mut Thumbnails,
    facts: &Facts,
    commands: &mut Vec<Command>,
) {
    ui.spacing_mut().item_spacing.x = 4.0;
    step(ui, facts, commands, Command::PreviousStage, "‹");
    let title = match facts.document().stage() {
        Some(stage) if facts.document().has_changed_scene() => {
            format!("{}  {} (changed)", stage.section, stage.title)
        }
        Some(stage) => format!("{}  {}", stage.section, stage.title),
        None => facts.document().title(),
    };
    let width = if is_wide { (ui.available_width() - 400.0).clamp(160.0, 284.0) } else { 240.0 };
    let button = Button::new(RichText::new(title).strong()).min_size(egui::vec2(width, 0.0)).truncate();
    let sized = ui.scope(|ui| {
        ui.set_max_width(width);
        egui::containers::menu::MenuButton::from_button(button).ui(ui, |ui| {
            ui.set_width(stage_list::WIDTH);
            stage_list::ui(ui, thumbnails, facts, commands);
        })
    });
    let response =
        sized.inner.0.on_hover_text(with_keys(ui, Command::Stages)).accessible_name("Choose a stage");
    if ui.data_mut(|data| data.remove_temp::<bool>(asked())).is_some() {
        egui::Popup::open_id(ui.ctx(), egui::Popup::default_response_id(&response));
        ui.ctx().request_repaint();
    }
    step(ui, facts, commands, Command::NextStage, "›");
}

/// Where the wish for the list of stages is left.
fn asked() -> egui::Id {
    egui::Id::unique("the list of stages")
}

/// Opens the list of stages in the next frame.
pub fn open_stage_list(context: &egui::Context) {
    context.data_mut(|data| data.insert_temp(asked(), true));
}

fn step(ui: &mut Ui, facts: &Facts, commands: &mut Vec<Command>, command: Command, label: &str) {
    let disabled_reason = facts.disabled_reason(command);
    let response =
        ui.add_enabled(disabled_reason.is_none(), Button::new(label)).accessible_name(command.name());
    let response = response
        .on_hover_text(with_keys(ui, command))
        .on_disabled_hover_text(disabled_reason.unwrap_or_default());
    if response.clicked() {
        commands.push(command);
    }
}

/// A command's help text with its keys.
fn with_keys(ui: &Ui, command: Command) -> String {
    match command.keys(ui.ctx()) {
        Some(keys) => format!("{} ({keys})", command.help()),
        None => command.help().to_owned(),
    }
}

/// The buttons on the right side, laid out from right to left.
fn buttons(ui: &mut Ui, facts: &Facts, commands: &mut Vec<Command>) {
    save(ui, commands);
    pause(ui, facts, commands);
    ui.add_space(8.0);
    ui.spacing_mut().item_spacing.x = 3.0;
    for device in Device::ALL.into_iter().rev() {
        device_button(ui, facts, commands, device);
    }
    if let Some(further) = facts.further() {
        ui.add_space(8.0);
        go_on(ui, &format!("Go on to {}", further.words), &further, commands);
    }
}

fn save(ui: &mut Ui, commands: &mut Vec<Command>) {
    let command = Command::Save(OutputFormat::Png);
    let response = ui.button("Save").on_hover_text(with_keys(ui, command));
    if response.clicked() {
        commands.push(command);
    }
}

fn pause(ui: &mut Ui, facts: &Facts, commands: &mut Vec<Command>) {
    // Both labels have the same width, so that nothing beside the button moves.
    let is_paused = facts.model.is_paused;
    let label = if is_paused { "Go on" } else { "Pause" };
    let button = Button::new(label).min_size(egui::vec2(58.0, 0.0)).selected(is_paused);
    let can_pause = facts.is_working() || is_paused;
    let response = ui
        .add_enabled(can_pause, button)
        .on_hover_text(with_keys(ui, Command::Pause))
        .on_disabled_hover_text("The picture is done; the Stop panel sets when it ends");
    if response.clicked() {
        commands.push(Command::Pause);
    }
}

/// Offers to go on after the end of a render.
fn go_on(ui: &mut Ui, label: &str, further: &Further, commands: &mut Vec<Command>) {
    let button = Button::new(label).min_size(egui::vec2(58.0, 0.0));
    let help = format!("Go on to {}; no sample is lost", further.words);
    if ui.add(button).on_hover_text(help).clicked() {
        commands.push(Command::GoOn);
    }
}

fn devices(ui: &mut Ui, facts: &Facts, commands: &mut Vec<Command>) {
    ui.spacing_mut().item_spacing.x = 3.0;
    for device in Device::ALL {
        device_button(ui, facts, commands, device);
    }
}

fn device_button(ui: &mut Ui, facts: &Facts, commands: &mut Vec<Command>, device: Device) {
    let is_chosen = facts.model.remembered.device == device;
    let unavailable = device.unavailable();
    let mut label = RichText::new(device.label());
    if is_chosen {
        label = label.color(ui.visuals().selection.stroke.color);
    }
    let mut button = Button::new(label);
    if is_chosen {
        button = button.fill(theme::accent(ui));
    }
    let response = ui
        .add_enabled(unavailable.is_none(), button)
        .on_hover_text(format!(
            "{}. The same picture continues. (G switches between CPU and GPU)",
            device.long_help()
        ))
        .on_disabled_hover_text(unavailable.unwrap_or_default())
        .accessible_name(Command::Device(device).name());
    if response.clicked() {
        commands.push(Command::Device(device));
    }
}
