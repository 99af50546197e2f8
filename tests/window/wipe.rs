//! Two pictures on the two sides of a divider.

use crate::common::{drag_from, has_samples, open, send, until, window};
use eframe::egui::{Pos2, Vec2, vec2};
use egui_kittest::Harness;
use std::time::{Duration, Instant};
use weekender::app::{Command, Window};
use weekender::progressive::Stop;
use weekender::stages::Stage;

/// The colour on the screen.
fn colour_at(harness: &mut Harness<'_, Window>, at: Pos2) -> [u8; 3] {
    let image = harness.render().unwrap();
    let [red, green, blue, _] = image.get_pixel(at.x as u32, at.y as u32).0;
    [red, green, blue]
}

/// Shows a small picture of a stage with a camera that is not its own.
fn show(harness: &mut Harness<'_, Window>, stage: &'static Stage) {
    send(harness, Command::Stage(stage));
    let document = harness.state_mut().document_mut();
    document.give_size([64, 36]);
    document.camera.vfov_degrees = 60.0;
    document.stop = Stop::at_samples(16);
    harness.step();
}

fn is_near(a: [u8; 3], b: [u8; 3]) -> bool {
    a.iter().zip(b).all(|(a, b)| a.abs_diff(b) < 12)
}

#[test]
fn the_earlier_stage_is_left_of_the_divider() {
    let mut harness =
        Harness::builder().with_size([1000.0, 700.0]).with_step_dt(1.0 / 60.0).wgpu().build_ui_state(
            |ui, window: &mut Window| window.ui_in(ui),
            window("--stage lambertian-gamma --size 64x36 --samples 16"),
        );
    let mine_stage = Stage::find("lambertian-gamma").unwrap();
    show(&mut harness, mine_stage);
    until(&mut harness, "a picture", has_samples(16));
    harness.run_steps(10);
    let rect = harness.state().picture_rect();
    // Below the titles; the second point is on the ball, which is larger with this camera.
    let places = [0.1, 0.35, 0.9].map(|share| rect.lerp_inside(vec2(share, 0.35)));
    let mine = places.map(|at| colour_at(&mut harness, at));
    let other = Stage::find("lambertian-linear").unwrap();
    show(&mut harness, other);
    until(&mut harness, "the other picture", has_samples(16));
    harness.run_steps(10);
    let theirs = places.map(|at| colour_at(&mut harness, at));
    assert!((0..3).all(|i| !is_near(mine[i], theirs[i])), "{mine:?} {theirs:?}");

    show(&mut harness, mine_stage);
    until(&mut harness, "a picture", has_samples(16));
    send(&mut harness, Command::Wipe);
    until(&mut harness, "two pictures", |window| window.has_other_picture());
    let is_theirs = |found: [[u8; 3]; 3]| {
        [0, 1, 2].map(|i| {
            assert!(is_near(found[i], mine[i]) != is_near(found[i], theirs[i]), "{found:?}");
            is_near(found[i], theirs[i])
        })
    };
    // The other stage is the earlier one: it ends at the divider.
    for (share, expected) in [(0.25, [true, false, false]), (0.6, [true, true, false])] {
        let begin = Instant::now();
        while begin.elapsed() < Duration::from_secs(2) {
            std::thread::sleep(Duration::from_millis(20));
            harness.run_steps(2);
        }
        let at = harness.state().divider();
        let knob = rect.lerp_inside(vec2(at, 0.5));
        drag_from(&mut harness, knob, Vec2::new((share - at) * rect.width(), 0.0));
        harness.run_steps(5);
        let found = places.map(|at| colour_at(&mut harness, at));
        assert_eq!(is_theirs(found), expected, "{found:?}");
    }
}

/// The sky is the same in both stages, so their difference is nothing there.
#[test]
fn the_difference_from_another_stage_is_shown_when_that_is_traced() {
    let mut harness = open("--stage glass-schlick --size 32x18 --samples 16 --device cpu");
    until(&mut harness, "the end", |window| has_samples(16)(window) && window.status().phase.is_over());
    let sky = harness.state().shown_pixel([0, 0]).unwrap();
    send(&mut harness, Command::WipeDifference);
    until(&mut harness, "no sky", |window| window.shown_pixel([0, 0]).is_some_and(|colour| colour != sky));
    send(&mut harness, Command::WipeDifference);
    until(&mut harness, "the sky again", |window| window.shown_pixel([0, 0]) == Some(sky));
}
