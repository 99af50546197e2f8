//! Every command, by menu, key and palette.

use crate::common::{SMALL, control, open, send};
use eframe::egui::{Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use weekender::app::{Command, SlotCommand, Window};

/// Gives a command. Returns whether it was enabled or says why not.
fn is_done_or_refused(harness: &mut Harness<'_, Window>, command: Command) -> bool {
    let before = harness.state().disabled_reason(command);
    harness.state_mut().send(command);
    harness.step();
    assert_eq!(harness.state().performed(), Some(command));
    let (told, after) = (harness.state().messages(), harness.state().disabled_reason(command));
    before
        .filter(|_| after.is_some())
        .is_none_or(|reason| told.iter().any(|text| text.ends_with(&reason[1..])))
}

#[test]
fn every_command_is_carried_out_or_says_why_not() {
    let mut harness = open(SMALL);
    for command in Command::all() {
        // A picture that an earlier command has asked for may come in that very frame, and be used up by the command.
        let is_told = (0..3).any(|_| is_done_or_refused(&mut harness, command));
        let (reason, told) = (harness.state().disabled_reason(command), harness.state().messages());
        assert!(is_told, "{command:?}: {reason:?}; {told:?}");
        harness.step();
        harness.key_press(Key::Escape);
        harness.run_steps(2);
        assert!(!harness.state().has_dialog(), "{command:?}");
    }
}

#[test]
fn every_shortcut_reaches_its_command() {
    let mut harness = open(SMALL);
    for command in Command::all() {
        let Some(shortcut) = command.shortcut() else { continue };
        harness.key_press_modifiers(shortcut.modifiers, shortcut.logical_key);
        harness.run_steps(2);
        assert_eq!(harness.state().performed(), Some(command), "{shortcut:?}");
        harness.key_press(Key::Escape);
        harness.run_steps(2);
    }
}

#[test]
fn every_command_is_found_in_the_palette() {
    let mut harness = open(SMALL);
    for command in Command::all() {
        let is_useless = harness.state().disabled_reason(command).is_some();
        if command == Command::Palette || is_useless {
            continue;
        }
        harness.key_press_modifiers(Modifiers::COMMAND, Key::P);
        harness.run_steps(3);
        harness.get_by_label("Command").type_text(&command.name());
        harness.run_steps(2);
        harness.key_press(Key::Enter);
        harness.run_steps(2);
        assert_eq!(harness.state().performed(), Some(command));
        harness.key_press(Key::Escape);
        harness.run_steps(2);
    }
}

#[test]
fn every_menu_lists_its_commands() {
    let mut harness = open(SMALL);
    for menu in ["File", "Edit", "Camera", "Spheres", "View", "Slots", "Render", "Extreme scenes", "Help"] {
        control(&harness, menu).click();
        harness.run_steps(3);
        for command in Command::all().into_iter().filter(|command| command.group().name() == menu) {
            // Only slots in use are listed; see slots.rs.
            if matches!(command, Command::Slot(SlotCommand::Look(_) | SlotCommand::KeepIn(_))) {
                continue;
            }
            let name = command.name();
            assert!(harness.query_all_by_label_contains(&name).next().is_some(), "{menu}: {name}");
        }
        harness.key_press(Key::Escape);
        harness.run_steps(3);
    }
}

#[test]
fn escape_leaves_a_control_before_tab_hides_the_panels() {
    let mut harness = open(SMALL);
    control(&harness, "Seed").focus();
    harness.run_steps(2);
    harness.key_press(Key::Tab);
    harness.run_steps(2);
    assert!(harness.state_mut().remembered_mut().has_panels, "Tab goes to the next control");
    send(&mut harness, Command::FullScreen);
    harness.key_press(Key::Escape);
    harness.run_steps(2);
    assert_eq!(harness.state().performed(), Some(Command::FullScreen));
    assert!(harness.state().is_full_screen(), "the first Escape leaves the control");
    harness.key_press(Key::Escape);
    harness.run_steps(2);
    assert!(!harness.state().is_full_screen());
    harness.key_press(Key::Tab);
    harness.run_steps(2);
    assert!(!harness.state_mut().remembered_mut().has_panels);
}

#[test]
fn changes_are_taken_back_and_made_again_one_by_one() {
    let mut harness = open(SMALL);
    let angle = |harness: &Harness<'_, Window>| harness.state().document().camera.vfov_degrees;
    let first = angle(&harness);
    let angles = [first, 33.0, 44.0, 55.0];
    for degrees in &angles[1..] {
        harness.run_steps(90);
        harness.state_mut().document_mut().camera.vfov_degrees = *degrees;
        harness.run_steps(2);
    }
    for degrees in angles.iter().rev().skip(1) {
        send(&mut harness, Command::Undo);
        assert_eq!(angle(&harness), *degrees, "taken back");
    }
    assert!(harness.state().disabled_reason(Command::Undo).is_some());
    for degrees in &angles[1..] {
        harness.run_steps(90);
        send(&mut harness, Command::Redo);
        assert_eq!(angle(&harness), *degrees, "made again");
    }
    assert!(harness.state().disabled_reason(Command::Redo).is_some());
    send(&mut harness, Command::Undo);
    harness.state_mut().document_mut().camera.vfov_degrees = 66.0;
    harness.run_steps(2);
    assert!(
        harness.state().disabled_reason(Command::Redo).is_some(),
        "a change ends what could be made again"
    );
    send(&mut harness, Command::Undo);
    assert_eq!(angle(&harness), 44.0);
}
