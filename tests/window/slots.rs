//! Pictures that are kept in slots.

use crate::common::{
    SMALL, control, copied, has_samples, open, open_sized, painted, save, send, until, until_painted,
};
use eframe::egui::{Key, Modifiers, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use std::time::Duration;
use weekender::app::{Command, Show, SlotCommand, SlotNumber, Window};
use weekender::film::{key, to_byte};
use weekender::heat::HeatScale;
use weekender::output::{Encoding, OutputFormat, read_description};
use weekender::pictures::Picture;
use weekender::pictures::compare::{compare_sides, text};
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

#[test]
fn pictures_of_different_sizes_are_not_subtracted() {
    let mut harness = finished(4);
    keep(&mut harness, Command::Slot(SlotCommand::Keep), ONE);
    send(&mut harness, Command::Slot(SlotCommand::Difference));
    until(&mut harness, "a difference", |window| window.has_other_picture());
    harness.state_mut().document_mut().settings.width = 40;
    harness.run_steps(3);
    assert!(!harness.state().is_comparing());
    let told = harness.state().messages();
    let reason = "slot 1 is 32x18 and the picture is 40x18";
    assert!(told.iter().any(|text| text.contains(reason)), "{told:?}");
    for command in [Command::Slot(SlotCommand::Difference), Command::Slot(SlotCommand::OnlyNoise)] {
        assert!(
            harness.state().disabled_reason(command).unwrap().starts_with("Slot 1 is 32x18"),
            "{command:?}"
        );
    }
    // It can be looked at, at its own size.
    let aspect = |harness: &Harness<'_, Window>| {
        let size = harness.state().picture_rect().size();
        (f64::from(size.x / size.y) * 18.0).round()
    };
    assert_eq!(aspect(&harness), 40.0);
    send(&mut harness, Command::Slot(SlotCommand::Look(ONE)));
    assert_eq!(aspect(&harness), 32.0);
}

/// The strip takes room from the picture, which must not change its size because of that.
#[test]
fn pictures_keep_their_size_while_slots_are_in_use() {
    let mut harness = open_sized("--stage glass-schlick --samples 1", [700.0, 500.0]);
    harness.state_mut().remembered_mut().sizing = weekender::app::Sizing::Viewport;
    let wait = |harness: &mut Harness<'_, Window>| {
        for _ in 0..40 {
            std::thread::sleep(Duration::from_millis(10));
            harness.step();
        }
    };
    send(&mut harness, Command::Size(weekender::app::Sizing::Viewport));
    wait(&mut harness);
    until(&mut harness, "the end", is_done);
    wait(&mut harness);
    let (size, height) = (harness.state().document().size(), harness.state().picture_rect().height());
    keep(&mut harness, Command::Slot(SlotCommand::Keep), ONE);
    wait(&mut harness);
    assert_eq!(harness.state().document().size(), size);
    assert!(harness.state().picture_rect().height() <= height);
    send(&mut harness, Command::NextStage);
    wait(&mut harness);
    until(&mut harness, "the next stage", is_done);
    assert_eq!(harness.state().document().size(), size);
    assert_eq!(harness.state().disabled_reason(Command::Slot(SlotCommand::Wipe)), None);
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
        let by_compare = text(&sides, &compare_sides(&sides).unwrap());
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

#[test]
fn what_is_shown_is_saved_and_copied() {
    let directory = tempfile::tempdir().unwrap();
    let mut harness = finished(8);
    let kept = mean(&mut harness);
    keep(&mut harness, Command::Slot(SlotCommand::Keep), ONE);
    change(&mut harness);
    send(&mut harness, Command::Slot(SlotCommand::Look(ONE)));
    let path = directory.path().join("slot.png");
    save(&mut harness, Command::Save(OutputFormat::Png), &path);
    let saved = image::open(&path).unwrap().to_rgb8();
    assert_eq!(saved.get_pixel(AT[0], AT[1]).0, in_8_bits(kept, 0.0));
    let description = read_description(&path).unwrap();
    assert_eq!(description.get(key::SAMPLES), Some("8"));
    assert!(description.get(key::CAMERA).unwrap().contains("vfov 90 degrees"), "{description:?}");
    assert!(description.get(key::BACKEND).unwrap().starts_with("cpu"), "{description:?}");
    harness.state_mut().send(Command::CopyPicture);
    let picture = copied(&mut harness, Duration::from_secs(60)).unwrap();
    let [red, green, blue, _] = picture[(AT[0] as usize, AT[1] as usize)].to_array();
    assert_eq!([red, green, blue], in_8_bits(kept, 0.0));
    let told = harness.state().messages();
    assert!(told.iter().any(|text| text.starts_with("Copied the picture: 32x18, 8 samples")), "{told:?}");
}

#[test]
fn the_strip_lists_names_and_deletes() {
    for size in [[1280.0, 800.0], [800.0, 600.0]] {
        let mut harness = open_sized(&format!("{SMALL} --samples 4"), size);
        harness.run_steps(3);
        until(&mut harness, "the end", is_done);
        let height = harness.state().picture_rect().height();
        assert!(harness.query_by_label("Slot 1").is_none() && harness.query_by_label("Flip").is_none());
        keep(&mut harness, Command::Slot(SlotCommand::Keep), ONE);
        harness.run_steps(3);
        assert!(harness.state().picture_rect().height() <= height);
        let strip = harness.get_by_label("Slot 1").rect();
        assert!(strip.is_positive() && strip.bottom() < size[1], "{strip:?}");
        assert!(harness.query_by_label_contains("32x18, 4 samples").is_some());
        // The name.
        harness.get_by_label("Name of slot 1").focus();
        harness.run_steps(2);
        harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
        harness.step();
        harness.event(eframe::egui::Event::Text("before".to_owned()));
        harness.run_steps(2);
        assert_eq!(harness.state().slot(ONE).unwrap().0, "before");
        harness.key_press(Key::Escape);
        harness.run_steps(2);
        // A click looks, another one returns.
        harness.get_by_label("Slot 1").click();
        harness.run_steps(3);
        assert_eq!(harness.state().looked(), Some(ONE));
        assert!(harness.state().disabled_reason(Command::Slot(SlotCommand::Keep)).is_some());
        harness.get_by_label("Slot 1").click();
        harness.run_steps(3);
        assert_eq!(harness.state().looked(), None);
        send(&mut harness, Command::Slot(SlotCommand::Delete));
        assert!(harness.state().slot(ONE).is_none() && harness.query_by_label("Slot 1").is_none());
        send(&mut harness, Command::Slot(SlotCommand::BringBack));
        assert_eq!(harness.state().slot(ONE).unwrap().0, "before");
        // The menu lists slots in use.
        control(&harness, "Slots").click();
        harness.run_steps(3);
        assert!(harness.query_by_label("Look at slot 1: before").is_some());
        assert!(harness.query_by_label_contains("Look at slot 2").is_none());
    }
}

#[test]
fn nine_slots_are_enough_to_fill() {
    let mut harness = finished(2);
    for number in SlotNumber::ALL {
        send(&mut harness, Command::Slot(SlotCommand::Keep));
        // A picture is kept once its film has come from another thread.
        until(&mut harness, "the next slot", |window| window.slot(number).is_some());
    }
    assert!(
        harness
            .state()
            .disabled_reason(Command::Slot(SlotCommand::Keep))
            .unwrap()
            .starts_with("All nine slots")
    );
    change(&mut harness);
    harness.state_mut().document_mut().stop = weekender::progressive::Stop::at_samples(4);
    until(&mut harness, "more samples", has_samples(4));
    send(&mut harness, Command::Slot(SlotCommand::KeepIn(TWO)));
    until(&mut harness, "another picture", |window| {
        window.slot(TWO).is_some_and(|(_, samples)| samples == 4)
    });
    send(&mut harness, Command::Slot(SlotCommand::BringBack));
    assert_eq!(harness.state().slot(TWO).unwrap().1, 2, "the replaced picture");
}
