//! Dialogs about files: saving, the system's own dialog, and a field for a path where the system has none.

use super::outcome::Outcome;
use crate::app::answers::Answers;
use crate::app::facts::Facts;
use crate::app::model::document::Document;
use crate::app::widgets::{About, Number, hint, primary};
use crate::film::Film;
use crate::job::output::OutputFormat;
use crate::job::recipe::plain_name;
use crate::job::render::SIZE_LIMIT;
use crate::progressive::{Phase, Status};
use crate::system::files::{home_directory, pictures_directory};
use crate::system::memory;
use eframe::egui::{self, Key, RichText, TextEdit, Ui};
use std::path::{Path, PathBuf, is_separator};
use std::sync::{Arc, Weak};
use std::time::{Duration, Instant};

/// What is saved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum What {
    Picture(OutputFormat),
    Scene,
}

impl What {
    const ALL: [What; 4] = [
        What::Picture(OutputFormat::Png),
        What::Picture(OutputFormat::P6),
        What::Picture(OutputFormat::Exr),
        What::Scene,
    ];

    fn words(self) -> [&'static str; 2] {
        match self {
            What::Picture(OutputFormat::Png) => ["PNG picture", "To look at; remembers how it was made"],
            What::Picture(OutputFormat::P6) => ["PPM picture (P6)", "The format of the book"],
            What::Picture(OutputFormat::Exr) => ["Film (EXR)", "All light and samples; can go on later"],
            What::Scene => ["Scene (TOML)", "Text to edit; no picture in it"],
        }
    }

    fn endings(self) -> &'static [&'static str] {
        match self {
            What::Picture(OutputFormat::Png) => &["png"],
            What::Picture(OutputFormat::P6) => &["ppm"],
            What::Picture(OutputFormat::Exr) => &["exr"],
            What::Scene => &["toml"],
        }
    }

    fn ending(self) -> &'static str {
        self.endings()[0]
    }
}

/// What a file is chosen for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    Open,
    /// To check the picture of the user's own program.
    Check,
    /// To load a film to compare with.
    ReferenceFilm,
    /// To save the points of the error over time.
    SavePlot,
    /// To save it, the picture with this size.
    Save(What, [u32; 2]),
    /// To change name and folder in the dialog of saving.
    Place(What),
}

impl Purpose {
    fn title(self) -> &'static str {
        match self {
            Purpose::Open => "Open",
            Purpose::Check => "Check my picture",
            Purpose::ReferenceFilm => "Film to compare with",
            Purpose::SavePlot => "Save the error over time",
            Purpose::Save(..) | Purpose::Place(_) => "Save",
        }
    }

    fn is_saving(self) -> bool {
        matches!(self, Purpose::Save(..) | Purpose::Place(_) | Purpose::SavePlot)
    }

    fn endings(self) -> &'static [&'static str] {
        match self {
            Purpose::Open => &["png", "ppm", "exr", "toml"],
            Purpose::Check => &["png", "ppm"],
            Purpose::ReferenceFilm => &["exr"],
            Purpose::SavePlot => &["csv"],
            Purpose::Save(what, _) | Purpose::Place(what) => what.endings(),
        }
    }
}

/// The path with this ending, which is added if the name has another.
fn with_ending(path: PathBuf, ending: &str) -> PathBuf {
    if path.extension().is_some_and(|own| own.eq_ignore_ascii_case(ending)) {
        return path;
    }
    let mut name = path.into_os_string();
    name.push(format!(".{ending}"));
    name.into()
}

/// A path as it was typed, from `folder`; the home directory can be written as `~`.
fn typed_path(text: &str, folder: &Path) -> PathBuf {
    let text = text.trim();
    let rest = text.strip_prefix('~').filter(|rest| rest.is_empty() || rest.starts_with(is_separator));
    match (rest, home_directory()) {
        (Some(rest), Some(home)) => home.join(rest.trim_start_matches(is_separator)),
        _ => folder.join(text),
    }
}

/// The system's file dialog.
#[derive(Default)]
pub struct System {
    /// There is one; else the field for a path is shown at once.
    pub is_there: bool,
    /// Can be upgraded as long as the dialog is open.
    open: Weak<()>,
    chosen: Answers<Chosen>,
}

/// What the user has chosen, if there was a dialog to choose in.
pub struct Chosen {
    pub purpose: Purpose,
    pub from: PathBuf,
    pub path: Option<PathBuf>,
}

impl System {
    /// A dialog that closes sooner than this was never visible.
    const SEEN: Duration = Duration::from_millis(300);

    pub fn chosen(&self) -> Option<Chosen> {
        self.chosen.take()
    }

    /// Opens the dialog at a folder or a file, on a thread of its own, because it can block for any time.
    pub fn ask(&mut self, context: &egui::Context, purpose: Purpose, from: PathBuf) {
        let start = from.clone();
        let answer = self.chosen.answer_or(context, move |_| Chosen { purpose, from: start, path: None });
        if !self.is_there {
            return answer.give(Chosen { purpose, from, path: None });
        }
        if self.open.strong_count() > 0 {
            return answer.wake();
        }
        let token = Arc::new(());
        self.open = Arc::downgrade(&token);
        let choose = move || {
            let begin = Instant::now();
            let (folder, name) = match from.file_name().filter(|_| !from.is_dir()) {
                Some(name) => (from.parent().unwrap_or(&from), name.to_string_lossy().into_owned()),
                None => (from.as_path(), String::new()),
            };
            let dialog = rfd::FileDialog::new()
                .set_title(purpose.title())
                .add_filter(purpose.endings().join(", "), purpose.endings())
                .set_directory(folder);
            let path =
                if purpose.is_saving() { dialog.set_file_name(name).save_file() } else { dialog.pick_file() };
            drop(token);
            match path {
                None if begin.elapsed() >= System::SEEN => answer.wake(),
                path => answer.give(Chosen { purpose, from, path }),
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
    is_new: bool,
}

impl PathField {
    pub fn new(purpose: Purpose, from: PathBuf) -> Self {
        let text = if purpose.is_saving() { from.display().to_string() } else { String::new() };
        let folder = if from.is_dir() { from } else { PathBuf::new() };
        PathField { purpose, folder, text, is_new: true }
    }

    pub(super) fn ui(&mut self, ui: &mut Ui) -> Outcome {
        ui.heading(self.purpose.title());
        ui.add_space(8.0);
        let field = TextEdit::singleline(&mut self.text).desired_width(f32::INFINITY);
        let field = field.hint_text("File name; or drop the file on the window");
        let response = named(ui.add(field), "File name");
        if std::mem::take(&mut self.is_new) {
            response.request_focus();
        }
        let path = (!self.text.trim().is_empty()).then(|| typed_path(&self.text, &self.folder));
        let (path, refused) = match path {
            Some(path) if self.purpose.is_saving() => {
                let path = with_ending(path, self.purpose.endings()[0]);
                let refused = missing_folder(&path);
                (Some(path), refused)
            }
            Some(path) if path.is_file() => (Some(path), None),
            Some(path) => (None, Some(format!("{} is not there", path.display()))),
            None => (None, None),
        };
        note(ui, refused.as_deref(), path.as_deref().filter(|_| self.purpose.is_saving()));
        let label = if self.purpose.is_saving() { "Save" } else { "Open" };
        match buttons(ui, &response, label, path.is_some() && refused.is_none()) {
            Some(true) => path.map_or(Outcome::Stay, |path| Outcome::Named(self.purpose, path)),
            Some(false) => Outcome::Close,
            None => Outcome::Stay,
        }
    }
}

fn named(response: egui::Response, name: &str) -> egui::Response {
    crate::app::widgets::named(&response, name);
    response
}

fn missing_folder(path: &Path) -> Option<String> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty() && !folder.is_dir())?;
    Some(format!("The folder {} is not there: choose another", folder.display()))
}

/// Says why a path cannot be used, or that its file would be replaced.
fn note(ui: &mut Ui, refused: Option<&str>, saved: Option<&Path>) {
    let [bad, replaced] = [ui.visuals().error_fg_color, ui.visuals().warn_fg_color];
    if let Some(reason) = refused {
        ui.colored_label(bad, reason);
    } else if saved.is_some_and(Path::exists) {
        ui.colored_label(replaced, "A file of this name is there already.");
    } else {
        ui.label("");
    }
}

/// The buttons at the lower right. True for the main one, or Enter in the field; false for Cancel.
fn buttons(ui: &mut Ui, field: &egui::Response, label: &str, is_usable: bool) -> Option<bool> {
    ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
        let is_pressed = ui.add_enabled_ui(is_usable, |ui| primary(ui, label)).inner.clicked();
        let is_cancelled = ui.button("Cancel").clicked();
        let is_enter = field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
        if is_enter && !is_usable {
            field.request_focus();
        }
        if is_pressed || is_enter && is_usable { Some(true) } else { is_cancelled.then_some(false) }
    })
    .inner
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Size {
    Seen,
    Book,
    Twice,
    Other,
}

/// Name, folder, format and size of what is saved.
pub struct SaveBox {
    name: String,
    folder: PathBuf,
    what: What,
    size: Size,
    other: [u32; 2],
    is_new: bool,
}

impl SaveBox {
    pub fn new(name: &str, folder: PathBuf, what: What, size: [u32; 2]) -> Self {
        SaveBox { name: name.to_owned(), folder, what, size: Size::Seen, other: size, is_new: true }
    }

    /// Takes name and folder from the system's dialog.
    pub(super) fn place(&mut self, path: &Path) {
        if let (Some(folder), Some(stem)) = (path.parent(), path.file_stem()) {
            (self.folder, self.name) = (folder.to_owned(), stem.to_string_lossy().into_owned());
        }
    }

    fn path(&self) -> PathBuf {
        with_ending(typed_path(&self.name, &self.folder), self.what.ending())
    }

    fn pixels(&self, size: Size, shown: &Document) -> [u32; 2] {
        match size {
            Size::Seen => shown.size(),
            Size::Book => shown.origin.book_size(),
            Size::Twice => shown.size().map(|side| side.saturating_mul(2).min(SIZE_LIMIT)),
            Size::Other => self.other,
        }
    }

    pub(super) fn ui(&mut self, ui: &mut Ui, facts: &Facts, system: &mut System) -> Outcome {
        ui.set_width(ui.available_width().min(512.0));
        ui.heading("Save");
        ui.add_space(12.0);
        let ending = format!(".{}", self.what.ending());
        let field = ui.horizontal(|ui| {
            ui.add_sized([64.0, 24.0], egui::Label::new("Name").halign(egui::Align::Min));
            let width = ui.available_width() - 44.0;
            let field = TextEdit::singleline(&mut self.name).desired_width(width).show(ui);
            ui.weak(&ending);
            field
        });
        let mut output = field.inner;
        // A typed ending chooses the format.
        let typed = Path::new(self.name.trim()).extension();
        let named = |what: &What| typed.is_some_and(|typed| typed.eq_ignore_ascii_case(what.ending()));
        self.what = What::ALL.into_iter().find(named).unwrap_or(self.what);
        let field = self::named(output.response.response, "Name");
        if std::mem::take(&mut self.is_new) {
            field.request_focus();
            let all = egui::text::CCursor::new(self.name.chars().count());
            let range = egui::text::CCursorRange::two(egui::text::CCursor::default(), all);
            output.state.cursor.set_char_range(Some(range));
            output.state.store(ui.ctx(), field.id);
        }
        ui.horizontal(|ui| {
            ui.add_sized([64.0, 24.0], egui::Label::new("Folder").halign(egui::Align::Min));
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                if system.is_there && ui.button("Change…").clicked() {
                    system.ask(ui.ctx(), Purpose::Place(self.what), self.path());
                }
                let folder = self.folder.display().to_string();
                ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
                    let help = "A name can also begin with another folder";
                    ui.add(egui::Label::new(folder).truncate()).on_hover_text(help);
                });
            });
        });
        ui.add_space(12.0);
        let shown = facts.shown();
        ui.columns_const(|[left, right]| {
            left.weak("What");
            for what in What::ALL {
                let [label, help] = what.words();
                option(left, &mut self.what, what, label, help);
            }
            right.add_enabled_ui(self.what != What::Scene, |ui| self.sizes(ui, facts));
        });
        let path = self.path();
        let is_empty = self.name.trim().is_empty() || path.is_dir();
        let default = default_folder();
        let refused = missing_folder(&path).filter(|_| path.parent() != default.as_deref());
        let size = self.pixels(self.size, shown);
        if refused.is_none() && !path.exists() && self.what != What::Scene && !is_ready(facts, size) {
            hint(ui, "Renders first, and you can go on meanwhile.");
        } else {
            note(ui, refused.as_deref(), Some(&path));
        }
        let label = if path.exists() { "Replace" } else { "Save" };
        let pressed = ui.horizontal(|ui| {
            if let What::Picture(format) = self.what {
                ui.weak(format!("About {}", memory::words(file_bytes(format, size, shown))));
            }
            buttons(ui, &field, label, !is_empty && refused.is_none())
        });
        match pressed.inner {
            Some(true) => Outcome::Named(Purpose::Save(self.what, size), path),
            Some(false) => Outcome::Close,
            None => Outcome::Stay,
        }
    }

    fn sizes(&mut self, ui: &mut Ui, facts: &Facts) {
        ui.weak("Size");
        for (size, label) in [
            (Size::Seen, "As you see it"),
            (Size::Book, "As in the book"),
            (Size::Twice, "Twice as large"),
            (Size::Other, "Other"),
        ] {
            let [width, height] = self.pixels(size, facts.shown());
            let time = match seconds_at(facts, [width, height]) {
                _ if is_ready(facts, [width, height]) => ", ready".to_owned(),
                Some(seconds) => format!(", about {}", about(seconds)),
                None => String::new(),
            };
            option(ui, &mut self.size, size, label, &format!("{width} × {height}{time}"));
        }
        if self.size == Size::Other {
            ui.horizontal(|ui| {
                for (name, side) in ["Width", "Height"].into_iter().zip(&mut self.other) {
                    let mut value = f64::from(*side);
                    let number = Number::new(About::new(name, "Pixels"), 1.0..=f64::from(SIZE_LIMIT)).whole();
                    number.field(ui, 64.0, &mut value);
                    *side = value as u32;
                }
            });
        }
    }
}

fn option<T: PartialEq>(ui: &mut Ui, chosen: &mut T, value: T, label: &str, help: &str) {
    ui.radio_value(chosen, value, label);
    ui.horizontal(|ui| {
        ui.add_space(24.0);
        ui.label(RichText::new(help).small().weak());
    });
}

/// Where pictures go unless the user has chosen another folder; it is created when needed.
pub fn default_folder() -> Option<PathBuf> {
    pictures_directory().map(|pictures| pictures.join("Weekender"))
}

/// The name for a file of this picture.
pub fn file_name(document: &Document) -> String {
    let title = match document.stage() {
        Some(stage) if !document.has_changed_scene() => format!("{} {}", stage.section, stage.title),
        _ => return plain_name(&document.name()),
    };
    title.replace(['/', '\\', ':', '?', '*', '"', '<', '>', '|'], "")
}

fn is_ready(facts: &Facts, size: [u32; 2]) -> bool {
    facts.shown().size() == size
}

/// Roughly.
fn file_bytes(format: OutputFormat, [width, height]: [u32; 2], document: &Document) -> u64 {
    let pixels = u64::from(width) * u64::from(height);
    match format {
        OutputFormat::Png => pixels,
        OutputFormat::P6 => 3 * pixels,
        OutputFormat::Exr => Film::bytes(width, height, document.settings.half_count()) / 2,
    }
}

/// Samples per pixel that the picture has when it is done, as far as is known.
pub fn samples_wanted(document: &Document, status: &Status) -> u64 {
    let traced = status.samples_per_pixel.max(1);
    if matches!(status.phase, Phase::Done(_)) { traced } else { document.stop.samples.unwrap_or(traced) }
}

/// About how many seconds the picture takes at this size.
fn seconds_at(facts: &Facts, [width, height]: [u32; 2]) -> Option<f64> {
    let speed = facts.speed.or_else(|| {
        let status = &facts.status;
        let paths = status.added() as f64 * facts.document().size().map(f64::from).iter().product::<f64>();
        (paths > 0.0).then(|| paths / status.trace.as_secs_f64().max(1e-3))
    })?;
    let samples = samples_wanted(facts.document(), &facts.status) as f64;
    Some(f64::from(width) * f64::from(height) * samples / speed)
}

fn about(seconds: f64) -> String {
    let whole = seconds.ceil() as u64;
    match whole {
        0..90 => format!("{} s", whole.max(1)),
        90..5400 => format!("{} min", whole.div_ceil(60)),
        5400..86_400 => format!("{} h", whole.div_ceil(3600)),
        _ => "more than a day".to_owned(),
    }
}

/// A size that needs much memory or time, and asks before it is rendered.
pub struct LargeSize {
    pub size: [u32; 2],
    words: String,
    /// The largest size of the same shape that fits into the free memory, if this one does not.
    fitting: Option<[u32; 2]>,
}

impl LargeSize {
    const BYTES: u64 = 1_000_000_000;
    const SECONDS: f64 = 300.0;

    /// None if the size is harmless.
    pub fn of(facts: &Facts, size: [u32; 2], before: [u32; 2]) -> Option<Self> {
        let halves = facts.document().settings.half_count();
        // The sums, the picture and its texture.
        let bytes_of = |[width, height]: [u32; 2]| {
            Film::bytes(width, height, halves) + 7 * u64::from(width) * u64::from(height)
        };
        let bytes = bytes_of(size);
        let seconds = seconds_at(facts, size);
        let is_slow = |size| seconds_at(facts, size).is_some_and(|seconds| seconds > LargeSize::SECONDS);
        if bytes_of(before) >= bytes || bytes <= LargeSize::BYTES && (!is_slow(size) || is_slow(before)) {
            return None;
        }
        let [width, height] = size;
        let needs = format!("{width} × {height} needs {}", memory::words(bytes));
        let refused = memory::check(|| needs.clone(), bytes, "choose a smaller size").err();
        let time = seconds.map_or_else(String::new, |seconds| format!(" and about {}", about(seconds)));
        let Some(refused) = refused else {
            return Some(LargeSize { size, words: format!("{needs}{time}."), fitting: None });
        };
        let share = (0.9 * refused.free_bytes as f64 / refused.needed_bytes as f64).sqrt();
        let [x, y] = size.map(|side| ((f64::from(side) * share) as u32).max(1));
        let free = memory::words(refused.free_bytes);
        let words = format!("{needs}; {free} are free. The largest that fits is {x} × {y}.");
        Some(LargeSize { size, words, fitting: Some([x, y]) })
    }

    pub(super) fn ui(&self, ui: &mut Ui) -> Outcome {
        ui.label(&self.words);
        ui.add_space(12.0);
        let (label, size) = self.fitting.map_or(("Render", self.size), |fitting| ("Use that", fitting));
        let choice = ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let is_chosen = primary(ui, label).clicked();
            let is_cancelled = ui.button("Cancel").clicked();
            [is_chosen, is_cancelled]
        });
        match choice.inner {
            [true, _] => Outcome::Size(size),
            [_, true] => Outcome::Close,
            _ => Outcome::Stay,
        }
    }
}
