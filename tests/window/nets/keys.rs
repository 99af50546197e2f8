//! What every key does, in several states.

use super::golden::{Golden, changes};
use super::{Harnessed, busy, finished, give, known, press};
use eframe::egui::{Key, Modifiers};
use weekender::app::{Command, SlotCommand, SlotNumber};

fn keys() -> Vec<Key> {
    // Each of them opens a file dialog of the system, or only gives the command of its letter.
    Key::ALL.iter().copied().filter(|key| !matches!(key, Key::Copy | Key::Cut | Key::Paste)).collect()
}

/// The command that a key gives, or what it changes.
fn done(harness: &mut Harnessed, before: &str, key: Key, modifiers: Modifiers) -> String {
    press(harness, key, modifiers);
    match harness.state().performed() {
        Some(command) => format!("{command:?}\n"),
        None => changes(before, &known(harness), 4),
    }
}

#[test]
#[ignore = "for an idle machine: it waits until the window is at rest"]
fn keys_do_what_is_stored() {
    let mut golden = Golden::open("keys.txt");
    for (held, modifiers) in [
        ("plain", Modifiers::NONE),
        ("Shift", Modifiers::SHIFT),
        ("Ctrl", Modifiers::COMMAND),
        ("Ctrl+Shift", Modifiers::COMMAND | Modifiers::SHIFT),
        ("Alt", Modifiers::ALT),
        ("Shift+Alt", Modifiers::SHIFT | Modifiers::ALT),
    ] {
        let mut all = String::new();
        let mut harness = finished("defocus");
        let before = known(&mut harness);
        for key in keys() {
            let what = done(&mut harness, &before, key, modifiers);
            if !what.is_empty() {
                all += &format!("{key:?}: {what}");
                harness = finished("defocus");
            }
        }
        golden.expect(held, || all.clone());
    }
    golden.finish();
}

/// Escape leaves one thing after the other.
#[test]
#[ignore = "for an idle machine: it waits until the window is at rest"]
fn escape_leaves_what_is_stored() {
    let mut golden = Golden::open("escape.txt");
    let slot = SlotNumber::ALL[0];
    let ways: [(&str, &[Command]); 6] = [
        ("nothing", &[]),
        ("a crop and a wipe", &[Command::Wipe, Command::Crop]),
        ("a slot in a presentation", &[Command::Present, Command::Slot(SlotCommand::Look(slot))]),
        ("the first steps and a sight", &[Command::ShowMe, Command::FirstSteps]),
        ("full screen and a view", &[Command::FullScreen, Command::Slot(SlotCommand::Difference)]),
        ("a finding", &[Command::Slot(SlotCommand::OnlyNoise)]),
    ];
    for (title, commands) in ways {
        let mut harness = busy();
        for command in commands {
            give(&mut harness, *command);
        }
        harness.run_steps(6);
        let mut all = String::new();
        for _ in 0..6 {
            press(&mut harness, Key::Escape, Modifiers::NONE);
            all += &format!("{:?}\n", harness.state().performed());
        }
        golden.expect(title, || all.clone());
    }
    golden.finish();
}
