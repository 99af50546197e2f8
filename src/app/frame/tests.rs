//! Tests of frames.

use super::*;
use crate::app::answers::caught;
use crate::app::command::{Command, SlotCommand};
use crate::app::dialogs::Purpose;
use crate::app::kept::on_screen::small_film;
use crate::app::model::crop::Crop;
use crate::app::model::document::Document;
use crate::app::model::kept::Kept;
use crate::app::model::kept_view::ShownSlots;
use crate::app::model::sizing::Sizing;
use crate::app::model::slots::{Slot, SlotNumber};
use crate::app::model::view::{Mode, With};
use crate::app::tests::{sleep_after, until, window};
use crate::film::Film;
use crate::interrupt::Interrupt;
use crate::progressive::ReferenceMeans;
use egui::vec2;
use std::sync::Arc;
use std::sync::atomic::Ordering;

#[test]
fn a_move_leaves_no_dust_in_what_the_camera_looks_at() {
    let camera = |look_at| Camera { look_from: DVec3::new(0.0, 1.0, 3.0), look_at, ..Camera::BOOK };
    let before = camera(DVec3::new(0.0, 2e-16, -1.0));
    let after = without_dust(camera(DVec3::new(-1.11e-16, 2e-16, -1.0)), &before);
    assert_eq!(after, camera(DVec3::new(0.0, 2e-16, -1.0)), "what was there before stays");
    let small = camera(DVec3::new(1e-13, 1e-9, -1.0));
    assert_eq!(without_dust(small, &before), small);
    // Close to the point itself it is no dust.
    let near = Camera { look_from: DVec3::X, look_at: DVec3::new(1.0, 4e-16, 0.0), ..Camera::BOOK };
    assert_eq!(without_dust(near, &before), near);
}

#[test]
fn a_signal_closes_a_window_that_is_hidden() {
    let mut window = window("weekender --stage normals --size 16x9 --samples 1");
    let interrupt = Arc::new(Interrupt::unheard());
    window.heed(Arc::clone(&interrupt));
    let context = egui::Context::default();
    let mut closes = || {
        let output = context.run_ui(egui::RawInput::default(), |ui| {
            eframe::App::logic(&mut window, ui.ctx(), &mut eframe::Frame::_new_kittest());
        });
        output.viewport_output[&egui::ViewportId::ROOT].commands.contains(&egui::ViewportCommand::Close)
    };
    assert!(!closes());
    interrupt.flag().store(true, Ordering::Relaxed);
    assert!(closes());
}

#[test]
fn a_picture_that_has_taken_long_keeps_its_size() {
    let mut window = window("weekender --stage normals --device cpu");
    let context = egui::Context::default();
    until(&mut window, &context, "a picture", |window| window.main.has_samples(window.document()));
    // With the time since then, it is more than that of a picture that would be given up.
    window.seconds_before = Some(10.0);
    let size = window.document().size();
    window.model.remembered.has_panels = false;
    let has_decided = |window: &Window| window.sizer.offer().is_some() || window.document().size() != size;
    until(&mut window, &context, "another room", has_decided);
    assert_eq!(window.document().size(), size);
}

#[test]
fn a_window_with_its_frame_fits_on_the_screen() {
    let screen = vec2(1280.0, 800.0);
    assert_eq!(fitting(vec2(1280.0, 800.0), vec2(1282.0, 821.0), screen), Some(vec2(1278.0, 779.0)));
    assert_eq!(fitting(vec2(1280.0, 800.0), vec2(1280.0, 800.0), screen), None);
    assert_eq!(fitting(vec2(1280.0, 800.0), vec2(1282.0, 821.0), vec2(1920.0, 1080.0)), None);
    assert_eq!(fitting(vec2(640.0, 400.0), vec2(640.0, 400.0), egui::Vec2::ZERO), None, "not known yet");
}

#[test]
fn a_change_is_seen_in_the_live_picture() {
    let mut window = window("weekender --stage normals --size 16x9 --samples 1 --device cpu");
    let mut film = Film::new(16, 9, 1);
    film.record(0..1, 0).unwrap();
    let kept = Arc::new(Kept::new(window.document().clone(), film, Arc::default(), None));
    let (one, name) = (SlotNumber::ALL[0], String::new());
    window.model.view.slots.put(one, Slot { name, kept });
    window.model.view.look(Some(one));
    window.recovery.shown_slots = Some(ShownSlots::default());
    window.seconds_before = Some(5.0);
    let context = egui::Context::default();
    let after_frame = |window: &mut Window| {
        let _ = context.run_ui(egui::RawInput::default(), |ui| window.follow(ui.ctx()));
        (window.looked(), window.seconds_before, window.recovery.shown_slots.is_some())
    };
    assert_eq!(after_frame(&mut window), (Some(one), Some(5.0), true));
    window.model.document.settings.seed = 5;
    assert_eq!(after_frame(&mut window), (None, Some(0.0), false));
}

#[test]
fn a_window_is_dressed_once() {
    let (mut window, context) = (window("weekender --stage normals"), egui::Context::default());
    let mut longest_click = || {
        window.dress(&context);
        context.options(|options| options.input_options.max_click_duration)
    };
    assert_eq!(longest_click(), 5.0);
    context.options_mut(|options| options.input_options.max_click_duration = 1.0);
    assert_eq!(longest_click(), 1.0);
}

#[test]
fn the_screen_of_a_new_window_is_looked_at_for_a_while() {
    for (frames, is_fitted) in [(119, true), (120, false)] {
        let (mut window, context) = (window("weekender --stage normals"), egui::Context::default());
        let mut is_fitted_on = |screen: Option<egui::Vec2>| {
            let mut input = egui::RawInput::default();
            let viewport = input.viewports.get_mut(&egui::ViewportId::ROOT).unwrap();
            let size = egui::Rect::from_min_size(egui::Pos2::ZERO, vec2(1280.0, 800.0));
            (viewport.inner_rect, viewport.outer_rect) = (Some(size), Some(size));
            viewport.monitor_size = screen;
            let output = context.run_ui(input, |ui| window.fit_on_screen(ui.ctx()));
            let commands = &output.viewport_output[&egui::ViewportId::ROOT].commands;
            commands.contains(&egui::ViewportCommand::InnerSize(vec2(1024.0, 768.0)))
        };
        for _ in 0..frames {
            assert!(!is_fitted_on(None));
        }
        assert_eq!(is_fitted_on(Some(vec2(1024.0, 768.0))), is_fitted, "after {frames} frames");
    }
}

/// Puts a film of this picture into the first slot.
fn keep(window: &mut Window, document: Document, film: Film) -> Arc<Kept> {
    let kept = Arc::new(Kept::new(document, film, Arc::default(), None));
    let slot = Slot { name: String::new(), kept: Arc::clone(&kept) };
    window.model.view.slots.put(SlotNumber::ALL[0], slot);
    kept
}

#[test]
fn layers_are_those_of_the_picture_on_the_screen() {
    let mut window = window("weekender --stage normals --size 16x9 --samples 1 --device cpu");
    let context = egui::Context::default();
    // The middle of the live picture is a sphere, whose normal is level; that of the other one is the sky.
    let mut document = window.document().clone();
    document.camera.look_at = document.camera.look_from + DVec3::new(0.0, 2.0, -1.0);
    let mut film = Film::new(16, 9, 1);
    film.record(0..1, 0).unwrap();
    keep(&mut window, document, film);
    window.model.view.choose(Show::Normals);
    window.model.view.look(Some(SlotNumber::ALL[0]));
    let green = |window: &Window| window.layers.value_at([8, 4]).map(|(_, value)| value[1]);
    until(&mut window, &context, "the layer of the slot", |window| window.layer_samples() > 0);
    assert!(green(&window).is_some_and(|green| green > 0.6), "{:?}", green(&window));
    window.model.view.look(None);
    until(&mut window, &context, "the layer of the live picture", |window| {
        green(window).is_some_and(|green| green < 0.6)
    });
}

#[test]
fn a_part_is_saved_of_the_picture_on_the_screen() {
    let mut window = window("weekender --stage normals --size 16x9 --samples 1 --device cpu");
    let (context, directory) = (egui::Context::default(), tempfile::tempdir().unwrap());
    let mut document = window.document().clone();
    document.give_size([4, 2]);
    // Black but for its last pixel.
    keep(&mut window, document, small_film(7, 14.0));
    window.model.view.look(Some(SlotNumber::ALL[0]));
    let path = directory.path().join("part.png");
    window.pending_crop = Some((Crop { first: [2, 0], size: [2, 2] }, path.clone()));
    let _ = context.run_ui(egui::RawInput::default(), |ui| window.follow(ui.ctx()));
    assert!(window.pending_crop.is_none());
    assert_eq!(window.files.saved.wait(), Some(Ok(path.clone())));
    let part = image::open(path).unwrap().to_rgb8();
    assert_eq!(
        (part.dimensions(), part.get_pixel(0, 0).0, part.get_pixel(1, 1).0),
        ((2, 2), [0; 3], [255; 3])
    );
}

#[test]
fn the_picture_that_a_key_would_flip_to_is_at_hand() {
    let mut window = window("weekender --stage normals --size 16x9 --samples 1 --device cpu");
    let mut film = Film::new(16, 9, 1);
    film.record(0..1, 0).unwrap();
    let document = window.document().clone();
    let kept = keep(&mut window, document, film);
    let is_there = |window: &Window| window.slot_actions.picture.shown(&kept).is_some();
    until(&mut window, &egui::Context::default(), "its picture", is_there);
    assert_eq!(window.looked(), None);
}

/// Looks at a kept picture of the same size.
fn look_at_a_slot(window: &mut Window) {
    let document = window.document().clone();
    keep(window, document, Film::new(16, 9, 2));
    window.model.view.look(Some(SlotNumber::ALL[0]));
}

fn present(window: &mut Window) {
    window.toggle_presentation(&egui::Context::default());
}

#[test]
fn escape_leaves_what_is_in_front() {
    type Prepare = fn(&mut Window);
    let live = Command::Slot(SlotCommand::LookLive);
    // What the window shows, what Escape then does, and whether the card with what others left stays.
    let cases: [(&str, Prepare, Option<Command>, bool); 21] = [
        ("nothing", |_| {}, None, false),
        ("full screen", |window| window.model.is_full_screen = true, Some(Command::FullScreen), false),
        ("a presentation", present, Some(Command::Present), false),
        ("a slot", look_at_a_slot, Some(live), false),
        (
            "a view",
            |window| window.model.view.choose(Show::Normals),
            Some(Command::Show(Show::Picture)),
            false,
        ),
        (
            "a wipe",
            |window| window.model.view.toggle(Mode::Wipe, With::Stage),
            Some(Command::Show(Show::Picture)),
            false,
        ),
        ("a sight", Window::toggle_sight, Some(Command::ShowMe), false),
        ("a selection", |window| window.model.selected = Some(1), Some(Command::Deselect), false),
        (
            "a selection behind a slot",
            |window| {
                window.model.selected = Some(1);
                look_at_a_slot(window);
            },
            Some(live),
            false,
        ),
        ("a crop", |window| window.model.view.crop = Some(None), Some(Command::Crop), false),
        ("first steps", |window| window.model.has_first_steps = true, Some(Command::FirstSteps), false),
        (
            "first steps behind a presentation",
            |window| {
                window.model.has_first_steps = true;
                present(window);
            },
            Some(Command::Present),
            false,
        ),
        ("the code", |window| window.model.remembered.has_code = true, Some(Command::Code), false),
        (
            "hidden code",
            |window| (window.model.remembered.has_code, window.model.remembered.has_panels) = (true, false),
            None,
            false,
        ),
        (
            "the code behind a presentation",
            |window| {
                window.model.remembered.has_code = true;
                present(window);
            },
            Some(Command::Present),
            false,
        ),
        ("a control", |window| (window.had_focus, window.model.selected) = (true, Some(1)), None, false),
        (
            "a dialog",
            |window| {
                window.model.selected = Some(1);
                window.ask_path(Purpose::Open);
            },
            None,
            false,
        ),
        (
            "the card over a selection",
            |window| (window.model.has_recovered, window.model.selected) = (true, Some(1)),
            None,
            false,
        ),
        (
            "the card in place of the first steps",
            |window| (window.model.has_recovered, window.model.has_first_steps) = (true, true),
            None,
            false,
        ),
        (
            "the code over the card",
            |window| (window.model.has_recovered, window.model.remembered.has_code) = (true, true),
            Some(Command::Code),
            true,
        ),
        (
            "a presentation over the card",
            |window| {
                window.model.has_recovered = true;
                present(window);
            },
            Some(Command::Present),
            true,
        ),
    ];
    for (name, prepare, expected, has_card) in cases {
        let mut window = window("weekender --stage glass-schlick --size 16x9 --device cpu");
        prepare(&mut window);
        let (key, physical_key, modifiers) = (egui::Key::Escape, None, egui::Modifiers::NONE);
        let press = egui::Event::Key { key, physical_key, pressed: true, repeat: false, modifiers };
        let input = egui::RawInput { events: vec![press], ..egui::RawInput::default() };
        let _ = egui::Context::default().run_ui(input, |ui| window.take_input(ui.ctx()));
        assert_eq!(window.commands, Vec::from_iter(expected), "{name}");
        assert_eq!(window.model.has_recovered, has_card, "{name}");
    }
}

#[test]
fn what_is_typed_after_a_tab_waits_for_frames_of_its_own() {
    let (mut window, context) = (window("weekender --stage normals"), egui::Context::default());
    let text = |text: &str| egui::Event::Text(text.to_owned());
    let (key, physical_key, modifiers) = (egui::Key::Tab, None, egui::Modifiers::NONE);
    let tab = egui::Event::Key { key, physical_key, pressed: true, repeat: false, modifiers };
    let mut arriving = vec![text("1"), tab.clone(), text("2")];
    for (expected, is_more) in [(text("1"), true), (tab, true), (text("2"), false)] {
        let mut raw = egui::RawInput { events: std::mem::take(&mut arriving), ..egui::RawInput::default() };
        let sleep = sleep_after(&context, |context| {
            eframe::App::raw_input_hook(&mut window, context, &mut raw);
        });
        assert_eq!(raw.events, [expected]);
        assert_eq!(sleep == Duration::ZERO, is_more);
    }
}

#[test]
fn a_film_that_is_about_to_go_on_keeps_its_size() {
    for (is_pending, is_read, size) in
        [(false, false, [400, 225]), (true, false, [16, 9]), (false, true, [16, 9])]
    {
        let mut window = window("weekender --stage metal --device cpu");
        window.model.remembered.sizing = Sizing::Book;
        window.model.document.set_size([16, 9]);
        window.pending_film = is_pending.then(|| Film::new(16, 9, 2));
        window.recovery.resuming = is_read.then(|| window.document().clone());
        window.follow_size(&egui::Context::default());
        assert_eq!(window.document().size(), size, "{is_pending} {is_read}");
    }
}

#[test]
fn a_picture_that_a_film_is_subtracted_from_keeps_its_size() {
    let mut window = window("weekender --stage normals --device cpu");
    let context = egui::Context::default();
    until(&mut window, &context, "a picture", |window| window.main.has_samples(window.document()));
    let [width, height] = window.document().size();
    let means = vec![[0.0; 3]; (width * height) as usize];
    let reference = ReferenceMeans { width, height, means, identity: None };
    window.model.view.reference = Some(Arc::new(reference));
    window.model.view.choose(Show::Difference);
    window.model.remembered.has_panels = false;
    let has_decided =
        |window: &Window| window.sizer.offer().is_some() || window.document().size() != [width, height];
    until(&mut window, &context, "another room", has_decided);
    assert_eq!((window.document().size(), window.show()), ([width, height], Show::Difference));
}

#[test]
fn an_injected_crash_comes_with_the_samples_that_it_waits_for() {
    let mut window = window("weekender --stage normals --size 16x9 --samples 1 --device cpu");
    let context = egui::Context::default();
    until(&mut window, &context, "a picture", |window| window.main.has_samples(window.document()));
    for (samples, crashes) in [(2, false), (1, true)] {
        window.crashes_at = Some(samples);
        assert_eq!(caught(|| window.poll(&context)).is_err(), crashes, "{samples}");
    }
}

#[test]
fn a_document_that_cannot_be_rendered_says_why_until_it_can() {
    let mut window = window("weekender --stage normals --size 16x9 --samples 1 --device cpu");
    let context = egui::Context::default();
    for (angle, is_invalid) in [(90.0, false), (0.0, true), (80.0, false)] {
        window.model.document.camera.vfov_degrees = angle;
        let _ = context.run_ui(egui::RawInput::default(), |ui| window.follow(ui.ctx()));
        assert_eq!(window.facts().invalid.is_some(), is_invalid, "{angle} degrees");
    }
}
