//! Tests of the layout.

use super::*;
use crate::app::command::Command;
use crate::app::model::kept::Kept;
use crate::app::model::presentation::Presentation;
use crate::app::model::show::Show;
use crate::app::model::slots::{Slot, SlotNumber};
use crate::app::model::view::With;
use crate::app::tests::{dressed, until, window};
use crate::film::Film;
use crate::progressive::ReferenceMeans;
use crate::stages::Stage;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use glam::DVec3;
use std::sync::Arc;

const ONE: SlotNumber = SlotNumber::ALL[0];
const TWO: SlotNumber = SlotNumber::ALL[1];

/// A window with kept pictures of these sizes in its first slots.
fn with_slots(sizes: &[[u32; 2]]) -> Window {
    let mut window = window("weekender --stage normals --size 16x9 --device cpu");
    for (number, size) in SlotNumber::ALL.into_iter().zip(sizes) {
        let mut document = window.document().clone();
        document.give_size(*size);
        let mut film = Film::new(size[0], size[1], 1);
        film.record(0..1, 0).unwrap();
        let kept = Arc::new(Kept::new(document, film, Arc::default(), None));
        window.model.view.slots.put(number, Slot { name: format!("of {}", size[0]), kept });
    }
    window
}

#[test]
fn a_slot_that_is_shown_or_subtracted_is_named() {
    let mut window = with_slots(&[[16, 9], [16, 9]]);
    let notice = |window: &Window| slot_notice(&window.facts());
    assert_eq!(notice(&window), None);
    window.model.view.look(Some(ONE));
    assert_eq!(notice(&window).as_deref(), Some("slot 1: of 16 (Escape returns)"));
    window.model.view.toggle(Mode::Difference, With::Slot(TWO));
    assert_eq!(notice(&window).as_deref(), Some("A: slot 1: of 16    B: slot 2: of 16"));
    window.model.view.toggle(Mode::Wipe, With::Slot(TWO));
    assert_eq!(notice(&window), None, "the titles of a wipe say it");
    window.model.view.look(None);
    window.model.view.toggle(Mode::Difference, With::Stage);
    assert_eq!(notice(&window), None);
}

#[test]
fn a_card_leaves_the_titles_free_where_it_would_cover_them() {
    let mut window = with_slots(&[[16, 9]]);
    let room = |height: f32| Rect::from_min_size(egui::pos2(10.0, 20.0), egui::vec2(320.0, height));
    let below = |window: &Window, height: f32| window.below_titles(room(height), &window.facts());
    let place = |window: &mut Window, top: f32| {
        let at = room(180.0).translate(egui::vec2(0.0, top));
        window.viewport.placement.place(at, egui::vec2(16.0, 9.0), 1.0);
    };
    place(&mut window, 0.0);
    assert_eq!(below(&window, 400.0), room(400.0), "nothing has a title");
    window.model.view.look(Some(ONE));
    let lower = |by: f32, height: f32| Rect { min: egui::pos2(10.0, 20.0 + by), ..room(height) };
    assert_eq!(below(&window, 400.0), lower(64.0, 400.0));
    assert_eq!(below(&window, 193.0), lower(64.0, 193.0));
    assert_eq!(below(&window, 192.0), room(192.0), "hardly anything would be left");
    place(&mut window, 239.0);
    assert_eq!(below(&window, 600.0), lower(303.0, 600.0));
    place(&mut window, 240.0);
    assert_eq!(below(&window, 600.0), room(600.0), "the titles are below the card");
    place(&mut window, -50.0);
    assert_eq!(below(&window, 400.0), lower(64.0, 400.0), "the titles are in sight");
}

#[test]
fn the_other_picture_is_told_at_the_same_place() {
    let mut window = with_slots(&[[16, 9], [32, 18], [9, 9]]);
    let other = |window: &Window, at| other_pixel(&window.model.view, &window.second, window.document(), at);
    assert_eq!(other(&window, [3, 2]), None);
    window.model.view.toggle(Mode::Wipe, With::Slot(ONE));
    assert_eq!(other(&window, [3, 2]), Some(OtherPixel { mean: [0.0; 3], scaled: None }));
    window.model.view.toggle(Mode::Wipe, With::Slot(TWO));
    assert_eq!(other(&window, [3, 4]), Some(OtherPixel { mean: [0.0; 3], scaled: Some([7, 9]) }));
    window.model.view.toggle(Mode::Wipe, With::Slot(SlotNumber::ALL[2]));
    assert_eq!(other(&window, [0, 2]), None, "beside the other picture");
}

#[test]
fn the_reference_is_told_at_the_pixel_while_the_difference_from_it_is_shown() {
    let mut window = with_slots(&[]);
    let means = (0..16 * 9_u16).map(|index| [f32::from(index); 3]).collect();
    let reference = ReferenceMeans { width: 16, height: 9, means, identity: None };
    window.model.view.reference = Some(Arc::new(reference));
    let other = |window: &Window| other_pixel(&window.model.view, &window.second, window.document(), [3, 2]);
    assert_eq!(other(&window), None, "it is not shown");
    window.model.view.choose(Show::Difference);
    // Two rows of 16 pixels are above it, and three pixels at its left.
    assert_eq!(other(&window), Some(OtherPixel { mean: [35.0; 3], scaled: None }));
}

#[test]
fn a_card_leaves_free_that_the_camera_is_inside_a_sphere() {
    let context = egui::Context::default();
    let mut window = window("weekender --stage glass-schlick --size 16x9 --device cpu");
    let room = Rect::from_min_size(egui::pos2(10.0, 20.0), egui::vec2(320.0, 400.0));
    let below = |window: &mut Window| {
        window.viewport.placement.place(room, egui::vec2(16.0, 9.0), 1.0);
        window.below_titles(room, &window.facts())
    };
    assert_eq!(below(&mut window), room);
    // In the blue ball.
    window.model.document.camera.look_from = DVec3::new(0.0, 0.0, -1.2);
    until(&mut window, &context, "the camera is inside", |window| {
        window.surfaces.inside(window.document()).is_some()
    });
    // The picture is 180 points high, in the middle of the room.
    assert_eq!(below(&mut window), Rect { min: egui::pos2(10.0, 130.0 + TITLES), ..room });
}

#[test]
fn a_panel_about_another_picture_begins_at_its_top() {
    let draw = |ui: &mut egui::Ui, name: &mut &str| {
        let panel = egui::Panel::right("about").default_size(200.0);
        scrolling(ui, panel, Some(*name), |ui| {
            (0..60).for_each(|line| _ = ui.label(format!("line {line}")));
        });
    };
    let mut harness = dressed([400.0, 300.0]).build_ui_state(draw, "first");
    let top = |harness: &Harness<'_, &str>| harness.get_by_label("line 0").rect().top();
    let before = top(&harness);
    harness.event(egui::Event::PointerMoved(egui::pos2(320.0, 150.0)));
    harness.event(egui::Event::MouseWheel {
        unit: egui::MouseWheelUnit::Point,
        delta: egui::vec2(0.0, -200.0),
        phase: egui::TouchPhase::Move,
        source: egui::MouseWheelSource::Wheel,
        modifiers: egui::Modifiers::NONE,
    });
    harness.run_steps(12);
    assert!(top(&harness) < before - 100.0, "it is scrolled, and stays so");
    *harness.state_mut() = "second";
    harness.run_steps(3);
    assert_eq!(top(&harness), before);
}
