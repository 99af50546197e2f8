//! Tests of the bar at the top.

use super::*;
use crate::app::tests::{Drawings, alone, dressed, facts_of};
use crate::progressive::{EndReason, Phase, Status, Stop};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use std::sync::Arc;

struct Bar {
    facts: Facts,
    thumbnails: Thumbnails,
    commands: Vec<Command>,
}

fn bar(words: &str, width: f32) -> Harness<'static, Bar> {
    let bar = Bar { facts: facts_of(words), thumbnails: Thumbnails::default(), commands: Vec::new() };
    let draw = |ui: &mut Ui, Bar { facts, thumbnails, commands }: &mut Bar| {
        super::ui(ui, thumbnails, facts, commands);
    };
    dressed([width, 900.0]).build_ui_state(draw, bar)
}

fn set(harness: &mut Harness<'_, Bar>, phase: Phase) {
    let status = Status { phase, samples_per_pixel: 100, ..Status::default() };
    harness.state_mut().facts.status = Arc::new(status);
}

#[test]
fn what_has_no_room_gives_way() {
    alone("title_bar::tests::what_has_no_room_gives_way", || {
        let mut drawings = Drawings::default();
        for width in [1500.0, 1280.0, 1180.0, 1100.0, 1000.0, 900.0, 640.0, 520.0, 400.0, 200.0] {
            let mut harness = bar("--stage glass-schlick --size 32x18", width);
            harness.state_mut().facts.model.document.stop = Stop::at_samples(100);
            for (name, phase) in [("tracing", Phase::Tracing), ("done", Phase::Done(EndReason::Samples))] {
                set(&mut harness, phase);
                harness.run_steps(2);
                drawings.add(&format!("{width} {name}"), &harness);
            }
        }
        drawings.keep("title_bar_widths");
    });
}

#[test]
fn the_bar_says_what_is_shown_and_what_can_be_done() {
    alone("title_bar::tests::the_bar_says_what_is_shown_and_what_can_be_done", || {
        let mut drawings = Drawings::default();
        let mut harness = bar("--stage glass-schlick --size 32x18", 1280.0);
        drawings.add("idle", &harness);
        for (name, phase) in [
            ("failed", Phase::Failed("no".to_owned())),
            ("stopped", Phase::Done(EndReason::Stopped)),
            ("paused", Phase::Paused),
        ] {
            harness.state_mut().facts.model.is_paused = name == "paused";
            set(&mut harness, phase);
            harness.run_steps(2);
            drawings.add(name, &harness);
        }
        for words in ["--stage ppm-tiny", "--stage book", "--scene three-spheres", "--scene field:20"] {
            harness.state_mut().facts.model.document = facts_of(words).model.document;
            harness.run_steps(2);
            drawings.add(words, &harness);
        }
        for (width, phase) in [(1280.0, Phase::Done(EndReason::Samples)), (900.0, Phase::Tracing)] {
            let mut harness = bar("--stage ppm-tiny", width);
            set(&mut harness, phase);
            harness.run_steps(2);
            drawings.add("before tips", &harness);
            drawings.add_tips(&mut harness);
        }
        drawings.keep("title_bar_states");
    });
}

#[test]
fn buttons_give_their_commands() {
    alone("title_bar::tests::buttons_give_their_commands", || {
        let mut harness = bar("--stage glass-schlick --size 32x18", 1500.0);
        set(&mut harness, Phase::Tracing);
        harness.state_mut().facts.model.document.stop = Stop::at_samples(100);
        let mut press = |name: &str| {
            harness.run_steps(2);
            harness.get_by_label(name).click();
            harness.run_steps(2);
            let commands = std::mem::take(&mut harness.state_mut().commands);
            set(&mut harness, Phase::Done(EndReason::Samples));
            commands
        };
        assert_eq!(press("Pause"), [Command::Pause]);
        assert_eq!(press("Go on to 200 spp"), [Command::GoOn]);
        assert_eq!(press("Save"), [Command::Save(OutputFormat::Png)]);
        for command in [Command::PreviousStage, Command::NextStage, Command::Device(Device::Reference)] {
            assert_eq!(press(&command.name()), [command]);
        }
    });
}

/// With these widths, everything but the stage takes 497 points; without words on until when, 366; with a menu of
/// devices, 226.
#[test]
fn the_stage_gives_way_first_then_the_words_and_then_the_devices() {
    let widths = Widths { menus: 1e6, steps: 40.0, go_on: 120.0, devices: 200.0, device: 60.0, save: 40.0 };
    for (room, least, expected) in [
        (900.0, LEAST_STAGE, Some((284.0, true, true))),
        (781.0, LEAST_STAGE, Some((284.0, true, true))),
        (780.5, LEAST_STAGE, Some((283.0, true, true))),
        (717.0, LEAST_STAGE, Some((220.0, true, true))),
        (716.5, LEAST_STAGE, Some((284.0, false, true))),
        (516.0, LEAST_STAGE, Some((150.0, false, true))),
        (515.5, LEAST_STAGE, Some((284.0, false, false))),
        (376.0, LEAST_STAGE, Some((150.0, false, false))),
        (375.5, LEAST_STAGE, None),
        (375.5, 0.0, Some((9.0, false, true))),
        (366.0, 0.0, Some((0.0, false, true))),
        (365.5, 0.0, Some((139.0, false, false))),
        (226.0, 0.0, Some((0.0, false, false))),
        (225.5, 0.0, None),
        (747.0, 250.0, Some((250.0, true, true))),
        (746.5, 250.0, Some((284.0, false, true))),
    ] {
        let expected = expected.map(|(stage, says_until_when, has_all_devices)| Fit {
            stage,
            says_until_when,
            has_all_devices,
        });
        assert_eq!(widths.fit(room, least), expected, "{room} points");
    }
}

#[test]
fn a_render_that_has_ended_can_go_on_but_not_pause() {
    alone("title_bar::tests::a_render_that_has_ended_can_go_on_but_not_pause", || {
        let mut harness = bar("--stage glass-schlick --size 32x18", 1500.0);
        harness.state_mut().facts.model.document.stop = Stop::at_samples(100);
        for (phase, is_paused, expected) in [
            (Phase::Idle, false, [Some(false), None]),
            (Phase::Preparing, false, [Some(true), None]),
            (Phase::Tracing, false, [Some(true), None]),
            (Phase::Paused, true, [None, Some(true)]),
            (Phase::Done(EndReason::Samples), true, [None, Some(true)]),
            (Phase::Done(EndReason::Samples), false, [Some(false), None]),
            (Phase::Failed("no memory".to_owned()), false, [Some(false), None]),
        ] {
            let told = format!("{phase:?}, paused: {is_paused}");
            harness.state_mut().facts.model.is_paused = is_paused;
            set(&mut harness, phase);
            harness.run_steps(2);
            let is_enabled =
                |name: &str| harness.query_by_label(name).map(|node| !node.accesskit_node().is_disabled());
            assert_eq!([is_enabled("Pause"), is_enabled("Go on")], expected, "{told}");
        }
    });
}
