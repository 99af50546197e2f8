//! The size of the picture: that of the viewport, the book's, or its own.

use crate::common::{
    SMALL, control, copied_command, has_samples, name_file, open, opened, save, send, until, until_seen,
    window, window_of_new_user,
};
use eframe::egui::{self, Key};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use std::time::{Duration, Instant};
use weekender::app::{Command, Show, Sizing, Window};
use weekender::output::OutputFormat;

/// A cheap picture that follows the viewport.
const FOLLOWING: &str = "--stage normals --samples 2";

fn sized(window: Window, size: [f32; 2], scale: f32) -> Harness<'static, Window> {
    let mut harness = Harness::builder()
        .with_size(size)
        .with_pixels_per_point(scale)
        .with_step_dt(1.0 / 60.0)
        .build_ui_state(|ui, window: &mut Window| window.ui_in(ui), window);
    harness.run_steps(2);
    harness
}

/// A window of this size, in points, whose picture follows the viewport.
fn following(arguments: &str, size: [f32; 2]) -> Harness<'static, Window> {
    sized(window_of_new_user(arguments), size, 1.0)
}

fn size(harness: &Harness<'_, Window>) -> [u32; 2] {
    harness.state().document().size()
}

/// Draws frames for longer than a new size takes to be followed.
fn settle(harness: &mut Harness<'_, Window>) {
    let begin = Instant::now();
    while begin.elapsed() < Duration::from_millis(600) {
        std::thread::sleep(Duration::from_millis(10));
        harness.step();
    }
}

/// Draws frames until the picture has another size than this one.
fn until_other_size(harness: &mut Harness<'_, Window>, before: [u32; 2]) -> [u32; 2] {
    until(harness, "another size", |window| window.document().size() != before);
    until(harness, "its picture", has_samples(1));
    size(harness)
}

/// Whether the picture fills the viewport in one direction, and each of its pixels is one of the screen.
fn fills_the_viewport(harness: &Harness<'_, Window>, scale: f32) {
    let (picture, room) = (harness.state().picture_rect(), harness.get_by_label("Picture").rect());
    let pixels = size(harness).map(|pixels| pixels as f32);
    let drawn = picture.size() * scale;
    assert!((drawn - egui::vec2(pixels[0], pixels[1])).length() < 0.1, "{drawn} for {pixels:?}");
    let free = (room.size() - picture.size()).min_elem();
    // The picture has a margin of 10 points.
    assert!((19.0..23.0).contains(&free), "{free} points are free");
    let aspect = pixels[0] / pixels[1];
    assert!((aspect - 16.0 / 9.0).abs() < 0.01, "the book's picture shows something else: {aspect}");
}

#[test]
fn the_picture_fills_the_viewport_at_its_own_resolution() {
    for (points, scale) in [([1000.0, 500.0], 1.0), ([1000.0, 900.0], 1.0), ([1000.0, 600.0], 2.0)] {
        let mut harness = sized(window_of_new_user(FOLLOWING), points, scale);
        until(&mut harness, "the end", has_samples(2));
        fills_the_viewport(&harness, scale);
        assert!(harness.state().disabled_reason(Command::Undo).is_some(), "nobody changed anything");
    }
}

#[test]
fn the_next_stage_fills_the_viewport_too() {
    let mut harness = following("--stage sky --size 32x18", [1000.0, 600.0]);
    assert_eq!(size(&harness), [32, 18]);
    send(&mut harness, Command::NextStage);
    until(&mut harness, "the end", has_samples(1));
    fills_the_viewport(&harness, 1.0);
}

#[test]
fn pictures_with_a_size_keep_it() {
    let directory = tempfile::tempdir().unwrap();
    let [film, scene] = ["a.exr", "a.toml"].map(|name| directory.path().join(name));
    let mut first = open("--stage metal --size 48x27 --samples 2");
    until(&mut first, "the end", has_samples(2));
    save(&mut first, Command::Save(OutputFormat::Exr), &film);
    save(&mut first, Command::SaveScene, &scene);
    let (film, scene) = (film.display(), scene.display());
    for (arguments, kept) in [
        ("--stage ppm-tiny".to_owned(), [16, 9]),
        ("--stage ppm-gradient".to_owned(), [480, 270]),
        (format!("{FOLLOWING} --size 33x19"), [33, 19]),
        (format!("--resume {film}"), [48, 27]),
        (format!("--scene {scene}"), [48, 27]),
    ] {
        let mut harness = following(&arguments, [1000.0, 600.0]);
        until(&mut harness, "a picture", has_samples(1));
        assert_eq!(size(&harness), kept, "{arguments}");
    }
    let mut harness = following(FOLLOWING, [1000.0, 600.0]);
    name_file(&mut harness, Command::Open, &directory.path().join("a.exr"));
    until(&mut harness, "the opened film", |window| window.document().size() == [48, 27]);
    settle(&mut harness);
    assert_eq!(size(&harness), [48, 27]);
}

#[test]
fn a_young_picture_follows_the_viewport_and_this_is_no_change_of_the_users() {
    let mut harness = following(FOLLOWING, [1000.0, 600.0]);
    until(&mut harness, "the end", has_samples(2));
    let first = size(&harness);
    harness.key_press(Key::Tab);
    harness.step();
    assert_eq!(size(&harness), first, "it waits until the size stays");
    let second = until_other_size(&mut harness, first);
    assert!(second[0] > first[0] + 300, "the panels gave their room to the picture: {second:?}");
    assert!(harness.state().disabled_reason(Command::Undo).is_some());
    harness.set_size(egui::vec2(700.0, 600.0));
    let third = until_other_size(&mut harness, second);
    assert!(third[0] > 650 && third[0] <= 700, "{third:?}");

    // Undo takes back a turn of the camera, not the size.
    let camera = harness.state().document().camera;
    harness.state_mut().document_mut().camera.vfov_degrees = 33.0;
    harness.run_steps(90);
    harness.key_press(Key::Tab);
    let fourth = until_other_size(&mut harness, third);
    send(&mut harness, Command::Undo);
    assert_eq!((harness.state().document().camera, size(&harness)), (camera, fourth));
    assert!(harness.state().disabled_reason(Command::Undo).is_some());
}

#[test]
fn what_would_be_lost_is_kept_until_the_user_asks() {
    let directory = tempfile::tempdir().unwrap();
    let film = directory.path().join("reference.exr");
    let mut harness = following(FOLLOWING, [1000.0, 600.0]);
    until(&mut harness, "the end", has_samples(2));
    save(&mut harness, Command::Save(OutputFormat::Exr), &film);
    // Another size would have no difference from the reference film.
    name_file(&mut harness, Command::LoadReference, &film);
    until(&mut harness, "the difference", |window| window.show() == Show::Difference);
    let (before, run) = (size(&harness), harness.state().status().run);
    harness.key_press(Key::Tab);
    until_seen(&mut harness, "Render at ");
    settle(&mut harness);
    assert_eq!((size(&harness), harness.state().status().run), (before, run), "it was kept");
    assert!(harness.state().picture_rect().width() > before[0] as f32 + 200.0, "it is shown larger");
    let offer = harness.get_by_label_contains("Render at ");
    let label = offer.accesskit_node().label().unwrap();
    offer.click();
    harness.run_steps(3);
    let [width, height] = size(&harness);
    assert_eq!(label, format!("Render at {width}x{height}"));
    assert!(width > before[0] + 300);
    assert!(harness.query_by_label_contains("Render at ").is_none());
    until(&mut harness, "the new picture", has_samples(2));
}

#[test]
fn the_books_size_is_one_click_away() {
    let mut harness = following(FOLLOWING, [1000.0, 1400.0]);
    until(&mut harness, "the end", has_samples(2));
    let large = size(&harness);
    control(&harness, &Command::Size(Sizing::Book).name()).click();
    harness.run_steps(3);
    assert_eq!(size(&harness), [400, 225]);
    until(&mut harness, "the picture", has_samples(2));
    assert_eq!(harness.state_mut().remembered_mut().sizing, Sizing::Book, "it is kept for the next run");
    send(&mut harness, Command::NextStage);
    assert_eq!(size(&harness), [400, 225]);
    control(&harness, &Command::Size(Sizing::Viewport).name()).click();
    harness.run_steps(3);
    assert_eq!(size(&harness), large);
}

/// In the book, pictures whose pixels are the lesson are not enlarged.
#[test]
fn the_books_size_of_a_tiny_picture_is_tiny() {
    for (id, size) in [("ppm-tiny", [16, 9]), ("ppm-gradient", [480, 270])] {
        let mut harness = open(&format!("--stage {id}"));
        send(&mut harness, Command::Size(Sizing::Book));
        harness.run_steps(2);
        assert_eq!(self::size(&harness), size, "{id}");
    }
}

#[test]
fn a_typed_size_is_the_pictures_own() {
    let mut harness = following(FOLLOWING, [1000.0, 1400.0]);
    until(&mut harness, "the end", has_samples(2));
    let before = size(&harness);
    harness.run_steps(90);
    control(&harness, "Width").set_value_accesskit(64.0);
    harness.run_steps(3);
    assert_eq!(size(&harness), [64, before[1]]);
    harness.set_size(egui::vec2(900.0, 1300.0));
    settle(&mut harness);
    assert_eq!(size(&harness), [64, before[1]]);
    send(&mut harness, Command::Undo);
    until(&mut harness, "the viewport's size", has_samples(2));
    fills_the_viewport(&harness, 1.0);
    // The size of the moment can be kept as well.
    let mut kept = size(&harness);
    control(&harness, "Own size").click();
    harness.run_steps(2);
    harness.set_size(egui::vec2(1000.0, 1400.0));
    settle(&mut harness);
    assert_eq!(size(&harness), kept);
    harness.get_by_label("Reset output").click();
    harness.run_steps(2);
    until(&mut harness, "the viewport's size again", |window| window.document().size() != kept);
    kept = size(&harness);
    assert_eq!(kept, before);
}

#[test]
fn what_is_saved_says_which_size_it_has() {
    for (arguments, sizing, words) in [
        (FOLLOWING, Sizing::Book, "400x225, as in the book"),
        (FOLLOWING, Sizing::Viewport, ", as in the viewport"),
        (SMALL, Sizing::Viewport, "The picture: 32x18"),
    ] {
        let mut window = window(arguments);
        window.remembered_mut().sizing = sizing;
        let mut harness = opened(window);
        until(&mut harness, "a picture", has_samples(1));
        let [width, height] = size(&harness);
        send(&mut harness, Command::Save(OutputFormat::Png));
        let said = harness.get_by_label_contains("The picture: ").accesskit_node().value().unwrap();
        assert!(said.contains(words) && said.contains(&format!("{width}x{height}")), "{said}");
        harness.key_press(Key::Escape);
        harness.run_steps(2);
        let copied = copied_command(&mut harness);
        assert!(copied.contains(&format!("--size={width}x{height}")), "{copied}");
    }
}

#[test]
fn listed_paths_stay_at_their_place_when_the_size_changes() {
    let mut harness = following("--stage metal --samples 1", [1000.0, 600.0]);
    until(&mut harness, "a picture", has_samples(1));
    let at = harness.state().picture_rect().lerp_inside(egui::vec2(0.9, 0.9));
    harness.event(egui::Event::PointerMoved(at));
    harness.run_steps(2);
    send(&mut harness, Command::ListPaths);
    until(&mut harness, "paths", |window| window.listed_paths() > 0);
    // This pixel is outside of the smaller picture.
    send(&mut harness, Command::Size(Sizing::Book));
    until(&mut harness, "the smaller picture", has_samples(1));
    settle(&mut harness);
    assert!(harness.state().listed_paths() > 0);
}
