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
fn captions_are_legible_on_every_screen() {
    for size in SCREENS {
        let mut harness = present("--stage ppm-tiny --samples 1", size);
        for stage in Stage::ALL {
            send(&mut harness, Command::Stage(stage));
            harness.run_steps(2);
            let texts = drawn(&harness);
            let screen = Rect::from_min_size(egui::Pos2::ZERO, size.into());
            for heading in ["What is new", "Look for"] {
                assert!(texts.iter().any(|(drawn, ..)| drawn == heading), "{} at {size:?}", stage.id);
            }
            for (text, least) in [
                (stage.title, 0.045),
                (stage.section, 0.045),
                (stage.what_is_new, 0.02),
                (stage.look_for, 0.02),
            ] {
                let found = texts.iter().find(|(drawn, ..)| drawn == text);
                let (_, points, rect) =
                    found.unwrap_or_else(|| panic!("{} at {size:?}: {text:?} is not drawn", stage.id));
                // A screen that is less wide than 4:3 would have smaller ones.
                assert!(
                    *points >= 0.99 * least * size[1],
                    "{} at {size:?}: {points} points: {text}",
                    stage.id
                );
                assert!(screen.contains_rect(*rect), "{} at {size:?}: {text} at {rect}", stage.id);
                let picture = harness.state().picture_rect();
                assert!(!picture.shrink(1.0).intersects(*rect), "{} at {size:?}: {text}", stage.id);
            }
            let picture = harness.state().picture_rect();
            assert!(picture.height() > 0.6 * size[1], "{} at {size:?}: {picture}", stage.id);
        }
    }
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

#[test]
fn the_screen_can_be_blanked() {
    let mut harness = present("--stage metal --size 32x18", [1280.0, 720.0]);
    let is_black = |harness: &Harness<'_, Window>| {
        let screen = Rect::from_min_size(egui::Pos2::ZERO, vec2(1280.0, 720.0));
        matches!(harness.output().shapes.last().map(|clipped| &clipped.shape),
            Some(egui::Shape::Rect(rect)) if rect.fill == egui::Color32::BLACK && rect.rect.contains_rect(screen))
    };
    for key in [Key::B, Key::Period] {
        harness.key_press(key);
        harness.run_steps(2);
        assert!(harness.state().is_blank() && is_black(&harness), "{key:?}");
        harness.key_press(key);
        harness.run_steps(2);
        assert!(!harness.state().is_blank() && !is_black(&harness), "{key:?}");
    }
    harness.key_press(Key::B);
    harness.run_steps(2);
    harness.key_press(Key::PageDown);
    harness.run_steps(2);
    assert!(!is_black(&harness), "the next stage is seen");
    assert_eq!(harness.state().selected(), None, "the period key selects no sphere here");
    harness.key_press(Key::Escape);
    harness.run_steps(3);
    assert!(harness.state().disabled_reason(Command::Blank).is_some());
}

#[test]
fn the_place_among_the_stages_is_told() {
    let mut harness = present("--stage ppm-tiny", [1280.0, 720.0]);
    let count = Stage::ALL.len();
    assert!(has(&harness, &format!("1 of {count}")));
    send(&mut harness, Command::Stage(&Stage::ALL[count - 1]));
    harness.run_steps(3);
    assert!(has(&harness, &format!("{count} of {count}")));
}

#[test]
fn the_progress_is_shown_along_the_bottom() {
    let mut harness = present("--stage metal --size 32x18 --samples 64", [1280.0, 720.0]);
    until(&mut harness, "the end", |window| window.status().phase.is_over());
    harness.run_steps(3);
    let words = "done: 64 of 64 samples per pixel";
    assert!(drawn(&harness).iter().any(|(text, size, _)| text == words && *size > 0.02 * 720.0));
    let bar = harness
        .query_all_by_label(words)
        .find(|node| node.accesskit_node().role() == egui::Role::ProgressIndicator);
    let bar = bar.unwrap().rect();
    // Without a window system there is a margin of 8 points.
    assert!(bar.width() > 1263.0 && bar.bottom() > 711.0 && bar.height() < 8.0, "{bar}");
}

#[test]
fn the_pixel_under_the_pointer_is_large() {
    for size in SCREENS {
        let mut harness = present("--stage metal --size 32x18 --samples 64", size);
        until(&mut harness, "the end", |window| window.status().phase.is_over());
        let squares = |harness: &Harness<'_, Window>| -> Vec<(Rect, egui::Color32)> {
            let side = 0.027 * size[1];
            let shapes = harness.output().shapes.iter().filter_map(|clipped| match &clipped.shape {
                egui::Shape::Rect(rect) => Some((rect.rect, rect.fill)),
                _ => None,
            });
            shapes
                .filter(|(rect, fill)| {
                    (rect.width() - side).abs() < 0.1 && (rect.height() - side).abs() < 0.1 && fill.a() == 255
                })
                .collect()
        };
        harness.run_steps(2);
        assert!(squares(&harness).is_empty(), "the pointer is not over the picture");
        for share in [[0.3, 0.4], [0.97, 0.4]] {
            let picture = harness.state().picture_rect();
            let at = picture.lerp_inside(vec2(share[0], share[1]));
            harness.event(egui::Event::PointerMoved(at));
            harness.run_steps(3);
            let pixel = [(share[0] * 32.0) as u32, (share[1] * 18.0) as u32];
            until(&mut harness, "its numbers", |window| {
                window.inspected().is_some_and(|(at, _)| at == pixel)
            });
            harness.run_steps(2);
            let squares = squares(&harness);
            let [red, green, blue] = harness.state().shown_pixel(pixel).unwrap();
            let own = egui::Color32::from_rgb(red, green, blue);
            assert_eq!(
                squares.len(),
                if share[0] < 0.5 { 81 } else { 45 },
                "neighbours beyond the edge are left out"
            );
            assert!(squares.iter().any(|(_, fill)| *fill == own));
            let place = format!("x {}   y {}", pixel[0], pixel[1]);
            assert!(drawn(&harness).iter().any(|(text, ..)| *text == place), "{place}");
            assert!(
                drawn(&harness).iter().any(|(text, ..)| text.starts_with(&format!("R {red:>3}   0."))),
                "{place}"
            );
            let around = squares.iter().fold(Rect::NOTHING, |all, (rect, _)| all.union(*rect));
            assert!(!around.contains(at), "the lens covers what it shows");
            let screen = Rect::from_min_size(egui::Pos2::ZERO, size.into());
            assert!(screen.contains_rect(around), "{around}");
        }
    }
}

#[test]
fn orbit_wipe_and_sights_go_on() {
    let mut harness = present("--stage glass-schlick --size 64x36", [1280.0, 720.0]);
    until(&mut harness, "a picture", has_samples(1));
    let before = harness.state().document().camera;
    drag(&mut harness, PointerButton::Primary, Modifiers::NONE);
    assert_ne!(harness.state().document().camera, before);
    harness.key_press(Key::Home);
    harness.key_press(Key::C);
    harness.run_steps(3);
    until(&mut harness, "the other picture", |window| window.has_other_picture());
    harness.run_steps(3);
    for title in ["11.4 The complete rule", "11.2 Glass that only refracts"] {
        let texts = drawn(&harness);
        let found = texts.iter().find(|(text, ..)| text.starts_with(&title[..5]) && *text != title[..4]);
        let (_, size, rect) = found.unwrap_or_else(|| panic!("no {title} in {texts:?}"));
        assert!(*size >= 0.025 * 720.0 && harness.state().picture_rect().intersects(*rect), "{size} {rect}");
    }
    harness.key_press(Key::Escape);
    harness.run_steps(3);
    assert!(
        !harness.state().is_comparing() && harness.state().is_presenting(),
        "Escape first leaves the wipe"
    );
    harness.key_press(Key::H);
    harness.run_steps(3);
    assert!(harness.state().has_sight());
    assert!(has(&harness, Stage::find("glass-schlick").unwrap().sight.caption));
    harness.key_press(Key::Escape);
    harness.run_steps(3);
    assert!(!harness.state().has_sight() && harness.state().is_presenting());
    send(&mut harness, Command::Show(Show::Normals));
    harness.key_press(Key::Escape);
    harness.run_steps(3);
    assert!(harness.state().show() == Show::Picture && harness.state().is_presenting());
    harness.key_press(Key::Escape);
    harness.run_steps(3);
    assert!(!harness.state().is_presenting());
}

#[test]
fn the_keys_are_told_and_fade() {
    let mut harness = present("--stage metal --size 32x18", [1280.0, 720.0]);
    let is_told =
        |harness: &Harness<'_, Window>| harness.query_all_by_label_contains("Escape: end").next().is_some();
    assert!(is_told(&harness));
    harness.run_steps(60 * 5);
    assert!(is_told(&harness));
    harness.run_steps(60 * 6);
    assert!(!is_told(&harness));
}

#[test]
fn tab_leaves_the_picture_alone() {
    let mut harness = present("--stage metal --size 32x18", [1280.0, 720.0]);
    let title = harness.state().document().stage().unwrap().title;
    let small = harness.state().picture_rect();
    harness.key_press(Key::Tab);
    harness.run_steps(3);
    assert!(!has(&harness, title));
    assert!(harness.state().picture_rect().height() > 1.3 * small.height());
    assert!(middle(&harness).distance(harness.state().picture_rect().center()) < 2.0);
    harness.key_press(Key::Tab);
    harness.run_steps(3);
    assert!(has(&harness, title) && harness.state().is_presenting());
    // Panels wait for the end.
    for command in [Command::Plot, Command::Info, Command::NextPanel, Command::Stages] {
        assert!(harness.state().disabled_reason(command).is_some(), "{command:?}");
    }
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

/// A later stage is at the right of the divider.
#[test]
fn the_lens_over_a_later_stage_does_not_tell_the_radiance_of_this_one() {
    let mut harness = present("--stage metal --size 64x36 --samples 16", [1280.0, 720.0]);
    until(&mut harness, "the end", is_finished);
    send(&mut harness, Command::Wipe);
    until(&mut harness, "the other picture", |window| window.has_other_picture());
    for (x, is_told) in [(0.02, true), (0.98, false)] {
        let (_, _, radiance) = told_by_lens(&mut harness, [x, 0.74]);
        assert_eq!(radiance.is_some(), is_told, "at {x}");
    }
}

#[test]
fn the_lens_over_another_stage_does_not_tell_the_radiance_of_this_one() {
    let mut harness = finished();
    send(&mut harness, Command::Wipe);
    until(&mut harness, "the other picture", |window| window.has_other_picture());
    // The other stage is an earlier one, which is at the left of the divider.
    for (x, is_told) in [(0.05, false), (0.95, true), (0.05, false)] {
        let (_, _, radiance) = told_by_lens(&mut harness, [x, 0.74]);
        assert_eq!(radiance.is_some(), is_told, "at {x}");
    }
}

#[test]
fn the_lens_over_a_kept_picture_shows_its_own_pixels() {
    let mut harness = finished();
    let theirs = harness.state().shown_pixel([3, 27]).unwrap();
    send(&mut harness, Command::Slot(SlotCommand::Keep));
    until(&mut harness, "a kept picture", |window| window.slot(SlotNumber::ALL[0]).is_some());
    let document = harness.state_mut().document_mut();
    document.give_size([32, 18]);
    document.camera.vfov_degrees = 25.0;
    harness.run_steps(2);
    until(&mut harness, "a smaller picture", is_finished);
    send(&mut harness, Command::Slot(SlotCommand::Wipe));
    until(&mut harness, "the other picture", |window| window.has_other_picture());
    // The kept picture is at the left. It has two pixels for one of the live picture.
    assert_eq!(told_by_lens(&mut harness, [0.05, 0.74]), ("x 3   y 27".to_owned(), theirs[0], None));
    let (place, byte, radiance) = told_by_lens(&mut harness, [0.95, 0.74]);
    let mine = harness.state().shown_pixel([30, 13]).unwrap();
    assert_eq!((place.as_str(), byte, radiance.is_some()), ("x 30   y 13", mine[0], true));
}
