//! The pictures of the window in the docs. `cargo test --release --test window pictures -- --ignored` takes them anew.

use crate::harness::{has_samples, until, window};
use crate::questions::Ask as _;
use eframe::egui::{self, Key, vec2};
use egui_kittest::Harness;
use std::path::Path;
use weekender::app::{Command, Theme, Window};

/// Points around the window that the harness leaves empty.
const EDGE: f32 = 8.0;

/// Opens a window, lets `act` use it, waits until its render has ended, and writes its picture.
fn take(
    name: &str,
    arguments: &str,
    theme: Theme,
    size: [f32; 2],
    act: impl FnOnce(&mut Harness<'static, Window>),
) {
    let mut shown = window(&format!("{arguments} --noise-target 0.004"));
    shown.send(Command::Theme(theme));
    let mut harness = Harness::builder()
        .with_size(size.map(|side| side + 2.0 * EDGE))
        .with_step_dt(1.0 / 60.0)
        .wgpu()
        .build_ui_state(|ui, window: &mut Window| window.ui_in(ui), shown);
    until(&mut harness, "a picture", has_samples(1));
    act(&mut harness);
    until(&mut harness, "the end", |window| window.status().phase.is_over() && window.is_up_to_date());
    harness.run_steps(30);
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/images").join(format!("{name}.png"));
    let [edge, width, height] = [EDGE, size[0], size[1]].map(|points| points as u32);
    let picture = image::DynamicImage::from(harness.render().unwrap()).crop_imm(edge, edge, width, height);
    picture.into_rgb8().save(path).unwrap();
}

fn press(harness: &mut Harness<'_, Window>, key: Key) {
    harness.key_press(key);
    harness.run_steps(5);
}

const SIZE: [f32; 2] = [1280.0, 800.0];

#[test]
#[ignore = "it writes the pictures of the docs"]
fn pictures_of_the_window() {
    take("window", "--stage glass-schlick", Theme::Dark, SIZE, |harness| {
        press(harness, Key::C);
        until(harness, "the other picture", |window| window.has_other_picture());
    });
    take("window-present", "--stage shadow-acne", Theme::Light, [1280.0, 720.0], |harness| {
        press(harness, Key::F5);
        press(harness, Key::H);
        until(harness, "the other picture", |window| window.has_other_picture());
        let at = harness.state().picture_rect().lerp_inside(vec2(0.505, 0.86));
        harness.event(egui::Event::PointerMoved(at));
    });
}
