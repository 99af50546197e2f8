//! Tests of the viewport: clicks and the menu of a right click, the divider, and pictures whose scene stays as it is.

use super::*;
use crate::app::model::view::With;
use crate::app::pixel_values::PixelValues;
use crate::app::tests::{dressed, facts_of};
use crate::scene::Pick;
use eframe::egui::{Event, Modifiers, Shape, Vec2};
use egui_kittest::Harness;

const PRIMARY: PointerButton = PointerButton::Primary;

/// A place on the ball in the middle, and one in the sky.
const BALL: [f32; 2] = [0.55, 0.47];
const SKY: [f32; 2] = [0.5, 0.1];

/// A picture of balls, of which nothing has been rendered.
struct Picture {
    viewport: Viewport,
    facts: Facts,
    selected: Option<Selected>,
    surfaces: Surfaces,
    commands: Vec<Command>,
    /// What the user has done, frame by frame.
    touches: Vec<Touch>,
}

fn picture_of(stage: &str) -> Harness<'static, Picture> {
    let draw = |ui: &mut Ui, picture: &mut Picture| {
        let Picture { viewport, facts, selected, surfaces, commands, touches } = picture;
        let mut camera = facts.document().camera;
        let (mut divider, mut crop) = (facts.model.view.divider, facts.model.view.crop);
        let values = PixelValues::default();
        let pictures = Pictures {
            main: None,
            has_film: false,
            second: None,
            paths: None,
            values: &values,
            notices: Vec::new(),
        };
        let handle = Handle {
            camera: &mut camera,
            divider: &mut divider,
            selected: selected.as_ref(),
            crop: &mut crop,
            surfaces,
        };
        touches.push(viewport.ui(ui, handle, pictures, facts, commands));
        facts.model.document.camera = camera;
        (facts.model.view.divider, facts.model.view.crop) = (divider, crop);
    };
    let picture = Picture {
        viewport: Viewport::default(),
        facts: facts_of(&format!("--stage {stage} --size 16x9")),
        selected: None,
        surfaces: Surfaces::default(),
        commands: Vec::new(),
        touches: Vec::new(),
    };
    dressed([900.0, 700.0]).with_step_dt(1.0 / 60.0).build_ui_state(draw, picture)
}

fn picture() -> Harness<'static, Picture> {
    picture_of("metal")
}

/// The point of the screen at this place of the picture.
fn at(harness: &Harness<'_, Picture>, place: [f32; 2]) -> Pos2 {
    harness.state().viewport.placement.rect().lerp_inside(Vec2::from(place))
}

/// The position in the picture of a point of the screen.
fn place_of(harness: &Harness<'_, Picture>, at: Pos2) -> [f64; 2] {
    place_at(harness.state().viewport.placement.rect(), at)
}

/// What the camera sees at a point of the screen.
fn under(harness: &Harness<'_, Picture>, at: Pos2) -> Pick {
    let document = harness.state().facts.document();
    let direction = document.camera.direction_through(place_of(harness, at), document.aspect());
    document.scene().pick(document.camera.look_from, direction).unwrap()
}

fn camera(harness: &Harness<'_, Picture>) -> Camera {
    harness.state().facts.document().camera
}

/// The sphere that was selected, if something was.
fn selects(harness: &Harness<'_, Picture>) -> Option<Option<usize>> {
    harness.state().touches.iter().find_map(|touch| touch.select)
}

/// The pixel whose paths were asked for.
fn lists(harness: &Harness<'_, Picture>) -> Option<[u32; 2]> {
    harness.state().touches.iter().find_map(|touch| touch.listed)
}

/// The part of the screen in which these words are drawn; `None` if they are not.
fn painted(harness: &Harness<'_, Picture>, words: &str) -> Option<Rect> {
    let is_it = |shape: &Shape| matches!(shape, Shape::Text(text) if text.galley.text() == words);
    harness.output().shapes.iter().find(|clipped| is_it(&clipped.shape)).map(|clipped| clipped.clip_rect)
}

fn click(harness: &mut Harness<'_, Picture>, at: Pos2, button: PointerButton, modifiers: Modifiers) {
    harness.event(Event::PointerMoved(at));
    for pressed in [true, false] {
        harness.event_modifiers(Event::PointerButton { pos: at, button, pressed, modifiers }, modifiers);
    }
    harness.step();
}

/// Drags with the primary button, and releases it.
fn drag(harness: &mut Harness<'_, Picture>, from: Pos2, to: Pos2) {
    let press = |pos, pressed| {
        let (button, modifiers) = (PRIMARY, Modifiers::NONE);
        Event::PointerButton { pos, button, pressed, modifiers }
    };
    harness.event(Event::PointerMoved(from));
    harness.event(press(from, true));
    harness.event(Event::PointerMoved(to));
    harness.event(press(to, false));
    harness.run_steps(2);
}

#[test]
fn a_click_selects_focuses_or_lists_paths_and_a_second_one_looks_there() {
    let home = camera(&picture());
    let clicked = |place: [f32; 2], modifiers: Modifiers| {
        let mut harness = picture();
        let pos = at(&harness, place);
        let seen = (place == BALL).then(|| under(&harness, pos));
        click(&mut harness, pos, PRIMARY, modifiers);
        (harness, seen)
    };
    let (mut harness, seen) = clicked(BALL, Modifiers::NONE);
    let seen = seen.unwrap();
    assert_eq!((seen.sphere, selects(&harness), lists(&harness)), (1, Some(Some(1)), None));
    assert_eq!(camera(&harness), home);
    let pos = at(&harness, BALL);
    click(&mut harness, pos, PRIMARY, Modifiers::NONE);
    assert_eq!(camera(&harness), Camera { look_at: seen.point, ..home }, "a double click");
    assert!(painted(&harness, "centre").is_some());

    let (harness, _) = clicked(SKY, Modifiers::NONE);
    assert_eq!((selects(&harness), camera(&harness)), (Some(None), home));
    assert!(painted(&harness, "sky").is_some());

    let (harness, _) = clicked(BALL, Modifiers::ALT);
    // 8.8 pixels from the left and 4.2 from the top.
    assert_eq!((selects(&harness), lists(&harness), camera(&harness)), (None, Some([8, 4]), home));

    let (harness, _) = clicked(BALL, Modifiers::COMMAND);
    let depth = home.depth_of(seen.point);
    assert_eq!(camera(&harness), Camera { focus_distance: Some(depth), ..home });
    assert_eq!((selects(&harness), lists(&harness)), (None, None));
    assert!(painted(&harness, &format!("focus {depth:.3} (a pinhole is sharp everywhere)")).is_some());
    let (harness, _) = clicked(SKY, Modifiers::COMMAND);
    assert!(camera(&harness) == home && painted(&harness, "sky").is_some());
}

#[test]
fn the_divider_of_a_wipe_is_dragged_from_nearby_and_within_the_picture() {
    for (beside, to, expected) in [
        (GRIP - 1.0, 0.25, Some(0.25)),
        (1.0 - GRIP, 0.75, Some(0.75)),
        (0.0, -0.1, Some(0.0)),
        (0.0, 1.1, Some(1.0)),
        (GRIP + 1.0, 0.25, None),
        (-GRIP - 1.0, 0.75, None),
    ] {
        let mut harness = picture();
        harness.state_mut().facts.model.view.toggle(Mode::Wipe, With::Stage);
        harness.run_steps(1);
        let before = camera(&harness);
        let from = at(&harness, [0.5, 0.1]) + vec2(beside, 0.0);
        harness.event(Event::PointerMoved(from));
        harness.run_steps(1);
        let is_shown = harness.output().platform_output.cursor_icon == CursorIcon::ResizeHorizontal;
        assert_eq!(is_shown, expected.is_some(), "{beside}");
        let to = at(&harness, [to, 0.2]);
        drag(&mut harness, from, to);
        let divider = harness.state().facts.model.view.divider;
        assert!((divider - expected.unwrap_or(0.5)).abs() < 1e-3, "{beside}: {divider}");
        assert_eq!(camera(&harness) == before, expected.is_some(), "{beside}");
        let elsewhere = at(&harness, [0.6, 0.6]);
        harness.event(Event::PointerMoved(elsewhere));
        harness.run_steps(1);
        assert_eq!(harness.state().facts.model.view.divider, divider);
    }
    let mut harness = picture();
    let (before, ends) = (camera(&harness), [[0.5, 0.1], [0.25, 0.2]].map(|place| at(&harness, place)));
    drag(&mut harness, ends[0], ends[1]);
    assert_eq!(harness.state().facts.model.view.divider, 0.5);
    assert_ne!(camera(&harness), before);
}
