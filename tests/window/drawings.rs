//! What the window draws in each of its states, beside the kept texts in `tests/golden/drawn`.

use crate::common::{
    SMALL, drag_from, has_samples, hold, middle, open_sized, send, until, until_drawn, until_seen,
};
use crate::drawings_views::know;
use crate::drawn::{change, drawn};
use crate::golden::{check, digest_of};
use eframe::egui::{self, Key, Modifiers, Rect, Role, Shape, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use weekender::app::{Command, Show, SlotCommand, SlotNumber, Theme, Window};

pub const SIZE: [f32; 2] = [1280.0, 800.0];

/// Runs a test of this file in a process that finds no graphics adapter, so that every machine draws the same.
fn alone(test: &str, draw: impl FnOnce()) {
    alone_in("drawings", test, draw);
}

/// The same for a test of another file.
pub fn alone_in(file: &str, test: &str, draw: impl FnOnce()) {
    if std::env::var("WGPU_BACKEND").is_ok_and(|backend| backend == "noop") {
        return draw();
    }
    let mut again = std::process::Command::new(std::env::current_exe().unwrap());
    again.args(["--exact", &format!("{file}::{test}"), "--nocapture"]).env("WGPU_BACKEND", "noop");
    let output = again.output().unwrap();
    let [out, err] = [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes));
    assert!(output.status.success() && out.contains("1 passed"), "{out}{err}");
}

/// A window with a finished picture, which does not depend on the processor.
pub fn finished(arguments: &str, size: [f32; 2]) -> Harness<'static, Window> {
    let arguments = format!("{arguments} --samples 4 --device cpu --isa portable --threads 1");
    let mut harness = open_sized(&arguments, size);
    until(&mut harness, "the end", |window| has_samples(4)(window) && window.status().phase.is_over());
    harness.run_steps(60);
    harness
}

/// The usual window, and what it draws.
pub fn usual() -> (Harness<'static, Window>, Vec<String>) {
    let harness = finished(SMALL, SIZE);
    let before = drawn(&harness);
    (harness, before)
}

/// Compares what has changed since `before`, after all movements have ended, with the kept text.
pub fn keep(name: &str, before: &[String], harness: &mut Harness<'_, Window>) {
    harness.run_steps(60);
    check(&format!("drawn/{name}"), &change(before, &drawn(harness)));
}

/// The same for a state in which so many messages are shown. They stay for four seconds: a machine that stalls draws all
/// of it again.
pub fn keep_told(name: &str, count: usize, make: impl Fn() -> (Harness<'static, Window>, Vec<String>)) {
    let text = (1..=5).find_map(|attempt| {
        let (mut harness, before) = make();
        harness.run_steps(60);
        let is_told = harness.state().messages().len() >= count;
        (is_told || attempt == 5).then(|| change(&before, &drawn(&harness)))
    });
    check(&format!("drawn/{name}"), &text.unwrap());
}

/// A window with a picture whose pixels are so large that their numbers are in them.
pub fn with_numbers() -> Harness<'static, Window> {
    let mut harness = finished("--stage glass-schlick --size 8x5", SIZE);
    until_numbers(&mut harness, 8 * 5);
    harness
}

/// Waits for the numbers of so many pixels, and of no others.
pub fn until_numbers(harness: &mut Harness<'_, Window>, pixels: usize) {
    let is_number = |shape: &Shape, room: Rect| match shape {
        Shape::Text(text) => room.contains(text.pos) && text.galley.text().parse::<f64>().is_ok(),
        _ => false,
    };
    until_drawn(harness, &format!("the numbers of {pixels} pixels"), |harness| {
        let room = harness.get_by_label("Picture").rect();
        let shapes = harness.output().shapes.iter();
        shapes.filter(|clipped| is_number(&clipped.shape, room)).count() == 3 * pixels
    });
}

/// Moves the pointer away.
pub fn leave(harness: &mut Harness<'_, Window>) {
    harness.event(egui::Event::PointerGone);
    harness.step();
}

#[test]
fn the_window() {
    alone("the_window", || {
        for (name, theme) in [("dark", Theme::Dark), ("light", Theme::Light)] {
            let (mut harness, _) = usual();
            send(&mut harness, Command::Theme(theme));
            keep(name, &[], &mut harness);
        }
    });
}

#[test]
fn a_narrow_window() {
    alone("a_narrow_window", || {
        keep("narrow", &[], &mut finished(SMALL, [640.0, 400.0]));
    });
}

#[test]
fn the_palette() {
    alone("the_palette", || {
        let (mut harness, before) = usual();
        harness.key_press_modifiers(Modifiers::COMMAND, Key::P);
        harness.run_steps(3);
        harness.get_by_label("Command").type_text("th");
        harness.run_steps(2);
        harness.key_press(Key::ArrowDown);
        keep("palette", &before, &mut harness);
    });
}

#[test]
fn dialogs() {
    alone("dialogs", || {
        for (name, command) in [
            ("help", Command::Help),
            ("first_steps", Command::FirstSteps),
            ("stages", Command::Stages),
            ("code", Command::Code),
        ] {
            let (mut harness, before) = usual();
            send(&mut harness, command);
            keep(name, &before, &mut harness);
        }
        keep_told("show_me", 1, || {
            let (mut harness, before) = usual();
            send(&mut harness, Command::ShowMe);
            until(&mut harness, "both pictures", |window| window.has_other_picture());
            (harness, before)
        });
    });
}

#[test]
fn a_presentation() {
    alone("a_presentation", || {
        let (mut harness, before) = usual();
        send(&mut harness, Command::Present);
        keep("presentation", &before, &mut harness);
    });
}

#[test]
fn views() {
    alone("views", || {
        let (mut harness, before) = usual();
        for (name, show) in [
            ("normals", Show::Normals),
            ("bounces", Show::Bounces),
            ("error", Show::Error),
            ("luminance", Show::Luminance),
        ] {
            send(&mut harness, Command::Show(show));
            let is_layer = matches!(show, Show::Normals | Show::Bounces);
            until(&mut harness, name, |window| !is_layer || window.layer_samples() == 16);
            keep(name, &before, &mut harness);
        }
    });
}

#[test]
fn a_darker_picture() {
    alone("a_darker_picture", || {
        let (mut harness, before) = usual();
        for _ in 0..3 {
            send(&mut harness, Command::Darker);
        }
        keep("darker", &before, &mut harness);
    });
}

#[test]
fn values_of_pixels() {
    alone("values_of_pixels", || {
        let mut harness = with_numbers();
        let before = drawn(&harness);
        let at = middle(&harness);
        harness.hover_at(at);
        until(&mut harness, "the pixel's value", |window| window.inspected().is_some());
        keep("pixels", &before, &mut harness);
    });
}

#[test]
fn paths_of_a_pixel() {
    alone("paths_of_a_pixel", || {
        let (mut harness, before) = usual();
        let at = middle(&harness);
        harness.event(egui::Event::PointerMoved(at));
        harness.run_steps(2);
        send(&mut harness, Command::ListPaths);
        until(&mut harness, "four paths", |window| window.listed_paths() == 4);
        until(&mut harness, "the pixel's value", |window| window.inspected().is_some());
        leave(&mut harness);
        keep("paths", &before, &mut harness);
        send(&mut harness, Command::NextRay);
        keep("ray", &before, &mut harness);
    });
}

#[test]
fn two_stages_and_a_divider() {
    alone("two_stages_and_a_divider", || {
        let (mut harness, before) = usual();
        send(&mut harness, Command::Wipe);
        until(&mut harness, "both pictures", |window| window.has_other_picture());
        // The noise decides where it is placed.
        until(&mut harness, "the divider in its place", |window| window.divider() != 0.5);
        harness.run_steps(30);
        let rect = harness.state().picture_rect();
        let [from, to] = [harness.state().divider(), 0.5].map(|share| rect.lerp_inside(vec2(share, 0.5)));
        drag_from(&mut harness, from, to - from);
        until(&mut harness, "the pixel's value", |window| {
            window.inspected().is_some_and(|(at, _)| at == [16, 9])
        });
        leave(&mut harness);
        keep("wipe", &before, &mut harness);
        send(&mut harness, Command::WipeDifference);
        until_seen(&mut harness, "A − B");
        keep("difference", &before, &mut harness);
    });
}

#[test]
fn kept_pictures() {
    alone("kept_pictures", || {
        let shown = || {
            let (mut harness, before) = usual();
            for number in [SlotNumber::ALL[0], SlotNumber::ALL[1]] {
                send(&mut harness, Command::Slot(SlotCommand::Keep));
                until(&mut harness, "a kept picture", |window| window.slot(number).is_some());
            }
            send(&mut harness, Command::Slot(SlotCommand::Look(SlotNumber::ALL[1])));
            until(&mut harness, "its picture", |window| window.shown_pixel([0, 0]).is_some());
            (harness, before)
        };
        let compared = || {
            let (mut harness, before) = shown();
            send(&mut harness, Command::Slot(SlotCommand::LookLive));
            send(&mut harness, Command::Slot(SlotCommand::Wipe));
            until(&mut harness, "both pictures", |window| window.has_other_picture());
            (harness, before)
        };
        let judged = || {
            let (mut harness, before) = compared();
            send(&mut harness, Command::Slot(SlotCommand::OnlyNoise));
            until(&mut harness, "a verdict", |window| window.only_noise().is_some());
            (harness, before)
        };
        keep_told("slots", 2, shown);
        keep_told("slot_wipe", 2, compared);
        keep_told("verdict", 2, judged);
    });
}

#[test]
fn a_selected_sphere() {
    alone("a_selected_sphere", || {
        let (mut harness, before) = usual();
        for (name, times) in [("sphere", 2), ("next_sphere", 1)] {
            for _ in 0..times {
                send(&mut harness, Command::NextSphere);
            }
            keep(name, &before, &mut harness);
        }
    });
}

#[test]
fn a_marked_part() {
    alone("a_marked_part", || {
        let (mut harness, before) = usual();
        send(&mut harness, Command::Crop);
        let from = harness.state().picture_rect().lerp_inside(vec2(0.2, 0.3));
        drag_from(&mut harness, from, vec2(200.0, 100.0));
        know(&mut harness, from + vec2(200.0, 100.0));
        leave(&mut harness);
        keep("crop", &before, &mut harness);
    });
}

#[test]
fn bookmarks_and_the_pictures_size() {
    alone("bookmarks_and_the_pictures_size", || {
        keep_told("bookmarks", 1, || {
            let (mut harness, before) = usual();
            send(&mut harness, Command::AddBookmark);
            send(&mut harness, Command::AddBookmark);
            send(&mut harness, Command::ActualSize);
            (harness, before)
        });
    });
}

#[test]
fn a_menu_of_the_picture() {
    alone("a_menu_of_the_picture", || {
        let (mut harness, before) = usual();
        let pos = middle(&harness);
        harness.event(egui::Event::PointerMoved(pos));
        for pressed in [true, false] {
            let (button, modifiers) = (egui::PointerButton::Secondary, Modifiers::NONE);
            harness.event(egui::Event::PointerButton { pos, button, pressed, modifiers });
            harness.step();
        }
        until(&mut harness, "the pixel's value", |window| window.inspected().is_some());
        keep("picture_menu", &before, &mut harness);
    });
}

/// The place of a menu's name in the bar.
fn menu(harness: &Harness<'_, Window>, name: &str) -> egui::Pos2 {
    let named = harness.get_all_by_label(name).map(|node| node.rect());
    named.min_by(|a, b| a.top().total_cmp(&b.top())).unwrap().center()
}

#[test]
fn menus() {
    alone("menus", || {
        let (mut harness, before) = usual();
        for name in ["File", "Edit", "Camera", "Spheres", "View", "Slots", "Render", "Stage", "Help"] {
            let at = menu(&harness, name);
            hold(&mut harness, at, true);
            hold(&mut harness, at, false);
            keep(&format!("menu_{}", name.to_lowercase()), &before, &mut harness);
            harness.key_press(Key::Escape);
            harness.run_steps(5);
        }
    });
}

/// The pointer rests on each control in turn.
#[test]
fn tips() {
    alone("tips", || {
        let (mut harness, before) = usual();
        let is_control =
            |role| matches!(role, Role::Button | Role::SpinButton | Role::CheckBox | Role::ComboBox);
        let nodes = harness.root().children_recursive();
        let mut controls: Vec<(String, Rect)> = nodes
            .filter(|node| is_control(node.accesskit_node().role()))
            .filter_map(|node| Some((node.accesskit_node().label()?, node.rect())))
            .collect();
        controls.sort_by(|(_, a), (_, b)| (a.left(), a.top()).partial_cmp(&(b.left(), b.top())).unwrap());
        let mut text = String::new();
        for (name, rect) in controls {
            harness.hover_at(rect.center());
            harness.run_steps(40);
            text.push_str(&format!("{name}\n{}", change(&before, &drawn(&harness))));
        }
        check("drawn/tips", &text);
    });
}

/// There are too many shapes to list.
#[test]
fn steps_of_a_packet() {
    alone("steps_of_a_packet", || {
        let (mut harness, before) = usual();
        send(&mut harness, Command::Packet);
        until(&mut harness, "its steps", |window| window.packet_steps().is_some());
        harness.run_steps(60);
        let change = change(&before, &drawn(&harness));
        let text = format!("{} shapes, digest {}\n", change.lines().count(), digest_of(change.as_bytes()));
        check("drawn/packet", &text);
    });
}

#[test]
fn stages_that_show_other_panels() {
    alone("stages_that_show_other_panels", || {
        let (_, usual) = usual();
        for id in ["ppm-tiny", "metal-fuzzy", "defocus", "book"] {
            let mut harness = finished(&format!("--stage {id} --size 32x18"), SIZE);
            keep(&format!("stage_{}", id.replace('-', "_")), &usual, &mut harness);
        }
    });
}
