//! A part of the picture that is marked, copied and saved.

use crate::common::{copied, drag_from, has_samples, name_file, open, painted, save, send, until};
use eframe::egui::{self, Key, Pos2, vec2};
use egui_kittest::Harness;
use std::time::Duration;
use weekender::app::{Command, Window};
use weekender::film::{checkpoint, key};
use weekender::output::{OutputFormat, read_description};

/// The middle of a pixel on the screen.
fn at(harness: &Harness<'_, Window>, x: u32, y: u32) -> Pos2 {
    let rect = harness.state().picture_rect();
    rect.lerp_inside(vec2((x as f32 + 0.5) / 32.0, (y as f32 + 0.5) / 18.0))
}

fn drag(harness: &mut Harness<'_, Window>, from: [u32; 2], to: [u32; 2]) {
    let (from, to) = (at(harness, from[0], from[1]), at(harness, to[0], to[1]));
    drag_from(harness, from, to - from);
    harness.run_steps(2);
}

#[test]
fn a_part_is_marked_copied_and_saved() {
    let directory = tempfile::tempdir().unwrap();
    let whole = directory.path().join("whole.png");
    let mut harness = open("--stage lambertian-linear --size 32x18 --samples 8");
    until(&mut harness, "a picture", has_samples(8));
    save(&mut harness, Command::Save(OutputFormat::Png), &whole);
    let whole = image::open(&whole).unwrap().to_rgb8();
    assert!(harness.state().disabled_reason(Command::CopyCrop).is_some());
    let camera = harness.state().document().camera;
    send(&mut harness, Command::Crop);
    drag(&mut harness, [4, 3], [13, 8]);
    assert_eq!(harness.state().crop(), Some([[4, 3], [10, 6]]));
    assert!(painted(&harness, "10x6 at 4,3"));
    drag(&mut harness, [8, 5], [10, 4]);
    assert_eq!(harness.state().crop(), Some([[6, 2], [10, 6]]), "a drag within it moves it");
    assert_eq!(harness.state().document().camera, camera);
    let is_part = |pixel: &dyn Fn(u32, u32) -> [u8; 3]| {
        (0..6).all(|y| (0..10).all(|x| pixel(x, y) == whole.get_pixel(x + 6, y + 2).0))
    };

    harness.event(egui::Event::Copy);
    harness.step();
    let picture = copied(&mut harness, Duration::from_secs(60)).unwrap();
    assert_eq!(picture.size, [10, 6]);
    assert!(is_part(&|x, y| {
        let [red, green, blue, _] = picture[(x as usize, y as usize)].to_array();
        [red, green, blue]
    }));
    let told = harness.state().messages();
    assert!(told.iter().any(|text| text.starts_with("Copied the crop: 10x6 at 6,2, 8 samples")), "{told:?}");

    // Ctrl+S saves it, too.
    for (command, name) in [(Command::SaveCrop, "a.png"), (Command::Save(OutputFormat::Png), "b.png")] {
        let path = directory.path().join(name);
        name_file(&mut harness, command, &path);
        until(&mut harness, name, |window| window.messages().iter().any(|text| text.ends_with(name)));
        let saved = image::open(&path).unwrap().to_rgb8();
        assert_eq!(saved.dimensions(), (10, 6), "{name}");
        assert!(is_part(&|x, y| saved.get_pixel(x, y).0), "{name}");
        let description = read_description(&path).unwrap();
        assert_eq!(description.get(key::CROP), Some("10x6 at 6,2"));
        assert_eq!(description.get(key::SAMPLES), Some("8"));
    }
    let film = directory.path().join("film.exr");
    save(&mut harness, Command::Save(OutputFormat::Exr), &film);
    assert_eq!(checkpoint::load(&film).unwrap().film.width(), 32, "a film is never cropped");

    harness.key_press(Key::Escape);
    harness.run_steps(2);
    assert_eq!(harness.state().crop(), None);
    assert!(harness.state().disabled_reason(Command::SaveCrop).is_some());
    harness.event(egui::Event::Copy);
    harness.step();
    assert_eq!(copied(&mut harness, Duration::from_secs(60)).unwrap().size, [32, 18]);
}

#[test]
fn a_crop_ends_where_the_picture_ends() {
    let mut harness = open("--stage lambertian-linear --size 32x18 --samples 2");
    until(&mut harness, "a picture", has_samples(2));
    send(&mut harness, Command::Crop);
    assert!(painted(&harness, "Drag over the part to copy or save"));
    let from = at(&harness, 20, 10);
    drag_from(&mut harness, from, vec2(2e3, 2e3));
    harness.run_steps(2);
    assert_eq!(harness.state().crop(), Some([[20, 10], [12, 8]]));
    harness.state_mut().document_mut().settings.width = 24;
    harness.run_steps(2);
    assert_eq!(harness.state().crop(), Some([[20, 10], [4, 8]]));
    harness.state_mut().document_mut().settings.width = 16;
    harness.run_steps(2);
    assert_eq!(harness.state().crop(), None, "nothing of it is left");
}
