//! Films that the window resumes.

use crate::common::{has_samples, open, opened, save, send, until};
use egui_kittest::Harness;
use std::path::Path;
use weekender::app::{Command, SlotCommand, SlotNumber, Window};
use weekender::cli;
use weekender::film::{checkpoint, key};
use weekender::output::OutputFormat;
use weekender::progressive::Stop;
use weekender::stages::Stage;

const PICTURE: &str = "--stage defocus --size 48x27 --vfov 31 --device cpu";

/// Saves a film of [`PICTURE`] with forty samples.
fn save_film(path: &Path, more: &str) {
    let mut harness = open(&format!("{PICTURE} {more} --samples 40"));
    until(&mut harness, "the end", has_samples(40));
    save(&mut harness, Command::Save(OutputFormat::Exr), path);
}

#[test]
fn a_resumed_film_goes_on_as_the_flags_say() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("film.exr");
    save_film(&path, "");
    let resume = format!("--resume {} --device cpu", path.display());
    for (flags, stop) in [
        ("--samples 90", Stop::at_samples(90)),
        ("--samples 90 --time-limit 1000", Stop { seconds: Some(1000.0), ..Stop::at_samples(90) }),
        ("--samples 90 --stage defocus --size 48x27 --vfov 31", Stop::at_samples(90)),
    ] {
        let mut harness = open(&format!("{resume} {flags}"));
        until(&mut harness, flags, |window| {
            has_samples(90)(window)
                && window.status().phase.is_over()
                && window.status().contributions.len() == 1
        });
        until(&mut harness, "the film's samples", |window| {
            window.status().contributions.iter().map(|part| part.samples_per_pixel).sum::<u64>() == 50
        });
        let document = harness.state().document();
        assert_eq!(document.stop, stop, "{flags}");
        assert_eq!(document.stage().map(|stage| stage.id), Some("defocus"));
        assert_eq!((document.camera.vfov_degrees, document.settings.width), (31.0, 48));
        // Its samples are those of an uninterrupted render.
        let [resumed, whole] = ["resumed.exr", "whole.exr"].map(|name| directory.path().join(name));
        save(&mut harness, Command::Save(OutputFormat::Exr), &resumed);
        let mut harness = open(&format!("{PICTURE} --samples 90"));
        until(&mut harness, "the end", has_samples(90));
        save(&mut harness, Command::Save(OutputFormat::Exr), &whole);
        let [resumed, whole] = [resumed, whole].map(|path| checkpoint::load(&path).unwrap().film);
        assert!(resumed == whole, "{flags}");
    }
    // Without a stop condition of its own, it continues as the picture usually would.
    let harness = open(&resume);
    assert_eq!(harness.state().document().stop, Stop { noise: Some(Stop::NOISE), ..Stop::default() });
}

#[test]
fn the_film_of_another_picture_is_refused() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("film.exr");
    save_film(&path, "");
    let parse = |flags: &str| {
        let line = format!("weekender --resume {} --device cpu {flags}", path.display());
        cli::parse(line.split_whitespace().map(Into::into))
    };
    for (flags, told) in [("--seed 5", "seed is 5"), ("--scene book --size 48x27", "another picture")] {
        let refused = parse(flags).unwrap_err().to_string();
        assert!(refused.contains(told) && refused.contains("film.exr"), "{flags}: {refused}");
    }
    // A film that replaces it later is refused, too, and the picture starts from the beginning.
    let cli::Request::Window(options) = parse("--samples 50").unwrap() else { panic!("no window") };
    save_film(&path, "--seed 9");
    let mut harness = opened(weekender::app::Window::new(*options).unwrap());
    until(&mut harness, "refused", |window| {
        window
            .messages()
            .iter()
            .any(|text| text.starts_with("Not resumed") && text.contains("seed is 0 here, 9 there"))
    });
    until(&mut harness, "a render from the beginning", has_samples(50));
}

/// Says of a film that it took a million seconds.
fn make_old(path: &Path) {
    let mut file = checkpoint::load(path).unwrap();
    file.description.set(key::SECONDS, 1e6);
    checkpoint::save(path, &file.film, &file.description).unwrap();
}

/// Saves what is shown, and returns the seconds of tracing that its film tells.
fn seconds(harness: &mut Harness<'_, Window>, path: &Path) -> f64 {
    save(harness, Command::Save(OutputFormat::Exr), path);
    checkpoint::load(path).unwrap().description.get(key::SECONDS).unwrap().parse().unwrap()
}

#[test]
fn another_picture_begins_at_zero_seconds() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("film.exr");
    save_film(&path, "");
    make_old(&path);
    let mut harness = open(&format!("--resume {} --device cpu --samples 40", path.display()));
    until(&mut harness, "the film", has_samples(40));
    let run = harness.state().status().run;
    send(&mut harness, Command::Stage(Stage::find("normals").unwrap()));
    until(&mut harness, "the stage", |window| window.status().run > run && has_samples(1)(window));
    assert!(seconds(&mut harness, &directory.path().join("stage.exr")) < 1e5);
}

#[test]
fn kept_pictures_have_seconds_of_their_own() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("film.exr");
    save_film(&path, "");
    make_old(&path);
    let mut harness = open(&format!("--resume {} --device cpu --samples 90", path.display()));
    until(&mut harness, "the end", |window| has_samples(90)(window) && window.status().phase.is_over());
    send(&mut harness, Command::Slot(SlotCommand::Keep));
    until(&mut harness, "a kept picture", |window| window.slot(SlotNumber::ALL[0]).is_some());
    harness.state_mut().document_mut().camera.vfov_degrees = 25.0;
    harness.run_steps(2);
    until(&mut harness, "another film", |window| has_samples(90)(window) && window.status().phase.is_over());
    assert!(seconds(&mut harness, &directory.path().join("live.exr")) < 1e5);
    send(&mut harness, Command::Slot(SlotCommand::Look(SlotNumber::ALL[0])));
    let kept = seconds(&mut harness, &directory.path().join("kept.exr"));
    assert!(kept > 1e6 + 1e-4, "{kept}: those of the film and of this window");
    send(&mut harness, Command::Slot(SlotCommand::Open));
    until(&mut harness, "the film of the slot", |window| {
        window.document().camera.vfov_degrees == 31.0 && window.looked().is_none() && has_samples(90)(window)
    });
    let opened = seconds(&mut harness, &directory.path().join("opened.exr"));
    assert!((opened - kept).abs() < 1e-6, "{opened} instead of {kept}");
}

#[test]
fn a_new_start_forgets_the_seconds_of_the_film() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("film.exr");
    save_film(&path, "");
    make_old(&path);
    let has_traced = |samples: u64| {
        move |window: &Window| {
            let traced = window.status().contributions.iter().map(|part| part.samples_per_pixel);
            has_samples(90)(window) && traced.sum::<u64>() == samples
        }
    };
    let mut harness = open(&format!("--resume {} --device cpu --samples 90", path.display()));
    until(&mut harness, "the film's end", has_traced(50));
    assert!(seconds(&mut harness, &directory.path().join("resumed.exr")) > 1e6);
    send(&mut harness, Command::Restart);
    until(&mut harness, "the new film's end", has_traced(90));
    let traced = seconds(&mut harness, &directory.path().join("new.exr"));
    assert!(traced < 1e5, "{traced} s");
}
