//! Tests of what commands copy and save, and under which names.

use super::tests::prepared;
use super::*;
use crate::app::model::document::Document;
use crate::app::tests::{until, window};
use crate::progressive::Stop;
use eframe::egui::{Context, OutputCommand, Pos2, RawInput, Rect, vec2};

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
