//! Tests of the selected sphere in the picture.

use super::*;
use crate::app::model::origin::Origin;
use crate::app::tests::dressed;
use crate::stages::Stage;
use eframe::egui::{Event, Modifiers, Sense};
use egui_kittest::Harness;

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
