//! Tests of the keyboard.

use super::*;

fn key(key: Key, modifiers: Modifiers) -> egui::Event {
    egui::Event::Key { key, physical_key: None, pressed: true, repeat: false, modifiers }
}

/// The commands of these events, and whether held keys may move the camera then.
fn taken(events: Vec<egui::Event>, context: &egui::Context) -> (Vec<Command>, bool) {
    let input = egui::RawInput { events, ..egui::RawInput::default() };
    let (mut commands, mut is_free) = (Vec::new(), false);
    context.run_ui(input, |ui| is_free = take_keys(ui.ctx(), false, &mut commands)).textures_delta.clear();
    (commands, is_free)
}

#[test]
fn each_press_counts_and_a_dialog_gets_the_keys_that_follow() {
    let context = egui::Context::default();
    let plain = |pressed| key(pressed, Modifiers::NONE);
    let thrice = vec![plain(Key::Plus), plain(Key::Plus), plain(Key::Plus)];
    assert_eq!(taken(thrice, &context).0, [Command::Brighter; 3]);
    let dialog = vec![key(Key::P, Modifiers::COMMAND), plain(Key::M)];
    assert_eq!(taken(dialog, &context), (vec![Command::Palette], false));
    let copied = vec![egui::Event::Copy, egui::Event::Text("c".to_owned())];
    assert_eq!(taken(copied, &context).0, [Command::Copy]);
}

#[test]
fn a_control_with_the_keyboard_keeps_its_own_keys() {
    for (pressed, command) in [
        (Key::Space, Command::Pause),
        (Key::Tab, Command::Panels),
        (Key::ArrowRight, Command::NextRay),
        (Key::ArrowLeft, Command::PreviousRay),
        (Key::F, Command::Fit),
    ] {
        for is_focused in [false, true] {
            let context = egui::Context::default();
            if is_focused {
                context.memory_mut(|memory| memory.request_focus(egui::Id::unique("a control")));
            }
            let expected = if is_focused && pressed != Key::F { vec![] } else { vec![command] };
            let found = taken(vec![key(pressed, Modifiers::NONE)], &context).0;
            assert_eq!(found, expected, "{pressed:?}");
        }
    }
}

/// How far a camera, four units before what it looks at, flies in a frame while these keys are held.
fn flown_in(seconds: f32, keys: &[(Key, Modifiers)], modifiers: Modifiers) -> Option<DVec3> {
    let context = egui::Context::default();
    let before = Camera { look_from: DVec3::new(0.0, 0.0, 4.0), look_at: DVec3::ZERO, ..Camera::BOOK };
    let mut camera = before;
    let mut has_moved = false;
    let mut events: Vec<egui::Event> = keys.iter().map(|(pressed, with)| key(*pressed, *with)).collect();
    events.push(egui::Event::ModifiersChanged(modifiers));
    for events in [events, Vec::new()] {
        let input = egui::RawInput { events, predicted_dt: seconds, ..egui::RawInput::default() };
        context
            .run_ui(input, |ui| {
                camera = before;
                has_moved = fly(ui.ctx(), &mut camera);
            })
            .textures_delta
            .clear();
    }
    assert_eq!(has_moved, camera != before);
    has_moved.then(|| camera.look_from - before.look_from)
}

fn flown(keys: &[(Key, Modifiers)], modifiers: Modifiers) -> Option<DVec3> {
    flown_in(0.04, keys, modifiers)
}

#[test]
fn held_keys_fly_as_fast_as_the_scene_is_large() {
    let none = Modifiers::NONE;
    let step = flown(&[(Key::D, none)], none).unwrap();
    // Seven tenths of four units a second, in a frame of at most a twentieth.
    assert!(step.distance(DVec3::X * (0.7 * 4.0 * 0.04)) < 1e-6, "{step}");
    let long = flown_in(1.0, &[(Key::D, none)], none).unwrap();
    assert!(long.distance(DVec3::X * (0.7 * 4.0 * 0.05)) < 1e-6, "{long}");
    for (pressed, along) in [
        (Key::A, DVec3::NEG_X),
        (Key::E, DVec3::Y),
        (Key::Q, DVec3::NEG_Y),
        (Key::W, DVec3::NEG_Z),
        (Key::S, DVec3::Z),
    ] {
        let found = flown(&[(pressed, none)], none).unwrap();
        assert!(found.distance(along * step.x) < 1e-9, "{pressed:?}: {found}");
    }
    let fast = flown(&[(Key::D, none)], Modifiers::SHIFT).unwrap();
    assert!((fast.x / step.x - 4.0).abs() < 1e-9, "{fast}");
    assert_eq!(flown(&[(Key::A, none), (Key::D, none)], none), None);
    assert_eq!(flown(&[(Key::D, none)], Modifiers::COMMAND), None);
    assert_eq!(flown(&[(Key::D, none)], Modifiers::ALT), None);
    assert_eq!(flown(&[(Key::D, Modifiers::COMMAND)], none), None, "D is still held after Ctrl+D");
    assert_eq!(flown(&[(Key::F, none)], none), None);
}
