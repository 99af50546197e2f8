//! Tests of frames.

use super::*;
use crate::app::answers::caught;
use crate::app::model::kept::Kept;
use crate::app::model::kept_view::ShownSlots;
use crate::app::model::slots::{Slot, SlotNumber};
use crate::app::tests::{until, window};
use crate::film::Film;
use crate::system::interrupt::Interrupt;
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
