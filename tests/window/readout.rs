//! The numbers are those of the pixel under the pointer, whatever is drawn there.

use crate::common::gpu::has_adapter;
use crate::harness::{has_samples, name_file, send, until, window};
use crate::questions::Ask as _;
use eframe::egui::{self, Pos2, vec2};
use egui_kittest::Harness;
use std::path::{Path, PathBuf};
use weekender::app::{Command, Partner, Window};
use weekender::numbers::heat::HeatScale;
use weekender::stages::Stage;

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

/// Points at this place, given in pixels of a picture of the size [`SIZE`], and waits until the numbers are those of the
/// pixel that is drawn there, which is one of the other picture or of this one.
fn read(harness: &mut Harness<'_, Window>, name: &str, at: [u32; 2], is_other: bool) {
    // In a presentation, the picture has the screen's size.
    let size = harness.state().shown_document().size();
    let at = [0, 1].map(|axis| at[axis] * size[axis] / SIZE[axis]);
    let rect = harness.state().picture_rect();
    let share = vec2((at[0] as f32 + 0.5) / size[0] as f32, (at[1] as f32 + 0.5) / size[1] as f32);
    let point = rect.min + share * rect.size();
    harness.event(egui::Event::PointerMoved(point));
    let name = format!("{name} {at:?}");
    until(harness, &name, |window| {
        let pixel = |at| if is_other { window.other_pixel(at) } else { window.shown_pixel(at) };
        let found = window.readout();
        found.is_some_and(|(pixel_at, bytes, of_other, _)| {
            (pixel_at, Some(bytes), of_other) == (at, pixel(at), is_other)
        })
    });
    let bytes = harness.state().readout().unwrap().1;
    if size == SIZE
        // Beside the pointer, which is drawn, too.
        && let Some(colour) = drawn(harness, point - vec2(3.0, 3.0))
    {
        assert_eq!(colour, bytes, "{name}");
    }
}

const PLACES: [[u32; 2]; 4] = [[10, 20], [54, 20], [20, 30], [40, 12]];

fn is_left(at: [u32; 2]) -> bool {
    at[0] < SIZE[0] / 2
}

fn settle(harness: &mut Harness<'_, Window>) {
    harness.run_steps(30);
    until(harness, "the end", |window| window.status().phase.is_over() && has_samples(16)(window));
    let is_over = |window: &Window| window.other_status().is_none_or(|status| status.phase.is_over());
    until(harness, "the other end", |window| {
        !window.is_comparing() || window.has_other_picture() && is_over(window)
    });
    harness.run_steps(30);
}

#[test]
fn numbers_match_the_pixel_under_the_pointer() {
    let mut harness = with_kept();
    for (mode, commands) in [
        ("picture", vec![]),
        ("denoised", vec![Command::Denoise]),
        ("presented", vec![Command::Wipe, Command::Present]),
    ] {
        commands.iter().for_each(|command| send(&mut harness, *command));
        settle(&mut harness);
        for at in PLACES {
            read(&mut harness, mode, at, mode == "presented" && is_left(at));
        }
        commands.iter().rev().for_each(|command| send(&mut harness, *command));
        assert!(!harness.state().is_comparing(), "{mode}");
    }
}

/// The picture of a program that has nothing to do with this one.
fn other_file(folder: &Path) -> PathBuf {
    let pixels = (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).flat_map(move |x| [4 * x as u8, 7 * y as u8, 90]));
    let head = format!("P6\n{} {}\n255\n", SIZE[0], SIZE[1]);
    let path = folder.join("other.ppm");
    std::fs::write(&path, head.bytes().chain(pixels).collect::<Vec<_>>()).unwrap();
    path
}

#[test]
fn every_partner_is_wiped_flipped_and_subtracted_and_read() {
    let mut harness = with_kept();
    let folder = tempfile::tempdir().unwrap();
    name_file(&mut harness, Command::CompareFile, &other_file(folder.path()));
    until(&mut harness, "the file", |window| window.is_comparing());
    settle(&mut harness);
    assert_eq!(harness.state().other_pixel([10, 20]), Some([40, 140, 90]), "the bytes of the file");
    send(&mut harness, Command::Wipe);
    let stage = Stage::find("metal").unwrap();
    let partners = harness.state().partners().into_iter().chain([Partner::Stage(stage)]);
    let mut kinds = 0;
    for partner in partners.collect::<Vec<_>>() {
        let name = format!("{partner:?}");
        if harness.state().disabled_reason(Command::CompareWith(partner)).is_some() {
            continue;
        }
        kinds += 1;
        send(&mut harness, Command::CompareWith(partner));
        settle(&mut harness);
        PLACES.iter().for_each(|at| read(&mut harness, &name, *at, is_left(*at)));
        send(&mut harness, Command::Flip);
        PLACES.iter().for_each(|at| read(&mut harness, &name, *at, true));
        send(&mut harness, Command::Difference);
        for at in PLACES {
            let point = place(&harness, at);
            harness.event(egui::Event::PointerMoved(point));
            until(&mut harness, &name, |window| {
                let Some((found, _, _, Some([theirs, mine]))) = window.readout() else { return false };
                let square: f64 = (0..3).map(|i| (mine[i] - theirs[i]).powi(2)).sum();
                let colour = HeatScale::DIFFERENCE.colour((square / 3.0).sqrt());
                found == at && window.shown_pixel(at) == Some(colour)
            });
        }
        send(&mut harness, Command::Difference);
        assert!(!harness.state().is_comparing(), "{name}");
    }
    assert!(kinds >= 5, "{kinds}");
}
