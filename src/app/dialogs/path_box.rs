//! Entry of a file's name, by typing it or with the system's file dialog, if there is one.

use super::outcome::Outcome;
use super::purpose::Purpose;
use crate::app::answers::Answers;
use crate::recipe::plain_name;
use eframe::egui::{self, Key, RichText, Ui};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Weak};
use std::time::{Duration, Instant};

/// The state of the box, with the text.
pub struct PathBox {
    purpose: Purpose,
    text: String,
    /// What is saved, in words.
    about: String,
    is_new: bool,
    /// Can be upgraded as long as the system's dialog is open.
    browsing: Weak<()>,
}

/// The result of the system's dialog.
pub enum Chosen {
    /// The user chose this path.
    Path(PathBuf),
    /// The system has no dialog to show.
    NoDialog,
}

/// What a note about the path means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Tone {
    /// The file can be used.
    Plain,
    /// The file exists and would be replaced.
    Replaces,
    /// The path cannot be used.
    Refused,
}

/// A dialog that closes sooner than this was never visible.
const SEEN: Duration = Duration::from_millis(300);

impl PathBox {
    pub fn new(purpose: Purpose, name: &str, directory: Option<&Path>) -> Self {
        let file = match purpose.endings() {
            [ending] if purpose.is_saving() => format!("{}.{ending}", plain_name(name)),
            _ => String::new(),
        };
        let path = directory.map_or_else(|| PathBuf::from(&file), |directory| directory.join(&file));
        PathBox::of(purpose, &path)
    }

    fn of(purpose: Purpose, path: &Path) -> Self {
        let text = path.display().to_string();
        PathBox { purpose, text, about: String::new(), is_new: true, browsing: Weak::new() }
    }

    /// Says what is saved, in these words.
    pub fn say(&mut self, about: String) {
        self.about = about;
    }

    /// Handles a name from the system's dialog, which has already asked before it returned the name of an existing
    /// file. If the ending is added here, the name is a different one and the box asks.
    pub fn chosen(purpose: Purpose, path: PathBuf) -> Result<PathBuf, Self> {
        let named = purpose.with_ending(path.clone());
        if named != path && named.exists() { Err(PathBox::of(purpose, &named)) } else { Ok(named) }
    }

    pub(super) fn ui(&mut self, ui: &mut Ui, browsed: &Answers<(Purpose, Chosen)>) -> Outcome {
        ui.set_width(ui.available_width());
        ui.heading(self.purpose.title());
        if !self.about.is_empty() {
            ui.label(RichText::new(&self.about).color(ui.visuals().weak_text_color()));
        }
        ui.add_space(6.0);
        let mut edit = egui::TextEdit::singleline(&mut self.text).desired_width(f32::INFINITY);
        if !self.purpose.is_saving() {
            edit = edit.hint_text("File name; or drop the file on the window");
        }
        let output = edit.show(ui);
        let response = output.response.response.accessible_name("File name");
        if self.is_new {
            self.is_new = false;
            response.request_focus();
            self.select_stem(ui, response.id, output.state);
        }
        let path = self.path();
        let (note, tone) = self.note(path.as_deref());
        let (refused, replaces) = (tone == Tone::Refused, tone == Tone::Replaces);
        let visuals = ui.visuals();
        let words = RichText::new(note);
        let words = match tone {
            Tone::Plain => words.small().color(visuals.weak_text_color()),
            Tone::Replaces => words.color(visuals.warn_fg_color).strong(),
            Tone::Refused => words.color(visuals.error_fg_color),
        };
        ui.add(egui::Label::new(words).wrap());
        ui.add_space(8.0);
        let is_enter = response.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
        let mut outcome = Outcome::Stay;
        ui.horizontal(|ui| {
            let label = if replaces { "Replace" } else { self.purpose.button() };
            let button = egui::Button::new(label).min_size(egui::vec2(72.0, 0.0));
            let is_pressed = ui
                .add_enabled(path.is_some() && !refused, button)
                .on_disabled_hover_text(if refused { "See above" } else { "Type a file's name first" })
                .clicked();
            if is_enter && refused {
                response.request_focus();
            } else if let Some(path) = path.filter(|_| is_pressed || is_enter) {
                outcome = Outcome::Named(self.purpose, path);
            }
            if ui.button("Cancel").clicked() {
                outcome = Outcome::Close;
            }
            let is_browsing = self.browsing.strong_count() > 0;
            let browse = ui
                .add_enabled(!is_browsing, egui::Button::new("Browse…"))
                .on_hover_text("The system's file dialog, if there is one")
                .on_disabled_hover_text("The system's dialog is open");
            if browse.clicked() {
                self.browse(browsed, ui.ctx());
            }
        });
        outcome
    }

    /// The path from the text, with the ending that belongs to the purpose.
    fn path(&self) -> Option<PathBuf> {
        let text = self.text.trim();
        (!text.is_empty()).then(|| self.purpose.with_ending(text.into()))
    }

    /// What is said about the path.
    fn note(&self, path: Option<&Path>) -> (String, Tone) {
        let Some(path) = path else { return (String::new(), Tone::Plain) };
        let whole = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        let missing = whole.parent().filter(|directory| !directory.is_dir());
        match (self.purpose.is_saving(), path.exists(), missing) {
            (true, _, Some(directory)) => {
                let words = "does not exist: create it, or choose another folder";
                (format!("The folder {} {words}", directory.display()), Tone::Refused)
            }
            (_, true, _) if path.is_dir() => {
                (format!("{} is a folder: add a file's name", whole.display()), Tone::Refused)
            }
            (true, true, _) => (format!("{} exists and will be replaced", whole.display()), Tone::Replaces),
            (true, false, _) if whole == path => ("A new file".to_owned(), Tone::Plain),
            (true, false, _) => (whole.display().to_string(), Tone::Plain),
            (false, true, _) => (String::new(), Tone::Plain),
            (false, false, _) => (format!("{} does not exist", whole.display()), Tone::Refused),
        }
    }

    /// Selects the name without its ending, so that typing replaces it.
    fn select_stem(&self, ui: &Ui, id: egui::Id, mut state: egui::text_edit::TextEditState) {
        let start = self.text.rfind(['/', '\\']).map_or(0, |slash| slash + 1);
        let stem = self.text[start..].rfind('.').map_or(self.text.len(), |dot| start + dot);
        let letters = |end: usize| self.text[..end].chars().count();
        let cursor = |at: usize| egui::text::CCursor::new(letters(at));
        let range = egui::text::CCursorRange::two(cursor(start), cursor(stem));
        state.cursor.set_char_range(Some(range));
        state.store(ui.ctx(), id);
    }

    /// Opens the system's dialog on its own thread, because it can block for any time.
    fn browse(&mut self, browsed: &Answers<(Purpose, Chosen)>, context: &egui::Context) {
        let (purpose, text) = (self.purpose, self.text.clone());
        let answer = browsed.answer(context);
        let browsing = Arc::new(());
        self.browsing = Arc::downgrade(&browsing);
        let choose = move || {
            let begin = Instant::now();
            let (directory, name) = place_of(Path::new(&text));
            let mut dialog = rfd::FileDialog::new().set_title(purpose.title());
            dialog = dialog.add_filter(purpose.endings().join(", "), purpose.endings());
            if let Some(directory) = directory {
                dialog = dialog.set_directory(directory);
            }
            let chosen =
                if purpose.is_saving() { dialog.set_file_name(name).save_file() } else { dialog.pick_file() };
            drop(browsing);
            match chosen {
                Some(path) => answer.give((purpose, Chosen::Path(path))),
                None if begin.elapsed() < SEEN => answer.give((purpose, Chosen::NoDialog)),
                None => answer.wake(),
            }
        };
        // Without a thread there is no system dialog, but the box still works.
        let _ = std::thread::Builder::new().name("file dialog".into()).spawn(choose);
    }
}

/// Where the system's dialog starts: the directory, if it exists, and the file's name in it.
fn place_of(path: &Path) -> (Option<PathBuf>, String) {
    let whole = std::env::current_dir().unwrap_or_default().join(path);
    if whole.is_dir() {
        return (Some(whole), String::new());
    }
    let name = whole.file_name().map(|name| name.to_string_lossy().into_owned());
    let directory = whole.parent().filter(|directory| directory.is_dir());
    (directory.map(Path::to_owned), name.unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::tests::{Drawings, dressed, part};
    use crate::output::OutputFormat;
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;

    fn typed(purpose: Purpose, text: &str) -> Option<PathBuf> {
        PathBox::of(purpose, Path::new(text)).path()
    }

    #[test]
    fn endings_are_added_where_one_is_missing() {
        let png = Purpose::Save(OutputFormat::Png);
        assert_eq!(typed(png, "a"), Some("a.png".into()));
        assert_eq!(typed(png, "a.PNG"), Some("a.PNG".into()));
        assert_eq!(typed(png, "v1.2"), Some("v1.2.png".into()));
        assert_eq!(typed(png, "  "), None);
        assert_eq!(typed(Purpose::Open, "a"), Some("a".into()));
    }

    #[test]
    fn what_would_happen_is_told_first() {
        let directory = tempfile::tempdir().unwrap();
        let png = Purpose::Save(OutputFormat::Png);
        let tone = |purpose, name: &str| {
            let path = directory.path().join(name);
            PathBox::of(purpose, &path).note(Some(&path)).1
        };
        assert_eq!(tone(png, "a.png"), Tone::Plain);
        std::fs::write(directory.path().join("a.png"), "").unwrap();
        std::fs::create_dir(directory.path().join("b.png")).unwrap();
        assert_eq!(tone(png, "a.png"), Tone::Replaces);
        assert_eq!(tone(png, "b.png"), Tone::Refused);
        assert_eq!(tone(png, "no/a.png"), Tone::Refused);
        assert_eq!(tone(Purpose::Open, "a.png"), Tone::Plain);
        assert_eq!(tone(Purpose::Open, "c.png"), Tone::Refused);
    }

    #[test]
    fn a_name_from_the_systems_dialog_gets_its_ending_and_replaces_nothing_unasked() {
        let directory = tempfile::tempdir().unwrap();
        let png = Purpose::Save(OutputFormat::Png);
        let [bare, named] = ["a", "a.png"].map(|name| directory.path().join(name));
        let taken = |path: &Path| PathBox::chosen(png, path.to_owned()).map_err(|asks| asks.text);
        assert_eq!(taken(&bare), Ok(named.clone()));
        std::fs::write(&named, "").unwrap();
        assert_eq!(taken(&bare), Err(named.display().to_string()));
        assert_eq!(taken(&named), Ok(named), "the dialog has asked");
    }

    #[test]
    fn the_systems_dialog_begins_where_the_box_is() {
        let directory = tempfile::tempdir().unwrap();
        assert_eq!(
            place_of(&directory.path().join("a.png")),
            (Some(directory.path().into()), "a.png".into())
        );
        assert_eq!(place_of(directory.path()), (Some(directory.path().into()), String::new()));
        assert_eq!(place_of(Path::new("a.png")), (std::env::current_dir().ok(), "a.png".into()));
        assert_eq!(place_of(&directory.path().join("no/a.png")), (None, "a.png".into()));
    }

    #[test]
    fn the_name_of_a_scene_becomes_a_files() {
        let path_box = PathBox::new(Purpose::Save(OutputFormat::P6), "field:1000", Some(Path::new("out")));
        assert_eq!(PathBuf::from(&path_box.text), Path::new("out").join("field-1000.ppm"));
    }

    #[test]
    fn the_name_is_selected_without_its_folder_and_ending() {
        for (text, ends) in
            [("out/a.b.png", [4, 7]), ("käse.png", [0, 4]), ("out.d/a", [6, 7]), ("out.d/", [6, 6])]
        {
            let path_box = PathBox::of(Purpose::Open, Path::new(text));
            let mut selected = None;
            let _ = egui::Context::default().run_ui(egui::RawInput::default(), |ui| {
                let id = egui::Id::unique("name");
                path_box.select_stem(ui, id, egui::text_edit::TextEditState::default());
                let state = egui::text_edit::TextEditState::load(ui.ctx(), id).unwrap();
                selected = state.cursor.char_range();
            });
            let [from, to] = ends.map(|end: usize| egui::text::CCursor::new(end));
            assert_eq!(selected, Some(egui::text::CCursorRange::two(from, to)), "{text}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn the_box_tells_what_will_happen_to_a_file() {
        let mut drawings = Drawings::default();
        for (name, purpose, text, about) in [
            ("no such folder", Purpose::Save(OutputFormat::Png), "/not there/a.png", "4 samples per pixel"),
            ("no name", Purpose::Save(OutputFormat::Exr), "", ""),
            ("a file to open", Purpose::Open, "", ""),
            ("a film that is not there", Purpose::ReferenceFilm, "/not there/a.exr", ""),
            ("a new file", Purpose::SaveScene, "/not there.toml", ""),
            ("a file", Purpose::Open, "/dev/null", ""),
            ("a folder", Purpose::Open, "/", ""),
        ] {
            let mut path_box = PathBox::of(purpose, Path::new(text));
            path_box.say(about.to_owned());
            let browsed = Answers::default();
            let mut dialog = part([500.0, 240.0], |ui| _ = path_box.ui(ui, &browsed));
            drawings.add(name, &dialog);
            drawings.add_tips(&mut dialog);
        }
        drawings.keep("path_box");
    }

    struct Asked {
        path_box: PathBox,
        browsed: Answers<(Purpose, Chosen)>,
        named: Option<PathBuf>,
        is_closed: bool,
    }

    fn asked(purpose: Purpose, path: &Path) -> Harness<'static, Asked> {
        let draw = |ui: &mut Ui, asked: &mut Asked| match asked.path_box.ui(ui, &asked.browsed) {
            Outcome::Named(_, path) => asked.named = Some(path),
            Outcome::Close => asked.is_closed = true,
            Outcome::Stay => {}
        };
        let (path_box, browsed) = (PathBox::of(purpose, path), Answers::default());
        dressed([500.0, 240.0])
            .build_ui_state(draw, Asked { path_box, browsed, named: None, is_closed: false })
    }

    #[test]
    fn a_name_is_taken_by_enter_and_by_the_button() {
        let directory = tempfile::tempdir().unwrap();
        let (png, path) = (Purpose::Save(OutputFormat::Png), directory.path().join("a.png"));
        let mut dialog = asked(png, &path);
        dialog.key_press(Key::Enter);
        dialog.run_steps(3);
        assert_eq!(dialog.state().named.as_ref(), Some(&path));
        let mut dialog = asked(png, &path);
        dialog.get_by_label("File name").type_text("b");
        dialog.run_steps(3);
        dialog.get_by_label("Save").click();
        dialog.run_steps(3);
        assert_eq!(dialog.state().named, Some(directory.path().join("b.png")), "the name was selected");
        std::fs::write(&path, "").unwrap();
        let mut dialog = asked(png, &path);
        dialog.get_by_label("Replace").click();
        dialog.run_steps(3);
        assert_eq!(dialog.state().named.as_ref(), Some(&path));
        let mut dialog = asked(png, &directory.path().join("no/a.png"));
        dialog.key_press(Key::Enter);
        dialog.run_steps(3);
        assert_eq!(dialog.state().named, None);
        let before = dialog.state().path_box.text.clone();
        dialog.get_by_label("File name").type_text("c");
        dialog.run_steps(3);
        assert_ne!(dialog.state().path_box.text, before, "the box still has the keyboard");
        dialog.get_by_label("Cancel").click();
        dialog.run_steps(3);
        assert!(dialog.state().is_closed);
    }
}
