//! The divider of a wipe, and when a comparison ends. `readout` checks what is drawn on its sides.

use crate::harness::{drag_from, has_samples, open, send, until};
use crate::questions::Ask as _;
use eframe::egui::vec2;
use weekender::app::{Command, Partner};

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
