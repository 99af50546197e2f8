//! Tests of the viewport: clicks and the menu of a right click, the divider, and pictures whose scene stays as it is.

use super::*;
use crate::app::model::edit::Body;
use crate::app::model::kept::Kept;
use crate::app::model::presentation::Presentation;
use crate::app::model::slots::{Slot, SlotNumber};
use crate::app::model::view::With;
use crate::app::pixel_values::PixelValues;
use crate::app::tests::{Case, dressed, facts_of, leave};
use crate::film::Film;
use crate::scene::Pick;
use eframe::egui::{Event, Modifiers, Shape, Vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use std::sync::Arc;

const PRIMARY: PointerButton = PointerButton::Primary;

const PRESENTATION: Presentation =
    Presentation { was_full_screen: false, has_captions: true, is_blank: false };

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

/// Opens the menu of a right click.
fn open_menu(harness: &mut Harness<'_, Picture>, at: Pos2) {
    click(harness, at, PointerButton::Secondary, Modifiers::NONE);
    harness.run_steps(5);
}

#[test]
fn the_menu_of_a_right_click_is_about_where_it_was_opened() {
    let home = camera(&picture());
    let chosen = |name: &str| {
        let mut harness = picture();
        // On the ball at the left.
        let pos = at(&harness, [0.3, 0.5]);
        let seen = under(&harness, pos);
        assert_eq!(seen.sphere, 2);
        open_menu(&mut harness, pos);
        harness.get_by_label_contains(name).click();
        harness.run_steps(5);
        (harness, pos, seen)
    };
    let (harness, ..) = chosen("Select this");
    assert_eq!((selects(&harness), camera(&harness)), (Some(Some(2)), home));
    let (harness, _, seen) = chosen("Focus on this");
    assert_eq!(camera(&harness), Camera { focus_distance: Some(home.depth_of(seen.point)), ..home });
    let (harness, _, seen) = chosen("Look at this");
    assert_eq!(camera(&harness), Camera { look_at: seen.point, ..home });
    let (harness, ..) = chosen("List the paths of this pixel");
    assert_eq!(lists(&harness), Some([4, 4]));
    let (harness, pos, seen) = chosen("Add a sphere here");
    let aspect = harness.state().facts.document().aspect();
    let body = new_body(Some(seen), &home, aspect, place_of(&harness, pos));
    let edits: Vec<Edit> = harness.state().touches.iter().filter_map(|touch| touch.edit).collect();
    assert_eq!(edits, [Edit::Add(body)]);

    // Beside the picture there is nothing to select.
    let mut harness = picture();
    harness.state_mut().facts.model.document.camera.vfov_degrees = 30.0;
    let beside = harness.state().viewport.room().unwrap().center_top() + vec2(0.0, 20.0);
    open_menu(&mut harness, beside);
    assert!(harness.query_by_label_contains("Select this").is_none());
    harness.get_by_label(&Command::Home.name()).click();
    harness.run_steps(5);
    assert_eq!(harness.state().commands, [Command::Home]);
}

/// Shows a kept picture in place of the live one.
fn look_at_slot(picture: &mut Picture) {
    let model = &mut picture.facts.model;
    let mut film = Film::new(16, 9, 1);
    film.record(0..1, 0).unwrap();
    let kept = Arc::new(Kept::new(model.document.clone(), film, Arc::default(), None));
    model.view.slots.put(SlotNumber::ALL[0], Slot { name: String::new(), kept });
    model.view.look(Some(SlotNumber::ALL[0]));
}

#[test]
fn a_menu_lists_what_can_be_done_with_the_picture_that_is_shown() {
    let cases: [(Case<Picture>, [bool; 4]); 5] = [
        (("the live one", |_| ()), [true, false, false, false]),
        (
            ("a sphere is selected", |picture| picture.facts.model.selected = Some(1)),
            [true, true, false, false],
        ),
        (("a slot", look_at_slot), [false, false, true, false]),
        (("a crop", |picture| picture.facts.model.view.crop = Some(None)), [false, false, false, true]),
        (
            ("a crop of a slot", |picture| {
                look_at_slot(picture);
                picture.facts.model.view.crop = Some(None);
            }),
            [false, false, false, true],
        ),
    ];
    for ((name, change), expected) in cases {
        let mut harness = picture();
        change(harness.state_mut());
        harness.run_steps(2);
        let pos = at(&harness, [0.3, 0.5]);
        open_menu(&mut harness, pos);
        let look = Command::Slot(SlotCommand::LookLive);
        let found = [Command::Home, Command::DuplicateSphere, look, Command::CopyCrop]
            .map(|command| harness.query_by_label(&command.name()).is_some());
        assert_eq!(found, expected, "{name}");
        assert_eq!(harness.query_by_label_contains("Select this").is_some(), expected[0], "{name}");
    }
}

#[test]
fn the_scene_of_a_kept_picture_or_a_crop_stays_as_it_is() {
    let by = vec2(60.0, -30.0);
    // Whether a click selects, the camera moves, the picture moves, and a part is marked.
    let cases: [(Case<Picture>, [bool; 4]); 3] = [
        (("the live one", |_| ()), [true, true, false, false]),
        (("a slot", look_at_slot), [false, false, true, false]),
        (("a crop", |picture| picture.facts.model.view.crop = Some(None)), [false, false, false, true]),
    ];
    for ((name, change), expected) in cases {
        let mut harness = picture();
        change(harness.state_mut());
        harness.run_steps(2);
        let (before, rect) = (camera(&harness), harness.state().viewport.placement.rect());
        let pos = at(&harness, BALL);
        click(&mut harness, pos, PRIMARY, Modifiers::NONE);
        // Later than a second click.
        harness.run_steps(40);
        drag(&mut harness, pos, pos + by);
        let Picture { viewport, facts, .. } = harness.state();
        let is_marked = facts.model.view.crop.is_some_and(|crop| crop.is_some());
        let moved = viewport.placement.rect().min - rect.min;
        assert!(moved == Vec2::ZERO || moved == by, "{name}: {moved}");
        let found = [selects(&harness).is_some(), camera(&harness) != before, moved == by, is_marked];
        assert_eq!(found, expected, "{name}");
    }
}

/// The part of the screen in which the name of the selected ball is drawn, and the place of the picture.
fn named(stage: &str, change: fn(&mut Picture)) -> (Option<Rect>, Rect) {
    let mut harness = picture_of(stage);
    let body = Body::of(harness.state().facts.document().scene(), 1).unwrap();
    let selected = Selected { sphere: 1, body, material: "blue".to_owned(), count: 4 };
    let name = selected.name();
    harness.state_mut().selected = Some(selected);
    change(harness.state_mut());
    harness.run_steps(2);
    (painted(&harness, &name), harness.state().viewport.placement.rect())
}

#[test]
fn the_selected_sphere_is_shown_in_its_own_picture() {
    let (clip, rect) = named("metal", |_| ());
    assert_eq!(clip, Some(rect));
    assert_eq!(named("metal", look_at_slot).0, None, "a kept picture has spheres of its own");
    // The later stage is at the right of a wipe.
    for (stage, from, to) in [("metal", 0.0, 0.5), ("metal-fuzzy", 0.5, 1.0)] {
        let (clip, rect) = named(stage, |picture| picture.facts.model.view.toggle(Mode::Wipe, With::Stage));
        let own = [from, to].map(|share| rect.left() + share * rect.width());
        let found = clip.unwrap();
        assert!((found.left() - own[0]).abs() + (found.right() - own[1]).abs() < 0.01, "{stage}: {found}");
    }
}

#[test]
fn there_are_axes_where_they_turn_the_camera_and_panels_are_shown() {
    let cases: [(Case<Picture>, bool); 6] = [
        (("the live one", |_| ()), true),
        (("without axes", |picture| picture.facts.model.remembered.has_gizmo = false), false),
        (("without panels", |picture| picture.facts.model.remembered.has_panels = false), false),
        (("a presentation", |picture| picture.facts.model.presentation = Some(PRESENTATION)), false),
        (("a slot", look_at_slot), false),
        (("a crop", |picture| picture.facts.model.view.crop = Some(None)), false),
    ];
    for ((name, change), expected) in cases {
        let mut harness = picture();
        change(harness.state_mut());
        harness.run_steps(2);
        assert_eq!(harness.query_by_label("Axes").is_some(), expected, "{name}");
    }
    assert!(picture_of("ppm-gradient").query_by_label("Axes").is_none(), "it traces no rays");
}

#[test]
fn the_picture_has_a_margin_between_panels_and_none_without() {
    let mut harness = picture();
    for (has_panels, margin) in [(true, 10.0), (false, 0.0)] {
        harness.state_mut().facts.model.remembered.has_panels = has_panels;
        harness.run_steps(2);
        let viewport = &harness.state().viewport;
        let free = viewport.room().unwrap().shrink(margin);
        assert_eq!(viewport.room_pixels(), [free.width() as u32, free.height() as u32], "{has_panels}");
        let rect = viewport.placement.rect();
        assert!((rect.width() - free.width()).abs() < 0.1, "{has_panels}: {rect} in {free}");
    }
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

#[test]
fn a_new_sphere_goes_to_the_pointer_or_to_the_ground_before_the_camera() {
    let mut harness = picture();
    let ground = [0.5, 0.7];
    assert_eq!(harness.state().viewport.aim(), ground);
    let pos = at(&harness, [0.27, 0.75]);
    harness.event(Event::PointerMoved(pos));
    harness.run_steps(1);
    assert_eq!(harness.state().viewport.aim(), place_of(&harness, pos));
    assert_eq!(harness.state().touches.last().unwrap().hovered, Some([4, 6]));
    let beside = harness.state().viewport.room().unwrap().center_top() + vec2(0.0, 20.0);
    harness.event(Event::PointerMoved(beside));
    harness.run_steps(1);
    let Picture { viewport, touches, .. } = harness.state();
    assert_eq!((viewport.aim(), touches.last().unwrap().hovered), (ground, None));
    harness.event(Event::PointerMoved(pos));
    leave(&mut harness);
    assert_eq!(harness.state().viewport.aim(), ground);
}
