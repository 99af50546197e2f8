//! The numbers are those of the pixel under the pointer, whatever is drawn there.

use crate::common::{has_samples, open, send, until, window};
use crate::gpu_common::has_adapter;
use crate::questions::Ask as _;
use eframe::egui::{self, Pos2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use weekender::app::{Command, Window};
use weekender::numbers::heat::HeatScale;

const SIZE: [u32; 2] = [64, 36];

/// A window with a kept picture of another camera.
fn with_kept() -> Harness<'static, Window> {
    let window = window("--stage glass-schlick --size 64x36 --samples 16 --device cpu");
    let builder = Harness::builder().with_size([1000.0, 700.0]).with_step_dt(1.0 / 60.0);
    let builder = if has_adapter() { builder.wgpu() } else { builder };
    let mut harness = builder.build_ui_state(|ui, window: &mut Window| window.ui_in(ui), window);
    until(&mut harness, "a picture", has_samples(16));
    send(&mut harness, Command::Keep);
    until(&mut harness, "a kept picture", |window| !window.kept().is_empty());
    harness.state_mut().document_mut().camera.vfov_degrees = 40.0;
    harness.run_steps(3);
    until(&mut harness, "the other picture", has_samples(16));
    harness
}

/// The colour that is drawn at a point, if that can be seen here.
fn drawn(harness: &mut Harness<'_, Window>, at: Pos2) -> Option<[u8; 3]> {
    let image = has_adapter().then(|| harness.render().unwrap())?;
    let [red, green, blue, _] = image.get_pixel(at.x as u32, at.y as u32).0;
    Some([red, green, blue])
}

/// The middle of a pixel on the screen.
fn place(harness: &Harness<'_, Window>, [x, y]: [u32; 2]) -> Pos2 {
    let rect = harness.state().picture_rect();
    let share = vec2((x as f32 + 0.5) / SIZE[0] as f32, (y as f32 + 0.5) / SIZE[1] as f32);
    rect.min + share * rect.size()
}

#[test]
fn the_numbers_are_those_of_the_pixel_that_is_drawn_under_the_pointer() {
    let mut harness = with_kept();
    for (mode, commands) in [
        ("picture", vec![]),
        ("wipe", vec![Command::Wipe]),
        ("wipe with the kept picture", vec![Command::KeptWipe]),
        ("kept picture", vec![Command::Flip]),
        ("denoised", vec![Command::Denoise]),
        ("presented", vec![Command::Wipe, Command::Present]),
    ] {
        commands.iter().for_each(|command| send(&mut harness, *command));
        harness.run_steps(70);
        until(&mut harness, "the end", |window| window.status().phase.is_over() && has_samples(16)(window));
        if mode.starts_with("wipe") || mode == "presented" {
            until(&mut harness, "the other picture", |window| window.has_other_picture());
            harness.run_steps(20);
        }
        for at in [[10, 20], [54, 20], [20, 30], [40, 12]] {
            // In a presentation, the picture has the screen's size.
            let size = harness.state().shown_document().size();
            let at = [0, 1].map(|axis| at[axis] * size[axis] / SIZE[axis]);
            let rect = harness.state().picture_rect();
            let share = vec2((at[0] as f32 + 0.5) / size[0] as f32, (at[1] as f32 + 0.5) / size[1] as f32);
            let point = rect.min + share * rect.size();
            harness.event(egui::Event::PointerMoved(point));
            let is_left = at[0] < size[0] / 2;
            let is_wipe = mode.starts_with("wipe") || mode == "presented";
            let is_other = mode == "kept picture" || is_wipe && is_left;
            let name = format!("{mode} {at:?}");
            until(&mut harness, &name, |window| {
                let pixel = |at| if is_other { window.other_pixel(at) } else { window.shown_pixel(at) };
                let found = window.readout();
                found.is_some_and(|(pixel_at, bytes, of_other, _)| {
                    (pixel_at, Some(bytes), of_other) == (at, pixel(at), is_other)
                })
            });
            let bytes = harness.state().readout().unwrap().1;
            if mode != "presented"
                // Beside the pointer, which is drawn, too.
                && let Some(colour) = drawn(&mut harness, point - vec2(3.0, 3.0))
            {
                assert_eq!(colour, bytes, "{name}");
            }
        }
        commands.iter().rev().for_each(|command| send(&mut harness, *command));
        assert!(!harness.state().is_comparing(), "{mode}");
    }
}

#[test]
fn the_numbers_of_a_difference_are_those_of_its_colours() {
    let mut harness = with_kept();
    for command in [Command::Difference, Command::KeptDifference] {
        send(&mut harness, command);
        for at in [[10, 20], [54, 20]] {
            let point = place(&harness, at);
            harness.event(egui::Event::PointerMoved(point));
            until(&mut harness, "the change", |window| {
                let Some((found, _, _, Some([theirs, mine]))) = window.readout() else { return false };
                let square: f64 = (0..3).map(|i| (mine[i] - theirs[i]).powi(2)).sum();
                let colour = HeatScale::DIFFERENCE.colour((square / 3.0).sqrt());
                found == at && window.shown_pixel(at) == Some(colour)
            });
        }
        send(&mut harness, command);
    }
}

#[test]
fn the_panel_names_the_sides_of_a_wipe() {
    let mut harness = open("--stage glass-schlick --size 64x36 --samples 4 --device cpu");
    send(&mut harness, Command::Wipe);
    until(&mut harness, "the other picture", |window| window.has_other_picture());
    let point = place(&harness, [10, 20]);
    harness.event(egui::Event::PointerMoved(point));
    until(&mut harness, "both sides", |window| window.readout().is_some_and(|found| found.3.is_some()));
    harness.run_steps(2);
    for name in ["11.2", "11.4", "change", "saved as"] {
        assert!(harness.query_all_by_label(name).next().is_some(), "{name}");
    }
}
