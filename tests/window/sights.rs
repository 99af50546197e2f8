//! "Show me": each stage's thing to look for.

use crate::harness::{control, has_samples, open, open_sized, send, until};
use crate::questions::Ask as _;
use eframe::egui::{Key, Rect, pos2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use weekender::app::{Command, Show, Window};
use weekender::stages::{Means, Stage};

/// The part of the screen where the stage's part of the picture is.
fn seen(harness: &Harness<'_, Window>, stage: &Stage) -> Rect {
    let rect = harness.state().picture_rect();
    let [left, top, right, bottom] =
        stage.sight.part.unwrap_or([0.0, 0.0, 1.0, 1.0]).map(|share| share as f32);
    let at = |x: f32, y: f32| pos2(rect.left() + x * rect.width(), rect.top() + y * rect.height());
    Rect::from_min_max(at(left, top), at(right, bottom))
}

#[test]
fn every_stage_shows_what_to_look_for_and_escape_returns() {
    let mut harness = open_sized("--stage ppm-tiny", [1280.0, 800.0]);
    for stage in Stage::ALL {
        send(&mut harness, Command::Stage(stage));
        until(&mut harness, stage.id, has_samples(1));
        harness.run_steps(2);
        let before = (harness.state().picture_rect(), harness.state().show(), harness.state().is_comparing());
        harness.key_press(Key::H);
        harness.run_steps(4);
        assert!(harness.state().has_sight(), "{}", stage.id);
        assert!(harness.query_by_label(stage.sight.caption).is_some(), "{}", stage.id);
        let room = harness.get_by_label("Picture").rect();
        let part = seen(&harness, stage);
        assert!(room.expand(1.0).contains_rect(part), "{}: {part} in {room}", stage.id);
        let fills = (part.width() / room.width()).max(part.height() / room.height());
        assert!(fills > 0.95, "{}: {part} fills {fills} of {room}", stage.id);
        let (show, is_wipe) = match stage.sight.means {
            Means::Picture => (Show::Picture, false),
            Means::Albedo => (Show::Albedo, false),
            Means::RaysPerPath => (Show::Bounces, false),
            Means::StandardError => (Show::Error, false),
            Means::Luminance(_) => (Show::Luminance, false),
            Means::Wipe(_) => (Show::Picture, true),
        };
        assert_eq!((harness.state().show(), harness.state().is_comparing()), (show, is_wipe), "{}", stage.id);
        if let Means::Wipe(divider) = stage.sight.means {
            until(&mut harness, stage.id, |window| window.has_other_picture());
            harness.run_steps(20);
            assert_eq!(harness.state().divider(), divider, "{}", stage.id);
        }
        harness.key_press(Key::Escape);
        harness.run_steps(4);
        let after = (harness.state().picture_rect(), harness.state().show(), harness.state().is_comparing());
        assert_eq!((after, harness.state().has_sight()), (before, false), "{}", stage.id);
    }
}

#[test]
fn a_sight_ends_with_its_stage_and_with_its_view() {
    let mut harness = open("--stage glass-refract");
    until(&mut harness, "a picture", has_samples(1));
    let fitting = harness.state().picture_rect();
    control(&harness, "Show me").click();
    harness.run_steps(4);
    assert!(harness.state().has_sight() && harness.state().is_comparing());
    assert!(harness.state().picture_rect().width() > 1.5 * fitting.width());
    harness.key_press(Key::PageDown);
    harness.run_steps(4);
    assert_eq!(harness.state().shown_document().stage().unwrap().id, "glass-tir");
    assert!(!harness.state().has_sight() && !harness.state().is_comparing());
    assert_eq!(harness.state().picture_rect(), fitting, "the next stage is seen whole");
    // Who chooses another view keeps it, and Escape then leaves that.
    send(&mut harness, Command::ShowMe);
    send(&mut harness, Command::Show(Show::Error));
    harness.run_steps(4);
    assert_eq!((harness.state().has_sight(), harness.state().show()), (false, Show::Error));
    harness.key_press(Key::Escape);
    harness.run_steps(4);
    assert_eq!(harness.state().show(), Show::Picture);
}
