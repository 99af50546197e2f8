//! A file's name, to be typed here or chosen in the system's dialog, where there is one.

use super::Outcome;
use crate::app::files::Message;
use crate::app::window::Window;
use crate::output::OutputFormat;
use eframe::egui::{self, Key, RichText, Ui};
use std::path::{Path, PathBuf};

/// What the file is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// To be opened.
    Open,
    /// To be written.
    Save(OutputFormat),
    /// To be written with the scene.
    SaveScene,
    /// To be written with the plot's points.
    SavePlot,
    /// To be compared with.
    Reference,
}

impl Purpose {
    fn title(self) -> &'static str {
        match self {
            Purpose::Open => "Open",
            Purpose::Save(OutputFormat::Png) => "Save picture as PNG",
            Purpose::Save(OutputFormat::P6) => "Save picture as PPM",
            Purpose::Save(OutputFormat::Exr) => "Save film as EXR",
            Purpose::SaveScene => "Save scene file",
            Purpose::SavePlot => "Save error against time as CSV",
            Purpose::Reference => "Load reference film",
        }
    }

    fn button(self) -> &'static str {
        match self {
            Purpose::Open | Purpose::Reference => "Open",
            _ => "Save",
        }
    }

    fn is_saving(self) -> bool {
        matches!(self, Purpose::Save(_) | Purpose::SaveScene | Purpose::SavePlot)
    }

    fn endings(self) -> &'static [&'static str] {
        match self {
            Purpose::Open => &["png", "ppm", "exr", "toml"],
            Purpose::Save(OutputFormat::Png) => &["png"],
            Purpose::Save(OutputFormat::P6) => &["ppm"],
            Purpose::Save(OutputFormat::Exr) | Purpose::Reference => &["exr"],
            Purpose::SaveScene => &["toml"],
            Purpose::SavePlot => &["csv"],
        }
    }
}

/// The box, with what was typed.
pub struct PathBox {
    purpose: Purpose,
    text: String,
    is_new: bool,
}

impl PathBox {
    pub fn new(purpose: Purpose, name: &str, directory: Option<&Path>) -> Self {
        let file = match purpose.endings() {
            [ending] if purpose.is_saving() => format!("{}.{ending}", plain(name)),
            _ => String::new(),
        };
        let path = directory.map_or_else(|| PathBuf::from(&file), |directory| directory.join(&file));
        PathBox { purpose, text: path.display().to_string(), is_new: true }
    }

    pub(super) fn ui(&mut self, window: &mut Window, ui: &mut Ui) -> Outcome {
        ui.set_width(ui.available_width());
        ui.heading(self.purpose.title());
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
        let note = self.note(path.as_deref());
        let weak = ui.visuals().weak_text_color();
        ui.label(RichText::new(note.unwrap_or_default()).small().color(weak));
        ui.add_space(8.0);
        let is_enter = response.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
        let mut outcome = Outcome::Stay;
        ui.horizontal(|ui| {
            let button = egui::Button::new(self.purpose.button()).min_size(egui::vec2(72.0, 0.0));
            let is_pressed = ui
                .add_enabled(path.is_some(), button)
                .on_disabled_hover_text("Type a file's name first")
                .clicked();
            if let Some(path) = path.filter(|_| is_pressed || is_enter) {
                window.use_path(self.purpose, path, ui.ctx());
                outcome = Outcome::Close;
            }
            if ui.button("Cancel").clicked() {
                outcome = Outcome::Close;
            }
            if ui.button("Browse…").on_hover_text("The system's own dialog, where there is one").clicked() {
                self.browse(window, ui.ctx());
            }
        });
        outcome
    }

    /// What was typed, with the ending that belongs to it.
    fn path(&self) -> Option<PathBuf> {
        let text = self.text.trim();
        if text.is_empty() {
            return None;
        }
        let path = PathBuf::from(text);
        let is_known = path.extension().is_some_and(|ending| {
            self.purpose.endings().iter().any(|known| ending.eq_ignore_ascii_case(known))
        });
        match self.purpose.endings() {
            [ending] if self.purpose.is_saving() && !is_known => {
                let mut name = path.into_os_string();
                name.push(format!(".{ending}"));
                Some(PathBuf::from(name))
            }
            _ => Some(path),
        }
    }

    fn note(&self, path: Option<&Path>) -> Option<String> {
        let path = path?;
        let whole = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        match (self.purpose.is_saving(), path.exists()) {
            (true, true) => Some(format!("{} is there and will be replaced", whole.display())),
            (true, false) => Some(whole.display().to_string()),
            (false, true) => None,
            (false, false) => Some(format!("{} is not there", whole.display())),
        }
    }

    /// Selects the name without its ending, so that typing replaces that.
    fn select_stem(&self, ui: &Ui, id: egui::Id, mut state: egui::text_edit::TextEditState) {
        let stem = self.text.rfind('.').unwrap_or(self.text.len());
        let start = self.text.rfind(['/', '\\']).map_or(0, |slash| slash + 1);
        let letters = |end: usize| self.text[..end].chars().count();
        let cursor = |at: usize| egui::text::CCursor::new(letters(at));
        let range = egui::text::CCursorRange::two(cursor(start.min(stem)), cursor(stem));
        state.cursor.set_char_range(Some(range));
        state.store(ui.ctx(), id);
    }

    fn browse(&self, window: &Window, context: &egui::Context) {
        let (purpose, text) = (self.purpose, self.text.clone());
        let (sender, context) = (window.messages.0.clone(), context.clone());
        let choose = move || {
            let path = PathBuf::from(text);
            let mut dialog = rfd::FileDialog::new().set_title(purpose.title());
            dialog = dialog.add_filter(purpose.endings().join(", "), purpose.endings());
            if let Some(directory) = path.parent().filter(|directory| directory.is_dir()) {
                dialog = dialog.set_directory(directory);
            }
            let chosen = if purpose.is_saving() {
                let name = path.file_name().map(|name| name.to_string_lossy().into_owned());
                dialog.set_file_name(name.unwrap_or_default()).save_file()
            } else {
                dialog.pick_file()
            };
            if let Some(path) = chosen {
                let _ = sender.send(Message::Chosen(purpose, path));
                context.request_repaint();
            }
        };
        // Without a thread there is no dialog, and the box is still there.
        let _ = std::thread::Builder::new().name("file dialog".into()).spawn(choose);
    }
}

/// A name as a file system takes it.
fn plain(name: &str) -> String {
    name.chars().map(|c| if c.is_alphanumeric() || "-_. ".contains(c) { c } else { '-' }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn typed(purpose: Purpose, text: &str) -> Option<PathBuf> {
        PathBox { purpose, text: text.into(), is_new: false }.path()
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
    fn the_name_of_a_scene_becomes_a_files() {
        let path_box = PathBox::new(Purpose::Save(OutputFormat::P6), "field:1000", Some(Path::new("out")));
        assert_eq!(PathBuf::from(&path_box.text), Path::new("out").join("field-1000.ppm"));
    }
}
