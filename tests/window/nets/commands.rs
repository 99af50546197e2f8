//! Every command from two states: what it changes, and that undo returns to what was there.

use super::golden::{Golden, changes};
use super::{Harnessed, busy, done, finished, give, known, open, without_divider};
use eframe::egui::{self, OutputCommand};
use weekender::app::Command;

/// Carries out a command and returns what is sent out of the window meanwhile.
fn carry_out(harness: &mut Harnessed, command: Command) -> String {
    harness.state_mut().send(command);
    let mut sent = String::new();
    for _ in 0..5 {
        harness.step();
        let output = harness.output();
        for command in &output.platform_output.commands {
            sent += &match command {
                OutputCommand::CopyText(text) => format!("copies {:?}\n", text.lines().next()),
                OutputCommand::CopyImage(image) => format!("copies {:?}\n", image.size),
                other => format!("{other:?}\n"),
            };
        }
        for viewport in output.viewport_output.values() {
            for command in &viewport.commands {
                if !matches!(command, egui::ViewportCommand::SetTheme(_)) {
                    sent += &format!("{command:?}\n");
                }
            }
        }
    }
    sent
}

fn walk(file: &str, limit: usize, new: impl Fn() -> Harnessed, is_wanted: impl Fn(Command) -> bool) {
    let mut golden = Golden::open(file);
    let before = without_divider(&known(&mut new()));
    for command in Command::all().into_iter().filter(|command| is_wanted(*command)) {
        let mut harness = new();
        let reason = harness.state().disabled_reason(command);
        let sent = carry_out(&mut harness, command);
        let of_place = matches!(command, Command::Stage(_) | Command::Extreme(_));
        let limit = if of_place { 6 } else { limit };
        golden.expect(&format!("{command:?}"), || {
            let changed = changes(&before, &without_divider(&known(&mut harness)), limit);
            let reason = reason.iter().map(|reason| format!("disabled: {reason}\n")).collect::<String>();
            format!("{reason}{sent}{changed}")
        });
        undo_and_redo(&mut harness, &document(&before), command);
    }
    golden.finish();
}

/// Undo returns to the document from before a command, and redo to that after it.
fn undo_and_redo(harness: &mut Harnessed, before: &str, command: Command) {
    let is_history = matches!(command, Command::Undo | Command::Redo);
    // Another picture than in the book's size may have come back with its own.
    if is_history || harness.state().disabled_reason(Command::Undo).is_some() {
        return;
    }
    if matches!(command, Command::ViewFrom(_) | Command::FlyBookmarks) {
        // A flight takes its time.
        harness.run_steps(40);
    }
    let after = document(&known(harness));
    if after == before {
        return;
    }
    carry_out(harness, Command::Undo);
    assert_eq!(changes(before, &document(&known(harness)), 20), "", "{command:?}: undo");
    carry_out(harness, Command::Redo);
    assert_eq!(changes(&after, &document(&known(harness)), 20), "", "{command:?}: redo");
}

/// What belongs to the document, as undo restores it.
fn document(known: &str) -> String {
    let is_documents = |line: &&str| line.starts_with("model.document");
    known.lines().filter(is_documents).fold(String::new(), |all, line| all + line + "\n")
}

fn is_tried(command: Command) -> bool {
    match command {
        // Their names depend on the machine.
        Command::Device(_) | Command::SwitchDevice => false,
        Command::Stage(stage) => ["book", "metal", "ppm-tiny"].contains(&stage.id),
        Command::Extreme(case) => std::ptr::eq(case, first_case()),
        _ => true,
    }
}

fn first_case() -> &'static weekender::stress::Case {
    let mut cases = Command::all().into_iter().filter_map(|command| match command {
        Command::Extreme(case) => Some(case),
        _ => None,
    });
    cases.next().unwrap()
}

#[test]
#[ignore = "for an idle machine: it waits until the window is at rest"]
fn commands_change_what_is_stored() {
    walk("commands.txt", 14, || finished("glass-schlick"), is_tried);
}

#[test]
#[ignore = "for an idle machine: it waits until the window is at rest"]
fn commands_in_a_busy_window_change_what_is_stored() {
    let is_other = |command| is_tried(command) && !matches!(command, Command::Stage(_) | Command::Extreme(_));
    let zoomed = || {
        let mut harness = busy();
        give(&mut harness, Command::ZoomIn);
        give(&mut harness, Command::Brighter);
        harness
    };
    walk("busy_commands.txt", 14, zoomed, is_other);
}

#[test]
#[ignore = "for an idle machine: it waits until the window is at rest"]
fn commands_about_a_picture_that_follows_a_size_change_what_is_stored() {
    let following = || {
        let mut harness = done(open("--stage metal --samples 4 --isa portable --threads 1"));
        harness.state_mut().document_mut().camera.vfov_degrees = 25.0;
        harness.run_steps(2);
        done(harness)
    };
    let is_about_size =
        |command| matches!(command, Command::ResetAll | Command::Undo | Command::Home | Command::NextStage);
    walk("following_commands.txt", 14, following, is_about_size);
}
