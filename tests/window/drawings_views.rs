//! What the window draws at other sizes, zooms and scales, with the keyboard, while something is dragged or refused,
//! beside the kept texts in `tests/golden/drawn`.

use crate::common::{SMALL, control, hold, middle, send, until};
use crate::drawings::{SIZE, alone_in, finished, keep, keep_told, leave, until_numbers, usual, with_numbers};
use crate::drawn::drawn;
use eframe::egui::{self, Key, Modifiers, PointerButton, Pos2, Vec2, vec2};
use egui_kittest::Harness;
use weekender::app::{Command, Show, Theme, Window};
use weekender::output::OutputFormat;
use weekender::stages::Stage;

fn alone(test: &str, draw: impl FnOnce()) {
    alone_in("drawings_views", test, draw);
}

/// Turns the wheel over a point, as far as a list goes.
fn scroll(harness: &mut Harness<'_, Window>, at: Pos2, points: f32) {
    harness.event(egui::Event::PointerMoved(at));
    harness.event(egui::Event::MouseWheel {
        unit: egui::MouseWheelUnit::Point,
        delta: vec2(0.0, points),
        phase: egui::TouchPhase::Move,
        source: egui::MouseWheelSource::Wheel,
        modifiers: Modifiers::NONE,
    });
    harness.run_steps(60);
}

/// Presses the button and drags, without releasing it.
fn grab(harness: &mut Harness<'_, Window>, from: Pos2, by: Vec2) {
    hold(harness, from, true);
    for step in 1..=10 {
        harness.event(egui::Event::PointerMoved(from + by * (step as f32 / 10.0)));
        harness.step();
    }
}

/// Waits for the value of the pixel at a point.
pub fn know(harness: &mut Harness<'_, Window>, at: Pos2) {
    let (rect, settings) = (harness.state().picture_rect(), harness.state().document().settings);
    let share = (at - rect.min) / rect.size();
    let pixel = [(share.x, settings.width), (share.y, settings.height)]
        .map(|(share, length)| ((share * length as f32) as u32).min(length - 1));
    until(harness, "the pixel's value", |window| window.inspected().is_some_and(|(at, _)| at == pixel));
}

#[test]
fn windows_of_other_sizes() {
    alone("windows_of_other_sizes", || {
        for [width, height] in [[480, 320], [899, 600], [900, 600], [1920, 1080]] {
            let mut harness = finished(SMALL, [width as f32, height as f32]);
            keep(&format!("window_{width}x{height}"), &[], &mut harness);
        }
    });
}

#[test]
fn a_screen_of_higher_resolution() {
    alone("a_screen_of_higher_resolution", || {
        let (mut harness, _) = usual();
        harness.set_pixels_per_point(1.5);
        keep("high_resolution", &[], &mut harness);
    });
}

#[test]
fn a_narrow_window_with_the_stage_below_the_controls() {
    alone("a_narrow_window_with_the_stage_below_the_controls", || {
        let mut harness = finished(SMALL, [700.0, 500.0]);
        let before = drawn(&harness);
        control(&harness, "Stage and pixel: below").click();
        harness.run_steps(5);
        leave(&mut harness);
        keep("narrow_below", &before, &mut harness);
    });
}

#[test]
fn panels_that_are_scrolled_or_hidden() {
    alone("panels_that_are_scrolled_or_hidden", || {
        let (mut harness, before) = usual();
        scroll(&mut harness, egui::pos2(100.0, 400.0), -2000.0);
        leave(&mut harness);
        keep("scrolled", &before, &mut harness);
        for (name, command) in
            [("no_controls", Command::Controls), ("no_info", Command::Info), ("no_axes", Command::Gizmo)]
        {
            let (mut harness, before) = usual();
            send(&mut harness, command);
            keep(name, &before, &mut harness);
        }
        keep_told("no_panels", 1, || {
            let (mut harness, before) = usual();
            send(&mut harness, Command::Panels);
            (harness, before)
        });
    });
}

#[test]
fn zooms() {
    alone("zooms", || {
        let mut harness = with_numbers();
        let before = drawn(&harness);
        let at = middle(&harness);
        harness.hover_at(at);
        until(&mut harness, "the pixel's value", |window| window.inspected().is_some());
        leave(&mut harness);
        for (name, command, times) in [
            ("actual", Command::ActualSize, 1),
            ("zoomed_in", Command::ZoomIn, 18),
            ("zoomed_out", Command::ZoomOut, 9),
        ] {
            for _ in 0..times {
                send(&mut harness, command);
            }
            if command == Command::ZoomIn {
                until_numbers(&mut harness, 8 * 5);
            }
            keep(name, &before, &mut harness);
        }
        send(&mut harness, Command::Fit);
        until_numbers(&mut harness, 8 * 5);
        harness.event(egui::Event::PointerMoved(at));
        harness.event(egui::Event::Zoom(6.0));
        leave(&mut harness);
        // Those of the columns at both sides are not visible any more.
        until_numbers(&mut harness, 6 * 5);
        keep("zoomed_at", &before, &mut harness);
    });
}

#[test]
fn a_part_while_it_is_marked() {
    alone("a_part_while_it_is_marked", || {
        let (mut harness, before) = usual();
        send(&mut harness, Command::Crop);
        leave(&mut harness);
        keep("crop_none", &before, &mut harness);
        let from = harness.state().picture_rect().lerp_inside(vec2(0.1, 0.05));
        grab(&mut harness, from, vec2(220.0, 150.0));
        know(&mut harness, from + vec2(220.0, 150.0));
        keep("crop_held", &before, &mut harness);
        hold(&mut harness, from + vec2(220.0, 150.0), false);
        let inside = from + vec2(100.0, 80.0);
        harness.event(egui::Event::PointerMoved(inside));
        for pressed in [true, false] {
            let (button, modifiers) = (PointerButton::Secondary, Modifiers::NONE);
            harness.event(egui::Event::PointerButton { pos: inside, button, pressed, modifiers });
            harness.step();
        }
        know(&mut harness, inside);
        leave(&mut harness);
        keep("crop_menu", &before, &mut harness);
    });
}

#[test]
fn a_divider_at_both_ends() {
    alone("a_divider_at_both_ends", || {
        let (mut harness, before) = usual();
        send(&mut harness, Command::Wipe);
        until(&mut harness, "both pictures", |window| window.has_other_picture());
        until(&mut harness, "the divider in its place", |window| window.divider() != 0.5);
        harness.run_steps(30);
        for (name, share) in [("divider_left", 0.0), ("divider_right", 1.0)] {
            let rect = harness.state().picture_rect();
            let [from, to] =
                [harness.state().divider(), share].map(|share| rect.lerp_inside(vec2(share, 0.3)));
            grab(&mut harness, from, to - from);
            hold(&mut harness, to, false);
            know(&mut harness, to);
            leave(&mut harness);
            keep(name, &before, &mut harness);
        }
    });
}

#[test]
fn what_is_refused_and_what_is_told() {
    alone("what_is_refused_and_what_is_told", || {
        keep_told("refused", 1, || {
            let (mut harness, before) = usual();
            harness.key_press(Key::ArrowRight);
            harness.run_steps(3);
            send(&mut harness, Command::ActualSize);
            send(&mut harness, Command::Fit);
            (harness, before)
        });
        let (mut harness, before) = usual();
        let camera = &mut harness.state_mut().document_mut().camera;
        camera.look_at = camera.look_from;
        keep("invalid", &before, &mut harness);
    });
}

#[test]
fn names_of_files() {
    alone("names_of_files", || {
        for (name, command) in [
            ("save_png", Command::Save(OutputFormat::Png)),
            ("save_scene", Command::SaveScene),
            ("open", Command::Open),
        ] {
            let (mut harness, before) = usual();
            harness.state_mut().remembered_mut().directory = Some("/not there".into());
            send(&mut harness, command);
            keep(name, &before, &mut harness);
        }
    });
}

#[test]
fn files_over_the_window() {
    alone("files_over_the_window", || {
        let (mut harness, before) = usual();
        let file = egui::HoveredFile { path: Some("/of/a.png".into()), ..egui::HoveredFile::default() };
        harness.input_mut().hovered_files = vec![file];
        keep("dropping", &before, &mut harness);
    });
}

#[test]
fn the_keyboard_in_the_panels() {
    alone("the_keyboard_in_the_panels", || {
        let (mut harness, before) = usual();
        for name in ["focus_menu", "focus_controls", "focus_info", "focus_picture"] {
            harness.key_press(Key::F6);
            keep(name, &before, &mut harness);
        }
        for _ in 0..2 {
            harness.key_press(Key::F6);
            harness.run_steps(3);
        }
        for _ in 0..2 {
            harness.key_press(Key::Tab);
            harness.run_steps(3);
        }
        keep("focus_third", &before, &mut harness);
        let (mut harness, _) = usual();
        send(&mut harness, Command::Code);
        harness.run_steps(30);
        let before = drawn(&harness);
        for _ in 0..4 {
            harness.key_press(Key::F6);
            harness.run_steps(3);
        }
        keep("focus_code", &before, &mut harness);
    });
}

#[test]
fn pressed_controls() {
    alone("pressed_controls", || {
        for (name, label) in [
            ("pressed_button", "Add a sphere"),
            ("pressed_stage", "Choose a stage"),
            ("pressed_number", "Look from x"),
            ("pressed_choice", "Threads"),
        ] {
            let (mut harness, before) = usual();
            let at = control(&harness, label).rect().center();
            hold(&mut harness, at, true);
            keep(name, &before, &mut harness);
        }
    });
}

#[test]
fn a_light_window_with_more_in_it() {
    alone("a_light_window_with_more_in_it", || {
        let (mut harness, _) = usual();
        send(&mut harness, Command::Theme(Theme::Light));
        send(&mut harness, Command::NextSphere);
        send(&mut harness, Command::Show(Show::Error));
        until(&mut harness, "the view", |window| window.is_up_to_date());
        keep("light_error", &[], &mut harness);
        send(&mut harness, Command::Show(Show::Picture));
        let light = drawn(&harness);
        harness.key_press(Key::F1);
        keep("light_help", &light, &mut harness);
    });
}

#[test]
fn other_views() {
    alone("other_views", || {
        let (mut harness, before) = usual();
        for (name, show) in [("albedo", Show::Albedo), ("occupancy", Show::Occupancy)] {
            send(&mut harness, Command::Show(show));
            until(&mut harness, name, |window| {
                window.is_up_to_date() && (show != Show::Albedo || window.layer_samples() == 16)
            });
            keep(name, &before, &mut harness);
        }
    });
}

#[test]
fn sights() {
    alone("sights", || {
        // The estimate of the first one is doubtful, which is told, too.
        for (id, count) in [("gamut", 2), ("shadow-acne", 1), ("defocus", 1)] {
            keep_told(&format!("sight_{}", id.replace('-', "_")), count, || {
                let mut harness = finished(&format!("--stage {id} --size 32x18"), SIZE);
                let before = drawn(&harness);
                send(&mut harness, Command::ShowMe);
                let means = Stage::find(id).unwrap().sight.means;
                let is_wipe = matches!(means, weekender::stages::Means::Wipe(_));
                until(&mut harness, "the sight", |window| !is_wipe || window.has_other_picture());
                (harness, before)
            });
        }
    });
}
