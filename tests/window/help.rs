//! The dialog that lists keys and mouse actions.

use crate::common::{SMALL, open_sized, send};
use eframe::egui::Role;
use egui_kittest::kittest::Queryable;
use weekender::app::{Command, SlotCommand};

/// In two columns, and in one where the window is narrow.
#[test]
fn the_help_lists_every_key_at_every_width() {
    for size in [[1280.0, 800.0], [500.0, 700.0]] {
        let mut harness = open_sized(SMALL, size);
        send(&mut harness, Command::Help);
        harness.run_steps(5);
        let listed: Vec<String> =
            harness.get_all_by_role(Role::Label).filter_map(|node| node.value()).collect();
        assert!(listed.iter().any(|text| text == "Mouse and flying"), "{size:?}: {listed:?}");
        for command in Command::all().into_iter().filter(|command| command.shortcut().is_some()) {
            // The nine slots share a line.
            if matches!(command, Command::Slot(SlotCommand::Look(_) | SlotCommand::KeepIn(_))) {
                continue;
            }
            let name = command.name();
            let name = name.trim_end_matches('…');
            assert!(listed.iter().any(|text| text == name), "{size:?}: no {name} in {listed:?}");
        }
    }
}
