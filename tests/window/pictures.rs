//! The README's pictures of the window. `cargo test --release --test window pictures -- --ignored` takes them anew.

use crate::common::{control, drag_from, has_samples, until, window};
use crate::objects::{click, middle_sphere, on_screen, spheres};
use eframe::egui::{self, Key, Modifiers, vec2};
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
#[ignore = "it writes the pictures of the README"]
fn pictures_of_the_window() {
    take("window-wipe", "--stage glass-schlick", Theme::Dark, SIZE, |harness| {
        press(harness, Key::C);
        until(harness, "the other picture", |window| window.has_other_picture());
    });
    take("window-stages", "--stage metal-fuzzy", Theme::Dark, SIZE, |harness| {
        press(harness, Key::O);
    });
    take("window-present", "--stage shadow-acne", Theme::Light, [1280.0, 720.0], |harness| {
        press(harness, Key::F5);
        press(harness, Key::H);
        until(harness, "the other picture", |window| window.has_other_picture());
        let at = harness.state().picture_rect().lerp_inside(vec2(0.505, 0.86));
        harness.event(egui::Event::PointerMoved(at));
    });
    take("window-spheres", "--stage three-spheres", Theme::Dark, SIZE, |harness| {
        let matte = middle_sphere(harness);
        let at = on_screen(harness, spheres(harness)[matte].center);
        click(harness, at, Modifiers::NONE);
        harness.key_press_modifiers(Modifiers::COMMAND, Key::D);
        harness.run_steps(40);
        let added = harness.state().selected().unwrap();
        let at = on_screen(harness, spheres(harness)[added].center);
        drag_from(harness, at, harness.state().picture_rect().lerp_inside(vec2(0.62, 0.16)) - at);
        harness.run_steps(40);
        control(harness, "Metal").click();
        harness.run_steps(40);
    });
    take("window-path", "--stage hollow-glass", Theme::Light, SIZE, |harness| {
        let at = harness.state().picture_rect().lerp_inside(vec2(338.5 / 480.0, 148.5 / 270.0));
        harness.event(egui::Event::PointerMoved(at));
        harness.run_steps(5);
        press(harness, Key::T);
        until(harness, "the paths", |window| window.listed_paths() == 16);
        harness.run_steps(30);
        press(harness, Key::ArrowRight);
    });
    take("window-code", "--stage glass-schlick", Theme::Light, SIZE, |harness| press(harness, Key::K));
    take("window-lanes", "--stage hollow-glass", Theme::Dark, SIZE, |harness| {
        press(harness, Key::N);
        until(harness, "the lanes", |window| window.lane_steps().is_some());
    });
}
