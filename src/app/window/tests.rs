//! Tests of what a window begins with, and of other pictures in it.

use super::*;
use crate::app::tests::{until, window};
use crate::cli::{Request, parse};
use crate::progressive::Stop;
use crate::recipe::file;

fn noise(noise: f64) -> Stop {
    Stop { noise: Some(noise), ..Stop::default() }
}

#[test]
fn a_picture_comes_from_what_the_flags_name() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("mine.toml");
    std::fs::write(&path, file::to_toml(&Recipe::builtin("three-spheres").unwrap())).unwrap();
    let of_file = format!("--scene {}", path.display());
    let metal = Source::Stage(Stage::find("metal").unwrap());
    let of_path = Source::File(path.clone());
    // The source, whether its size is its own, whether it is changed, and when it ends, if not as usual.
    for (words, source, has_own_size, is_changed, stop) in [
        ("--stage metal", &metal, false, false, None),
        ("--stage metal --size 16x9", &metal, true, true, None),
        ("--stage metal --vfov 31", &metal, false, true, None),
        ("--stage metal --samples 9", &metal, false, false, Some(Stop::at_samples(9))),
        ("--scene touching-spheres", &Source::Builtin, false, false, None),
        (of_file.as_str(), &of_path, true, false, None),
    ] {
        let window = window(&format!("weekender {words} --device cpu"));
        let document = window.document();
        assert_eq!(&document.origin.source, source, "{words}");
        assert_eq!((document.has_own_size, document.is_changed()), (has_own_size, is_changed), "{words}");
        assert_eq!(document.stop, stop.unwrap_or(document.origin.usual_stop()), "{words}");
        let recent = &window.model.remembered.recent;
        assert_eq!(recent.contains(&path), source == &of_path, "{words}: {recent:?}");
    }
}

#[test]
fn a_stop_that_was_chosen_stays_for_other_pictures() {
    let of_stage = |id: &str| Origin::of_stage(Stage::find(id).unwrap());
    let (usual, chosen) = (noise(Stop::NOISE), noise(0.01));
    let one = Stop::at_samples(1);
    for (from, stop, to, expected) in [
        ("metal", usual, "glass-schlick", usual),
        ("metal", usual, "ppm-tiny", one),
        ("ppm-tiny", one, "metal", usual),
        ("metal", chosen, "glass-schlick", chosen),
        // A picture without noise ends after its sample.
        ("metal", chosen, "ppm-tiny", one),
        ("metal", Stop::default(), "glass-schlick", Stop::default()),
        ("metal", Stop::at_samples(7), "glass-schlick", Stop::at_samples(7)),
    ] {
        let mut window = window(&format!("weekender --stage {from} --device cpu"));
        window.model.document.stop = stop;
        window.show_origin(of_stage(to));
        assert_eq!(window.document().stage().map(|stage| stage.id), Some(to));
        assert_eq!(window.document().stop, expected, "{stop:?} from {from} to {to}");
    }
}

#[test]
fn another_picture_has_nothing_of_the_one_before() {
    let mut window = window("weekender --stage metal --size 16x9 --device cpu");
    window.toggle_sight();
    assert!(window.has_sight());
    window.model.selected = Some(1);
    window.show_origin(Origin::of_stage(Stage::find("glass-schlick").unwrap()));
    assert_eq!((window.has_sight(), window.selected()), (false, None));
    assert_eq!(window.document().stage().map(|stage| stage.id), Some("glass-schlick"));
}

#[test]
fn a_film_that_is_adopted_brings_its_seconds() {
    let mut window = window("weekender --stage metal --size 16x9 --device cpu");
    for seconds in [Some(7.0), None] {
        window.model.document.settings.seed += 1;
        window.adopt(SavedFilm { film: Film::new(16, 9, 2), seconds, backend: None });
        assert!(window.pending_film.take().is_some());
        assert_eq!((window.seconds_before, window.facts().seconds_before), (seconds, seconds));
        let context = eframe::egui::Context::default();
        let document = window.document().clone();
        assert!(!window.changes.follow(&context, &document, false), "it is no change that starts a new film");
    }
}

#[test]
fn facts_are_those_of_the_window() {
    let mut window = window("weekender --stage metal --size 16x9 --device cpu");
    let facts = window.facts();
    assert!(!(facts.can_undo || facts.can_redo || facts.has_pixel || facts.has_paths || facts.has_sight));
    assert_eq!((facts.speed, facts.invalid), (None, None));
    let (context, before) = (eframe::egui::Context::default(), window.document().clone());
    window.changes.follow(&context, &before, false);
    window.model.document.settings.seed = 5;
    assert_eq!((window.facts().can_undo, window.facts().can_redo), (true, false));
    window.changes.undo(&mut window.model.document);
    assert_eq!((window.facts().can_undo, window.facts().can_redo), (false, true));
    window.inspector.hover(Some([1, 2]));
    window.invalid = Some("why".to_owned());
    window.toggle_sight();
    let facts = window.facts();
    assert!(facts.has_pixel && facts.has_sight);
    assert_eq!(facts.invalid.as_deref(), Some("why"));
}

#[test]
fn another_picture_forgets_paths_and_the_pixel() {
    let mut window = window("weekender --stage metal --size 16x9 --samples 4 --device cpu");
    let context = eframe::egui::Context::default();
    let document = window.document().clone();
    window.inspector.hover(Some([8, 4]));
    window.paths.list(&document, [8, 4], &context);
    until(&mut window, &context, "paths and a pixel", |window| {
        window.listed_paths() > 0 && window.inspected().is_some()
    });
    window.show_origin(Origin::of_stage(Stage::find("glass-schlick").unwrap()));
    assert_eq!((window.listed_paths(), window.inspected()), (0, None));
}

#[test]
fn the_first_picture_of_a_new_user_ends_as_the_flags_say() {
    for (words, stop) in [("", noise(Stop::NOISE)), ("--samples 7", Stop::at_samples(7))] {
        let window = window(&format!("weekender {words} --device cpu"));
        assert_eq!(window.document().stage(), Stage::ALL.last(), "{words}");
        assert_eq!(window.document().stop, stop, "{words}");
    }
}

/// The options of a command line.
fn options(words: &str) -> WindowOptions {
    match parse(words.split_whitespace().map(Into::into)).unwrap() {
        Request::Window(options) => *options,
        other => panic!("{words}: {other:?}"),
    }
}

#[test]
fn only_the_first_window_without_a_picture_is_new() {
    let directory = tempfile::tempdir().unwrap();
    let settings = Some(directory.path().join("settings.json"));
    let open =
        |words: &str| Window::new(WindowOptions { settings: settings.clone(), ..options(words) }).unwrap();
    let asked = open("weekender --stage metal");
    assert!(!asked.is_new && !asked.model.has_first_steps);
    let mut first = open("weekender");
    assert!(first.is_new && first.model.has_first_steps);
    first.end_in_order();
    let second = open("weekender");
    assert!(!second.is_new && second.model.has_first_steps, "not all of them have been tried");
}

#[test]
fn a_device_that_is_not_asked_for_is_the_remembered_one() {
    let directory = tempfile::tempdir().unwrap();
    let settings = Some(directory.path().join("settings.json"));
    let open =
        |words: &str| Window::new(WindowOptions { settings: settings.clone(), ..options(words) }).unwrap();
    for (words, device) in [
        ("weekender --stage metal --device reference", Device::Reference),
        ("weekender --stage metal", Device::Reference),
        ("weekender --stage metal --device cpu", Device::Cpu),
        ("weekender --stage metal", Device::Cpu),
    ] {
        let mut window = open(words);
        assert_eq!(window.model.remembered.device, device, "{words}");
        window.end_in_order();
    }
}

#[test]
fn a_frame_log_that_cannot_be_written_is_named() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("none/log.csv");
    let options = WindowOptions { frame_log: Some(path.clone()), ..options("weekender --stage metal") };
    let told = Window::new(options).err().unwrap().to_string();
    assert_eq!(told, format!("cannot write {}", path.display()));
}
