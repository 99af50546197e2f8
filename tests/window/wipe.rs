//! Two pictures on the two sides of a divider, and their difference.

use crate::common::gpu::has_adapter;
use crate::harness::{drag_from, has_samples, open, send, until, window};
use crate::questions::Ask as _;
use eframe::egui::{Pos2, vec2};
use egui_kittest::Harness;
use weekender::app::{Command, Partner, Window};

/// The colour on the screen.
fn colour_at(harness: &mut Harness<'_, Window>, at: Pos2) -> [u8; 3] {
    let image = harness.render().unwrap();
    let [red, green, blue, _] = image.get_pixel(at.x as u32, at.y as u32).0;
    [red, green, blue]
}

/// Against an earlier stage, and against a picture that was kept.
#[test]
fn the_traced_picture_is_right_of_the_divider() {
    if !has_adapter() {
        return;
    }
    let mut harness =
        Harness::builder().with_size([1000.0, 700.0]).with_step_dt(1.0 / 60.0).wgpu().build_ui_state(
            |ui, window: &mut Window| window.ui_in(ui),
            window("--stage lambertian-gamma --size 64x36 --samples 16 --device cpu"),
        );
    until(&mut harness, "a picture", has_samples(16));
    send(&mut harness, Command::Keep);
    until(&mut harness, "a kept picture", |window| !window.kept().is_empty());
    harness.state_mut().document_mut().camera.vfov_degrees = 40.0;
    harness.run_steps(3);
    until(&mut harness, "the other picture", has_samples(16));
    harness.run_steps(10);
    // Below the titles, beside and on the ball.
    let places = |harness: &Harness<'_, Window>| {
        let rect = harness.state().picture_rect();
        [0.12, 0.88].map(|share| rect.lerp_inside(vec2(share, 0.7)))
    };
    let colours = |harness: &mut Harness<'_, Window>| {
        let places = places(harness);
        places.map(|at| colour_at(harness, at))
    };
    let is_near = |a: [u8; 3], b: [u8; 3]| a.iter().zip(b).all(|(a, b)| a.abs_diff(b) < 12);
    let traced = colours(&mut harness);
    let kept = harness.state().partner().unwrap();
    for partner in [kept, Partner::Usual] {
        let command = Command::CompareWith(partner);
        send(&mut harness, command);
        until(&mut harness, "two pictures", |window| window.has_other_picture());
        let rect = harness.state().picture_rect();
        harness.run_steps(60);
        for share in [0.03, 0.97] {
            let at = harness.state().divider();
            drag_from(&mut harness, rect.lerp_inside(vec2(at, 0.5)), vec2((share - at) * rect.width(), 0.0));
            harness.run_steps(5);
            let found = colours(&mut harness);
            let is_traced = [0, 1].map(|side| is_near(found[side], traced[side]));
            let expected = if share < 0.5 { [true; 2] } else { [false; 2] };
            assert_eq!(is_traced, expected, "{command:?} {share}: {found:?} {traced:?}");
        }
        send(&mut harness, Command::Wipe);
    }
}

/// The sky is the same in both stages, so their difference is nothing there.
#[test]
fn differences_from_another_stage_appear_once_it_is_traced() {
    let mut harness = open("--stage glass-schlick --size 32x18 --samples 16 --device cpu");
    until(&mut harness, "the end", |window| has_samples(16)(window) && window.status().phase.is_over());
    let sky = harness.state().shown_pixel([0, 0]).unwrap();
    send(&mut harness, Command::Difference);
    until(&mut harness, "no sky", |window| window.shown_pixel([0, 0]).is_some_and(|colour| colour != sky));
    send(&mut harness, Command::Difference);
    until(&mut harness, "the sky again", |window| window.shown_pixel([0, 0]) == Some(sky));
}

/// A new scene belongs to no stage.
#[test]
fn a_comparison_with_a_stage_ends_with_the_stages() {
    let mut harness = open("--stage metal --size 32x18 --samples 16 --device cpu");
    send(&mut harness, Command::Wipe);
    assert!(matches!(harness.state().partner(), Some(Partner::Stage(_))));
    send(&mut harness, Command::NextStage);
    assert!(harness.state().model.view.mode().is_some());
    send(&mut harness, Command::NewScene);
    assert_eq!(harness.state().model.view.mode(), None);
}
