//! Pictures of different sizes: a wipe scales one to the other, a difference is refused.

use crate::common::{drag_from, has_samples, name_file, open, painted, save, send, until, window};
use eframe::egui::{Key, Pos2, pos2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use std::time::Duration;
use weekender::app::{Command, Show, SlotCommand, SlotNumber, Theme, Window};
use weekender::output::OutputFormat;
use weekender::progressive::{Phase, Stop};

const ONE: SlotNumber = SlotNumber::ALL[0];

fn is_done(window: &Window) -> bool {
    matches!(window.status().phase, Phase::Done(_)) && has_samples(1)(window)
}

/// Keeps the picture and renders another one of this size.
fn keep_and_resize(harness: &mut Harness<'_, Window>, size: [u32; 2]) {
    send(harness, Command::Slot(SlotCommand::Keep));
    until(harness, "a kept picture", |window| window.slot(ONE).is_some());
    harness.state_mut().document_mut().give_size(size);
    harness.run_steps(2);
    until(harness, "the other picture", is_done);
}

fn begin_wipe(harness: &mut Harness<'_, Window>) {
    send(harness, Command::Slot(SlotCommand::Wipe));
    until(harness, "a wipe", |window| window.is_comparing() && window.has_other_picture());
    harness.run_steps(3);
}

fn told(harness: &Harness<'_, Window>) -> String {
    harness.state().messages().join("\n")
}

fn colour_at(harness: &mut Harness<'_, Window>, at: Pos2) -> [u8; 3] {
    let image = harness.render().unwrap();
    let [red, green, blue, _] = image.get_pixel(at.x as u32, at.y as u32).0;
    [red, green, blue]
}

fn is_near(a: [u8; 3], b: [u8; 3]) -> bool {
    a.iter().zip(b).all(|(a, b)| a.abs_diff(b) < 16)
}

#[test]
fn a_wipe_scales_a_slot_of_another_size() {
    let mut harness = open("--stage metal --size 64x36 --samples 4");
    until(&mut harness, "the end", is_done);
    for (size, words) in [
        ([128, 72], "scaled from 64x36"),
        ([32, 18], "scaled from 64x36"),
        ([40, 40], "scaled from 64x36, with bars"),
    ] {
        let mut harness = open("--stage metal --size 64x36 --samples 4");
        until(&mut harness, "the end", is_done);
        keep_and_resize(&mut harness, size);
        assert_eq!(harness.state().disabled_reason(Command::Slot(SlotCommand::Wipe)), None);
        begin_wipe(&mut harness);
        assert!(painted(&harness, words), "{size:?}");
        let rect = harness.state().picture_rect();
        let aspect = f64::from(rect.width() / rect.height());
        assert!(
            (aspect - f64::from(size[0]) / f64::from(size[1])).abs() < 0.01,
            "the picture keeps its shape"
        );
        // It goes on while the picture changes its size.
        harness.state_mut().document_mut().give_size([48, 27]);
        harness.run_steps(3);
        until(&mut harness, "the end", is_done);
        assert!(harness.state().is_comparing(), "{}", told(&harness));
    }
    keep_and_resize(&mut harness, [64, 36]);
    begin_wipe(&mut harness);
    assert!(!painted(&harness, "scaled"), "pictures of one size are not scaled");
}

/// A square picture beside a wide one: what the kept one shows at a share of its height is at that share of the rectangle,
/// and beside it there is nothing.
#[test]
fn a_scaled_picture_is_in_its_place() {
    let mut harness =
        Harness::builder().with_size([1000.0, 700.0]).with_step_dt(1.0 / 60.0).wgpu().build_ui_state(
            |ui, window: &mut Window| window.ui_in(ui),
            window("--stage lambertian-gamma --size 64x64 --samples 64"),
        );
    send(&mut harness, Command::Theme(Theme::Dark));
    until(&mut harness, "the end", is_done);
    harness.run_steps(10);
    let square = harness.state().picture_rect();
    // In the sky, on the ball, and beside it: in a picture that is stretched, the ball is there.
    let places = [vec2(0.1, 0.25), vec2(0.5, 0.5), vec2(0.1, 0.45)];
    let expected = places.map(|place| colour_at(&mut harness, square.lerp_inside(place)));
    assert!([0, 2].iter().all(|sky| !is_near(expected[*sky], expected[1])), "{expected:?}");
    keep_and_resize(&mut harness, [64, 36]);
    begin_wipe(&mut harness);
    harness.run_steps(300);
    let rect = harness.state().picture_rect();
    let knob = rect.lerp_inside(vec2(harness.state().divider(), 0.5));
    drag_from(&mut harness, knob, vec2(rect.right() - 1.0 - knob.x, 0.0));
    harness.hover_at(pos2(1.0, 1.0));
    harness.run_steps(5);
    assert!(harness.state().divider() > 0.97);
    let side = rect.height();
    let left = rect.center().x - 0.5 * side;
    for (place, expected) in places.into_iter().zip(expected) {
        let at = pos2(left + place.x * side, rect.top() + place.y * side);
        let found = colour_at(&mut harness, at);
        assert!(is_near(found, expected), "{place}: {found:?}, not {expected:?}");
    }
    let bars = [0.1, 0.9].map(|x| colour_at(&mut harness, rect.lerp_inside(vec2(x, 0.8))));
    assert!(bars.iter().all(|bar| bar.iter().all(|byte| *byte < 30)), "{bars:?}");
}

/// The pointer is at a quarter of both pictures.
#[test]
fn the_inspector_takes_the_value_at_the_same_place() {
    let mut harness = open("--stage metal --size 64x36 --samples 4");
    until(&mut harness, "the end", is_done);
    let at = |harness: &mut Harness<'_, Window>, pixel: [u32; 2]| {
        let rect = harness.state().picture_rect();
        let size = harness.state().document().size();
        let share = |axis: usize| (pixel[axis] as f32 + 0.25) / size[axis] as f32;
        let place = rect.lerp_inside(vec2(share(0), share(1)));
        harness.hover_at(place);
        until(harness, "the pixel", |window| window.inspected().is_some_and(|(at, _)| at == pixel));
        harness.run_steps(3);
        std::thread::sleep(Duration::from_millis(30));
        harness.run_steps(3);
        harness.state().inspected().unwrap().1
    };
    let kept = at(&mut harness, [16, 9]);
    keep_and_resize(&mut harness, [128, 72]);
    begin_wipe(&mut harness);
    let mine = at(&mut harness, [32, 18]);
    for (value, whose) in [(mine, "A"), (kept, "B")] {
        let text = format!("{:.5}", value[0]);
        assert!(harness.query_all_by_label(&text).next().is_some(), "{whose}: no {text}");
    }
    assert!(harness.query_by_label("B, other").is_some());
    assert!(harness.query_by_label("A − B").is_none(), "of scaled pictures there is no difference");
}

#[test]
fn a_difference_of_other_sizes_is_refused_and_the_size_is_offered() {
    let mut harness = open("--stage metal --size 64x36 --samples 4");
    until(&mut harness, "the end", is_done);
    keep_and_resize(&mut harness, [128, 72]);
    for command in [SlotCommand::Difference, SlotCommand::OnlyNoise] {
        let reason = harness.state().disabled_reason(Command::Slot(command)).unwrap();
        assert!(reason.contains("64x36") && reason.contains("128x72"), "{reason}");
        assert!(reason.contains("Slots > Set the picture to the slot's size"), "{reason}");
    }
    harness.run_steps(3);
    // The card of the slot has a button for it.
    harness.get_by_label("Set the picture to the size of slot 1").click();
    harness.run_steps(3);
    assert_eq!(harness.state().document().size(), [64, 36]);
    until(&mut harness, "the end", is_done);
    harness.key_press_modifiers(eframe::egui::Modifiers::SHIFT, Key::X);
    until(&mut harness, "a difference", |window| window.is_comparing() && window.has_other_picture());
    let set =
        Command::all().into_iter().find(|command| command.name() == "Set the picture to the slot's size");
    assert!(harness.state().disabled_reason(set.unwrap()).is_some(), "it has that size");
}

/// A difference that is shown ends when the picture gets another size, and says what to do.
#[test]
fn a_difference_ends_with_another_size() {
    let mut harness = open("--stage metal --size 64x36 --samples 4");
    until(&mut harness, "the end", is_done);
    send(&mut harness, Command::Slot(SlotCommand::Keep));
    until(&mut harness, "a kept picture", |window| window.slot(ONE).is_some());
    send(&mut harness, Command::Slot(SlotCommand::Difference));
    until(&mut harness, "a difference", |window| window.is_comparing() && window.has_other_picture());
    harness.state_mut().document_mut().give_size([40, 20]);
    harness.state_mut().document_mut().stop = Stop::at_samples(4);
    harness.run_steps(3);
    assert!(!harness.state().is_comparing());
    assert!(told(&harness).contains("Slots > Set the picture to the slot's size"), "{}", told(&harness));
}

#[test]
fn a_reference_of_another_size_is_loaded_and_its_size_is_offered() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("reference.exr");
    let mut harness = open("--stage metal --size 64x36 --samples 4");
    until(&mut harness, "the end", is_done);
    save(&mut harness, Command::Save(OutputFormat::Exr), &path);
    harness.state_mut().document_mut().give_size([128, 72]);
    harness.run_steps(2);
    until(&mut harness, "the other picture", is_done);
    name_file(&mut harness, Command::LoadReference, &path);
    until(&mut harness, "a reason", |window| {
        window.messages().iter().any(|text| text.contains("is 64x36 and the picture is 128x72"))
    });
    let reason = harness.state().disabled_reason(Command::Show(Show::Difference)).unwrap();
    assert!(reason.contains("File > Set the picture to the reference's size"), "{reason}");
    send(&mut harness, Command::ReferenceSize);
    assert_eq!(harness.state().document().size(), [64, 36]);
    send(&mut harness, Command::Show(Show::Difference));
    assert_eq!(harness.state().show(), Show::Difference);
    assert!(harness.state().disabled_reason(Command::ReferenceSize).is_some());
}
