//! The right panel: its tabs, the code of a stage, and the check of a picture.

use crate::harness::{SMALL, control, drop_file, has_samples, open, send, until, until_seen};
use crate::questions::Ask as _;
use crate::recovered::held;
use eframe::egui;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use weekender::app::{Command, Window};

/// The picture of stage 2.1 at 160 × 90, as the book's first program writes it; `upside_down`, if it counts rows from
/// the wrong end.
pub fn gradient(upside_down: bool) -> Vec<u8> {
    let share = |at: u32, count: u32| (255.999 * f64::from(at) / f64::from(count - 1)) as u8;
    let row = |y: u32| if upside_down { 89 - y } else { y };
    let pixels = (0..90).flat_map(|y| (0..160).map(move |x| [x, y]));
    let rgb8 = pixels.flat_map(|[x, y]| [share(x, 160), share(row(y), 90), 0]);
    b"P6\n160 90\n255\n".iter().copied().chain(rgb8).collect()
}

/// Drops a picture of this content on the window.
pub fn drop_picture(harness: &mut Harness<'_, Window>, content: &[u8]) -> tempfile::TempDir {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("mine.ppm");
    std::fs::write(&path, content).unwrap();
    drop_file(harness, &path);
    directory
}

/// Waits until the picture of a check is shown beside that of its stage.
pub fn until_compared(harness: &mut Harness<'_, Window>) {
    until(harness, "both pictures", |window| {
        let is_beside = window.is_comparing() && !window.model.view.is_hidden();
        is_beside && window.has_other_picture() && has_samples(1)(window)
    });
}

#[test]
fn a_picture_of_another_program_is_checked() {
    let mut harness = open(SMALL);
    until(&mut harness, "a picture", has_samples(1));
    let _kept = drop_picture(&mut harness, &gradient(false));
    until_seen(&mut harness, "It is right");
    until_compared(&mut harness);
    let document = harness.state().shown_document();
    assert!(document.stage().unwrap().section.starts_with("2.") && document.size() == [160, 90]);
    for at in [[0, 0], [80, 40], [159, 89]] {
        assert_eq!(harness.state().other_pixel(at), harness.state().shown_pixel(at), "{at:?}");
    }
    let _kept = drop_picture(&mut harness, &gradient(true));
    until(&mut harness, "the answer", |window| window.checked().is_some_and(|title| title != "It is right"));
    until_compared(&mut harness);
    control(&harness, "Go to 2.2").click();
    harness.run_steps(3);
    assert_eq!(harness.state().shown_document().stage().unwrap().section, "2.2");
    assert!(!harness.state().is_comparing(), "the stage that was chosen is shown alone");
    control(&harness, "Check").click();
    until_compared(&mut harness);
    assert_eq!(harness.state().other_pixel([159, 0]).unwrap()[1], 255, "the picture of the file");
    control(&harness, "Close").click();
    harness.run_steps(3);
    assert!(harness.state().checked().is_none() && !harness.state().is_comparing());
    let _kept = drop_picture(&mut harness, b"P6\nnothing");
    until_seen(&mut harness, "cannot be checked");
}

#[test]
fn a_check_leaves_the_users_own_picture_as_it_was() {
    let mut harness = open(&format!("{SMALL} --samples 40"));
    send(&mut harness, Command::AddSphere);
    until(&mut harness, "my scene", |window| has_samples(40)(window) && window.status().phase.is_over());
    let own = harness.state().shown_document().clone();
    harness.state_mut().tracing.main.seconds_before = Some(60.0);
    let _kept = drop_picture(&mut harness, &gradient(true));
    until_compared(&mut harness);
    assert_eq!(harness.state().shown_document().size(), [160, 90]);
    control(&harness, "Close").click();
    harness.run_steps(3);
    assert!(*harness.state().shown_document() == own && !harness.state().is_comparing());
    assert_eq!(harness.state().changes.labels(&own)[0], Some("added sphere"), "a check is no step");
    until(&mut harness, "its samples", |window| held(window) == 40);
    assert!(harness.state().status().contributions.is_empty(), "nothing was traced again");
    // A picture that was changed during a check stays.
    let _kept = drop_picture(&mut harness, &gradient(true));
    until_compared(&mut harness);
    control(&harness, "Go to 2.2").click();
    harness.run_steps(3);
    control(&harness, "Check").click();
    harness.run_steps(3);
    control(&harness, "Close").click();
    harness.run_steps(3);
    assert_eq!(harness.state().shown_document().stage().unwrap().section, "2.2");
    send(&mut harness, Command::Undo);
}

/// A stage of metal in which a part is wrong: what differs is marked and enlarged.
#[test]
fn places_that_differ_are_enlarged_one_by_one() {
    let mut harness = open("--stage red-sphere --size 160x90");
    until(&mut harness, "the end", |window| window.status().phase.is_over());
    let size = harness.state().shown_document().size();
    let right = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| [x, y]));
    let pixels = right.flat_map(|[x, y]| match (20..30).contains(&x) && (20..30).contains(&y) {
        true => [0, 255, 0],
        false => harness.state().shown_pixel([x, y]).unwrap(),
    });
    let file: Vec<u8> = b"P6\n160 90\n255\n".iter().copied().chain(pixels).collect();
    let _kept = drop_picture(&mut harness, &file);
    until_compared(&mut harness);
    let whole = harness.state().picture_rect();
    until_seen(&mut harness, "Show where");
    control(&harness, "Show where").click();
    harness.run_steps(3);
    let rect = harness.state().picture_rect();
    let place = rect.lerp_inside(egui::vec2(25.0 / 160.0, 25.0 / 90.0));
    let room = harness.get_by_label("Picture").rect();
    assert!(rect.width() > 2.0 * whole.width() && room.contains(place), "{rect} {room}");
    control(&harness, "Whole picture").click();
    harness.run_steps(3);
    assert_eq!(harness.state().picture_rect(), whole);
}

#[test]
fn the_code_of_a_stage_is_shown_and_copied() {
    let mut harness = open(SMALL);
    send(&mut harness, Command::Code);
    for (language, code) in [
        ("C", "static double reflectance("),
        ("WGSL", "fn reflectance(cosine: f32"),
        ("Rust", "fn reflectance<"),
    ] {
        control(&harness, language).click();
        harness.run_steps(2);
        assert!(harness.query_by_label_contains(code).is_some(), "{language}");
    }
    harness.get_all_by_label("Copy").next().unwrap().click();
    harness.step();
    let is_code = |command: &egui::OutputCommand| matches!(command, egui::OutputCommand::CopyText(text) if text.contains("fn reflectance"));
    assert!(harness.output().platform_output.commands.iter().any(is_code));
    send(&mut harness, Command::Code);
    harness.run_steps(2);
    assert!(harness.query_by_label("Why").is_some());
}
