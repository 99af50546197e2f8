//! Tests of what commands copy and save, and under which names.

use super::tests::prepared;
use super::*;
use crate::app::model::document::Document;
use crate::app::model::kept::Kept;
use crate::app::model::slots::{Slot, SlotNumber};
use crate::app::tests::{until, window};
use crate::film::Film;
use crate::progressive::Stop;
use crate::recipe::file;
use crate::stages::Stage;
use eframe::egui::{Context, OutputCommand, Pos2, RawInput, Rect, vec2};
use std::sync::Arc;

#[test]
fn what_is_saved_is_said_in_words() {
    let mut window = window("weekender --stage glass-schlick --size 16x9 --device cpu");
    assert_eq!(window.size_words(), "The picture: 16x9");
    window.model.document.has_own_size = false;
    assert_eq!(window.size_words(), "The picture: 16x9, as in the viewport");
}

/// Shows a slot whose picture is another one than the live one and has 7 samples per pixel.
fn look_at_another(window: &mut Window) -> Arc<Kept> {
    let mut document = Document::new(Origin::of_stage(Stage::find("metal").unwrap()));
    document.give_size([4, 2]);
    let mut film = Film::new(4, 2, 2);
    film.record(0..7, 0).unwrap();
    let kept = Arc::new(Kept::new(document, film, Arc::default(), None));
    let slot = Slot { name: "mine".to_owned(), kept: Arc::clone(&kept) };
    window.model.view.slots.put(SlotNumber::ALL[0], slot);
    window.model.view.look(Some(SlotNumber::ALL[0]));
    kept
}

/// The command line that is copied.
fn copied(context: &Context, window: &mut Window) -> String {
    let output = context.run_ui(RawInput::default(), |ui| window.perform(ui.ctx(), Command::CopyCommand));
    let [OutputCommand::CopyText(line)] = &output.platform_output.commands[..] else {
        panic!("{:?}", output.platform_output.commands)
    };
    line.clone()
}

/// The texts of the open dialog.
fn dialog(context: &Context, window: &mut Window) -> Vec<String> {
    let (facts, mut texts) = (window.facts(), Vec::new());
    let screen = Rect::from_min_size(Pos2::ZERO, vec2(1280.0, 800.0));
    for _ in 0..3 {
        let input = RawInput { screen_rect: Some(screen), ..RawInput::default() };
        let output = context.run_ui(input, |ui| {
            assert!(window.dialogs.ui(ui, &facts, &mut Vec::new()).is_none());
        });
        let shapes = output.shapes.into_iter().map(|clipped| clipped.shape);
        texts = shapes
            .filter_map(|shape| match shape {
                egui::Shape::Text(text) => Some(text.galley.text().to_owned()),
                _ => None,
            })
            .collect();
    }
    texts
}

#[test]
fn what_is_copied_named_and_saved_is_the_picture_of_the_slot_that_is_shown() {
    let (context, mut window) = (Context::default(), prepared());
    window.model.view.crop = None;
    let kept = look_at_another(&mut window);
    let line = copied(&context, &mut window);
    for part in [" --stage=metal ", " --size=4x2 ", " --samples=7 ", " --out=metal.png"] {
        assert!(line.contains(part), "{line}");
    }
    assert_eq!(window.size_words(), "slot 1: mine: 4x2");
    for (command, name) in
        [(Command::Save(OutputFormat::Png), "metal.png"), (Command::SaveScene, "metal.toml")]
    {
        window.perform(&context, command);
        let texts = dialog(&context, &mut window);
        assert!(texts.iter().any(|text| text == name), "{texts:?}");
        let is_size_told = texts.iter().any(|text| text == "slot 1: mine: 4x2");
        assert_eq!(is_size_told, command != Command::SaveScene, "{texts:?}");
    }
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("a.toml");
    window.use_path(&context, Purpose::SaveScene, path.clone());
    assert_eq!(window.files.saved.wait(), Some(Ok(path.clone())));
    assert_eq!(std::fs::read_to_string(path).unwrap(), file::to_toml(&kept.document.recipe()));
}

#[test]
fn a_copied_command_has_the_samples_of_the_film_if_that_is_of_the_picture() {
    let mut window = window("weekender --stage glass-schlick --size 16x9 --samples 4 --device cpu");
    let context = Context::default();
    let is_over =
        |window: &Window| window.main.has_samples(window.document()) && window.status().phase.is_over();
    until(&mut window, &context, "the end", is_over);
    let mut has = |change: fn(&mut Document), samples: u64| {
        change(&mut window.model.document);
        let line = copied(&context, &mut window);
        assert!(line.contains(&format!(" --samples={samples} ")), "{samples}: {line}");
    };
    has(|document| document.stop = Stop::at_samples(100), 4);
    // That would be another film, which has no samples yet.
    has(|document| document.settings.seed = 9, 100);
    let usual = prepared().document().origin.recipe.samples_per_pixel;
    has(|document| document.stop = Stop::default(), usual);
}

#[test]
fn a_file_is_named_after_what_is_saved_and_goes_where_the_last_one_went() {
    let (context, mut window) = (Context::default(), prepared());
    window.model.remembered.directory = Some("/of".into());
    let (picture, crop) = (Some("The picture: 16x9"), Some("The crop: 3x4 at 1,2"));
    for (command, name, about) in [
        (Command::Save(OutputFormat::P6), "glass-schlick.ppm", picture),
        (Command::Save(OutputFormat::Exr), "glass-schlick.exr", picture),
        (Command::Save(OutputFormat::Png), "glass-schlick-crop.png", crop),
        (Command::SaveCrop, "glass-schlick-crop.png", crop),
        (Command::SaveScene, "glass-schlick.toml", None),
        (Command::SaveFlight, "glass-schlick-path.toml", None),
    ] {
        window.perform(&context, command);
        let texts = dialog(&context, &mut window);
        let path = Path::new("/of").join(name).display().to_string();
        assert!(texts.contains(&path), "{command:?}: {texts:?}");
        let is_about = |text: &&str| text.starts_with("The picture: ") || text.starts_with("The crop: ");
        assert_eq!(texts.iter().map(String::as_str).find(is_about), about, "{command:?}");
    }
}

#[test]
fn a_picture_that_keeps_an_earlier_size_is_told_with_both() {
    let (mut window, context) = (window("weekender --stage normals --device cpu"), Context::default());
    until(&mut window, &context, "a picture", |window| window.main.has_samples(window.document()));
    // So long that it is not given up for the other size.
    window.seconds_before = Some(1e6);
    window.model.remembered.has_panels = false;
    until(&mut window, &context, "an offer", |window| window.sizer.offer().is_some());
    let ([width, height], [wide, high]) = (window.document().size(), window.sizer.offer().unwrap());
    let told = format!("The picture: {width}x{height}, as in the viewport when it began (now {wide}x{high})");
    assert_eq!(window.size_words(), told);
    assert_ne!([width, height], [wide, high]);
}
