//! The divider of a wipe, and when a comparison ends. `readout` checks what is drawn on its sides.

use crate::harness::{drag_from, has_samples, open, send, until};
use crate::questions::Ask as _;
use eframe::egui::vec2;
use weekender::app::{Command, Partner, Window};
use weekender::progressive::Phase;

#[test]
fn the_divider_is_dragged() {
    let mut harness = open("--stage lambertian-gamma --size 64x36 --samples 16 --device cpu");
    until(&mut harness, "a picture", has_samples(16));
    send(&mut harness, Command::Wipe);
    until(&mut harness, "two pictures", |window| window.has_other_picture());
    harness.run_steps(60);
    let rect = harness.state().picture_rect();
    for share in [0.1, 0.9] {
        let at = harness.state().divider();
        drag_from(&mut harness, rect.lerp_inside(vec2(at, 0.5)), vec2((share - at) * rect.width(), 0.0));
        harness.run_steps(5);
        assert!((harness.state().divider() - share).abs() < 0.01, "{share}: {}", harness.state().divider());
    }
}

/// The partner keeps its samples, also in a pause, and while it is not shown.
#[test]
fn a_comparison_that_comes_back_is_not_traced_anew() {
    let mut harness = open("--stage lambertian-gamma --size 64x36 --samples 4000000000 --device cpu");
    send(&mut harness, Command::Wipe);
    until(&mut harness, "samples", |window| {
        window.other_status().is_some_and(|other| other.samples_per_pixel >= 64)
    });
    send(&mut harness, Command::Pause);
    until(&mut harness, "the pause", |window| {
        window.other_status().is_some_and(|other| other.phase == Phase::Paused)
    });
    let before = harness.state().other_status().unwrap();
    for command in [Command::Flip, Command::Flip, Command::Difference] {
        send(&mut harness, command);
    }
    let after = harness.state().other_status().unwrap();
    assert_eq!((after.run, after.samples_per_pixel), (before.run, before.samples_per_pixel));
    send(&mut harness, Command::Difference);
    send(&mut harness, Command::Pause);
    harness.run_steps(30);
    send(&mut harness, Command::Wipe);
    until(&mut harness, "more", |window| {
        let other = window.other_status();
        other.is_some_and(|other| {
            other.run == before.run && other.samples_per_pixel > before.samples_per_pixel
        })
    });
}

/// The light that is subtracted is that of the same camera.
#[test]
fn a_difference_waits_for_both_pictures_after_a_move() {
    let mut harness = open("--stage lambertian-gamma --size 64x36 --samples 64 --device cpu");
    send(&mut harness, Command::Difference);
    let means = |window: &Window| window.tracing.second.means(&window.model, [64, 36]).is_some();
    until(&mut harness, "the difference", means);
    harness.state_mut().document_mut().camera.vfov_degrees += 9.0;
    harness.step();
    assert!(!means(harness.state()));
    until(&mut harness, "the new one", means);
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
