//! Tips stand beside what they explain and never cover the next control.

use crate::common::{SMALL, control, has_samples, open_sized, send, until};
use eframe::egui::{Key, Pos2, Rect, Role, pos2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use weekender::app::{Command, SlotCommand, SlotNumber, Window};
use weekender::stages::Stage;

/// Wide, narrow, and so narrow that the list leaves less room than a tip usually takes.
const SIZES: [[f32; 2]; 3] = [[1280.0, 800.0], [800.0, 600.0], [640.0, 400.0]];

/// Around the text of a tip, points.
const MARGIN: f32 = 6.0;

/// The tip that is shown while the pointer rests at this point.
fn tip_at(harness: &mut Harness<'_, Window>, at: Pos2) -> Option<Rect> {
    harness.hover_at(at);
    harness.run_steps(60);
    let tip = harness.query_all_by_role(Role::Tooltip).next()?;
    let text = tip.children_recursive().find(|node| node.accesskit_node().role() == Role::Label)?;
    Some(text.rect().expand(MARGIN))
}

/// The rows of the open list that are seen, and the tip of each.
fn rows(harness: &mut Harness<'_, Window>, size: [f32; 2]) -> Vec<(Rect, Rect)> {
    let mut rows = Vec::new();
    for stage in Stage::ALL {
        let name = Command::Stage(stage).name();
        let nodes =
            harness.get_all_by_label(&name).filter(|node| node.accesskit_node().role() == Role::Button);
        let Some(row) = nodes.map(|node| node.rect()).find(|rect| rect.height() > 40.0) else { continue };
        let is_seen = row.top() > 100.0 && row.bottom() < size[1] - 60.0;
        if let Some(tip) = tip_at(harness, row.center()).filter(|_| is_seen) {
            rows.push((row, tip));
        }
    }
    rows
}

fn assert_beside(rows: &[(Rect, Rect)], size: [f32; 2]) {
    assert!(rows.len() > 1, "{size:?}: {} tips", rows.len());
    let window = Rect::from_min_max(Pos2::ZERO, pos2(size[0], size[1]));
    for (_, tip) in rows {
        assert!(tip.is_positive() && window.contains_rect(*tip), "{size:?}: {tip}");
        for (row, _) in rows {
            assert!(!tip.intersects(*row), "{size:?}: the tip {tip} covers the row {row}");
        }
    }
}

#[test]
fn tips_of_the_list_of_stages_cover_no_row() {
    for size in SIZES {
        let mut harness = open_sized(SMALL, size);
        until(&mut harness, "a picture", has_samples(1));
        send(&mut harness, Command::Stages);
        harness.run_steps(10);
        let rows = rows(&mut harness, size);
        assert_beside(&rows, size);
    }
}

/// The menu is left of the middle, and a long list of commands precedes the rows.
#[test]
fn tips_of_the_stage_menu_cover_no_row() {
    let size = SIZES[0];
    let mut harness = open_sized(SMALL, size);
    until(&mut harness, "a picture", has_samples(1));
    control(&harness, "Stage").click();
    harness.run_steps(10);
    let rows = rows(&mut harness, size);
    assert_beside(&rows, size);
}

#[test]
fn tips_of_slots_cover_no_other_control_of_the_strip() {
    for size in &SIZES[..2] {
        let mut harness = open_sized(&format!("{SMALL} --samples 2"), *size);
        until(&mut harness, "a picture", has_samples(2));
        let slot = SlotNumber::ALL[0];
        send(&mut harness, Command::Slot(SlotCommand::Keep));
        until(&mut harness, "a kept picture", |window| window.slot(slot).is_some());
        harness.run_steps(10);
        let names = [
            "Live",
            "Keep",
            "Flip",
            "Slot 1",
            "Name of slot 1",
            "Wipe against the slot 1",
            "More about slot 1",
        ];
        let rects = names.map(|name| control(&harness, name).rect());
        for (name, rect) in names.iter().zip(rects) {
            let tip = tip_at(&mut harness, rect.center());
            let tip = tip.unwrap_or_else(|| panic!("{size:?}: no tip of {name}"));
            for (other, covered) in names.iter().zip(rects) {
                assert!(!tip.intersects(covered), "{size:?}: the tip of {name} covers {other}");
            }
        }
    }
}

#[test]
fn tips_of_the_title_bar_cover_none_of_its_controls() {
    for size in SIZES {
        let mut harness = open_sized(SMALL, size);
        until(&mut harness, "a picture", has_samples(1));
        harness.run_steps(5);
        let names = ["Previous stage", "Choose a stage", "Next stage", "Save"];
        let rects = names.map(|name| control(&harness, name).rect());
        for (name, rect) in names.iter().zip(rects) {
            let tip = tip_at(&mut harness, rect.center());
            let tip = tip.unwrap_or_else(|| panic!("{size:?}: no tip of {name}"));
            for (other, covered) in names.iter().zip(rects) {
                assert!(!tip.intersects(covered), "{size:?}: the tip of {name} covers {other}");
            }
        }
    }
}

#[test]
fn a_dialog_covers_the_tips_of_what_is_behind_it() {
    let mut harness = open_sized(SMALL, SIZES[0]);
    until(&mut harness, "a picture", has_samples(1));
    harness.run_steps(5);
    let button = control(&harness, "Previous stage").rect().center();
    for command in [Command::Help, Command::Palette, Command::Open] {
        assert!(tip_at(&mut harness, button).is_some());
        harness.state_mut().send(command);
        for _ in 0..60 {
            harness.step();
            assert!(harness.query_all_by_role(Role::Tooltip).next().is_none(), "{command:?}");
        }
        assert!(harness.state().has_dialog());
        harness.key_press(Key::Escape);
        harness.run_steps(5);
        assert!(!harness.state().has_dialog());
        harness.hover_at(pos2(5.0, 5.0));
        harness.run_steps(5);
    }
}
