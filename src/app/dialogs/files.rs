//! Dialogs about files: saving, the system's own dialog, and a field for a path where the system has none.

use super::outcome::{Outcome, Purpose, Wanted, What};
use crate::app::commands::Snapshot;
use crate::app::model::animation::FRAMES_PER_SECOND;
use crate::app::model::{Document, Source};
use crate::app::panels::controls::in_shape;
use crate::app::toolkit::number::{Number, samples_words};
use crate::app::toolkit::widgets::{About, FIELD, hint, named, primary, row, small};
use crate::app::toolkit::{Answers, theme};
use crate::job::recipe::plain_name;
use crate::job::render::{SAMPLE_LIMIT, SIZE_LIMIT};
use crate::progressive::describe::seconds as time;
use crate::progressive::{Phase, Status};
use crate::scene::animation::FRAME_LIMIT;
use crate::system::files::pictures_directory;
use eframe::egui::text::{CCursor, CCursorRange};
use eframe::egui::{self, Align, Key, Label, Layout, Stroke, TextEdit, Ui, vec2};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// The system's file dialog.
#[derive(Default)]
pub struct System {
    /// There is one; else the field for a path is shown at once.
    pub is_there: bool,
    /// The purpose of the dialog, its first folder, and the chosen path; no path if there was no dialog.
    chosen: Answers<(Purpose, PathBuf, Option<PathBuf>)>,
}

impl System {
    /// A dialog that closes sooner than this was never visible.
    const SEEN: Duration = Duration::from_millis(300);

    pub fn chosen(&mut self) -> Option<(Purpose, PathBuf, Option<PathBuf>)> {
        self.chosen.take()?.ok()
    }

    /// Opens the dialog at a folder, on a thread of its own, because it can block for any time.
    pub fn ask(&mut self, context: &egui::Context, purpose: Purpose, from: PathBuf) {
        if self.chosen.is_open() {
            return;
        }
        let answer = self.chosen.answer(context);
        if !self.is_there {
            return answer.give(Ok((purpose, from, None)));
        }
        let choose = move || {
            let begin = Instant::now();
            // The system shows nothing where there is no folder, such as the usual one before the first picture.
            let path = choose(purpose, from.ancestors().find(|folder| folder.is_dir()).unwrap_or(&from));
            match path {
                None if begin.elapsed() >= System::SEEN => drop(answer),
                path => answer.give(Ok((purpose, from, path))),
            }
        };
        // Without a thread the answer is that there is no dialog.
        let _ = std::thread::Builder::new().name("file dialog".into()).spawn(choose);
    }
}

/// Entry of a path, where the system has no dialog.
pub struct PathField {
    purpose: Purpose,
    folder: PathBuf,
    text: String,
    was_focused: bool,
}

impl PathField {
    pub fn new(purpose: Purpose, folder: PathBuf) -> Self {
        PathField { purpose, folder, text: String::new(), was_focused: false }
    }

    pub(super) fn ui(&mut self, ui: &mut Ui) -> Outcome {
        ui.heading(self.purpose.title());
        let field = TextEdit::singleline(&mut self.text).desired_width(f32::INFINITY);
        let field = ui.add(field.hint_text("File name; or drop the file on the window"));
        named(&field, "File name");
        focus(ui, &field, &self.text, &mut self.was_focused);
        let path = self.folder.join(self.text.trim());
        // A path that is mistyped is not lost.
        let is_missing = !self.text.trim().is_empty() && !path.exists();
        let words = if is_missing { "There is no file of this name." } else { "" };
        hint(ui, words);
        match buttons(ui, &field, "Open", !self.text.trim().is_empty() && !is_missing) {
            Some(true) => Outcome::Named(self.purpose, path),
            Some(false) => Outcome::Close,
            None => Outcome::Stay,
        }
    }
}

/// Focuses a field of text, all of which is selected, when its dialog opens.
fn focus(ui: &Ui, field: &egui::Response, text: &str, was_focused: &mut bool) {
    *was_focused |= field.has_focus();
    if !*was_focused {
        field.request_focus();
        if let Some(mut state) = TextEdit::load_state(ui.ctx(), field.id) {
            let end = CCursor::new(text.chars().count());
            state.cursor.set_char_range(Some(CCursorRange::two(CCursor::default(), end)));
            state.store(ui.ctx(), field.id);
        }
    }
}

/// The buttons at the lower right. True for the main one, or Enter in the field; false for Cancel.
fn buttons(ui: &mut Ui, field: &egui::Response, label: &str, is_usable: bool) -> Option<bool> {
    let is_enter = field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
        ui.spacing_mut().interact_size.y = 32.0;
        let is_pressed = ui.add_enabled(is_usable, primary(label)).clicked();
        let is_cancelled = ui.button("Cancel").clicked();
        if is_pressed || is_enter && is_usable { Some(true) } else { is_cancelled.then_some(false) }
    })
    .inner
}

/// Name, folder, format and size of what is saved.
pub struct SaveBox {
    name: String,
    pub(super) folder: PathBuf,
    was_focused: bool,
    wanted: Wanted,
}

impl SaveBox {
    pub fn new(document: &Document, folder: PathBuf, what: What) -> Self {
        let samples = document.stop.samples.map_or(FRAME_SAMPLES, |count| count.min(u32::MAX.into()) as u32);
        let (size, frames) = (document.size(), document.frame_count());
        let wanted = Wanted { what, size, frames, samples, path: PathBuf::new() };
        SaveBox { name: file_name(document), folder, was_focused: false, wanted }
    }

    /// The path with the ending, which is added if the name has another.
    fn path(&self) -> PathBuf {
        let (path, ending) = (self.folder.join(self.name.trim()), self.wanted.what.ending());
        if ending.is_empty() || path.extension().is_some_and(|own| own.eq_ignore_ascii_case(ending)) {
            return path;
        }
        let mut name = path.into_os_string();
        name.push(format!(".{ending}"));
        name.into()
    }

    pub(super) fn ui(&mut self, ui: &mut Ui, snapshot: &Snapshot, system: &mut System) -> Outcome {
        ui.heading("Save");
        ui.add_space(8.0);
        let field = labelled(ui, "Name", |ui| {
            ui.weak(match self.wanted.what {
                What::Animation => "/frame-0000.png".to_owned(),
                _ => format!(".{}", self.wanted.what.ending()),
            });
            ui.add(TextEdit::singleline(&mut self.name).desired_width(f32::INFINITY))
        });
        named(&field, "Name");
        focus(ui, &field, &self.name, &mut self.was_focused);
        // A typed ending chooses the format.
        let typed = Path::new(self.name.trim()).extension();
        let is_typed = |ending: &str| {
            !ending.is_empty() && typed.is_some_and(|typed| typed.eq_ignore_ascii_case(ending))
        };
        let of_ending = What::ALL.into_iter().find(|(.., ending)| is_typed(ending));
        self.wanted.what = of_ending.map_or(self.wanted.what, |(what, ..)| what);
        labelled(ui, "Folder", |ui| {
            if system.is_there && ui.button("Change…").clicked() {
                system.ask(ui.ctx(), Purpose::Folder, self.folder.clone());
            }
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                let folder = Label::new(self.folder.display().to_string()).truncate();
                ui.add(folder).on_hover_text("A name can also begin with another folder");
            });
        });
        ui.add_space(8.0);
        ui.columns_const(|[left, right]| {
            small(left, "What");
            let before = self.wanted.what;
            let can_move = snapshot.no_rays().is_none();
            for (what, label, help, _) in What::ALL {
                if what != What::Animation || can_move {
                    option(left, &mut self.wanted.what, what, label, help);
                }
            }
            if self.wanted.what != before && of_ending.is_some() {
                // Instead of the ending that was typed.
                self.name = Path::new(self.name.trim()).with_extension("").display().to_string();
            }
            right.add_enabled_ui(self.wanted.what != What::Scene, |ui| self.sizes(ui, snapshot));
        });
        let (path, shown) = (self.path(), snapshot.document());
        let size = self.wanted.size;
        // A scene is saved in its own file.
        let is_own = self.wanted.what == What::Scene && shown.origin.source == Source::File(path.clone());
        let (is_replaced, has_folder) = (path.exists() && !is_own, path.parent().is_none_or(Path::is_dir));
        let (free, mut replaces) = (if is_own { path.clone() } else { free_path(&path) }, false);
        let is_animation = self.wanted.what == What::Animation;
        match has_folder {
            _ if is_animation && path.is_dir() => ui.weak("Frames of it that are there already are kept."),
            _ if is_replaced => {
                ui.horizontal(|ui| {
                    let name = free.file_name().unwrap_or_default().display();
                    let words = format!("It is there already; Save makes \u{201c}{name}\u{201d}.");
                    ui.colored_label(theme::colours(ui).warn, words);
                    replaces = ui.button("Replace").clicked();
                })
                .response
            }
            false => ui.weak("The folder will be created."),
            true if self.wanted.what != What::Scene && shown.size() != size => {
                ui.weak("Renders first; you can keep working.")
            }
            true => ui.label(""),
        };
        let is_usable = !self.name.trim().is_empty() && path.is_dir() <= is_animation;
        match buttons(ui, &field, "Save", is_usable) {
            _ if replaces && is_usable => Outcome::Save(self.wanted(path)),
            Some(true) => Outcome::Save(self.wanted(if is_animation { path } else { free })),
            Some(false) => Outcome::Close,
            None => Outcome::Stay,
        }
    }

    fn wanted(&self, path: PathBuf) -> Wanted {
        Wanted { path, ..self.wanted.clone() }
    }

    /// How long an animation is, and how fine.
    fn film(&mut self, ui: &mut Ui, snapshot: &Snapshot) {
        for (name, help, count, least, most) in [
            ("Frames", "30 make a second", &mut self.wanted.frames, 2.0, FRAME_LIMIT),
            ("Samples", "Samples per pixel of each frame", &mut self.wanted.samples, 1.0, u32::MAX),
        ] {
            let about = About::new(name, help);
            row(ui, about, |ui| Number::new(about, least..=f64::from(most)).whole_field(ui, FIELD, count));
        }
        let Wanted { size, frames, samples, .. } = self.wanted;
        let seconds = seconds_at(&snapshot.status, size, u64::from(samples) * u64::from(frames));
        let time = seconds.map_or_else(String::new, |seconds| format!(", about {} to render", time(seconds)));
        small(ui, format!("{:.1} s{time}", f64::from(frames) / FRAMES_PER_SECOND));
    }

    fn sizes(&mut self, ui: &mut Ui, snapshot: &Snapshot) {
        small(ui, "Size");
        let (shown, size) = (snapshot.document(), &mut self.wanted.size);
        let before = *size;
        ui.horizontal(|ui| {
            for (name, side) in ["Width", "Height"].into_iter().zip(&mut *size) {
                let number = Number::new(About::new(name, "Pixels"), 1.0..=f64::from(SIZE_LIMIT));
                number.whole_field(ui, FIELD, side);
            }
        });
        if *size != before {
            *size = in_shape(shown.size(), before, *size);
        }
        let book = if shown.stage().is_some() { "As in the book" } else { "As in the scene" };
        let twice = shown.size().map(|side| side.saturating_mul(2).min(SIZE_LIMIT));
        for (name, of) in
            [("As it is rendered", shown.size()), (book, shown.origin.book_size()), ("Twice as large", twice)]
        {
            if ui.selectable_label(*size == of, name).clicked() {
                *size = of;
            }
        }
        let samples = samples_to_save(shown, &snapshot.status);
        match seconds_at(&snapshot.status, *size, samples) {
            _ if self.wanted.what == What::Animation => self.film(ui, snapshot),
            Some(seconds) if shown.size() != *size => {
                small(ui, format!("{}, about {}", samples_words(samples), time(seconds)));
            }
            _ => {}
        }
    }
}

/// Samples per pixel of a frame, unless the picture has a number of its own.
const FRAME_SAMPLES: u32 = 64;

/// Opens the system's dialog, and blocks until it is closed.
fn choose(purpose: Purpose, from: &Path) -> Option<PathBuf> {
    let dialog = rfd::FileDialog::new().set_title(purpose.title()).set_directory(from);
    let endings: &[&str] = match purpose {
        Purpose::Open => &["png", "ppm", "exr", "toml"],
        Purpose::Check => &["png", "ppm"],
        Purpose::Compare => &["png", "ppm", "exr"],
        Purpose::Folder => return dialog.pick_folder(),
    };
    dialog.add_filter(endings.join(", "), endings).pick_file()
}

/// The path, or the first with a number after its name where no file is.
fn free_path(path: &Path) -> PathBuf {
    let part = |part: Option<&std::ffi::OsStr>| part.unwrap_or_default().display().to_string();
    let (stem, ending) = (part(path.file_stem()), part(path.extension()));
    let numbered = (2_u32..).map(|number| path.with_file_name(format!("{stem} {number}.{ending}")));
    std::iter::once(path.to_owned()).chain(numbered).find(|path| !path.exists()).unwrap_or_default()
}

/// A label, and what follows it over the rest of the width, from the right to the left.
fn labelled<R>(ui: &mut Ui, label: &str, add: impl FnOnce(&mut Ui) -> R) -> R {
    ui.horizontal(|ui| {
        let layout = Layout::left_to_right(Align::Center).with_main_align(Align::Min);
        ui.allocate_ui_with_layout(vec2(64.0, 24.0), layout, |ui| {
            ui.set_min_width(64.0);
            ui.label(label);
        });
        ui.with_layout(Layout::right_to_left(Align::Center), add).inner
    })
    .inner
}

fn option<T: PartialEq>(ui: &mut Ui, chosen: &mut T, value: T, label: &str, help: &str) {
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        let edge = if *chosen == value { theme::colours(ui).accent } else { theme::colours(ui).edge };
        ui.visuals_mut().widgets.inactive.bg_stroke = Stroke::new(1.0, edge);
        ui.radio_value(chosen, value, label);
        ui.spacing_mut().interact_size.y = 16.0;
        ui.spacing_mut().indent = ui.spacing().icon_width + ui.spacing().icon_spacing;
        ui.indent(label, |ui| small(ui, help));
    });
}

/// Where pictures go unless the user has chosen another folder; it is created when needed.
pub fn default_folder() -> Option<PathBuf> {
    pictures_directory().map(|pictures| pictures.join("Weekender"))
}

/// The name for a file of this picture.
fn file_name(document: &Document) -> String {
    let title = match document.stage() {
        Some(stage) if !document.has_changed_scene() => format!("{} {}", stage.section, stage.title),
        _ => return plain_name(&document.name()),
    };
    title.replace(['/', '\\', ':', '?', '*', '"', '<', '>', '|'], "")
}

/// Samples per pixel of a picture that is rendered to be saved: those of the one on the screen when that reaches its goal.
pub fn samples_to_save(document: &Document, status: &Status) -> u64 {
    let traced = status.samples_per_pixel.max(1);
    // Four times the samples halve the error.
    let at_goal = document.stop.noise.zip(status.error).map(|(goal, error)| (error.rmse / goal).powi(2));
    match document.stop.samples.or(at_goal.map(|times| (traced as f64 * times).ceil() as u64)) {
        Some(samples) if !matches!(status.phase, Phase::Done(_)) => {
            samples.clamp(traced, SAMPLE_LIMIT.max(traced))
        }
        _ => traced,
    }
}

/// About how many seconds this number of samples per pixel takes at this size.
fn seconds_at(status: &Status, [width, height]: [u32; 2], samples: u64) -> Option<f64> {
    let speed = Some(status.paths_per_second()).filter(|speed| *speed > 0.0)?;
    Some((f64::from(width) * f64::from(height) * samples as f64 / speed).ceil())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::Origin;
    use crate::film::ErrorEstimate;
    use crate::progressive::{EndReason, Stop};

    #[test]
    fn a_picture_to_be_saved_has_the_samples_of_its_goal() {
        let mut document = Document::new(Origin::usual());
        document.stop = Stop { noise: Some(0.002), ..Stop::default() };
        let error = Some(ErrorEstimate { rmse: 0.01, rmse_deviation: 0.0, rel_mse: 0.0 });
        let mut status = Status { samples_per_pixel: 10, phase: Phase::Tracing, error, ..Status::default() };
        assert_eq!(samples_to_save(&document, &status), 250);
        document.stop = Stop::at_samples(99);
        assert_eq!(samples_to_save(&document, &status), 99);
        status.phase = Phase::Done(EndReason::Samples);
        assert_eq!(samples_to_save(&document, &status), 10, "as many as the one on the screen");
    }
}
