//! Tests of what commands do.

use super::*;
use crate::app::model::crop::Crop;
use crate::app::tests::{until, window};

use crate::progressive::Stop;
use eframe::egui::{Context, OutputCommand, Pos2, RawInput, Rect, vec2};
use std::cell::Cell;

/// A window in which most commands have something to do.
pub(super) fn prepared() -> Window {
    let mut window = window("weekender --stage glass-schlick --size 16x9 --samples 4 --device cpu");
    let Model { document, view, remembered, selected, .. } = &mut window.model;
    remembered.bookmarks =
        ["near", "far"].map(|name| Bookmark::new(name.to_owned(), &document.camera)).to_vec();
    remembered.recent = vec!["/of/gone.toml".into()];
    document.camera.look_from.x += 0.5;
    document.camera.vfov_degrees = 33.0;
    (view.tone.exposure, *selected) = (1.0, Some(1));
    view.crop = Some(Some(Crop { first: [1, 2], size: [3, 4] }));
    window.seconds_before = Some(5.0);
    window
}

#[test]
fn the_picture_is_zoomed_in_steps() {
    let mut window = window("weekender --stage normals --size 160x90 --samples 1 --device cpu");
    let (context, screen) = (Context::default(), Rect::from_min_size(Pos2::ZERO, vec2(1280.0, 800.0)));
    let mut width = |command: Option<Command>| {
        command.into_iter().for_each(|command| window.perform(&context, command));
        for _ in 0..3 {
            let input = RawInput { screen_rect: Some(screen), ..RawInput::default() };
            let _ = context.run_ui(input, |ui| window.ui_in(ui));
        }
        window.picture_rect().width()
    };
    let fitting = width(None);
    assert!(fitting > 400.0, "{fitting}");
    for (command, expected) in [
        (Command::ActualSize, 160.0),
        (Command::ZoomIn, 200.0),
        (Command::ZoomIn, 250.0),
        (Command::ZoomOut, 200.0),
        (Command::Fit, fitting),
    ] {
        let found = width(Some(command));
        assert!((found - expected).abs() < 0.1, "{command:?}: {found}, not {expected}");
    }
}

#[test]
fn the_companion_opens_at_the_stage_once_it_is_written() {
    let directory = tempfile::tempdir().unwrap();
    let page = directory.path().join("index.html");
    let (mut window, context) = (prepared(), Context::default());
    let mut open = || {
        let output = context.run_ui(RawInput::default(), |ui| window.open_companion(ui.ctx(), &page));
        (window.messages().pop().unwrap(), output.platform_output.commands)
    };
    let (told, commands) = open();
    let missing = "There is no companion/index.html here; write it with: weekender companion --out companion";
    assert_eq!(told, missing);
    assert!(commands.is_empty());
    std::fs::write(&page, "").unwrap();
    let (told, commands) = open();
    let url = companion::url(&page, prepared().document().stage());
    assert_eq!(told, format!("Opening {url}"));
    assert!(
        matches!(&commands[..], [OutputCommand::OpenUrl(asked)] if asked.url == url && asked.new_tab),
        "{commands:?}"
    );
}

#[test]
fn a_view_that_a_picture_has_not_is_left() {
    let mut window = prepared();
    for (show, is_left) in [(Show::Picture, false), (Show::Normals, false), (Show::Difference, true)] {
        window.model.view.choose(show);
        window.leave_useless_show();
        assert_eq!(window.show(), if is_left { Show::Picture } else { show });
        let told = window.messages();
        let is_told = told.iter().any(|text| text.starts_with(&format!("No {} here: ", show.name())));
        assert_eq!(is_told, is_left, "{told:?}");
    }
}

#[test]
fn a_bookmark_is_named_after_its_picture() {
    for (words, name) in
        [("--stage glass-schlick", "11.4 view 1"), ("--scene touching-spheres", "touching-spheres view 1")]
    {
        let mut window = window(&format!("weekender {words} --size 16x9 --device cpu"));
        window.perform(&Context::default(), Command::AddBookmark);
        assert_eq!(window.model.remembered.bookmarks[0].name, name);
    }
}

#[test]
fn a_render_that_has_ended_goes_on_to_twice_its_samples() {
    let mut window = window("weekender --stage glass-schlick --size 16x9 --samples 4 --device cpu");
    let context = Context::default();
    until(&mut window, &context, "the end", |window| {
        window.main.has_samples(window.document()) && window.status().phase.is_over()
    });
    window.perform(&context, Command::GoOn);
    assert_eq!(window.document().stop, Stop::at_samples(8));
    until(&mut window, &context, "more samples", |window| window.status().samples_per_pixel == 8);
}

#[test]
fn what_a_picture_is_compared_with_pauses_and_goes_on_with_it() {
    for command in [Command::Pause, Command::Restart] {
        let mut window =
            window("weekender --stage glass-schlick --size 16x9 --samples 4000000000 --device cpu");
        let context = Context::default();
        let samples = |window: &Window| window.second.shown().map_or(0, |shown| shown.samples);
        window.perform(&context, Command::Wipe);
        until(&mut window, &context, "both pictures", |window| {
            samples(window) > 0 && window.status().samples_per_pixel > 0
        });
        window.perform(&context, Command::Pause);
        assert!(window.is_paused());
        // The samples of the last frame, and in how many frames there have been as many.
        let seen = Cell::new((0, 0));
        until(&mut window, &context, "a rest", |window| {
            let ((last, frames), now) = (seen.get(), samples(window));
            seen.set((now, if now == last { frames + 1 } else { 0 }));
            frames >= 30
        });
        let before = samples(&window);
        window.perform(&context, command);
        assert!(!window.is_paused(), "{command:?}");
        until(&mut window, &context, "more samples", |window| samples(window) > before);
    }
}
