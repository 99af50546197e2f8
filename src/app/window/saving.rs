//! Opening and saving, with their dialogs, and pages in the browser.

use super::Window;
use crate::app::dialogs::{Dialog, Outcome, Purpose, SaveBox, Wanted, What, default_folder, samples_to_save};
use crate::app::model::companion;
use crate::batch::{BatchOptions, FrameNames, FramesOptions, Output, Studio};
use crate::job::output::OutputFormat;
use crate::job::recipe::Recipe;
use crate::system::terminal::ProgressChoice;
use eframe::egui::{self, Context};
use std::path::{Path, PathBuf};
use std::time::Duration;

impl Window {
    pub(super) fn ask_path(&mut self, context: &Context, purpose: Purpose) {
        let from = self.folder();
        self.shell.dialogs.system.ask(context, purpose, from);
    }

    /// Opens the dialog of saving with this choice.
    pub(super) fn ask_save(&mut self, what: What) {
        let save = SaveBox::new(self.document(), self.folder(), what);
        self.shell.dialogs.open(Dialog::Save(save));
    }

    /// The folder in which the user is at work.
    pub(super) fn folder(&self) -> PathBuf {
        let last = self.model.remembered.recent.first().and_then(|path| path.parent());
        let last = last.filter(|folder| folder.is_dir()).map(Path::to_owned);
        last.or_else(default_folder).or_else(|| std::env::current_dir().ok()).unwrap_or_default()
    }

    pub(super) fn end_dialog(&mut self, context: &Context, outcome: Outcome) {
        match outcome {
            Outcome::Named(Purpose::Check, path) => self.tools.check.begin(context, &path, None),
            Outcome::Named(Purpose::Compare, path) => self.display.kept.read(context, &self.model, path),
            Outcome::Named(_, path) => self.files.open(context, path),
            Outcome::Save(wanted) => {
                // If this fails, writing the file tells why.
                let _ = wanted.path.parent().map(std::fs::create_dir_all);
                if let Err(reason) = self.save(context, wanted) {
                    self.shell.toasts.bad(format!("Not saved: {reason}"));
                }
            }
            Outcome::Stay | Outcome::Close => {}
        }
    }

    pub(super) fn save(&mut self, context: &Context, wanted: Wanted) -> Result<(), String> {
        let Wanted { what, size, frames, samples, path } = wanted;
        let (document, backend) = (&self.model.document, self.model.backend());
        match what {
            What::Scene => self.files.save_scene(context, path, document),
            What::Picture(format) if size == document.size() => {
                self.files.save.make(document, (format, path));
            }
            What::Picture(format) => {
                let samples = samples_to_save(document, self.tracing.main.status());
                let mut document = document.clone();
                document.give_size(size);
                self.files.save_rendered(context, (document, samples), backend, (format, path))?;
            }
            What::Animation => {
                self.model.document.stretch(frames);
                let mut document = self.document().clone();
                document.give_size(size);
                let (frames, job) = (frames.max(document.keyframes.len() as u32), document.job(1));
                let pattern = path.join("frame-####.png");
                let names = FrameNames::of_pattern(&pattern).ok_or("it has no name")?;
                let output = Output { path: pattern, format: OutputFormat::Png, is_checkpoint: false };
                let picture = BatchOptions {
                    recipe: Recipe { samples_per_pixel: samples.into(), ..document.recipe() },
                    job: job.map_err(|error| error.to_string())?,
                    stage: document.stage().filter(|_| !document.has_changed_scene()),
                    plan: Studio::plan(samples.into()),
                    denoise: false,
                    outputs: vec![output],
                    every: Duration::MAX,
                    resume: None,
                    save_scene: None,
                    backend,
                    progress: ProgressChoice::Off,
                    json: None,
                    command: String::new(),
                    frame: None,
                };
                let options =
                    FramesOptions { picture, path: document.path(frames), frames: 0..frames, names };
                options.check().map_err(|error| format!("{error:#}"))?;
                self.files.save_frames(context, options)?;
            }
        }
        Ok(())
    }

    pub(super) fn open_recent(&mut self, context: &Context, place: usize) {
        let recent = &mut self.model.remembered.recent;
        let Some(path) = recent.get(place).cloned() else { return };
        if path.exists() {
            self.files.open(context, path);
        } else {
            recent.remove(place);
            self.shell.toasts.bad(format!("{} is no longer there; the list drops it", path.display()));
        }
    }

    /// Opens a page in the browser, or tells its address.
    pub(super) fn open_url(&mut self, context: &Context, url: String) {
        if !self.shell.dialogs.system.is_there || webbrowser::Browser::is_available() {
            context.open_url(egui::OpenUrl::new_tab(url));
        } else {
            self.shell.toasts.bad(format!("No browser could be started; the page is {url}"));
        }
    }

    /// Opens the companion at the stage that is shown.
    pub(super) fn show_companion(&mut self, context: &Context) {
        match companion::page() {
            Some(page) => self.open_url(context, companion::url(&page, self.document().stage())),
            None => self.shell.toasts.bad(
                "The companion is not installed beside this program; in its sources, cargo run --release -p companion \
                 writes the page",
            ),
        }
    }
}
