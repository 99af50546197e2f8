//! Tests of the selected sphere in the picture.

use super::*;
use crate::app::model::checked::CheckedScene;
use crate::app::model::origin::Origin;
use crate::app::tests::{Case, Drawings, dressed, leave};
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
fn spheres_are_outlined_and_named() {
    let mut drawings = Drawings::default();
    for stage in ["metal", "hollow-glass", "view-close"] {
        let count = picture(stage, 0).state().selected.as_ref().map_or(0, |selected| selected.count);
        for sphere in 0..count {
            drawings.add(&format!("{stage} {sphere}"), &picture(stage, sphere));
        }
    }
    let mut harness = picture("metal", 1);
    for (name, center, radius) in [
        ("behind another", DVec3::new(0.0, 0.0, -4.0), 1.5),
        ("behind the eye", DVec3::new(0.0, 0.0, 3.0), 0.5),
        ("tiny", DVec3::new(0.5, 0.5, -1.0), 0.01),
        ("all around the eye", DVec3::ZERO, 2.0),
        ("far to the left", DVec3::new(-3.5, 0.0, -1.0), 0.5),
        ("above", DVec3::new(0.0, 1.2, -1.0), 0.4),
    ] {
        let picture = harness.state_mut();
        let material = Material::Lambertian { albedo: DVec3::splat(0.5) };
        picture.selected.as_mut().unwrap().body = Body { center, radius, material };
        harness.run_steps(2);
        drawings.add(name, &harness);
    }
    harness.state_mut().selected = None;
    harness.run_steps(2);
    drawings.add("none", &harness);
    assert!(harness.state().selection.drawn.is_none());
    drawings.keep("selections");
}

#[test]
fn the_pointer_shows_what_a_drag_would_do() {
    let mut harness = picture("metal", 1);
    let mut drawings = Drawings::default();
    drawings.add("the pointer is elsewhere", &harness);
    let (middle, handle) = (RECT.center(), handle(&harness));
    at(&mut harness, middle);
    assert_eq!(harness.state().cursor, CursorIcon::Grab);
    at(&mut harness, handle + vec2(GRIP - 0.5, 0.0));
    assert_eq!(harness.state().cursor, CursorIcon::ResizeHorizontal);
    drawings.add("at the handle", &harness);
    at(&mut harness, RECT.left_top() + vec2(5.0, 5.0));
    assert_eq!(harness.state().cursor, CursorIcon::Default, "the sky");
    assert!(!harness.state().is_held && harness.state().edits.is_empty());
    drawings.keep("selection_pointer");
}

#[test]
fn drags_move_and_resize_the_sphere() {
    let mut drawings = Drawings::default();
    for (name, from_handle, modifiers, cursor) in [
        ("its centre", false, Modifiers::NONE, CursorIcon::Grabbing),
        ("level", false, Modifiers::COMMAND, CursorIcon::Move),
        ("its radius", true, Modifiers::NONE, CursorIcon::ResizeHorizontal),
    ] {
        let mut harness = picture("metal", 1);
        let before = harness.state().selected.clone().unwrap().body;
        // From above, where a level drag leads somewhere.
        harness.state_mut().document.camera.look_from.y = 0.5;
        harness.run_steps(1);
        let from = if from_handle { handle(&harness) } else { RECT.center() };
        let to = from + vec2(16.0, 0.0);
        button(&mut harness, from, true, modifiers);
        harness.event_modifiers(Event::PointerMoved(to), modifiers);
        harness.run_steps(1);
        assert!(harness.state().is_held && harness.state().cursor == cursor, "{name}");
        drawings.add(name, &harness);
        let Some(Edit::Change(1, body)) = harness.state().edits.last().copied() else { panic!("{name}") };
        assert_eq!(body.radius > before.radius, from_handle, "{name}: {body:?}");
        // The picture is 400 pixels wide for 320 points, and a unit at the sphere's distance takes 90 points.
        assert_eq!(body.center.x > before.center.x + 0.05, !from_handle, "{name}: {body:?}");
        button(&mut harness, to, false, modifiers);
        leave(&mut harness);
        assert!(!harness.state().is_held && harness.state().selection.held.is_none());
    }
    drawings.keep("selection_drags");
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
fn the_outline_is_made_anew_for_what_changes_it() {
    let mut harness = picture("metal", 1);
    let drawn = |harness: &Harness<'_, Picture>| {
        harness.state().selection.drawn.as_ref().map(|drawn| drawn.outline.points.clone())
    };
    let changes: [Case<Picture>; 4] = [
        ("camera", |picture| picture.document.camera.look_from.x = 0.3),
        ("aspect ratio", |picture| picture.document.settings.width /= 2),
        ("a sphere before it", |picture| add(picture, DVec3::new(0.3, 0.0, -0.4), 0.2, 1)),
        ("itself", |picture| picture.selected.as_mut().unwrap().body.radius = 0.4),
    ];
    for (name, change) in changes {
        let before = drawn(&harness);
        change(harness.state_mut());
        harness.run_steps(1);
        let Picture { document, selected, .. } = harness.state();
        let Body { center, radius, .. } = selected.as_ref().unwrap().body;
        let outline =
            Outline::new(&document.camera, document.aspect(), center, radius, Some(document.scene()));
        assert!(before.is_some_and(|before| before != outline.points), "{name}");
        assert!(drawn(&harness) == Some(outline.points), "{name}");
    }
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
