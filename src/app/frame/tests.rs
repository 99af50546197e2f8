//! Tests of frames.

use super::*;
use crate::app::kept::on_screen::small_film;
use crate::app::model::crop::Crop;
use crate::app::model::document::Document;
use crate::app::model::kept::Kept;
use crate::app::model::kept_view::ShownSlots;
use crate::app::model::slots::{Slot, SlotNumber};
use crate::app::tests::{until, window};
use crate::film::Film;
use crate::interrupt::Interrupt;
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
