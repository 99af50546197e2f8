//! A presentation.

use crate::common::{SMALL, drag, has_samples, middle, open, open_sized, send, until};
use eframe::egui::{self, Key, Modifiers, PointerButton, Rect, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use weekender::app::{Command, Show, SlotCommand, SlotNumber, Window};
use weekender::stages::Stage;

/// Screens that a presentation is made for.
const SCREENS: [[f32; 2]; 4] = [[1024.0, 768.0], [1280.0, 720.0], [1920.0, 1080.0], [2560.0, 1440.0]];

fn has(harness: &Harness<'_, Window>, label: &str) -> bool {
    harness.query_all_by_label(label).next().is_some()
}

fn present(arguments: &str, size: [f32; 2]) -> Harness<'static, Window> {
    let mut harness = open_sized(arguments, size);
    harness.run_steps(2);
    harness.key_press(Key::F5);
    harness.run_steps(4);
    assert!(harness.state().is_presenting());
    harness
}

/// The text that is drawn, with its size in points and its place.
fn drawn(harness: &Harness<'_, Window>) -> Vec<(String, f32, Rect)> {
    fn texts(shape: &egui::Shape, found: &mut Vec<(String, f32, Rect)>) {
        match shape {
            egui::Shape::Text(text) => {
                let size =
                    text.galley.job.sections.first().map_or(0.0, |section| section.format.font_id.size);
                found.push((text.galley.text().to_owned(), size, text.visual_bounding_rect()));
            }
            egui::Shape::Vec(shapes) => shapes.iter().for_each(|shape| texts(shape, found)),
            _ => {}
        }
    }
    let mut found = Vec::new();
    harness.output().shapes.iter().for_each(|clipped| texts(&clipped.shape, &mut found));
    found
}

#[test]
fn f5_begins_and_escape_ends() {
    let mut harness = open(SMALL);
    until(&mut harness, "a picture", has_samples(1));
    assert!(has(&harness, "Choose a stage"));
    for ends in [Key::Escape, Key::F5] {
        harness.key_press(Key::F5);
        harness.run_steps(3);
        assert!(harness.state().is_presenting() && harness.state().is_full_screen());
        assert!(!has(&harness, "Choose a stage") && !has(&harness, "Field of view"), "no menus and panels");
        harness.key_press(ends);
        harness.run_steps(3);
        assert!(!harness.state().is_presenting() && !harness.state().is_full_screen(), "{ends:?}");
        assert!(has(&harness, "Choose a stage"));
    }
    // A window that was in full-screen mode before stays in it.
    send(&mut harness, Command::FullScreen);
    send(&mut harness, Command::Present);
    harness.key_press(Key::Escape);
    harness.run_steps(3);
    assert!(!harness.state().is_presenting() && harness.state().is_full_screen());
}

#[test]
fn one_key_goes_to_the_next_stage() {
    let mut harness = present("--stage metal --size 32x18", [1280.0, 720.0]);
    let id = |harness: &Harness<'_, Window>| harness.state().document().stage().unwrap().id;
    for (key, expected) in [
        (Key::PageDown, "metal-fuzzy"),
        (Key::ArrowRight, "glass-refract"),
        (Key::ArrowDown, "glass-tir"),
        (Key::ArrowLeft, "glass-refract"),
        (Key::ArrowUp, "metal-fuzzy"),
        (Key::PageUp, "metal"),
    ] {
        harness.key_press(key);
        harness.run_steps(3);
        assert_eq!(id(&harness), expected, "{key:?}");
        assert!(has(&harness, harness.state().document().stage().unwrap().title));
    }
    assert!(harness.state().messages().is_empty(), "{:?}", harness.state().messages());
}

/// What the lens tells at this share of the picture: the place, the byte of the red channel, and its linear radiance if
/// that is told. The window has been asked for the pixel by then.
fn told_by_lens(harness: &mut Harness<'_, Window>, share: [f32; 2]) -> (String, u8, Option<String>) {
    let picture = harness.state().picture_rect();
    harness.event(egui::Event::PointerMoved(picture.lerp_inside(vec2(share[0], share[1]))));
    harness.run_steps(3);
    let size = harness.state().document().size();
    let pixel = [0, 1].map(|axis| (share[axis] * size[axis] as f32) as u32);
    until(harness, "its numbers", |window| window.inspected().is_some_and(|(at, _)| at == pixel));
    harness.run_steps(2);
    let texts = drawn(harness);
    let line = |begin: &str| texts.iter().find(|(text, ..)| text.starts_with(begin)).unwrap().0.clone();
    let red = line("R ");
    let mut words = red.split_whitespace().skip(1);
    let byte = words.next().unwrap().parse().unwrap();
    (line("x "), byte, words.next().map(str::to_owned))
}

/// A presentation with a finished picture.
fn finished() -> Harness<'static, Window> {
    let mut harness = present("--stage glass-schlick --size 64x36 --samples 16", [1280.0, 720.0]);
    until(&mut harness, "the end", is_finished);
    harness
}

fn is_finished(window: &Window) -> bool {
    has_samples(16)(window) && window.status().phase.is_over()
}
