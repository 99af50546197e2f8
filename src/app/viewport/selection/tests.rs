//! Tests of the selected sphere in the picture.

use super::*;
use crate::app::model::checked::CheckedScene;
use crate::app::model::origin::Origin;
use crate::app::tests::{dressed, leave};
use crate::scene::Material;
use crate::stages::Stage;
use eframe::egui::{Event, Modifiers, Sense, Shape};
use egui_kittest::Harness;
use glam::DVec3;
use std::sync::Arc;

const RECT: Rect = Rect { min: pos2(20.0, 10.0), max: pos2(340.0, 190.0) };

struct Picture {
    document: Document,
    selected: Option<Selected>,
    selection: Selection,
    is_held: bool,
    edits: Vec<Edit>,
    cursor: CursorIcon,
}

/// A picture of a stage in which a sphere is selected.
fn picture(stage: &str, sphere: usize) -> Harness<'static, Picture> {
    let document = Document::new(Origin::of_stage(Stage::find(stage).unwrap()));
    let selected = selected(&document, sphere);
    let draw = |ui: &mut Ui, picture: &mut Picture| {
        let Picture { document, selected, selection, is_held, edits, cursor } = picture;
        let response = ui.allocate_rect(RECT, Sense::click_and_drag());
        let (held, edit) = selection.handle(ui, &response, RECT, selected.as_ref(), document);
        *is_held = held;
        edits.extend(edit);
        selection.paint(ui, (RECT, RECT), selected.as_ref(), (0, &[]));
        *cursor = ui.ctx().output(|output| output.cursor_icon);
    };
    let picture = Picture {
        document,
        selected: Some(selected),
        selection: Selection::default(),
        is_held: false,
        edits: Vec::new(),
        cursor: CursorIcon::Default,
    };
    dressed([360.0, 200.0]).build_ui_state(draw, picture)
}

fn selected(document: &Document, sphere: usize) -> Selected {
    let body = Body::of(document.scene(), sphere).unwrap();
    let count = document.scene().spheres.len();
    Selected { sphere, body, material: "a material".to_owned(), count }
}

fn at(harness: &mut Harness<'_, Picture>, pos: Pos2) {
    harness.event(Event::PointerMoved(pos));
    harness.run_steps(1);
}

fn button(harness: &mut Harness<'_, Picture>, pos: Pos2, pressed: bool, modifiers: Modifiers) {
    let button = PointerButton::Primary;
    harness.event(Event::PointerMoved(pos));
    harness.event_modifiers(Event::PointerButton { pos, button, pressed, modifiers }, modifiers);
    harness.run_steps(1);
}

/// Where the handle of the selected sphere is on the screen.
fn handle(harness: &Harness<'_, Picture>) -> Pos2 {
    harness.state().selection.handle_at(RECT).unwrap().0
}

#[test]
fn the_name_covers_no_other_words() {
    let document = Document::new(Origin::of_stage(Stage::find("metal").unwrap()));
    let selected = selected(&document, 0);
    let taken = Rect::from_min_max(RECT.min, pos2(RECT.right(), RECT.center().y));
    let draw = |ui: &mut Ui, selection: &mut Selection| {
        selection.draw(&selected, &document);
        selection.paint(ui, (RECT, RECT), Some(&selected), (0, &[taken]));
    };
    let harness = dressed([360.0, 200.0]).build_ui_state(draw, Selection::default());
    let name = harness.output().shapes.iter().find_map(|clipped| match &clipped.shape {
        Shape::Text(text) if text.galley.text() == selected.name() => Some(text.pos),
        _ => None,
    });
    assert!(name.unwrap().y > taken.bottom(), "{name:?}");
}

#[test]
fn drags_beside_the_sphere_or_with_shift_hold_nothing() {
    for (at, modifiers) in
        [(RECT.left_top() + vec2(5.0, 5.0), Modifiers::NONE), (RECT.center(), Modifiers::SHIFT)]
    {
        let mut harness = picture("metal", 1);
        button(&mut harness, at, true, modifiers);
        harness.event_modifiers(Event::PointerMoved(at + vec2(16.0, 0.0)), modifiers);
        harness.run_steps(1);
        assert!(!harness.state().is_held && harness.state().edits.is_empty(), "{modifiers:?}");
    }
}

#[test]
fn a_sphere_that_looks_larger_than_pictures_is_not_dragged() {
    let mut harness = picture("metal", 0);
    assert!(harness.state().selection.extent().is_none(), "the ground");
    button(&mut harness, RECT.center_bottom() - vec2(0.0, 5.0), true, Modifiers::NONE);
    let to = RECT.center_bottom() - vec2(20.0, 5.0);
    harness.event(Event::PointerMoved(to));
    harness.run_steps(1);
    assert!(!harness.state().is_held);
}

/// Adds spheres to the picture.
fn add(picture: &mut Picture, center: DVec3, radius: f64, count: usize) {
    let document = &mut picture.document;
    let mut scene = document.scene().clone();
    (0..count).for_each(|_| scene.add_sphere(center, radius, 0));
    document.checked = Arc::new(CheckedScene::new(Arc::new(scene), *document.rules()));
}

/// The sphere that a drag at the middle of the picture holds if this one is selected. The left sphere is before the
/// middle one there; so many further spheres are out of sight.
fn held_before_another(sphere: usize, further: usize) -> Option<usize> {
    let mut harness = picture("metal", sphere);
    let state = harness.state_mut();
    state.document.camera.look_from = DVec3::new(-2.2, 0.0, -1.0);
    state.document.camera.look_at = DVec3::new(0.0, 0.0, -1.2);
    add(state, DVec3::new(0.0, 900.0, 0.0), 0.01, further);
    harness.run_steps(1);
    button(&mut harness, RECT.center(), true, Modifiers::NONE);
    at(&mut harness, RECT.center() + vec2(16.0, 0.0));
    harness.state().selection.held.map(|held| held.sphere)
}

#[test]
fn what_is_seen_before_the_selected_sphere_hides_it_from_drags() {
    let (middle, left) = (1, 2);
    assert_eq!([middle, left].map(|sphere| held_before_another(sphere, 0)), [None, Some(left)]);
    // Among very many spheres, it would take too long to find out.
    assert_eq!(held_before_another(middle, LARGE - 4), None);
    assert_eq!(held_before_another(middle, LARGE - 3), Some(middle));
}

#[test]
fn a_drag_ends_when_another_sphere_is_selected() {
    let mut harness = picture("metal", 1);
    button(&mut harness, RECT.center(), true, Modifiers::NONE);
    at(&mut harness, RECT.center() + vec2(16.0, 0.0));
    assert!(harness.state().is_held);
    let state = harness.state_mut();
    state.selected = Some(selected(&state.document, 2));
    state.edits.clear();
    at(&mut harness, RECT.center() + vec2(20.0, 0.0));
    let Picture { is_held, edits, selection, .. } = harness.state();
    assert!(!is_held && edits.is_empty() && selection.held.is_none(), "{edits:?}");
}

#[test]
fn a_drag_that_changes_nothing_is_no_edit() {
    let mut harness = picture("metal", 1);
    let middle = RECT.center();
    button(&mut harness, middle, true, Modifiers::NONE);
    at(&mut harness, middle + vec2(16.0, 0.0));
    assert!(harness.state().is_held && harness.state().edits.len() == 1);
    // Where it began.
    at(&mut harness, middle);
    assert!(harness.state().is_held && harness.state().edits.len() == 1, "{:?}", harness.state().edits);
}

#[test]
fn the_name_is_above_the_sphere_and_below_the_notices() {
    let document = Document::new(Origin::of_stage(Stage::find("metal").unwrap()));
    let selected = selected(&document, 1);
    // Where the name is with so many rows of notices, as seen by a camera that looks so far up.
    let top = |rows: usize, up: f64| {
        let mut document = document.clone();
        document.camera.look_at.y = up;
        let selected = selected.clone();
        let draw = move |ui: &mut Ui, selection: &mut Selection| {
            selection.draw(&selected, &document);
            selection.paint(ui, (RECT, RECT), Some(&selected), (rows, &[]));
        };
        let harness = dressed([360.0, 200.0]).build_ui_state(draw, Selection::default());
        let mut shapes = harness.output().shapes.iter();
        let name = shapes.find_map(|clipped| match &clipped.shape {
            Shape::Text(text) if text.galley.text().starts_with("sphere 1, ") => {
                Some(text.visual_bounding_rect())
            }
            _ => None,
        });
        name.unwrap()
    };
    // The ball's upper edge is at about half of the way from the middle of the picture to its top.
    let usual = top(0, 0.0);
    assert!(usual.bottom() < RECT.center().y - 41.0 && usual.top() > RECT.top() + 10.0, "{usual}");
    // Looking down, the camera has the ball at the top of the picture.
    let [none, one, two] = [0, 1, 2].map(|rows| top(rows, -0.6));
    assert!(none.top() > RECT.top() && none.top() < RECT.top() + 34.0, "{none}");
    for (name, rows) in [(one, 1.0), (two, 2.0)] {
        assert!((name.top() - none.top() - rows * ROW).abs() < 0.01, "{none} {name}");
    }
}
