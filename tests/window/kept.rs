//! Pictures that are kept.

use crate::harness::{
    SMALL, drag_from, has_samples, mean, middle, name_file, open, save, scroll, send, until,
};
use crate::objects::click;
use crate::questions::Ask as _;
use crate::recovered::held;
use eframe::egui::{Key, Modifiers, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use weekender::app::{Command, Window};
use weekender::film::to_byte;
use weekender::progressive::Phase;
use weekender::stages::Transfer;

/// A pixel in the sky above the left ball.
const AT: [u32; 2] = [9, 2];

pub fn is_done(window: &Window) -> bool {
    matches!(window.status().phase, Phase::Done(_)) && has_samples(1)(window)
}

/// A window with a finished picture of this many samples.
pub fn finished(samples: u64) -> Harness<'static, Window> {
    let mut harness = open(&format!("{SMALL} --samples {samples}"));
    until(&mut harness, "the end", is_done);
    harness
}

pub fn keep(harness: &mut Harness<'_, Window>) {
    let count = harness.state().kept().len();
    send(harness, Command::Keep);
    until(harness, "a kept picture", |window| window.kept().len() > count);
    harness.run_steps(2);
}

/// Renders the picture with another field of view, in which the pixel shows something else.
fn change(harness: &mut Harness<'_, Window>) {
    harness.state_mut().document_mut().camera.vfov_degrees = 25.0;
    harness.run_steps(2);
    until(harness, "the changed picture", is_done);
}

fn in_8_bits(mean: [f64; 3], stops: f64) -> [u8; 3] {
    mean.map(|x| to_byte(x * stops.exp2(), Transfer::Gamma2, AT[1] as usize, 18))
}

/// While a kept picture is shown, nothing changes or saves the one that it hides.
#[test]
fn a_kept_picture_shields_the_traced_one() {
    let mut harness = finished(8);
    keep(&mut harness);
    change(&mut harness);
    let centre = middle(&harness);
    harness.hover_at(centre);
    harness.run_steps(2);
    send(&mut harness, Command::ListPaths);
    until(&mut harness, "paths", |window| window.listed_paths() > 0);
    until(&mut harness, "the end", is_done);
    let camera = harness.state().shown_document().camera;

    harness.key_press(Key::J);
    harness.run_steps(2);
    scroll(&mut harness, centre, 3.0);
    drag_from(&mut harness, centre, vec2(30.0, 10.0));
    harness.key_down(Key::W);
    harness.run_steps(3);
    harness.key_up(Key::W);
    assert_eq!(harness.state().shown_document().camera, camera);
    assert_eq!((harness.state().looked(), harness.state().selected()), (Some(0), None));
    for command in [Command::Save, Command::Copy, Command::Keep] {
        assert!(harness.state().disabled_reason(command).is_some(), "{command:?}");
    }
    harness.key_press(Key::Escape);
    harness.run_steps(2);
    assert_eq!(harness.state().looked(), None);
    assert!(harness.state().listed_paths() > 0 && is_done(harness.state()));
}

/// Left of the divider lies the kept picture, which has no spheres to select.
#[test]
fn nothing_acts_on_what_a_wipe_covers() {
    let mut harness = finished(8);
    keep(&mut harness);
    send(&mut harness, Command::Wipe);
    harness.run_steps(3);
    let rect = harness.state().picture_rect();
    let camera = harness.state().shown_document().camera;
    for (x, is_selected) in [(0.3, false), (0.6, true)] {
        let at = rect.lerp_inside(vec2(x, 0.6));
        click(&mut harness, at, Modifiers::NONE);
        assert_eq!(harness.state().selected().is_some(), is_selected, "{x}");
        assert_eq!(harness.state().disabled_reason(Command::ListPaths).is_none(), is_selected, "{x}");
    }
    drag_from(&mut harness, rect.lerp_inside(vec2(0.2, 0.2)), vec2(9.0, 9.0));
    assert_eq!(harness.state().shown_document().camera, camera);
}

#[test]
fn a_kept_picture_stays_as_it_was() {
    let mut harness = finished(8);
    let kept = mean(&mut harness, AT);
    keep(&mut harness);
    assert_eq!(harness.state().kept()[0].1, 8);
    change(&mut harness);
    let live = mean(&mut harness, AT);
    assert_ne!(in_8_bits(kept, 0.0), in_8_bits(live, 0.0));

    harness.key_press(Key::J);
    until(&mut harness, "it", |window| window.other_pixel(AT) == Some(in_8_bits(kept, 0.0)));
    assert_eq!(harness.state().looked(), Some(0));
    send(&mut harness, Command::Brighter);
    until(&mut harness, "exposure", |window| window.other_pixel(AT) == Some(in_8_bits(kept, 0.5)));
    send(&mut harness, Command::NoExposure);
    harness.key_press(Key::Escape);
    harness.run_steps(2);
    assert_eq!(harness.state().looked(), None);
    until(&mut harness, "the live picture", |window| window.shown_pixel(AT) == Some(in_8_bits(live, 0.0)));
    harness.key_press(Key::J);
    harness.run_steps(2);
    assert_eq!(harness.state().looked(), Some(0));
    harness.state_mut().document_mut().camera.vfov_degrees = 50.0;
    harness.run_steps(2);
    assert!(harness.state().looked().is_none() && !harness.state().is_comparing(), "a change returns");
}

#[test]
fn kept_picture_continues_with_its_samples() {
    let mut harness = finished(8);
    keep(&mut harness);
    let kept = harness.state().shown_document().camera;
    harness.state_mut().tracing.main.seconds_before = Some(60.0);
    change(&mut harness);
    send(&mut harness, Command::GoOnFromKept);
    until(&mut harness, "its samples", |window| held(window) == 8);
    assert_eq!(harness.state().shown_document().camera, kept);
}

#[test]
fn pictures_of_other_sizes_are_not_subtracted() {
    let mut harness = finished(2);
    keep(&mut harness);
    harness.state_mut().document_mut().set_size([64, 36]);
    harness.run_steps(2);
    assert!(harness.state().disabled_reason(Command::Difference).is_some());
    send(&mut harness, Command::RenderAtPartnerSize);
    assert_eq!(harness.state().shown_document().size(), [32, 18]);
    assert!(harness.state().disabled_reason(Command::Difference).is_none());
}

/// A file has 8 bits and no noise of its own.
#[test]
fn saved_picture_differs_from_its_render_only_by_noise() {
    let mut harness = open("--stage glass-schlick --size 96x54 --samples 16");
    until(&mut harness, "the end", is_done);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mine.png");
    save(&mut harness, Command::Save, &path);
    name_file(&mut harness, Command::CompareFile, &path);
    until(&mut harness, "the file", |window| window.is_comparing() && window.has_other_picture());
    assert_eq!(harness.state().other_pixel([9, 2]), harness.state().shown_pixel([9, 2]));
    assert_eq!(only_noise(&mut harness), "Only noise.");
}

#[test]
fn the_compared_picture_is_deleted() {
    let mut harness = finished(2);
    for _ in 0..2 {
        keep(&mut harness);
    }
    send(&mut harness, Command::Wipe);
    send(&mut harness, Command::DeleteKept);
    assert_eq!((harness.state().kept().len(), harness.state().is_comparing()), (1, false));
}

/// The first sentence of the answer, once it is there.
fn only_noise(harness: &mut Harness<'_, Window>) -> String {
    send(harness, Command::AreSame);
    until(harness, "an answer", |window| window.verdict().is_some());
    harness.state().verdict().unwrap().1.to_owned()
}

#[test]
fn noise_is_distinguished_from_a_difference() {
    let mut harness = open("--stage glass-schlick --size 96x54 --samples 16");
    until(&mut harness, "the end", is_done);
    keep(&mut harness);
    assert_eq!(only_noise(&mut harness), "Equal to the bit.");
    for (angle, expected) in [(90.0, "Only noise."), (80.0, "More than noise.")] {
        let document = harness.state_mut().document_mut();
        (document.settings.seed, document.camera.vfov_degrees) = (5, angle);
        harness.run_steps(2);
        until(&mut harness, "the changed picture", is_done);
        assert_eq!(only_noise(&mut harness), expected);
        harness.run_steps(2);
        assert!(harness.query_by_label(expected).is_some(), "the panel says it");
    }
}
