//! The top bar at every width: nothing covers anything, and what has no room gives way.

use crate::common::{SMALL, control, has_samples, open_sized, send, until};
use eframe::egui::{Rect, Role, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use weekender::app::{Command, SlotCommand, SlotNumber, Window};
use weekender::progressive::{Phase, Stop};
use weekender::stages::Stage;

fn is_done(window: &Window) -> bool {
    matches!(window.status().phase, Phase::Done(_)) && has_samples(1)(window)
}

/// Everything in the bar that can be clicked, with its name.
fn bar(harness: &Harness<'_, Window>) -> Vec<(String, Rect)> {
    let bottom = harness.get_by_label("Picture").rect().top();
    let buttons = harness.get_all_by_role(Role::Button).filter(|node| node.rect().bottom() <= bottom);
    let mut bar: Vec<(String, Rect)> =
        buttons.map(|node| (node.accesskit_node().label().unwrap_or_default(), node.rect())).collect();
    bar.retain(|(_, rect)| rect.left() > 0.0 || rect.width() > 0.0);
    bar
}

/// Nothing is covered or outside of the window; returns the names.
fn assert_apart(harness: &Harness<'_, Window>, width: f32, what: &str) -> Vec<String> {
    let bar = bar(harness);
    for (index, (name, rect)) in bar.iter().enumerate() {
        assert!(rect.left() >= 0.0 && rect.right() <= width, "{width}, {what}: {name} at {rect}");
        for (other, covered) in &bar[..index] {
            let both = rect.intersect(*covered);
            assert!(both.width() < 0.5 || both.height() < 0.5, "{width}, {what}: {name} covers {other}");
        }
    }
    bar.into_iter().map(|(name, _)| name).collect()
}

fn longest() -> &'static Stage {
    Stage::ALL.iter().max_by_key(|stage| stage.section.len() + stage.title.len()).unwrap()
}

fn widths() -> impl Iterator<Item = f32> {
    (480..1400_u16).step_by(40).chain([899, 900, 1024, 1280, 1600, 1920, 2560]).map(f32::from)
}

#[test]
fn nothing_in_the_bar_covers_anything_at_any_width() {
    let mut harness = open_sized(&format!("{SMALL} --samples 1000000000"), [1280.0, 800.0]);
    until(&mut harness, "a picture", has_samples(1));
    let mut bars = Vec::new();
    for what in ["working", "done", "a long name", "with slots"] {
        match what {
            "done" => harness.state_mut().document_mut().stop = Stop::at_samples(1),
            "a long name" => send(&mut harness, Command::Stage(longest())),
            "with slots" => send(&mut harness, Command::Slot(SlotCommand::Keep)),
            _ => {}
        }
        harness.run_steps(2);
        if what == "with slots" {
            until(&mut harness, "a slot", |window| window.slot(SlotNumber::ALL[0]).is_some());
        } else if what != "working" {
            harness.state_mut().document_mut().give_size([32, 18]);
            harness.state_mut().document_mut().stop = Stop::at_samples(1);
            until(&mut harness, "the end", is_done);
        }
        for width in widths() {
            harness.set_size(vec2(width, 700.0));
            harness.run_steps(4);
            let names = assert_apart(&harness, width, what);
            for wanted in ["File", "Help", "Choose a stage", "Previous stage", "Next stage", "Save"] {
                assert!(names.iter().any(|name| name == wanted), "{width}, {what}: no {wanted} in {names:?}");
            }
            let can_go_on = names.iter().any(|name| name.starts_with("Go on"));
            let can_pause = names.iter().any(|name| name == "Pause");
            assert!(if what == "working" { can_pause } else { can_go_on }, "{width}, {what}: {names:?}");
            bars.push((what, width as u32, names.len()));
        }
    }
    // In a wide window each device has its button.
    let of_wide = bars.iter().filter(|(_, width, _)| *width >= 1280).map(|(.., count)| *count).min();
    assert!(of_wide.unwrap() >= 10 + 3 + 4 + 2, "{bars:?}");
}

/// The arrows stay where they are when a render ends, so that they can be clicked again and again.
#[test]
fn the_arrows_stay_when_a_render_ends() {
    for width in [1024.0, 1280.0, 1440.0] {
        let mut harness = open_sized(&format!("{SMALL} --samples 1000000000"), [width, 700.0]);
        until(&mut harness, "a picture", has_samples(1));
        harness.run_steps(3);
        let places = |harness: &Harness<'_, Window>| {
            ["Previous stage", "Choose a stage", "Next stage"].map(|name| control(harness, name).rect())
        };
        let before = places(&harness);
        harness.state_mut().document_mut().stop = Stop::at_samples(1);
        until(&mut harness, "the end", is_done);
        harness.run_steps(3);
        assert_eq!(places(&harness), before, "{width}");
    }
}

/// Where devices have no room, they are in a menu.
#[test]
fn devices_fold_into_a_menu() {
    let mut harness = open_sized(SMALL, [960.0, 700.0]);
    until(&mut harness, "a picture", has_samples(1));
    harness.run_steps(3);
    control(&harness, "Choose a device").click();
    harness.run_steps(5);
    let reference = Command::Device(weekender::app::Device::Reference).name();
    control(&harness, &reference).click();
    harness.run_steps(5);
    assert_eq!(harness.state_mut().remembered_mut().device, weekender::app::Device::Reference);
}
