//! Pictures that are kept in slots.

use crate::common::{SMALL, control, has_samples, open, painted, save, send, until, until_painted};
use eframe::egui::{Key, Modifiers, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use weekender::app::{Command, Show, SlotCommand, SlotNumber, Window};
use weekender::film::to_byte;
use weekender::job::output::{Encoding, OutputFormat};
use weekender::numbers::heat::HeatScale;
use weekender::pictures::Picture;
use weekender::pictures::compare::{compare_sides, text as text_of};
use weekender::progressive::{Phase, luminance};
use weekender::stages::Transfer;

const ONE: SlotNumber = SlotNumber::ALL[0];
const TWO: SlotNumber = SlotNumber::ALL[1];
const THREE: SlotNumber = SlotNumber::ALL[2];

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

pub fn keep(harness: &mut Harness<'_, Window>, command: Command, number: SlotNumber) {
    send(harness, command);
    until(harness, "a kept picture", |window| window.slot(number).is_some());
}

/// Renders the picture with another field of view, in which the pixel shows something else.
fn change(harness: &mut Harness<'_, Window>) {
    harness.state_mut().document_mut().camera.vfov_degrees = 25.0;
    harness.run_steps(2);
    until(harness, "the changed picture", is_done);
}

/// The mean of the pixel on the screen, which the pointer asks for.
fn mean(harness: &mut Harness<'_, Window>) -> [f64; 3] {
    let rect = harness.state().picture_rect();
    let size = harness.state().document().size();
    let share = |axis: usize| (AT[axis] as f32 + 0.5) / size[axis] as f32;
    harness.hover_at(rect.lerp_inside(vec2(share(0), share(1))));
    until(harness, "the pixel's value", |window| window.inspected().is_some_and(|(at, _)| at == AT));
    for _ in 0..20 {
        std::thread::sleep(std::time::Duration::from_millis(2));
        harness.step();
    }
    harness.state().inspected().unwrap().1
}

fn in_8_bits(mean: [f64; 3], stops: f64) -> [u8; 3] {
    mean.map(|x| to_byte(x * stops.exp2(), Transfer::Gamma2, AT[1] as usize, 18))
}

#[test]
fn a_kept_picture_stays_as_it_was() {
    let mut harness = finished(8);
    let kept = mean(&mut harness);
    harness.key_press(Key::M);
    until(&mut harness, "a kept picture", |window| window.slot(ONE).is_some());
    let (name, samples) = harness.state().slot(ONE).unwrap();
    assert!(name.ends_with("8 samples") && name.starts_with("11."), "{name}");
    assert_eq!(samples, 8);
    change(&mut harness);
    let live = mean(&mut harness);
    assert_ne!(in_8_bits(kept, 0.0), in_8_bits(live, 0.0));

    harness.key_press_modifiers(Modifiers::ALT, Key::Num1);
    until(&mut harness, "the slot", |window| window.shown_pixel(AT) == Some(in_8_bits(kept, 0.0)));
    assert_eq!(harness.state().looked(), Some(ONE));
    assert!(painted(&harness, "samples (Escape returns)"), "a badge says what is shown");
    assert_eq!(mean(&mut harness), kept, "the inspector reads the slot");
    send(&mut harness, Command::Brighter);
    until(&mut harness, "exposure", |window| window.shown_pixel(AT) == Some(in_8_bits(kept, 0.5)));
    send(&mut harness, Command::NoExposure);
    send(&mut harness, Command::Show(Show::Luminance));
    let colour = HeatScale::luminance([-8.0, 4.0]).colour(luminance(kept));
    until(&mut harness, "false colours", |window| window.shown_pixel(AT) == Some(colour));
    assert!(harness.state().disabled_reason(Command::Show(Show::Occupancy)).is_some());

    harness.key_press(Key::Escape);
    harness.run_steps(2);
    assert_eq!((harness.state().show(), harness.state().looked()), (Show::Picture, Some(ONE)));
    harness.key_press(Key::Escape);
    harness.run_steps(2);
    assert_eq!(harness.state().looked(), None);
    until(&mut harness, "the live picture", |window| window.shown_pixel(AT) == Some(in_8_bits(live, 0.0)));
    assert_eq!(mean(&mut harness), live);
    assert!(!painted(&harness, "(Escape returns)"));
}

#[test]
fn one_key_flips_and_a_change_returns_to_the_live_picture() {
    let mut harness = finished(4);
    assert!(harness.state().disabled_reason(Command::Slot(SlotCommand::Swap)).is_some());
    keep(&mut harness, Command::Slot(SlotCommand::Keep), ONE);
    change(&mut harness);
    harness.key_press_modifiers(Modifiers::ALT | Modifiers::SHIFT, Key::Num3);
    until(&mut harness, "a third slot", |window| window.slot(THREE).is_some());
    send(&mut harness, Command::Slot(SlotCommand::Look(ONE)));
    let mut seen = Vec::new();
    for _ in 0..2 {
        harness.key_press(Key::J);
        harness.run_steps(2);
        seen.push(harness.state().looked());
    }
    assert_eq!(seen, [None, Some(ONE)]);
    send(&mut harness, Command::Slot(SlotCommand::Look(THREE)));
    harness.key_press(Key::J);
    harness.run_steps(2);
    assert_eq!(harness.state().looked(), Some(ONE), "between two slots");

    // A drag moves the picture, not the camera, which belongs to the live one.
    let camera = harness.state().document().camera;
    crate::common::drag(&mut harness, eframe::egui::PointerButton::Primary, Modifiers::NONE);
    harness.key_down(Key::W);
    harness.run_steps(3);
    harness.key_up(Key::W);
    harness.run_steps(2);
    assert_eq!((harness.state().document().camera, harness.state().looked()), (camera, Some(ONE)));
    harness.state_mut().document_mut().camera.vfov_degrees = 50.0;
    harness.run_steps(2);
    assert_eq!(harness.state().looked(), None);
}

#[test]
fn a_slot_is_wiped_and_subtracted_like_another_stage() {
    let mut harness = finished(8);
    let kept = mean(&mut harness);
    keep(&mut harness, Command::Slot(SlotCommand::Keep), ONE);
    send(&mut harness, Command::Slot(SlotCommand::Difference));
    until_painted(&mut harness, "identical to the bit");
    until(&mut harness, "no difference", |window| {
        window.shown_pixel(AT) == Some(HeatScale::DIFFERENCE.colour(0.0))
    });
    change(&mut harness);
    let live = mean(&mut harness);
    let squares: f64 = (0..3).map(|i| (live[i] - kept[i]).powi(2)).sum();
    let colour = HeatScale::DIFFERENCE.colour((squares / 3.0).sqrt());
    until(&mut harness, "the difference", |window| window.shown_pixel(AT) == Some(colour));
    assert!(!painted(&harness, "identical to the bit"));
    let difference = format!("{:+.4}", live[2] - kept[2]);
    assert!(harness.query_all_by_label(&difference).next().is_some(), "no {difference} in the inspector");
    assert!(harness.query_by_label("B, other").is_some());
    // Shift and C change how the two are compared.
    harness.key_press_modifiers(Modifiers::SHIFT, Key::C);
    harness.run_steps(2);
    until(&mut harness, "a wipe", |window| window.is_comparing() && window.has_other_picture());
    assert!(painted(&harness, "live: ") && painted(&harness, "slot 1: "));
    harness.key_press(Key::Escape);
    harness.run_steps(2);
    assert!(!harness.state().is_comparing());

    // Two slots with each other: the difference is that of the live picture with its sign changed.
    keep(&mut harness, Command::Slot(SlotCommand::Keep), TWO);
    send(&mut harness, Command::Slot(SlotCommand::Look(ONE)));
    control(&harness, "Difference from the slot 2").click();
    harness.run_steps(3);
    assert_eq!(harness.state().looked(), Some(ONE));
    until(&mut harness, "the difference", |window| window.shown_pixel(AT) == Some(colour));
    assert_eq!(mean(&mut harness), kept);
    let difference = format!("{:+.4}", kept[2] - live[2]);
    assert!(harness.query_all_by_label(&difference).next().is_some(), "no {difference} in the inspector");
    // A slot that is shown is compared with the live picture.
    send(&mut harness, Command::Slot(SlotCommand::Look(TWO)));
    send(&mut harness, Command::Slot(SlotCommand::Wipe));
    assert!(harness.state().is_comparing());
    assert_eq!(harness.state().looked(), None);
}

/// The words of the verdict, once it is there.
fn verdict(harness: &mut Harness<'_, Window>) -> (String, String) {
    send(harness, Command::Slot(SlotCommand::OnlyNoise));
    until(harness, "a verdict", |window| window.only_noise().is_some());
    let (headline, text) = harness.state().only_noise().unwrap().unwrap();
    (headline.to_owned(), text.to_owned())
}

#[test]
fn the_verdict_is_that_of_compare() {
    let directory = tempfile::tempdir().unwrap();
    let mut harness = open("--stage glass-schlick --size 96x54 --samples 16");
    until(&mut harness, "the end", is_done);
    let first = directory.path().join("first.exr");
    save(&mut harness, Command::Save(OutputFormat::Exr), &first);
    keep(&mut harness, Command::Slot(SlotCommand::Keep), ONE);
    let (headline, text) = verdict(&mut harness);
    assert_eq!(headline, "Identical to the bit");
    assert!(text.trim_end().ends_with("verdict     equal to the bit"), "{text}");
    harness.run_steps(3);
    assert!(harness.query_by_label("Identical to the bit").is_some());
    harness.key_press(Key::Escape);
    harness.run_steps(2);
    assert!(harness.query_by_label("Identical to the bit").is_none());
    for (seed, angle, expected) in [(5, 90.0, "Only noise"), (5, 80.0, "More than noise")] {
        let document = harness.state_mut().document_mut();
        (document.settings.seed, document.camera.vfov_degrees) = (seed, angle);
        harness.run_steps(2);
        until(&mut harness, "the changed picture", is_done);
        let second = directory.path().join(format!("{angle}.exr"));
        save(&mut harness, Command::Save(OutputFormat::Exr), &second);
        let (headline, text) = verdict(&mut harness);
        assert_eq!(headline, expected, "{text}");
        let sides = [&first, &second].map(|path| Picture::read(path, Encoding::Srgb).unwrap());
        let by_compare = text_of(&sides, &compare_sides(&sides).unwrap());
        let after_names = |text: &str| text.lines().skip(2).map(str::to_owned).collect::<Vec<_>>();
        assert_eq!(after_names(&text), after_names(&by_compare));
    }
}

#[test]
fn a_render_goes_on_from_a_slot() {
    let mut harness = finished(8);
    let before = harness.state().document().clone();
    keep(&mut harness, Command::Slot(SlotCommand::Keep), ONE);
    change(&mut harness);
    let changed = harness.state().document().camera;
    send(&mut harness, Command::Slot(SlotCommand::Open));
    until(&mut harness, "the picture of the slot", |window| *window.document() == before);
    until(&mut harness, "its samples", is_done);
    // All samples are there, and none was traced again.
    assert_eq!(harness.state().status().samples_per_pixel, 8);
    assert!(harness.state().status().contributions.is_empty(), "{:?}", harness.state().status());
    assert_eq!(verdict(&mut harness).0, "Identical to the bit");
    harness.key_press(Key::Escape);
    harness.run_steps(2);
    send(&mut harness, Command::Undo);
    assert_eq!(harness.state().document().camera, changed);
    send(&mut harness, Command::Redo);
    assert_eq!(*harness.state().document(), before);
    until(&mut harness, "the picture again", is_done);
    harness.state_mut().document_mut().stop = weekender::progressive::Stop::at_samples(12);
    until(&mut harness, "more samples", has_samples(12));
    // The live film is ahead of the slot and is not thrown away.
    send(&mut harness, Command::Slot(SlotCommand::Open));
    let told = "The live picture is this one, and it has no fewer samples";
    until(&mut harness, told, |window| window.messages().iter().any(|text| text == told));
    assert_eq!(harness.state().status().samples_per_pixel, 12);
}
