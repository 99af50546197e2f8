//! A picture of another program, dropped on the window: what is wrong with it, and where.

use super::answers::Answers;
use super::texture::Texture;
use crate::pictures::check::{Mine, judge, pictures, text};
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
            let read = Mine::read(&checked).map_err(|error| unreadable(&checked, error.to_string()));
            let outcome = read.and_then(|mine| {
                let finding = judge(&mine, stage).map_err(|error| error.to_string())?;
                let views = pictures(&mine, &finding).map(|pixels| pixels.into_iter().flatten().collect());
                let words = text(&checked, &mine, &finding, &[]);
                Ok(Found { words, size: [mine.width, mine.height], views })
            });
            Checked { number, path: checked, outcome }
        };
        let asked = path.clone();
        let substitute = move |reason: String| Checked { number, path: asked, outcome: Err(reason) };
        self.answers.ask("check", context, work, substitute);
        self.waiting = Some(path);
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

    /// Whether a finding is shown or awaited.
    pub fn is_open(&self) -> bool {
        self.waiting.is_some() || self.shown.is_some()
    }

    /// Closes the finding. One that is awaited is not shown.
    pub fn close(&mut self) {
        self.number += 1;
        (self.waiting, self.shown) = (None, None);
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

/// Why a file cannot be read as a picture. By its name, it may have been meant as a file of another kind.
fn unreadable(path: &Path, reason: String) -> String {
    let is_ending = |ending: &std::ffi::OsStr| {
        ["png", "ppm", "pnm"].iter().any(|known| ending.eq_ignore_ascii_case(known))
    };
    if path.extension().is_some_and(is_ending) || !path.is_file() {
        return reason;
    }
    format!("{} is neither a PNG nor a PPM; scene files end in .toml and films in .exr", path.display())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_last_picture_that_was_asked_about_is_told_of() {
        let context = egui::Context::default();
        let mut check = Check { number: 2, waiting: Some("second".into()), ..Check::default() };
        let answer = |check: &Check, number, outcome| {
            check.answers.answer(&context).give(Checked { number, path: "mine.ppm".into(), outcome });
        };
        let found = || Found { words: "mine".to_owned(), size: [1, 1], views: [(); 3].map(|()| vec![0; 3]) };
        answer(&check, 1, Ok(found()));
        assert!(check.follow().is_none() && check.waiting.is_some() && check.words().is_none());
        answer(&check, 2, Err("it is damaged".to_owned()));
        assert_eq!(check.follow(), Some(Err("it is damaged".to_owned())));
        assert!(check.waiting.is_none() && check.words().is_none());
        answer(&check, 2, Ok(found()));
        assert_eq!(check.follow(), Some(Ok("mine.ppm".into())));
        assert_eq!(check.words(), Some("mine"));
        check.begin(&context, Path::new("/of/nothing.ppm"), None);
        assert_eq!((check.number, check.waiting.as_deref()), (3, Some(Path::new("/of/nothing.ppm"))));
    }

    #[test]
    fn a_file_that_is_no_picture_is_told_and_ends_the_wait() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("notes.txt");
        std::fs::write(&path, "no picture").unwrap();
        let (context, mut check) = (egui::Context::default(), Check::default());
        check.begin(&context, &path, None);
        assert!(check.is_open() && check.words().is_none());
        let answer = check.answers.wait().unwrap();
        check.answers.answer(&context).give(answer);
        let told = check.follow().unwrap().unwrap_err();
        assert_eq!(told, unreadable(&path, String::new()));
        assert!(!check.is_open());
    }

    #[test]
    fn a_finding_is_about_the_picture_that_was_checked() {
        // The tiny picture of the book, as the first lines of its program print it.
        let [width, height] = [16_u32, 9];
        let share = |at: u32, count: u32| (255.999 * f64::from(at) / f64::from(count - 1)) as u8;
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
        let rgb8: Vec<u8> = pixels.flat_map(|[x, y]| [share(x, width), share(y, height), 0]).collect();
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("mine.ppm");
        std::fs::write(&path, [b"P6\n16 9\n255\n".as_slice(), &rgb8].concat()).unwrap();
        let (context, mut check) = (egui::Context::default(), Check::default());
        check.begin(&context, &path, Some(Stage::find("ppm-tiny").unwrap()));
        let answer = check.answers.wait().unwrap();
        let found = answer.outcome.as_ref().unwrap();
        assert_eq!((found.size, answer.number, &answer.path), ([16, 9], 1, &path));
        assert!(found.views[0] == rgb8, "the first picture is the reader's");
        assert!(found.views.iter().all(|view| view.len() == rgb8.len()));
        check.answers.answer(&context).give(answer);
        assert_eq!(check.follow(), Some(Ok(path)));
        assert!(check.words().is_some_and(|words| words.contains("mine.ppm")), "{:?}", check.words());
    }
}
