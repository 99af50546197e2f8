//! Tests of what commands do.

use super::*;
use crate::app::model::crop::Crop;
use crate::app::model::document::Document;
use crate::app::model::kept::Kept;
use crate::app::model::kept_view::ShownSlots;
use crate::app::model::slots::{Slot, SlotNumber};
use crate::app::model::view::Other;
use crate::app::tests::{until, window};
use crate::film::Film;
use crate::kept;
use crate::progressive::Stop;
use crate::recipe::file;
use crate::stages::Stage;
use eframe::egui::{Context, OutputCommand, Pos2, RawInput, Rect, ViewportId, vec2};
use std::collections::BTreeMap;
use std::sync::Arc;

/// A window in which most commands have something to do.
fn prepared() -> Window {
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

/// What can be seen of a window, by name. Scenes are told by the title.
fn seen(window: &Window) -> BTreeMap<String, String> {
    let mut seen: BTreeMap<String, String> = kept::fields(&window.model)
        .into_iter()
        .filter(|(path, _)| !path.contains("document.origin") && !path.contains("document.checked"))
        .collect();
    for (name, value) in [
        ("title", window.document().title()),
        ("dialog", window.dialogs.is_open().to_string()),
        ("copy", window.pending_copy.to_string()),
        ("seconds", format!("{:?}", window.seconds_before)),
        ("flight", window.flight.is_some().to_string()),
        ("sight", window.sight.is_some().to_string()),
        ("panel", format!("{:?}", window.panel)),
    ] {
        seen.insert(name.to_owned(), value);
    }
    seen
}

/// What a command changes, says, and asks of the system.
fn done(context: &Context, window: &mut Window, command: Command) -> String {
    let (before, told) = (seen(window), window.messages());
    let output = context.run_ui(RawInput::default(), |ui| window.perform(ui.ctx(), command));
    let after = seen(window);
    let mut text = format!("{}\n", command.name());
    let mut paths: Vec<&String> = before.keys().chain(after.keys()).collect();
    paths.sort();
    paths.dedup();
    for path in paths {
        let [old, new] = [&before, &after].map(|seen| seen.get(path).map_or("nothing", String::as_str));
        if old != new {
            text.push_str(&format!("  {path}: {old} -> {new}\n"));
        }
    }
    for words in window.messages().iter().filter(|words| !told.contains(words)) {
        text.push_str(&format!("  says {words}\n"));
    }
    for command in &output.platform_output.commands {
        text.push_str(&format!("  asks for {command:?}\n"));
    }
    for command in output.viewport_output.get(&ViewportId::ROOT).into_iter().flat_map(|root| &root.commands) {
        text.push_str(&format!("  asks for {command:?}\n"));
    }
    text
}

/// Commands for slots, devices and the companion depend on more than this.
#[test]
fn every_command_does_what_it_says() {
    let context = Context::default();
    let is_told = |command: &Command| {
        !matches!(
            command,
            Command::Slot(_)
                | Command::Device(_)
                | Command::SwitchDevice
                | Command::Companion
                | Command::Extreme(_)
                | Command::Stage(_)
        )
    };
    let mut commands: Vec<Command> = Command::all().into_iter().filter(is_told).collect();
    commands.extend([Command::Bookmark(1), Command::Bookmark(9), Command::Recent(0), Command::Recent(1)]);
    commands.push(Command::Stage(&Stage::ALL[3]));
    let mut text = String::new();
    for command in commands {
        text.push_str(&done(&context, &mut prepared(), command));
    }
    text.push_str("\nOne after the other\n");
    let mut window = prepared();
    for command in [
        Command::AddBookmark,
        Command::AddBookmark,
        Command::Crop,
        Command::Crop,
        Command::Darker,
        Command::NoExposure,
        Command::Wipe,
        Command::WipeDifference,
        Command::BookArithmetic,
        Command::WipeDifference,
        Command::WipeDifference,
        Command::Show(Show::Normals),
        Command::Brighter,
        Command::Panels,
        Command::Plot,
        Command::Plot,
        Command::Controls,
        Command::Gizmo,
        Command::Panels,
        Command::Gizmo,
        Command::Flights,
        Command::Bookmark(0),
        Command::FirstSteps,
        Command::FirstSteps,
        Command::FullScreen,
        Command::Present,
        Command::Panels,
        Command::Blank,
        Command::Blank,
        Command::Blank,
        Command::Fit,
        Command::Controls,
        Command::Present,
        Command::FullScreen,
        Command::ShowMe,
        Command::ShowMe,
        Command::ResetAll,
        Command::Fresh,
    ] {
        text.push_str(&done(&context, &mut window, command));
    }
    kept::check("commands_done", &text);
}

#[test]
fn a_difference_is_from_the_stage_once_the_books_arithmetic_was_left() {
    let context = Context::default();
    for leave in [Command::Show(Show::Picture), Command::BookArithmetic, Command::WipeDifference] {
        let mut window = window("weekender --stage glass-schlick --size 16x9 --device cpu");
        let is_by_book = |window: &Window| match window.model.view.compared(window.document()) {
            Some(Other::ByTheBook(..)) => Some(true),
            Some(_) => Some(false),
            None => None,
        };
        window.perform(&context, Command::BookArithmetic);
        if leave == Command::WipeDifference {
            window.perform(&context, Command::WipeDifference);
        }
        assert_eq!(is_by_book(&window), Some(true), "{leave:?}");
        window.perform(&context, leave);
        assert_eq!(is_by_book(&window), None, "{leave:?}");
        window.perform(&context, Command::WipeDifference);
        assert_eq!(is_by_book(&window), Some(false), "{leave:?}");
        window.perform(&context, Command::NextStage);
        assert_eq!(is_by_book(&window), Some(false), "{leave:?}");
    }
}

#[test]
fn what_is_saved_is_said_in_words() {
    let mut window = window("weekender --stage glass-schlick --size 16x9 --device cpu");
    assert_eq!(window.size_words(), "The picture: 16x9");
    window.model.document.has_own_size = false;
    assert_eq!(window.size_words(), "The picture: 16x9, as in the viewport");
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
fn a_command_ends_the_wait_for_slots_that_were_shown() {
    let mut window = prepared();
    for (command, is_enabled) in [(Command::Redo, false), (Command::Darker, true)] {
        assert_eq!(window.disabled_reason(command).is_none(), is_enabled);
        window.recovery.shown_slots = Some(ShownSlots::default());
        window.perform(&Context::default(), command);
        assert_eq!(window.recovery.shown_slots.is_none(), is_enabled, "{command:?}");
        assert_eq!(window.performed(), Some(command));
    }
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

/// Shows a slot whose picture is another one than the live one and has 7 samples per pixel.
fn look_at_another(window: &mut Window) -> Arc<Kept> {
    let mut document = Document::new(Origin::of_stage(Stage::find("metal").unwrap()));
    document.give_size([4, 2]);
    let mut film = Film::new(4, 2, 2);
    film.record(0..7, 0).unwrap();
    let kept = Arc::new(Kept::new(document, film, Arc::default(), None));
    let slot = Slot { name: "mine".to_owned(), kept: Arc::clone(&kept) };
    window.model.view.slots.put(SlotNumber::ALL[0], slot);
    window.model.view.look(Some(SlotNumber::ALL[0]));
    kept
}

/// The command line that is copied.
fn copied(context: &Context, window: &mut Window) -> String {
    let output = context.run_ui(RawInput::default(), |ui| window.perform(ui.ctx(), Command::CopyCommand));
    let [OutputCommand::CopyText(line)] = &output.platform_output.commands[..] else {
        panic!("{:?}", output.platform_output.commands)
    };
    line.clone()
}

/// The texts of the open dialog.
fn dialog(context: &Context, window: &mut Window) -> Vec<String> {
    let (facts, mut texts) = (window.facts(), Vec::new());
    let screen = Rect::from_min_size(Pos2::ZERO, vec2(1280.0, 800.0));
    for _ in 0..3 {
        let input = RawInput { screen_rect: Some(screen), ..RawInput::default() };
        let output = context.run_ui(input, |ui| {
            assert!(window.dialogs.ui(ui, &facts, &mut Vec::new()).is_none());
        });
        let shapes = output.shapes.into_iter().map(|clipped| clipped.shape);
        texts = shapes
            .filter_map(|shape| match shape {
                egui::Shape::Text(text) => Some(text.galley.text().to_owned()),
                _ => None,
            })
            .collect();
    }
    texts
}

#[test]
fn what_is_copied_named_and_saved_is_the_picture_of_the_slot_that_is_shown() {
    let (context, mut window) = (Context::default(), prepared());
    window.model.view.crop = None;
    let kept = look_at_another(&mut window);
    let line = copied(&context, &mut window);
    for part in [" --stage=metal ", " --size=4x2 ", " --samples=7 ", " --out=metal.png"] {
        assert!(line.contains(part), "{line}");
    }
    assert_eq!(window.size_words(), "slot 1: mine: 4x2");
    for (command, name) in
        [(Command::Save(OutputFormat::Png), "metal.png"), (Command::SaveScene, "metal.toml")]
    {
        window.perform(&context, command);
        let texts = dialog(&context, &mut window);
        assert!(texts.iter().any(|text| text == name), "{texts:?}");
        let is_size_told = texts.iter().any(|text| text == "slot 1: mine: 4x2");
        assert_eq!(is_size_told, command != Command::SaveScene, "{texts:?}");
    }
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("a.toml");
    window.use_path(&context, Purpose::SaveScene, path.clone());
    assert_eq!(window.files.saved.wait(), Some(Ok(path.clone())));
    assert_eq!(std::fs::read_to_string(path).unwrap(), file::to_toml(&kept.document.recipe()));
}

#[test]
fn a_copied_command_has_the_samples_of_the_film_if_that_is_of_the_picture() {
    let mut window = window("weekender --stage glass-schlick --size 16x9 --samples 4 --device cpu");
    let context = Context::default();
    let is_over =
        |window: &Window| window.main.has_samples(window.document()) && window.status().phase.is_over();
    until(&mut window, &context, "the end", is_over);
    let mut has = |change: fn(&mut Document), samples: u64| {
        change(&mut window.model.document);
        let line = copied(&context, &mut window);
        assert!(line.contains(&format!(" --samples={samples} ")), "{samples}: {line}");
    };
    has(|document| document.stop = Stop::at_samples(100), 4);
    // That would be another film, which has no samples yet.
    has(|document| document.settings.seed = 9, 100);
    let usual = prepared().document().origin.recipe.samples_per_pixel;
    has(|document| document.stop = Stop::default(), usual);
}
