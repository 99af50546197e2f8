//! Keyboard input, dropped files, and flying.

use crate::app::commands::{Command, ROWS};
use crate::app::model::navigation;
use crate::scene::Camera;
use eframe::egui::{self, Key, KeyboardShortcut, Modifiers};
use glam::DVec3;
use std::path::PathBuf;

/// Scene units a second, as a share of the distance to `look_at`.
const FLY_SHARE_PER_SECOND: f64 = 0.7;

/// Speed factor while Shift is held.
const FAST: f64 = 4.0;

/// Keys of a presenter's remote control in a presentation, besides Page Up, Page Down and B.
const REMOTE: [(Key, Command); 5] = [
    (Key::ArrowRight, Command::NextStage),
    (Key::ArrowDown, Command::NextStage),
    (Key::ArrowLeft, Command::PreviousStage),
    (Key::ArrowUp, Command::PreviousStage),
    (Key::Period, Command::Blank),
];

/// Keys that mean the same as others.
const ALSO: [(Command, Modifiers, Key); 5] = [
    (Command::Redo, Modifiers::COMMAND, Key::Y),
    (Command::Help, Modifiers::NONE, Key::Questionmark),
    // The list of rays is vertical.
    (Command::NextRay, Modifiers::NONE, Key::ArrowDown),
    (Command::PreviousRay, Modifiers::NONE, Key::ArrowUp),
    // The Delete key of an Apple keyboard.
    (Command::DeleteSphere, Modifiers::NONE, Key::Backspace),
];

/// Turns keys into commands. Returns whether held keys may move the camera.
pub fn take_keys(context: &egui::Context, is_presenting: bool, commands: &mut Vec<Command>) -> bool {
    let is_typing = context.text_edit_focused();
    // An open menu or list has the keys that are pressed alone.
    let has_popup = egui::Popup::is_any_open(context);
    let is_focused = context.memory(|memory| memory.focused().is_some());
    let keys_of_controls =
        [Key::Tab, Key::Space, Key::ArrowLeft, Key::ArrowRight, Key::ArrowUp, Key::ArrowDown];
    for (command, shortcut) in shortcuts(is_presenting) {
        // In a focused control, Tab moves on, Space presses it and arrows change it.
        let is_plain = shortcut.modifiers == Modifiers::NONE;
        let is_function_key = shortcut.logical_key >= Key::F1 && shortcut.logical_key <= Key::F12;
        if is_typing && !is_function_key {
            continue;
        }
        let is_of_control = is_focused && keys_of_controls.contains(&shortcut.logical_key);
        if is_plain && (has_popup || is_of_control) {
            continue;
        }
        // In a long frame a key can have been pressed several times.
        let mut presses =
            context.input_mut(|input| input.count_and_consume_key(shortcut.modifiers, shortcut.logical_key));
        if command == Command::Copy {
            presses += context.input_mut(take_copies);
        }
        if presses > 0 {
            if command == Command::Panels {
                context.memory_mut(|memory| memory.move_focus(egui::FocusDirection::None));
            }
            (0..presses).for_each(|_| commands.push(command));
            if command.opens_dialog() {
                // Keys that follow, even within this frame, belong to the dialog.
                return false;
            }
        }
    }
    !has_popup && !is_typing
}

/// Takes the events that the window system sends instead of Ctrl+C, and returns how many there were.
fn take_copies(input: &mut egui::InputState) -> usize {
    let before = input.events.len();
    input.events.retain(|event| !matches!(event, egui::Event::Copy));
    before - input.events.len()
}

/// Moves the camera while keys are held. Returns whether it moved.
pub fn fly(context: &egui::Context, camera: &mut Camera) -> bool {
    let taken = taken_keys(context);
    let (by, seconds, is_fast) = context.input(|input| {
        let is_plain = !input.modifiers.command && !input.modifiers.alt;
        let held = |key| f64::from(u8::from(is_plain && input.key_down(key) && !taken.contains(&key)));
        let by =
            DVec3::new(held(Key::D) - held(Key::A), held(Key::E) - held(Key::Q), held(Key::W) - held(Key::S));
        // Limited, because after a pause without frames the first step would be a jump.
        (by, f64::from(input.stable_dt.min(0.05)), input.modifiers.shift)
    });
    if by == DVec3::ZERO {
        return false;
    }
    let distance = camera.look_from.distance(camera.look_at);
    let speed = FLY_SHARE_PER_SECOND * distance * if is_fast { FAST } else { 1.0 };
    *camera = navigation::fly(camera, by * speed * seconds);
    context.request_repaint();
    true
}

/// The keys that are held since they were pressed with Ctrl. After Ctrl+D, D may be released later than Ctrl, but the
/// camera must not move.
fn taken_keys(context: &egui::Context) -> Vec<Key> {
    let id = egui::Id::unique("taken keys");
    let mut taken: Vec<Key> = context.data(|data| data.get_temp(id)).unwrap_or_default();
    context.input(|input| {
        for event in &input.raw.events {
            if let egui::Event::Key { key, pressed: true, modifiers, .. } = event
                && modifiers.command
            {
                taken.push(*key);
            }
        }
        taken.retain(|key| input.key_down(*key));
    });
    context.data_mut(|data| data.insert_temp(id, taken.clone()));
    taken
}

/// The files that were dropped on the window.
pub fn dropped(context: &egui::Context) -> Vec<PathBuf> {
    context.input(|input| input.raw.dropped_files.iter().map(|file| file.path().to_owned()).collect())
}

/// All keys of commands, those with the most modifiers first: a shortcut without Shift would take the one with it.
fn shortcuts(is_presenting: bool) -> Vec<(Command, KeyboardShortcut)> {
    let also = ALSO.map(|(command, modifiers, key)| (command, KeyboardShortcut::new(modifiers, key)));
    let of_rows = ROWS.iter().filter_map(|row| Some((row.command, row.keys?)));
    let remote = REMOTE.into_iter().filter(|_| is_presenting);
    let remote = remote.map(|(key, command)| (command, KeyboardShortcut::new(Modifiers::NONE, key)));
    let mut keys: Vec<_> = remote.chain(of_rows).chain(also).collect();
    keys.sort_by_key(|(_, shortcut)| {
        let Modifiers { command, shift, alt, .. } = shortcut.modifiers;
        std::cmp::Reverse([command, shift, alt].map(u8::from).iter().sum::<u8>())
    });
    keys
}

#[cfg(test)]
mod tests;
