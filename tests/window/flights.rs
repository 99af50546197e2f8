//! Bookmarks, and flights to and along them.

use crate::common::{control, has_samples, hold, middle, name_file, open, send, until};
use eframe::egui::{Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use glam::DVec3;
use weekender::app::{Command, Window};
use weekender::cli::{self, Request};
use weekender::scene::Camera;

fn camera(harness: &Harness<'_, Window>) -> Camera {
    harness.state().document().camera
}

/// Eyes of three bookmarks; the last one is where the camera is.
const EYES: [DVec3; 3] = [DVec3::new(-2.0, 2.0, 1.0), DVec3::new(3.0, 1.0, 2.0), DVec3::new(4.0, 2.0, -3.0)];

/// A window with three bookmarks that are called "12.2 view 1" and so on.
fn bookmarked() -> Harness<'static, Window> {
    let mut harness = open("--stage view-distant --size 64x36");
    until(&mut harness, "a picture", has_samples(1));
    for eye in EYES {
        harness.state_mut().document_mut().camera.look_from = eye;
        harness.run_steps(2);
        send(&mut harness, Command::AddBookmark);
    }
    // Undo returns only to states that have lasted for a moment.
    harness.run_steps(90);
    harness
}

fn names(harness: &mut Harness<'_, Window>) -> Vec<String> {
    harness.state_mut().remembered_mut().bookmarks.iter().map(|bookmark| bookmark.name.clone()).collect()
}

#[test]
fn a_bookmark_is_flown_to_in_one_undo_step() {
    let mut harness = bookmarked();
    let start = camera(&harness);
    let target = Camera { look_from: EYES[0], ..start };
    let eye = |harness: &Harness<'_, Window>| camera(harness).look_from;
    harness.get_by_label("Go to 12.2 view 1").click();
    harness.run_steps(3);
    let (begin, whole) = (eye(&harness), start.look_from.distance(EYES[0]));
    assert!(begin.distance(start.look_from) < 0.1 * whole, "it begins slowly");
    let mut farthest: f64 = 0.0;
    let mut before = begin;
    for _ in 0..31 {
        harness.step();
        farthest = farthest.max(before.distance(eye(&harness)));
        before = eye(&harness);
    }
    assert_ne!(camera(&harness), target, "it takes more than half a second");
    assert!(farthest < 0.25 * whole, "a step of {farthest} of {whole}");
    until(&mut harness, "a preview or the picture", |window| window.shown().is_some());
    harness.run_steps(10);
    assert_eq!(camera(&harness), target, "to the bit");
    until(&mut harness, "the picture at full size", has_samples(1));
    send(&mut harness, Command::Undo);
    assert_eq!(camera(&harness), start, "one step");
    harness.run_steps(60);
    assert_eq!(camera(&harness), start, "the flight is over");
}

#[test]
fn a_path_through_what_it_looks_at_is_told_of() {
    let mut harness = open("--stage view-distant --size 64x36");
    until(&mut harness, "a picture", has_samples(1));
    let Camera { look_from, look_at, .. } = camera(&harness);
    for eye in [look_from, look_at * 2.0 - look_from] {
        harness.state_mut().document_mut().camera.look_from = eye;
        harness.run_steps(2);
        send(&mut harness, Command::AddBookmark);
    }
    send(&mut harness, Command::FlyBookmarks);
    let told = harness.state().messages();
    let part = "of the path cannot be rendered";
    let words = told.iter().find(|text| text.contains(part)).unwrap_or_else(|| panic!("{told:?}"));
    assert!(words.starts_with("Frame 30 ") && words.ends_with("add a bookmark before it"), "{words}");
}

#[test]
fn any_input_ends_a_flight_where_it_is() {
    for is_key in [true, false] {
        let mut harness = bookmarked();
        let start = camera(&harness);
        send(&mut harness, Command::Bookmark(0));
        harness.run_steps(15);
        let halfway = camera(&harness);
        assert_ne!(halfway, start);
        let at = middle(&harness);
        if is_key {
            harness.key_press(Key::F7);
        } else {
            hold(&mut harness, at, true);
        }
        harness.step();
        let stopped = camera(&harness);
        harness.run_steps(60);
        assert_eq!(camera(&harness), stopped, "it stays");
        assert_ne!(stopped.look_from, EYES[0]);
        if !is_key {
            hold(&mut harness, at, false);
        }
        send(&mut harness, Command::Undo);
        assert_eq!(camera(&harness), start);
    }
}

#[test]
fn a_camera_that_is_set_during_a_flight_stays() {
    let mut harness = bookmarked();
    send(&mut harness, Command::Bookmark(0));
    harness.run_steps(15);
    let mut mine = camera(&harness);
    mine.vfov_degrees = 33.0;
    harness.state_mut().document_mut().camera = mine;
    harness.run_steps(60);
    assert_eq!(camera(&harness), mine);
}

#[test]
fn with_shift_or_without_flights_the_camera_jumps() {
    let mut harness = bookmarked();
    send(&mut harness, Command::Flights);
    send(&mut harness, Command::Bookmark(0));
    assert_eq!(camera(&harness).look_from, EYES[0]);
    send(&mut harness, Command::Flights);
    send(&mut harness, Command::Bookmark(1));
    assert_ne!(camera(&harness).look_from, EYES[1]);
    harness.run_steps(60);
    assert_eq!(camera(&harness).look_from, EYES[1]);
    let at = harness.get_by_label("Go to 12.2 view 3").rect().center();
    harness.event_modifiers(eframe::egui::Event::PointerMoved(at), Modifiers::SHIFT);
    harness.step();
    for pressed in [true, false] {
        let (button, modifiers) = (eframe::egui::PointerButton::Primary, Modifiers::SHIFT);
        let event = eframe::egui::Event::PointerButton { pos: at, button, pressed, modifiers };
        harness.event_modifiers(event, modifiers);
        harness.step();
    }
    harness.step();
    assert_eq!(camera(&harness).look_from, EYES[2]);
}

#[test]
fn bookmarks_are_flown_in_order_as_frames_render_them() {
    let mut harness = bookmarked();
    let start = camera(&harness);
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("path.toml");
    name_file(&mut harness, Command::SaveFlight, &path);
    until(&mut harness, "how to render it", |window| {
        window.messages().iter().any(|text| text.contains("--frames 0..121"))
    });
    let saved = format!("Saved {}", path.display());
    until(&mut harness, &saved, |window| window.messages().contains(&saved));
    let line = format!("weekender --batch --scene {} --frames 0..121 --out f", path.display());
    let Request::Frames(options) = cli::parse(line.split_whitespace().map(Into::into)).unwrap() else {
        panic!("{line}");
    };
    for (place, eye) in EYES.into_iter().enumerate() {
        assert_eq!(options.path.camera(60 * place as u32), Camera { look_from: eye, ..start });
    }
    send(&mut harness, Command::FlyBookmarks);
    let begin = harness.ctx.input(|input| input.time);
    let mut between = 0;
    for _ in 0..300 {
        harness.step();
        let frame = (harness.ctx.input(|input| input.time) - begin) * 30.0;
        let [before, after] = [frame - 2.5, frame + 2.5].map(|frame| frame.clamp(0.0, 120.0) as u32);
        let mut rendered = (before..=after + 1).map(|frame| options.path.camera(frame).look_from);
        let now = camera(&harness).look_from;
        assert!(rendered.any(|eye| eye.distance(now) < 0.12), "frame {frame}: {now} is not on the path");
        between += usize::from(!EYES.contains(&now));
    }
    assert!(between > 150, "{between}");
    assert_eq!(camera(&harness).look_from, EYES[2]);
    harness.run_steps(2);
    assert_eq!(camera(&harness), start);
}

/// The list fits into the panel, which would otherwise grow from frame to frame.
#[test]
fn bookmarks_leave_the_panel_its_width() {
    let mut harness = open("--stage view-distant --size 64x36");
    harness.run_steps(5);
    let left = |harness: &Harness<'_, Window>| harness.get_by_label("Picture").rect().left();
    let before = left(&harness);
    for _ in 0..8 {
        send(&mut harness, Command::AddBookmark);
    }
    harness.state_mut().remembered_mut().bookmarks[0].name = "a very long name, ".repeat(4);
    harness.run_steps(30);
    assert_eq!(left(&harness), before);
}

#[test]
fn a_path_needs_two_bookmarks() {
    let mut harness = open("--stage view-distant --size 64x36");
    for command in [Command::FlyBookmarks, Command::SaveFlight] {
        assert!(harness.state().disabled_reason(command).unwrap().contains("two bookmarks"));
    }
    send(&mut harness, Command::AddBookmark);
    assert!(harness.state().disabled_reason(Command::FlyBookmarks).is_some());
}

#[test]
fn bookmarks_are_renamed_ordered_replaced_and_forgotten() {
    let mut harness = bookmarked();
    let choose = |harness: &mut Harness<'_, Window>, bookmark: &str, item: &str| {
        control(harness, &format!("Change {bookmark}")).click();
        harness.run_steps(5);
        control(harness, item).click();
        harness.run_steps(5);
    };
    choose(&mut harness, "12.2 view 3", "Earlier");
    assert_eq!(names(&mut harness), ["12.2 view 1", "12.2 view 3", "12.2 view 2"]);
    choose(&mut harness, "12.2 view 1", "Later");
    assert_eq!(names(&mut harness), ["12.2 view 3", "12.2 view 1", "12.2 view 2"]);
    choose(&mut harness, "12.2 view 1", "Name of the bookmark");
    harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    harness.step();
    control(&harness, "Name of the bookmark").type_text("above");
    harness.run_steps(2);
    harness.key_press(Key::Enter);
    harness.run_steps(3);
    assert_eq!(names(&mut harness), ["12.2 view 3", "above", "12.2 view 2"]);
    choose(&mut harness, "above", "Replace");
    let replaced = harness.state_mut().remembered_mut().bookmarks[1].camera();
    assert_eq!(replaced.look_from, EYES[2]);
    choose(&mut harness, "12.2 view 3", "Forget");
    assert_eq!(names(&mut harness), ["above", "12.2 view 2"]);
    // A new bookmark gets a name that is free.
    send(&mut harness, Command::AddBookmark);
    assert_eq!(names(&mut harness).last().unwrap(), "12.2 view 1");
    send(&mut harness, Command::AddBookmark);
    assert_eq!(names(&mut harness).last().unwrap(), "12.2 view 3");
}
