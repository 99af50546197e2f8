//! Moving about: orbits and the wheel at what is under the pointer, and the axes in the corner.

use crate::common::{control, drag_from, has_samples, hold, middle, open, send, until};
use crate::objects::on_screen;
use eframe::egui::{self, Key, Modifiers, PointerButton, Pos2, Shape, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use glam::DVec3;
use weekender::app::{Command, Viewpoint, Window};
use weekender::cli::{self, Request};
use weekender::scene::Camera;

fn opened(stage: &str) -> Harness<'static, Window> {
    let mut harness = open(&format!("--stage {stage} --size 64x36"));
    until(&mut harness, "a picture", has_samples(1));
    // Undo returns only to states that have lasted for a moment.
    harness.run_steps(90);
    harness
}

fn camera(harness: &Harness<'_, Window>) -> Camera {
    harness.state().document().camera
}

/// What is seen at a point of the screen.
fn under(harness: &Harness<'_, Window>, at: Pos2) -> Option<DVec3> {
    let document = harness.state().document();
    let along = (at - harness.state().picture_rect().min) / harness.state().picture_rect().size();
    let place = [f64::from(along.x), f64::from(along.y)];
    let direction = document.camera.direction_through(place, document.aspect());
    document.scene().pick(document.camera.look_from, direction).map(|pick| pick.point)
}

/// A point of the screen on the edge of a sphere that is not in the middle of the picture.
fn aside(harness: &Harness<'_, Window>) -> Pos2 {
    on_screen(harness, DVec3::new(-1.0, 0.2, -1.0))
}

fn sky(harness: &Harness<'_, Window>) -> Pos2 {
    let rect = harness.state().picture_rect();
    let points = (0..20).map(|step| rect.lerp_inside(vec2(0.3 + 0.02 * step as f32, 0.02)));
    points.into_iter().find(|at| under(harness, *at).is_none()).unwrap()
}

/// Whether the pivot is marked at this point of the screen.
fn is_marked(harness: &Harness<'_, Window>, at: Pos2) -> bool {
    let shapes = &harness.output().shapes;
    shapes.iter().any(|clipped| {
        matches!(&clipped.shape, Shape::Circle(circle) if circle.center.distance(at) < 1.5 && circle.radius == 6.0)
    })
}

fn scroll(harness: &mut Harness<'_, Window>, at: Pos2, lines: f32) {
    harness.event(egui::Event::PointerMoved(at));
    harness.step();
    harness.event(egui::Event::MouseWheel {
        unit: egui::MouseWheelUnit::Line,
        delta: vec2(0.0, lines),
        phase: egui::TouchPhase::Move,
        source: egui::MouseWheelSource::Wheel,
        modifiers: Modifiers::NONE,
    });
    harness.run_steps(25);
}

/// The copied command line renders the camera of the window.
fn assert_reproduced(harness: &Harness<'_, Window>) {
    let document = harness.state().document();
    let line = document.command_line(1, "cpu", None);
    match cli::parse(line.split_whitespace().map(Into::into)).unwrap() {
        Request::Batch(options) => {
            assert_eq!(*options.renders[0].job.camera(), document.acting_camera(), "{line}");
        }
        other => panic!("{line}: {other:?}"),
    }
}

#[test]
fn a_drag_turns_about_what_was_under_the_pointer() {
    let mut harness = opened("view-distant");
    let (start, before) = (aside(&harness), camera(&harness));
    let pivot = under(&harness, start).expect("a sphere");
    hold(&mut harness, start, true);
    assert!(!is_marked(&harness, start), "nothing turns yet");
    for step in 1..=12 {
        harness.event(egui::Event::PointerMoved(start + vec2(9.0, 4.0) * step as f32));
        harness.step();
        let now = on_screen(&harness, pivot);
        assert!(now.distance(start) < 1.0, "step {step}: the pivot went from {start} to {now}");
        assert!(step < 2 || is_marked(&harness, start), "step {step}");
    }
    let after = camera(&harness);
    assert!(after.look_from.distance(before.look_from) > 0.3 && after.look_at != before.look_at);
    let ahead = |camera: &Camera| camera.look_from.distance(camera.look_at);
    assert!((ahead(&after) / ahead(&before) - 1.0).abs() < 1e-9, "look_at keeps its distance");
    assert_reproduced(&harness);
    hold(&mut harness, start + vec2(108.0, 48.0), false);
    harness.step();
    assert!(!is_marked(&harness, start));
    send(&mut harness, Command::Undo);
    assert_eq!(camera(&harness), before);
}

#[test]
fn in_the_sky_a_drag_turns_about_look_at() {
    let mut harness = opened("view-distant");
    let (start, before) = (sky(&harness), camera(&harness));
    drag_from(&mut harness, start, vec2(60.0, 20.0));
    assert_eq!(camera(&harness).look_at, before.look_at);
    assert_ne!(camera(&harness).look_from, before.look_from);
}

#[test]
fn the_wheel_goes_to_what_is_under_the_pointer_and_never_through() {
    let mut harness = opened("view-distant");
    let (at, before) = (aside(&harness), camera(&harness));
    let point = under(&harness, at).expect("a sphere");
    let far = before.look_from.distance(point);
    scroll(&mut harness, at, 3.0);
    let near = camera(&harness).look_from.distance(point);
    assert!(near < 0.9 * far, "from {far} to {near}");
    assert!(on_screen(&harness, point).distance(at) < 1.0);
    assert_reproduced(&harness);
    for _ in 0..12 {
        scroll(&mut harness, at, 10.0);
    }
    let document = harness.state().document();
    let eye = document.camera.look_from;
    let clearance = document.scene().spheres.iter().map(|sphere| eye.distance(sphere.center) - sphere.radius);
    let clearance = clearance.fold(f64::INFINITY, f64::min);
    assert!(clearance > 0.0 && eye.distance(point) < 0.1, "{clearance}, {eye}");
    assert!(on_screen(&harness, point).distance(at) < 1.0);
    // And back: the same point stays under the pointer.
    scroll(&mut harness, at, -10.0);
    assert!(camera(&harness).look_from.distance(point) > eye.distance(point));
    assert!(on_screen(&harness, point).distance(at) < 1.0);
}

#[test]
fn the_wheel_ends_at_the_point_of_a_slanting_surface_and_does_not_slide_along() {
    let mut harness = opened("view-distant");
    let ground = harness.state().picture_rect().lerp_inside(vec2(0.1, 0.95));
    let point = under(&harness, ground).expect("the ground");
    for _ in 0..40 {
        scroll(&mut harness, ground, 10.0);
        let now = on_screen(&harness, point);
        assert!(now.distance(ground) < 3.0, "the point went from {ground} to {now}");
    }
    let near = camera(&harness).look_from.distance(point);
    assert!(near < 0.5, "it came near: {near}");
}

#[test]
fn the_wheel_in_the_sky_goes_there_at_the_depth_of_look_at() {
    let mut harness = opened("view-distant");
    let (at, before) = (sky(&harness), camera(&harness));
    scroll(&mut harness, at, 2.0);
    let after = camera(&harness);
    let ahead = |camera: &Camera| camera.look_from.distance(camera.look_at);
    assert!(ahead(&after) < 0.95 * ahead(&before));
    assert!(after.basis().w.distance(before.basis().w) < 1e-12, "it looks the same way");
}

#[test]
fn a_click_on_the_axes_flies_to_that_side_in_one_undo_step() {
    let mut harness = opened("view-distant");
    let before = camera(&harness);
    for (name, away, up) in [
        ("View from the right (+x)", DVec3::X, DVec3::Y),
        ("View from the top (+y)", DVec3::Y, DVec3::NEG_Z),
        ("View from the front (+z)", DVec3::Z, DVec3::Y),
        ("View from the left (-x)", DVec3::NEG_X, DVec3::Y),
    ] {
        let start = camera(&harness);
        control(&harness, name).click();
        harness.run_steps(12);
        let halfway = camera(&harness);
        assert!(halfway != start && halfway.basis().w.distance(away) > 0.01, "{name}: on its way");
        harness.run_steps(60);
        let basis = camera(&harness).basis();
        assert!(basis.w.distance(away) < 1e-12 && basis.v.distance(up) < 1e-12, "{name}: {basis:?}");
        let [old, new] = [before, camera(&harness)].map(|camera| camera.effective_focus_distance());
        assert!((old - new).abs() < 1e-9, "{name}");
        assert_eq!(camera(&harness).look_at, before.look_at);
        assert_reproduced(&harness);
        send(&mut harness, Command::Undo);
        assert_eq!(camera(&harness), start, "{name}: one step back");
        send(&mut harness, Command::Redo);
        harness.run_steps(90);
    }
}

#[test]
fn a_view_from_the_top_can_be_turned() {
    let mut harness = opened("view-distant");
    send(&mut harness, Command::ViewFrom(Viewpoint::Top));
    harness.run_steps(60);
    assert_eq!(camera(&harness).vup, DVec3::NEG_Z);
    let (start, above) = (sky_or_corner(&harness), camera(&harness));
    drag_from(&mut harness, start, vec2(30.0, 0.0));
    let turned = camera(&harness);
    assert_eq!(turned.vup, DVec3::Y, "about what is up in the scene");
    let tilt = above.basis().w.angle_between(turned.basis().w).to_degrees();
    assert!(tilt < 1.01, "{tilt}");
    assert!(turned.basis().v.angle_between(above.basis().v).to_degrees() > 5.0, "it has turned");
    drag_from(&mut harness, start, vec2(0.0, -200.0));
    assert!(camera(&harness).basis().w.y < 0.8, "and comes down");
}

fn sky_or_corner(harness: &Harness<'_, Window>) -> Pos2 {
    harness.state().picture_rect().lerp_inside(vec2(0.1, 0.1))
}

#[test]
fn a_drag_on_the_axes_orbits_and_the_keyboard_reaches_them() {
    let mut harness = opened("view-distant");
    let before = camera(&harness);
    let at = control(&harness, "View from the right (+x)").rect().center();
    drag_from(&mut harness, at, vec2(40.0, 0.0));
    let after = camera(&harness);
    assert_eq!(after.look_at, before.look_at);
    assert!(after.look_from.distance(before.look_from) > 0.3);
    harness.run_steps(60);
    assert!(camera(&harness) == after, "a drag is no click");
    control(&harness, "View from the back (-z)").focus();
    harness.run_steps(2);
    harness.key_press(Key::Enter);
    harness.run_steps(60);
    assert!(camera(&harness).basis().w.distance(DVec3::NEG_Z) < 1e-12);
    assert_eq!(harness.state().selected(), None);
}

#[test]
fn the_axes_can_be_hidden_and_stages_without_rays_have_none() {
    let mut harness = opened("view-distant");
    let is_shown =
        |harness: &Harness<'_, Window>| harness.query_all_by_label("View from the top (+y)").next().is_some();
    assert!(is_shown(&harness));
    send(&mut harness, Command::Gizmo);
    assert!(!is_shown(&harness));
    send(&mut harness, Command::Gizmo);
    assert!(is_shown(&harness));
    send(&mut harness, Command::Panels);
    assert!(!is_shown(&harness), "nothing but the picture");
    let mut harness = opened("ppm-tiny");
    assert!(!is_shown(&harness));
    assert!(harness.state().disabled_reason(Command::ViewFrom(Viewpoint::Top)).is_some());
    harness.step();
}

/// Whatever would move the camera or list paths says why nothing happens.
#[test]
fn a_stage_without_rays_refuses_to_move_its_camera_and_has_no_paths() {
    type Act = fn(&mut Harness<'static, Window>, Pos2);
    let acts: [(&str, Act); 6] = [
        ("List the paths of this pixel: this", |harness, _| harness.key_press(Key::T)),
        ("Bookmark this camera: this", |harness, _| {
            harness.key_press_modifiers(Modifiers::COMMAND, Key::B);
        }),
        ("This", |harness, _| {
            harness.key_down(Key::W);
            harness.run_steps(3);
            harness.key_up(Key::W);
        }),
        ("This", |harness, at| drag_from(harness, at, vec2(40.0, 20.0))),
        ("This", |harness, at| scroll(harness, at, 2.0)),
        ("This", |harness, at| {
            hold(harness, at, true);
            hold(harness, at, false);
        }),
    ];
    for (index, (begin, act)) in acts.into_iter().enumerate() {
        let acted = || {
            let mut harness = open("--stage ppm-gradient --size 64x36");
            until(&mut harness, "a picture", has_samples(1));
            let (before, at) = (camera(&harness), middle(&harness));
            harness.event(egui::Event::PointerMoved(at));
            harness.run_steps(2);
            assert!(harness.state().messages().is_empty());
            act(&mut harness, at);
            harness.run_steps(3);
            (harness, before)
        };
        // A machine that stalls may miss a message, which stays for four seconds.
        let mut again = (0..5).map(|_| acted());
        let is_told = |(harness, _): &(Harness<'_, Window>, Camera)| !harness.state().messages().is_empty();
        let (mut harness, before) = again.find(is_told).unwrap_or_else(|| panic!("{index}: nothing is told"));
        let reason =
            format!("{begin} stage traces no rays: its picture depends only on the position of each pixel");
        assert_eq!(harness.state().messages(), [reason], "{index}");
        assert_eq!((camera(&harness), harness.state().listed_paths()), (before, 0), "{index}");
        assert!(harness.state().disabled_reason(Command::Undo).is_some(), "{index}");
        assert!(harness.state_mut().remembered_mut().bookmarks.is_empty(), "{index}");
    }
}

/// A click beside the ends of the axes does not select what is behind them.
#[test]
fn the_axes_hide_the_picture_from_the_mouse() {
    let mut harness = opened("view-distant");
    let ends = Viewpoint::ALL.map(|side| control(&harness, side.name()).rect());
    let all = ends.into_iter().fold(egui::Rect::NOTHING, egui::Rect::union);
    (0..8).for_each(|_| send(&mut harness, Command::ZoomIn));
    let (pos, button, modifiers) = (all.center(), PointerButton::Primary, Modifiers::NONE);
    assert!(harness.state().picture_rect().contains(pos) && under(&harness, pos).is_some());
    assert!(ends.iter().all(|end| !end.contains(pos)), "{ends:?}");
    harness.event(egui::Event::PointerMoved(pos));
    harness.step();
    for pressed in [true, false] {
        harness.event(egui::Event::PointerButton { pos, button, pressed, modifiers });
        harness.step();
    }
    harness.run_steps(2);
    assert_eq!(harness.state().selected(), None);
    let role = control(&harness, "View from the top (+y)").accesskit_node().role();
    assert_eq!(role, egui::Role::Button);
}

/// A new picture with as many samples as the one before is no less new.
#[test]
fn a_resting_pointer_reads_each_new_picture() {
    let mut harness = open("--stage normals --size 32x18 --samples 1");
    until(&mut harness, "a picture", has_samples(1));
    let at = middle(&harness);
    harness.event(egui::Event::PointerMoved(at));
    until(&mut harness, "the pixel", |window| window.inspected().is_some());
    for step in 1..=3 {
        let (pixel, before) = harness.state().inspected().unwrap();
        harness.state_mut().document_mut().camera.look_from.x += 0.2 * f64::from(step);
        let is_another =
            |window: &Window| window.inspected().is_some_and(|(at, mean)| at == pixel && mean != before);
        until(&mut harness, "the value in the new picture", is_another);
    }
}
