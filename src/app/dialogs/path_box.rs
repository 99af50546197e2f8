//! Entry of a file's name, by typing it or with the system's file dialog, if there is one.

use super::outcome::Outcome;
use super::purpose::Purpose;
use crate::app::answers::Answers;
use crate::job::recipe::plain_name;
use crate::system::files::home_directory;
use eframe::egui::{self, Key, RichText, Ui};
use std::path::{Path, PathBuf, is_separator};
use std::sync::{Arc, Weak};
use std::time::{Duration, Instant};

/// The state of the box, with the text.
pub struct PathBox {
    purpose: Purpose,
    text: String,
    /// The text before anything was typed.
    begun: String,
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
    /// Nothing has been typed yet.
    Unfinished,
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
        let begun = text.clone();
        PathBox { purpose, text, begun, about: String::new(), is_new: true, browsing: Weak::new() }
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
        let is_usable = path.is_some() && !refused && tone != Tone::Unfinished;
        let visuals = ui.visuals();
        let words = RichText::new(note);
        let words = match tone {
            Tone::Plain => words.small().color(visuals.weak_text_color()),
            Tone::Unfinished => words.color(visuals.weak_text_color()),
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
                .add_enabled(is_usable, button)
                .on_disabled_hover_text(if refused { "See above" } else { "Type a file's name first" })
                .clicked();
            if is_enter && !is_usable {
                // A folder that was there from the start is refused now.
                self.begun.clear();
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

    /// The path from the text, with the ending that belongs to the purpose unless it names a folder.
    fn path(&self) -> Option<PathBuf> {
        let text = self.text.trim();
        let path = in_home(text, home_directory().as_deref());
        let is_folder = text.ends_with(is_separator) || path.is_dir();
        (!text.is_empty()).then(|| if is_folder { path } else { self.purpose.with_ending(path) })
    }

    /// What is said about the path.
    fn note(&self, path: Option<&Path>) -> (String, Tone) {
        let Some(path) = path else { return (String::new(), Tone::Plain) };
        let whole = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        let text = self.text.trim();
        let folder = if text.ends_with(is_separator) { Some(whole.as_path()) } else { whole.parent() };
        let missing = folder.filter(|directory| !directory.is_dir());
        match (self.purpose.is_saving(), path.exists(), missing) {
            (true, _, Some(directory)) => {
                let words = "does not exist: create it, or choose another folder";
                (format!("The folder {} {words}", directory.display()), Tone::Refused)
            }
            (_, true, _) if path.is_dir() => {
                let is_untouched = !self.purpose.is_saving() && self.text == self.begun;
                let tone = if is_untouched { Tone::Unfinished } else { Tone::Refused };
                (format!("{} is a folder: add a file's name", whole.display()), tone)
            }
            (true, true, _) => (format!("{} exists and will be replaced", whole.display()), Tone::Replaces),
            (true, false, _) if whole == path && !text.starts_with('~') => {
                ("A new file".to_owned(), Tone::Plain)
            }
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
        let (purpose, path) = (self.purpose, in_home(self.text.trim(), home_directory().as_deref()));
        let answer = browsed.answer_or(context, move |_| (purpose, Chosen::NoDialog));
        let browsing = Arc::new(());
        self.browsing = Arc::downgrade(&browsing);
        let choose = move || {
            let begin = Instant::now();
            let (directory, name) = place_of(&path);
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

/// The path of a text, in which the home directory can be written as `~`.
fn in_home(text: &str, home: Option<&Path>) -> PathBuf {
    match (text.strip_prefix('~'), home) {
        (Some(""), Some(home)) => home.to_owned(),
        (Some(rest), Some(home)) if rest.starts_with(is_separator) => {
            home.join(rest.trim_start_matches(is_separator))
        }
        _ => text.into(),
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
mod tests;
