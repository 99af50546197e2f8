//! Tests of frames.

use super::*;
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
