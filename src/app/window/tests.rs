//! Tests of what a window begins with, and of other pictures in it.

use super::*;
use crate::app::tests::window;
use crate::cli::{Request, parse};
use crate::job::recipe::file;
use crate::progressive::Stop;

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

/// The options of a command line.
fn options(words: &str) -> WindowOptions {
    match parse(words.split_whitespace().map(Into::into)).unwrap() {
        Request::Window(options) => *options,
        other => panic!("{words}: {other:?}"),
    }
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
