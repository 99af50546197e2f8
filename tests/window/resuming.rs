//! Films that the window resumes.

use crate::harness::{has_samples, open, save, send, until};
use crate::questions::Ask as _;
use crate::recovered::held;
use std::path::Path;
use weekender::app::Command;
use weekender::film::checkpoint;
use weekender::progressive::Stop;

const PICTURE: &str = "--stage defocus --size 48x27 --vfov 31 --device cpu";

/// Saves a film of [`PICTURE`] with forty samples.
fn save_film(path: &Path) {
    let mut harness = open(&format!("{PICTURE} --samples 40"));
    until(&mut harness, "the end", has_samples(40));
    save(&mut harness, Command::Save, path);
}

#[test]
fn resumed_film_follows_the_flags() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("film.exr");
    save_film(&path);
    let resume = format!("--resume {} --device cpu", path.display());
    for (flags, stop) in [
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
        let document = harness.state().shown_document();
        assert_eq!(document.stop, stop, "{flags}");
        assert_eq!(document.stage().map(|stage| stage.id), Some("defocus"));
        assert_eq!((document.camera.vfov_degrees, document.settings.width), (31.0, 48));
        // Its samples are those of an uninterrupted render.
        let saved = tempfile::tempdir().unwrap();
        let [resumed, whole] = ["resumed.exr", "whole.exr"].map(|name| saved.path().join(name));
        save(&mut harness, Command::Save, &resumed);
        let mut harness = open(&format!("{PICTURE} --samples 90"));
        until(&mut harness, "the end", has_samples(90));
        save(&mut harness, Command::Save, &whole);
        let [resumed, whole] = [resumed, whole].map(|path| checkpoint::load(&path).unwrap().film);
        assert!(resumed == whole, "{flags}");
    }
    // Without a stop condition of its own, it continues as the picture usually would.
    let harness = open(&resume);
    assert_eq!(harness.state().shown_document().stop, Stop { noise: Some(Stop::NOISE), ..Stop::default() });
}

/// Here a pass takes a second, whose end the next picture waits for.
#[test]
fn a_long_render_left_while_it_traces_keeps_its_samples() {
    let mut harness =
        open("--stage metal --size 800x450 --samples 4000000000 --device reference --threads 1");
    until(&mut harness, "samples", has_samples(2));
    harness.state_mut().tracing.main.seconds_before = Some(60.0);
    send(&mut harness, Command::NextStage);
    until(&mut harness, "another picture", has_samples(1));
    send(&mut harness, Command::Undo);
    until(&mut harness, "its samples", |window| held(window) > 0);
    assert_eq!(harness.state().shown_document().stage().unwrap().id, "metal");
}
