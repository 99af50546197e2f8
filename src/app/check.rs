//! A picture of another program, dropped on the window: what is wrong with it, and where.

use super::answers::Answers;
use super::texture::Texture;
use crate::check::{Mine, judge, pictures, text};
use crate::stages::Stage;
use eframe::egui::{self, Align2, RichText, TextureOptions, vec2};
use std::path::{Path, PathBuf};

/// The largest width of each of the three pictures, in points.
const PICTURE_WIDTH: f32 = 300.0;

/// A picture that was checked.
struct Checked {
    number: u64,
    path: PathBuf,
    /// The finding, or why the picture cannot be checked.
    outcome: Result<Found, String>,
}

/// What was found.
struct Found {
    words: String,
    size: [u32; 2],
    /// Mine, ours and the difference, RGB.
    views: [Vec<u8>; 3],
}

/// A finding on the screen.
struct Shown {
    path: PathBuf,
    words: String,
    size: [u32; 2],
    textures: [Texture; 3],
}

/// The check of a picture, made by a background thread.
#[derive(Default)]
pub struct Check {
    number: u64,
    waiting: Option<PathBuf>,
    shown: Option<Shown>,
    answers: Answers<Checked>,
}

impl Check {
    /// Checks a picture; it is one of `stage` if that is known.
    pub fn begin(&mut self, context: &egui::Context, path: &Path, stage: Option<&'static Stage>) {
        self.number += 1;
        let (number, path) = (self.number, path.to_owned());
        let checked = path.clone();
        let work = move || {
            let outcome = Mine::read(&checked).map_err(|error| error.to_string()).and_then(|mine| {
                let finding = judge(&mine, stage).map_err(|error| error.to_string())?;
                let views = pictures(&mine, &finding).map(|pixels| pixels.into_iter().flatten().collect());
                let words = text(&checked, &mine, &finding, &[]);
                Ok(Found { words, size: [mine.width, mine.height], views })
            });
            Checked { number, path: checked, outcome }
        };
        if self.answers.ask("check", context, work).is_ok() {
            self.waiting = Some(path);
        }
    }

    /// Takes findings. Returns the picture that was checked, or why it could not be.
    pub fn follow(&mut self) -> Option<Result<PathBuf, String>> {
        let checked = self.answers.take()?;
        if checked.number != self.number {
            return None;
        }
        self.waiting = None;
        match checked.outcome {
            Ok(Found { words, size, views }) => {
                let textures = views.map(|rgb8| Texture::new(size, &rgb8, None));
                self.shown = Some(Shown { path: checked.path.clone(), words, size, textures });
                Some(Ok(checked.path))
            }
            Err(reason) => Some(Err(reason)),
        }
    }

    /// The finding in words, while it is shown.
    pub fn words(&self) -> Option<&str> {
        self.shown.as_ref().map(|shown| shown.words.as_str())
    }

    /// Draws the finding, or that it is awaited.
    pub fn ui(&mut self, context: &egui::Context) {
        if let Some(path) = &self.waiting {
            egui::Window::new("Checking your picture")
                .id(egui::Id::unique("checking"))
                .pivot(Align2::CENTER_CENTER)
                .default_pos(context.content_rect().center())
                .collapsible(false)
                .show(context, |ui| {
                    ui.horizontal(|ui| {
                        ui.spinner();
                        ui.label(format!("{}: rendering what it could be", path.display()));
                    });
                });
        }
        let Some(shown) = &mut self.shown else { return };
        let mut is_open = true;
        egui::Window::new("Your picture")
            .id(egui::Id::unique("check"))
            .open(&mut is_open)
            .pivot(Align2::CENTER_CENTER)
            .default_pos(context.content_rect().center())
            .default_width(3.0 * PICTURE_WIDTH + 40.0)
            .show(context, |ui| {
                ui.label(RichText::new(shown.path.display().to_string()).weak());
                ui.horizontal_wrapped(|ui| {
                    let width = (ui.available_width() / 3.0 - 8.0).clamp(80.0, PICTURE_WIDTH);
                    let height = width * shown.size[1] as f32 / shown.size[0] as f32;
                    for (name, texture) in
                        ["yours", "ours", "difference"].into_iter().zip(&mut shown.textures)
                    {
                        ui.vertical(|ui| {
                            let id = texture.id(context, TextureOptions::LINEAR);
                            ui.image((id, vec2(width, height)));
                            ui.label(RichText::new(name).small());
                        });
                    }
                });
                ui.add_space(4.0);
                ui.add(egui::Label::new(RichText::new(shown.words.trim_end()).monospace()).wrap());
            });
        if !is_open {
            self.shown = None;
        }
    }
}
