//! The mouse on the picture, and what the picture shows.

use crate::common::{SMALL, choose_from_menu, control, drag, has_samples, middle, open, send, until};
use eframe::egui::{self, Key, Modifiers, PointerButton};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use weekender::app::{Command, Show, Window};
use weekender::stages::Stage;

#[test]
fn drags_move_the_camera_and_undo_brings_it_back() {
    let mut harness = open("--stage view-distant");
    until(&mut harness, "a picture", has_samples(1));
    let before = harness.state().document().camera;
    // Undo returns only to states that have lasted for a moment.
    harness.run_steps(90);

    drag(&mut harness, PointerButton::Primary, Modifiers::NONE);
    let orbited = harness.state().document().camera;
    assert_ne!(orbited.look_from, before.look_from);
    until(&mut harness, "the full size", has_samples(1));

    drag(&mut harness, PointerButton::Secondary, Modifiers::NONE);
    let looked = harness.state().document().camera;
    assert_eq!(looked.look_from, orbited.look_from);
    assert_ne!(looked.look_at, orbited.look_at);

    harness.key_press(Key::Home);
    harness.run_steps(2);
    assert_eq!(harness.state().document().camera, before);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    harness.run_steps(2);
    assert_ne!(harness.state().document().camera, before);

    let camera = harness.state().document().camera;
    drag(&mut harness, PointerButton::Primary, Modifiers::SHIFT);
    assert_eq!(harness.state().document().camera, camera, "the picture moves, not the camera");
}

/// Where a point of the scene is seen, from 0 to 1 from the upper left.
fn seen(harness: &Harness<'_, Window>, point: glam::DVec3) -> [f64; 2] {
    let document = harness.state().document();
    document.camera.place_of(point, document.aspect()).unwrap()
}

#[test]
fn the_scene_follows_a_drag_and_the_eye_follows_a_right_drag() {
    let mut harness = open("--stage view-distant --size 64x36");
    until(&mut harness, "a picture", has_samples(1));
    let before = harness.state().document().camera;
    // Points nearer than the centre of the orbit move with the mouse, to the right and down.
    let near = before.look_at.lerp(before.look_from, 0.3);
    assert!(seen(&harness, near).map(|share| (share - 0.5).abs() < 1e-9) == [true; 2]);
    drag(&mut harness, PointerButton::Primary, Modifiers::NONE);
    let [x, y] = seen(&harness, near);
    assert!(x > 0.505 && y > 0.505, "orbit: {x}, {y}");
    send(&mut harness, Command::Home);
    assert_eq!(harness.state().document().camera, before);
    // The eye turns to the right and down, so the point that it looked at moves to the left and up.
    drag(&mut harness, PointerButton::Secondary, Modifiers::NONE);
    let [x, y] = seen(&harness, before.look_at);
    assert!(x < 0.495 && y < 0.495, "look: {x}, {y}");
}

#[test]
fn keys_fly_where_they_say() {
    let mut harness = open("--stage view-distant --size 64x36");
    until(&mut harness, "a picture", has_samples(1));
    for (key, expected) in [
        (Key::D, [1, 0, 0]),
        (Key::A, [-1, 0, 0]),
        (Key::E, [0, 1, 0]),
        (Key::Q, [0, -1, 0]),
        (Key::W, [0, 0, 1]),
        (Key::S, [0, 0, -1]),
    ] {
        let before = harness.state().document().camera;
        harness.key_down(key);
        harness.run_steps(3);
        harness.key_up(key);
        harness.run_steps(2);
        let after = harness.state().document().camera;
        let (basis, moved) = (before.basis(), after.look_from - before.look_from);
        let [right, up, ahead] = [moved.dot(basis.u), moved.dot(basis.v), -moved.dot(basis.w)];
        let sign = |along: f64| if along.abs() < 1e-9 { 0 } else { along.signum() as i32 };
        assert_eq!([right, up, ahead].map(sign), expected, "{key:?}");
        assert!((after.look_at - before.look_at).distance(moved) < 1e-9, "{key:?} looks the same way");
    }
}

#[test]
fn the_picture_follows_a_shift_drag() {
    let mut harness = open("--stage view-distant --size 64x36");
    until(&mut harness, "a picture", has_samples(1));
    let before = harness.state().picture_rect();
    drag(&mut harness, PointerButton::Primary, Modifiers::SHIFT);
    let moved = harness.state().picture_rect().min - before.min;
    assert!((moved - egui::vec2(60.0, 30.0)).length() < 12.0, "{moved}");
    drag(&mut harness, PointerButton::Middle, Modifiers::NONE);
    let moved = harness.state().picture_rect().min - before.min;
    assert!((moved - egui::vec2(120.0, 60.0)).length() < 20.0, "{moved}");
}

#[test]
fn the_pointer_grabs_a_picture_that_it_moves() {
    let mut harness = open("--stage view-distant --size 64x36");
    until(&mut harness, "a picture", has_samples(1));
    let pos = middle(&harness);
    let (button, modifiers) = (PointerButton::Middle, Modifiers::NONE);
    harness.event(egui::Event::PointerMoved(pos));
    harness.event(egui::Event::PointerButton { pos, button, pressed: true, modifiers });
    harness.event(egui::Event::PointerMoved(pos + egui::vec2(30.0, 0.0)));
    harness.event(egui::Event::PointerMoved(pos + egui::vec2(60.0, 0.0)));
    harness.step();
    assert_eq!(harness.output().platform_output.cursor_icon, egui::CursorIcon::Grabbing);
}

#[test]
fn ctrl_and_the_wheel_zoom_at_the_pointer() {
    let mut harness = open("--stage view-distant --size 64x36");
    until(&mut harness, "a picture", has_samples(1));
    let before = harness.state().picture_rect();
    for share in [0.2, 0.7] {
        let rect = harness.state().picture_rect();
        let at = before.lerp_inside(egui::vec2(share, 0.3));
        harness.event(egui::Event::PointerMoved(at));
        harness.step();
        harness.event_modifiers(
            egui::Event::MouseWheel {
                unit: egui::MouseWheelUnit::Line,
                delta: egui::vec2(0.0, 2.0),
                phase: egui::TouchPhase::Move,
                source: egui::MouseWheelSource::Wheel,
                modifiers: Modifiers::COMMAND,
            },
            Modifiers::COMMAND,
        );
        harness.run_steps(20);
        let zoomed = harness.state().picture_rect();
        assert!(zoomed.width() > 1.05 * rect.width(), "{rect:?} {zoomed:?}");
        let [old, new] = [rect, zoomed].map(|rect| (at - rect.min) / rect.size());
        let off = (new - old) * zoomed.size();
        // Each frame rounds the corner to a whole pixel.
        assert!(off.length() < 8.0, "off by {off} points, {rect:?} {zoomed:?}");
    }
}

#[test]
fn the_wheel_and_keys_move_and_clicks_aim() {
    let mut harness = open("--stage defocus");
    until(&mut harness, "a picture", has_samples(1));
    let before = harness.state().document().camera;
    let at = middle(&harness);
    harness.event(egui::Event::PointerMoved(at));
    harness.step();
    harness.event(egui::Event::MouseWheel {
        unit: egui::MouseWheelUnit::Line,
        delta: egui::vec2(0.0, 2.0),
        phase: egui::TouchPhase::Move,
        source: egui::MouseWheelSource::Wheel,
        modifiers: Modifiers::NONE,
    });
    harness.run_steps(20);
    let closer = harness.state().document().camera;
    assert!(closer.look_from.distance(closer.look_at) < before.look_from.distance(before.look_at));

    harness.key_down(Key::W);
    harness.run_steps(3);
    harness.key_up(Key::W);
    harness.run_steps(2);
    let flown = harness.state().document().camera;
    assert_ne!(flown.look_at, closer.look_at);

    let click = |harness: &mut Harness<'_, Window>, modifiers| {
        for pressed in [true, false] {
            let button = PointerButton::Primary;
            harness.event_modifiers(
                egui::Event::PointerButton { pos: at, button, pressed, modifiers },
                modifiers,
            );
            harness.step();
        }
    };
    click(&mut harness, Modifiers::COMMAND);
    let focused = harness.state().document().camera;
    assert_eq!(focused.look_at, flown.look_at);
    assert_ne!(focused.focus_distance, flown.focus_distance);
    assert_eq!(harness.state().selected(), None, "Ctrl and a click only focus");
    click(&mut harness, Modifiers::NONE);
    harness.run_steps(2);
    assert_ne!(harness.state().document().camera.look_at, focused.look_at, "a second click at once centres");

    harness.run_steps(60);
    click(&mut harness, Modifiers::ALT);
    until(&mut harness, "sixteen paths", |window| window.listed_paths() == 16);
    harness.run_steps(2);
    assert!(harness.query_by_label_contains("Paths of pixel").is_some());
    let is_open = |harness: &Harness<'_, Window>, index: usize| {
        let header = control(harness, &format!("Path of sample {index}")).rect();
        let next = control(harness, &format!("Path of sample {}", index + 1)).rect();
        next.top() - header.bottom() > 40.0
    };
    harness.run_steps(30);
    assert!(is_open(&harness, 0) && !is_open(&harness, 1));
    // The figures of the pixel above the list may still change, which would move the controls below.
    harness.get_by_label("Path of the sample after").click_accesskit();
    harness.run_steps(30);
    assert!(is_open(&harness, 1) && !is_open(&harness, 0));
    control(&harness, "Path of sample 3").click_accesskit();
    harness.run_steps(30);
    assert!(is_open(&harness, 3) && !is_open(&harness, 1));
    // The arrow keys go through the rays of the open path.
    let rays = |harness: &Harness<'_, Window>| harness.state().explained_ray().expect("a path is open");
    let [first, count] = rays(&harness);
    assert_eq!(first, 1);
    for expected in (2..=count).chain([count]) {
        harness.key_press(Key::ArrowRight);
        harness.run_steps(3);
        assert_eq!(rays(&harness)[0], expected);
    }
    for expected in (1..count).rev().chain([1]) {
        harness.key_press(Key::ArrowLeft);
        harness.run_steps(3);
        assert_eq!(rays(&harness)[0], expected);
    }
    assert!(harness.query_by_label_contains(&format!("ray 1 of {count}")).is_some());
    // The figures above may get another row at this moment; then the control moves and does not react.
    for _ in 0..10 {
        control(&harness, "Paths listed").set_value_accesskit(64.0);
        harness.run_steps(5);
    }
    until(&mut harness, "sixty-four paths", |window| window.listed_paths() == 64);
    control(&harness, "Paths listed").set_value_accesskit(1000.0);
    harness.run_steps(3);
    assert_eq!(harness.state().listed_paths(), 64, "no more than that");
    harness.state_mut().document_mut().settings.seed += 1;
    until(&mut harness, "the paths of another seed", |window| window.listed_paths() == 64);
    // The list may still change, which would move the button.
    harness.get_by_label("Clear paths").click_accesskit();
    harness.run_steps(2);
    assert!(harness.query_by_label_contains("Paths of pixel").is_none());
}

#[test]
fn zoom_commands_change_what_is_seen_and_not_the_picture() {
    let mut harness = open(SMALL);
    until(&mut harness, "a picture", has_samples(1));
    let (fitting, run) = (harness.state().picture_rect(), harness.state().status().run);
    send(&mut harness, Command::ActualSize);
    let actual = harness.state().picture_rect();
    assert_eq!(actual.size(), egui::vec2(32.0, 18.0));
    send(&mut harness, Command::ZoomIn);
    assert_eq!(harness.state().picture_rect().size(), actual.size() * 1.25);
    send(&mut harness, Command::ZoomOut);
    assert!((harness.state().picture_rect().width() - actual.width()).abs() < 1e-3);
    send(&mut harness, Command::Fit);
    assert_eq!(harness.state().picture_rect(), fitting);
    assert_eq!(harness.state().status().run, run);
}

#[test]
fn views_are_shown_and_follow_the_camera() {
    let mut harness = open("--stage defocus --size 64x36");
    until(&mut harness, "a picture", has_samples(2));
    for show in [Show::Normals, Show::Albedo, Show::Bounces] {
        send(&mut harness, Command::Show(show));
        until(&mut harness, "sixteen samples", |window| window.layer_samples() == 16);
        harness.state_mut().document_mut().camera.vfov_degrees += 1.0;
        harness.run_steps(2);
        until(&mut harness, "the moved layer", |window| window.layer_samples() == 16);
        assert_eq!(harness.state().show(), show);
    }
    for show in [Show::Occupancy, Show::Error] {
        send(&mut harness, Command::Show(show));
        assert_eq!((harness.state().show(), harness.state().layer_samples()), (show, 0));
    }
    // A stage that sends no rays does not have these views: it says so and shows its picture.
    send(&mut harness, Command::Show(Show::Albedo));
    send(&mut harness, Command::Stage(&Stage::ALL[0]));
    harness.run_steps(2);
    assert_eq!(harness.state().show(), Show::Picture);
    assert!(harness.state().messages().iter().any(|text| text.starts_with("No albedo here")));
    send(&mut harness, Command::Show(Show::Bounces));
    assert_eq!(harness.state().show(), Show::Picture);
}

#[test]
fn the_inspector_tells_what_a_view_shows() {
    let mut harness = open("--stage defocus --size 64x36");
    until(&mut harness, "a picture", has_samples(2));
    let at = middle(&harness);
    harness.event(egui::Event::PointerMoved(at));
    until(&mut harness, "the pixel's value", |window| window.inspected().is_some());
    let views = [(Show::Normals, "normal"), (Show::Albedo, "albedo"), (Show::Bounces, "rays/path")];
    let is_told =
        |harness: &Harness<'_, Window>, name: &str| harness.query_all_by_label(name).next().is_some();
    for (show, name) in views {
        send(&mut harness, Command::Show(show));
        until(&mut harness, "sixteen samples", |window| window.layer_samples() == 16);
        harness.run_steps(2);
        assert!(is_told(&harness, name), "{name}");
    }
    send(&mut harness, Command::Show(Show::Picture));
    assert!(views.iter().all(|(_, name)| !is_told(&harness, name)));
}

#[test]
fn the_menu_of_a_right_click_is_about_what_is_there() {
    let mut harness = open("--stage defocus");
    until(&mut harness, "a picture", has_samples(1));
    let at = middle(&harness) + egui::vec2(40.0, -20.0);
    let choose = |harness: &mut Harness<'_, Window>, name: &str| choose_from_menu(harness, at, name);
    let before = harness.state().document().camera;
    choose(&mut harness, "Focus on this");
    let focused = harness.state().document().camera;
    assert_eq!(focused.look_at, before.look_at);
    assert_ne!(focused.focus_distance, before.focus_distance);
    choose(&mut harness, "Look at this");
    assert_ne!(harness.state().document().camera.look_at, before.look_at);
    choose(&mut harness, "List the paths of this pixel");
    until(&mut harness, "sixteen paths", |window| window.listed_paths() == 16);
}

/// In a long frame, a key can be released before the click is handled.
#[test]
fn a_click_counts_with_the_keys_that_were_held_then() {
    let mut harness = open("--stage defocus");
    until(&mut harness, "a picture", has_samples(1));
    let before = harness.state().document().camera;
    let pos = middle(&harness) + egui::vec2(40.0, -20.0);
    let (button, modifiers) = (PointerButton::Primary, Modifiers::COMMAND);
    harness.event(egui::Event::PointerMoved(pos));
    for pressed in [true, false] {
        harness.event(egui::Event::PointerButton { pos, button, pressed, modifiers });
    }
    harness.run_steps(2);
    assert_ne!(harness.state().document().camera.focus_distance, before.focus_distance);
    assert_eq!(harness.state().selected(), None);
}

#[test]
fn a_key_lists_the_paths_of_the_pixel_under_the_pointer() {
    let mut harness = open(SMALL);
    until(&mut harness, "a picture", has_samples(1));
    assert!(harness.state().disabled_reason(Command::ListPaths).is_some());
    let at = middle(&harness);
    harness.event(egui::Event::PointerMoved(at));
    harness.run_steps(2);
    harness.key_press(Key::T);
    until(&mut harness, "sixteen paths", |window| window.listed_paths() == 16);
}

#[test]
fn escape_leaves_a_comparison_and_a_view() {
    let mut harness = open(SMALL);
    until(&mut harness, "a picture", has_samples(1));
    for command in [Command::WipeDifference, Command::Wipe, Command::Show(Show::Error)] {
        send(&mut harness, command);
        harness.run_steps(5);
        let is_other = |window: &Window| window.is_comparing() || window.show() != Show::Picture;
        assert!(is_other(harness.state()), "{command:?}");
        harness.key_press(Key::Escape);
        harness.run_steps(3);
        assert!(!is_other(harness.state()), "{command:?}");
    }
}

/// A click counts although a frame took long between press and release.
#[test]
fn a_click_in_a_long_frame_is_not_lost() {
    let mut harness = open(SMALL);
    until(&mut harness, "a picture", has_samples(1));
    let pos = control(&harness, &Command::Device(weekender::app::Device::Reference).name()).rect().center();
    let button = |pressed| egui::Event::PointerButton {
        pos,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    harness.event(egui::Event::PointerMoved(pos));
    harness.step();
    harness.event(button(true));
    harness.step();
    harness.input_mut().time = Some(harness.ctx.input(|input| input.time) + 3.0);
    harness.event(button(false));
    harness.run_steps(2);
    assert_eq!(harness.state_mut().remembered_mut().device, weekender::app::Device::Reference);
}
