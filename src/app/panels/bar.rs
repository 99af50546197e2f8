//! The bar at the top: menus, stage, device, pause and save. In a narrow window it has two rows.

use crate::app::commands::{Command, PanelContext};
use crate::app::model::{Device, Document};
use crate::app::toolkit::menu::menus;
use crate::app::toolkit::theme;
use crate::app::toolkit::widgets::{add_command, command_switch, named};
use eframe::egui::{self, Align, Atom, Button, Layout, Margin, Rect, RichText, Ui, ViewportCommand, vec2};

const HEIGHT: f32 = 48.0;

/// Height of its tallest button.
const ROW: f32 = 26.0;

/// Narrower windows have a second row, points.
const ONE_ROW: f32 = 780.0;

/// Narrower windows show only the section of the stage, points.
const WITH_TITLE: f32 = 1000.0;

/// Widths of the stage, a device, and the buttons that pause and save. They do not depend on the words, so that nothing
/// moves.
const STAGE: f32 = 288.0;
const DEVICE: f32 = 48.0;
const PAUSE: f32 = 72.0;
const SAVE: f32 = 64.0;

/// Draws the bar.
pub fn ui(ui: &mut Ui, cx: &PanelContext) {
    let has_one_row = ui.available_width() >= ONE_ROW;
    let height = if has_one_row { HEIGHT } else { 2.0 * HEIGHT - 14.0 };
    let panel = egui::Panel::top("bar").exact_size(height).frame(theme::panel(Margin::symmetric(8, 11)));
    panel.show(ui, |ui| {
        ui.horizontal(|ui| {
            ui.set_min_height(ROW);
            ui.scope(|ui| {
                egui::containers::menu::menu_style(ui.style_mut());
                ui.spacing_mut().item_spacing.x = 0.0;
                ui.spacing_mut().button_padding = vec2(8.0, 4.0);
                menus(ui, cx);
            });
            if has_one_row {
                actions(ui, cx);
            }
        });
        if !has_one_row {
            ui.horizontal(|ui| {
                ui.set_min_height(ROW);
                actions(ui, cx);
            });
        }
    });
}

/// The stage in the middle of the window; device, pause and save at the right.
fn actions(ui: &mut Ui, cx: &PanelContext) {
    let gap = ui.spacing().item_spacing.x;
    let devices = devices(cx);
    let at_right = devices.len() as f32 * DEVICE + PAUSE + SAVE + 4.0 * gap;
    let window = ui.ctx().content_rect();
    let wanted = if window.width() < WITH_TITLE { 100.0 } else { STAGE } + 56.0;
    let room = ui.available_width() - at_right;
    let width = wanted.min(room - gap).max(96.0);
    let indent = window.center().x - 0.5 * width - ui.cursor().left();
    ui.add_space(indent.min(room - width).max(gap));
    let layout = Layout::left_to_right(Align::Center);
    ui.allocate_ui_with_layout(vec2(width, 24.0), layout, |ui| stage(ui, cx));
    ui.add_space((ui.available_width() - at_right).max(0.0));
    command_switch(ui, cx, DEVICE, &devices);
    ui.add_space(gap);
    pause(ui, cx);
    add_command(ui, cx, Command::Save, Button::new("Save…").min_size(vec2(SAVE, 0.0)));
}

/// Names the window after its picture.
pub fn name_window(context: &egui::Context, document: &Document) {
    let changed = if document.is_changed() { ", changed" } else { "" };
    let title = format!("{}{changed} – Weekender", document.heading());
    // For screen readers.
    context.accesskit_node_builder(egui::accesskit_root_id(), |node| node.set_label(title.as_str()));
    let place = egui::Id::unique("title of the window");
    if context.data(|data| data.get_temp::<String>(place)).as_ref() != Some(&title) {
        context.data_mut(|data| data.insert_temp(place, title.clone()));
        context.send_viewport_cmd(ViewportCommand::Title(title));
    }
}

/// The stage between the arrows to its neighbours.
fn stage(ui: &mut Ui, cx: &PanelContext) {
    ui.spacing_mut().item_spacing.x = 4.0;
    let width = ui.available_width() - 56.0;
    step(ui, cx, Command::PreviousStage, "‹");
    let document = cx.document();
    let title = match document.stage() {
        Some(stage) if width < 140.0 => stage.section.to_owned(),
        _ => document.heading(),
    };
    let changed = if document.is_changed() && width >= 140.0 { " · changed" } else { "" };
    // The title is cut before "changed" is.
    let room_for_triangle = Atom::custom(egui::IdSalt::new("triangle"), vec2(12.0, 8.0));
    let atoms = (Atom::grow(), RichText::new(title).strong(), changed, Atom::grow(), room_for_triangle);
    let button = Button::new(atoms).gap(0.0).min_size(vec2(width, 24.0)).truncate();
    let sized = ui.scope(|ui| {
        ui.set_max_width(width);
        add_command(ui, cx, Command::Stages, button)
    });
    let response = sized.inner;
    let corner = response.rect.right_center() - vec2(14.0, 0.0);
    let icon = Rect::from_center_size(corner, vec2(9.0, 9.0));
    egui::collapsing_header::paint_default_icon(ui, 1.0, &response.clone().with_new_rect(icon));
    named(&response, "Choose a stage");
    step(ui, cx, Command::NextStage, "›");
}

fn step(ui: &mut Ui, cx: &PanelContext, command: Command, sign: &str) {
    let atoms = (Atom::grow(), RichText::new(sign).strong(), Atom::grow());
    let button = Button::new(atoms).gap(0.0).min_size(vec2(24.0, 24.0));
    named(&add_command(ui, cx, command, button), &command.name());
}

/// The devices to choose from.
fn devices(cx: &PanelContext) -> Vec<(&'static str, Command)> {
    let chosen = cx.model.remembered.device;
    let devices = [Device::Cpu, Device::Gpu].into_iter();
    let devices = devices.filter(|device| device.is_shown() || *device == chosen);
    devices.map(|device| (device.label(), Command::Device(device))).collect()
}

fn pause(ui: &mut Ui, cx: &PanelContext) {
    let label = match cx.model.is_paused {
        _ if cx.further().is_some() => "Continue",
        true => "Resume",
        false => "Pause",
    };
    add_command(ui, cx, Command::Pause, Button::new(label).min_size(vec2(PAUSE, 0.0)));
}
