//! Keyboard input, dropped files, and flying.

use super::command::{Command, SlotCommand};
use super::model::show::Show;
use super::navigation;
use crate::scene::Camera;
use eframe::egui::{self, Key, Modifiers};
use glam::DVec3;
use std::path::PathBuf;

/// Scene units a second, as a share of the distance to `look_at`.
const FLY_SHARE_PER_SECOND: f64 = 0.7;

/// Speed factor while Shift is held.
const FAST: f64 = 4.0;

/// What had the keyboard before this frame.
pub struct Keyboard {
    /// A control, a menu or a dialog had the keyboard focus.
    pub had_focus: bool,
    /// The window shows something other than the picture.
    pub is_other_view: bool,
    /// A part of the picture is being marked.
    pub is_cropping: bool,
    /// A slot is shown instead of the live picture.
    pub is_at_slot: bool,
    /// A sphere is selected.
    pub has_selection: bool,
    /// The window is in full-screen mode.
    pub is_full_screen: bool,
    /// The card with the first steps is shown.
    pub has_first_steps: bool,
    /// The stage's sight is shown.
    pub has_sight: bool,
    /// There is a presentation.
    pub is_presenting: bool,
}

/// What the keys of a presenter's remote control do in a presentation, besides Page Up, Page Down and B.
const REMOTE: [(Key, Command); 5] = [
    (Key::ArrowRight, Command::NextStage),
    (Key::ArrowDown, Command::NextStage),
    (Key::ArrowLeft, Command::PreviousStage),
    (Key::ArrowUp, Command::PreviousStage),
    (Key::Period, Command::Blank),
];

/// Turns keys into commands. Returns whether held keys may move the camera.
pub fn take_keys(context: &egui::Context, keyboard: &Keyboard, commands: &mut Vec<Command>) -> bool {
    if context.text_edit_focused() {
        return false;
    }
    context.input_mut(name_digits_by_place);
    for (key, command) in REMOTE.into_iter().filter(|_| keyboard.is_presenting) {
        let presses = context.input_mut(|input| input.count_and_consume_key(Modifiers::NONE, key));
        (0..presses).for_each(|_| commands.push(command));
    }
    let is_focused = context.memory(|memory| memory.focused().is_some());
    let keys_of_controls = [Key::Tab, Key::Space, Key::ArrowLeft, Key::ArrowRight];
    for command in by_modifiers() {
        let Some(shortcut) = command.shortcut() else { continue };
        // In a focused control, Tab moves on, Space presses it and arrows change it.
        let is_plain = shortcut.modifiers == Modifiers::NONE;
        if is_focused && is_plain && keys_of_controls.contains(&shortcut.logical_key) {
            continue;
        }
        // In a long frame a key can have been pressed several times.
        let mut presses =
            context.input_mut(|input| input.count_and_consume_key(shortcut.modifiers, shortcut.logical_key));
        if command == Command::CopyPicture {
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
    let also = |key| context.input_mut(|input| input.consume_key(Modifiers::NONE, key));
    if also(Key::Questionmark) {
        commands.push(Command::Help);
    }
    if context.input_mut(|input| input.consume_key(Modifiers::COMMAND, Key::Y)) {
        commands.push(Command::Redo);
    }
    // The Delete key of an Apple keyboard.
    if also(Key::Backspace) {
        commands.push(Command::DeleteSphere);
    }
    // Escape first leaves a control, then closes the first steps, then a crop, then deselects, then leaves a sight, a
    // comparison or another view, then a slot, then a presentation, then full-screen mode.
    if !keyboard.had_focus && also(Key::Escape) {
        if keyboard.has_first_steps && !keyboard.is_presenting {
            commands.push(Command::FirstSteps);
        } else if keyboard.is_cropping {
            commands.push(Command::Crop);
        } else if keyboard.has_selection && !keyboard.is_at_slot {
            commands.push(Command::Deselect);
        } else if keyboard.has_sight {
            commands.push(Command::ShowMe);
        } else if keyboard.is_other_view {
            commands.push(Command::Show(Show::Picture));
        } else if keyboard.is_at_slot {
            commands.push(Command::Slot(SlotCommand::LookLive));
        } else if keyboard.is_presenting {
            commands.push(Command::Present);
        } else if keyboard.is_full_screen {
            commands.push(Command::FullScreen);
        }
    }
    true
}

/// With Alt, a digit is known by its place on the keyboard: with Shift as well, it types something else.
fn name_digits_by_place(input: &mut egui::InputState) {
    for event in &mut input.events {
        if let egui::Event::Key { key, physical_key: Some(place), modifiers, .. } = event
            && modifiers.alt
            && (Key::Num0..=Key::Num9).contains(place)
        {
            *key = *place;
        }
    }
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

/// Commands with more modifiers come first, because Ctrl+Shift+S also matches Ctrl+S.
fn by_modifiers() -> Vec<Command> {
    let mut commands: Vec<Command> = Command::all().into_iter().filter(|c| c.shortcut().is_some()).collect();
    commands.sort_by_key(|command| {
        let modifiers = command.shortcut().map_or(Modifiers::NONE, |shortcut| shortcut.modifiers);
        std::cmp::Reverse(
            [modifiers.command, modifiers.shift, modifiers.alt].map(u8::from).iter().sum::<u8>(),
        )
    });
    commands
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::slots::SlotNumber;

    const KEYBOARD: Keyboard = Keyboard {
        had_focus: false,
        is_other_view: false,
        is_cropping: false,
        is_at_slot: false,
        has_selection: false,
        is_full_screen: false,
        has_first_steps: false,
        has_sight: false,
        is_presenting: false,
    };

    /// The commands of a key that types `key` and is at the place of `physical_key` on the keyboard.
    fn commands(key: Key, physical_key: Option<Key>, modifiers: Modifiers) -> Vec<Command> {
        let pressed = egui::Event::Key { key, physical_key, pressed: true, repeat: false, modifiers };
        let input = egui::RawInput { events: vec![pressed], ..egui::RawInput::default() };
        let mut commands = Vec::new();
        let _ = egui::Context::default().run_ui(input, |ui| {
            take_keys(ui.ctx(), &KEYBOARD, &mut commands);
        });
        commands
    }

    #[test]
    fn some_commands_have_a_second_key() {
        for (key, modifiers, command) in [
            (Key::Questionmark, Modifiers::SHIFT, Command::Help),
            (Key::Y, Modifiers::COMMAND, Command::Redo),
            (Key::Backspace, Modifiers::NONE, Command::DeleteSphere),
        ] {
            assert_eq!(commands(key, None, modifiers), [command]);
        }
    }

    #[test]
    fn a_digit_with_alt_is_known_by_its_place() {
        let place = Some(Key::Num1);
        let of_first = |command: fn(SlotNumber) -> SlotCommand| [Command::Slot(command(SlotNumber::ALL[0]))];
        let shift_alt = Modifiers::SHIFT | Modifiers::ALT;
        assert_eq!(commands(Key::Exclamationmark, place, shift_alt), of_first(SlotCommand::KeepIn));
        assert_eq!(commands(Key::Exclamationmark, place, Modifiers::ALT), of_first(SlotCommand::Look));
        assert!(commands(Key::Exclamationmark, place, Modifiers::SHIFT).is_empty());
    }

    fn key(key: Key, modifiers: Modifiers) -> egui::Event {
        egui::Event::Key { key, physical_key: None, pressed: true, repeat: false, modifiers }
    }

    /// The commands of these events, and whether held keys may move the camera then.
    fn taken(events: Vec<egui::Event>, keyboard: &Keyboard, context: &egui::Context) -> (Vec<Command>, bool) {
        let input = egui::RawInput { events, ..egui::RawInput::default() };
        let (mut commands, mut is_free) = (Vec::new(), false);
        let _ = context.run_ui(input, |ui| is_free = take_keys(ui.ctx(), keyboard, &mut commands));
        (commands, is_free)
    }

    fn commands_in(keyboard: &Keyboard, pressed: Key) -> Vec<Command> {
        taken(vec![key(pressed, Modifiers::NONE)], keyboard, &egui::Context::default()).0
    }

    #[test]
    fn every_shortcut_gives_its_command() {
        for command in Command::all() {
            let Some(shortcut) = command.shortcut() else { continue };
            let event = key(shortcut.logical_key, shortcut.modifiers);
            let found = taken(vec![event], &KEYBOARD, &egui::Context::default());
            assert_eq!(found, (vec![command], !command.opens_dialog()), "{command:?}");
        }
    }

    #[test]
    fn escape_leaves_one_thing_after_the_other() {
        let mut keyboard = Keyboard {
            had_focus: true,
            is_other_view: true,
            is_cropping: true,
            is_at_slot: false,
            has_selection: true,
            is_full_screen: true,
            has_first_steps: true,
            has_sight: true,
            is_presenting: false,
        };
        let escape = |keyboard: &Keyboard| commands_in(keyboard, Key::Escape);
        assert!(escape(&keyboard).is_empty(), "a control has the keyboard");
        keyboard.had_focus = false;
        assert_eq!(escape(&keyboard), [Command::FirstSteps]);
        keyboard.is_presenting = true;
        assert_eq!(escape(&keyboard), [Command::Crop], "a presentation has no card");
        (keyboard.is_presenting, keyboard.has_first_steps) = (false, false);
        assert_eq!(escape(&keyboard), [Command::Crop]);
        keyboard.is_cropping = false;
        assert_eq!(escape(&keyboard), [Command::Deselect]);
        keyboard.is_at_slot = true;
        assert_eq!(escape(&keyboard), [Command::ShowMe], "no sphere is selected in a slot");
        keyboard.has_sight = false;
        assert_eq!(escape(&keyboard), [Command::Show(Show::Picture)]);
        keyboard.is_other_view = false;
        assert_eq!(escape(&keyboard), [Command::Slot(SlotCommand::LookLive)]);
        (keyboard.is_at_slot, keyboard.has_selection, keyboard.is_presenting) = (false, false, true);
        assert_eq!(escape(&keyboard), [Command::Present]);
        keyboard.is_presenting = false;
        assert_eq!(escape(&keyboard), [Command::FullScreen]);
        keyboard.is_full_screen = false;
        assert!(escape(&keyboard).is_empty());
    }

    #[test]
    fn a_remote_control_goes_through_a_presentation() {
        let presenting = Keyboard { is_presenting: true, ..KEYBOARD };
        for (key, command) in REMOTE {
            assert_eq!(commands_in(&presenting, key), [command]);
            assert_ne!(commands_in(&KEYBOARD, key), [command], "{key:?}");
        }
    }

    #[test]
    fn each_press_counts_and_a_dialog_gets_the_keys_that_follow() {
        let context = egui::Context::default();
        let plain = |pressed| key(pressed, Modifiers::NONE);
        let thrice = vec![plain(Key::Plus), plain(Key::Plus), plain(Key::Plus)];
        assert_eq!(taken(thrice, &KEYBOARD, &context).0, [Command::Brighter; 3]);
        let dialog = vec![key(Key::P, Modifiers::COMMAND), plain(Key::M)];
        assert_eq!(taken(dialog, &KEYBOARD, &context), (vec![Command::Palette], false));
        let copied = vec![egui::Event::Copy, egui::Event::Text("c".to_owned())];
        assert_eq!(taken(copied, &KEYBOARD, &context).0, [Command::CopyPicture]);
    }

    #[test]
    fn a_control_with_the_keyboard_keeps_its_own_keys() {
        for (pressed, command) in [
            (Key::Space, Command::Pause),
            (Key::Tab, Command::Panels),
            (Key::ArrowRight, Command::NextRay),
            (Key::ArrowLeft, Command::PreviousRay),
            (Key::F, Command::Fit),
        ] {
            for is_focused in [false, true] {
                let context = egui::Context::default();
                if is_focused {
                    context.memory_mut(|memory| memory.request_focus(egui::Id::unique("a control")));
                }
                let expected = if is_focused && pressed != Key::F { vec![] } else { vec![command] };
                let found = taken(vec![key(pressed, Modifiers::NONE)], &KEYBOARD, &context).0;
                assert_eq!(found, expected, "{pressed:?}");
            }
        }
    }

    /// How far a camera, four units before what it looks at, flies in a frame while these keys are held.
    fn flown_in(seconds: f32, keys: &[(Key, Modifiers)], modifiers: Modifiers) -> Option<DVec3> {
        let context = egui::Context::default();
        let before = Camera { look_from: DVec3::new(0.0, 0.0, 4.0), look_at: DVec3::ZERO, ..Camera::BOOK };
        let mut camera = before;
        let mut has_moved = false;
        let mut events: Vec<egui::Event> = keys.iter().map(|(pressed, with)| key(*pressed, *with)).collect();
        events.push(egui::Event::ModifiersChanged(modifiers));
        for events in [events, Vec::new()] {
            let input = egui::RawInput { events, predicted_dt: seconds, ..egui::RawInput::default() };
            let _ = context.run_ui(input, |ui| {
                camera = before;
                has_moved = fly(ui.ctx(), &mut camera);
            });
        }
        assert_eq!(has_moved, camera != before);
        has_moved.then(|| camera.look_from - before.look_from)
    }

    fn flown(keys: &[(Key, Modifiers)], modifiers: Modifiers) -> Option<DVec3> {
        flown_in(0.04, keys, modifiers)
    }

    #[test]
    fn held_keys_fly_as_fast_as_the_scene_is_large() {
        let none = Modifiers::NONE;
        let step = flown(&[(Key::D, none)], none).unwrap();
        // Seven tenths of four units a second, in a frame of at most a twentieth.
        assert!(step.distance(DVec3::X * (0.7 * 4.0 * 0.04)) < 1e-6, "{step}");
        let long = flown_in(1.0, &[(Key::D, none)], none).unwrap();
        assert!(long.distance(DVec3::X * (0.7 * 4.0 * 0.05)) < 1e-6, "{long}");
        for (pressed, along) in [
            (Key::A, DVec3::NEG_X),
            (Key::E, DVec3::Y),
            (Key::Q, DVec3::NEG_Y),
            (Key::W, DVec3::NEG_Z),
            (Key::S, DVec3::Z),
        ] {
            let found = flown(&[(pressed, none)], none).unwrap();
            assert!(found.distance(along * step.x) < 1e-9, "{pressed:?}: {found}");
        }
        let fast = flown(&[(Key::D, none)], Modifiers::SHIFT).unwrap();
        assert!((fast.x / step.x - 4.0).abs() < 1e-9, "{fast}");
        assert_eq!(flown(&[(Key::A, none), (Key::D, none)], none), None);
        assert_eq!(flown(&[(Key::D, none)], Modifiers::COMMAND), None);
        assert_eq!(flown(&[(Key::D, none)], Modifiers::ALT), None);
        assert_eq!(flown(&[(Key::D, Modifiers::COMMAND)], none), None, "D is still held after Ctrl+D");
        assert_eq!(flown(&[(Key::F, none)], none), None);
    }
}
