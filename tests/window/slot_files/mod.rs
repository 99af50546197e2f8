//! Kept pictures on disk: what the next window has of them, and what becomes of them if something fails.

mod back;
mod disk;
mod left;

use crate::common::{has_samples, opened, save, send, until};
use crate::session::{close, files, options, until_offered};
use eframe::egui::Key;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;
use tempfile::TempDir;
use weekender::app::{Command, SlotCommand, SlotNumber, Window};
use weekender::film::{FilmFile, checkpoint};
use weekender::output::OutputFormat;

pub const ONE: SlotNumber = SlotNumber::ALL[0];
pub const TWO: SlotNumber = SlotNumber::ALL[1];
pub const THREE: SlotNumber = SlotNumber::ALL[2];
pub const LONG: Duration = Duration::from_secs(3600);
pub const PICTURE: &str = "--stage glass-schlick --size 32x18 --samples 4 --device cpu";

/// A window of a user who knows the first steps, in which kept pictures may take `limit` bytes on disk.
pub fn limited(state: &Path, arguments: &str, limit: Option<u64>) -> Harness<'static, Window> {
    let mut options = options(arguments, state, LONG);
    options.kept_limit = limit;
    let mut window = Window::new(options).unwrap();
    window.remembered_mut().first_steps.is_over = true;
    window.remembered_mut().sizing = weekender::app::Sizing::Book;
    opened(window)
}

pub fn window(state: &Path, arguments: &str) -> Harness<'static, Window> {
    limited(state, arguments, None)
}

/// Puts something in the way that looks like nothing: a link to nowhere.
#[cfg(unix)]
pub fn block(path: &Path) {
    std::os::unix::fs::symlink(path.with_extension("nowhere"), path).unwrap();
}

/// A window with a finished picture.
pub fn finished(state: &Path) -> Harness<'static, Window> {
    let mut harness = window(state, PICTURE);
    until(&mut harness, "the end", is_done);
    harness
}

pub fn is_done(window: &Window) -> bool {
    window.status().phase.is_over() && has_samples(1)(window)
}

pub fn keep_in(harness: &mut Harness<'_, Window>, number: SlotNumber) {
    send(harness, Command::Slot(SlotCommand::KeepIn(number)));
    until(harness, "a kept picture", |window| window.slot(number).is_some());
}

/// Renders the picture with another field of view.
pub fn change(harness: &mut Harness<'_, Window>, vfov: f64) {
    harness.state_mut().document_mut().camera.vfov_degrees = vfov;
    harness.run_steps(2);
    until(harness, "the changed picture", is_done);
}

/// The only folder with kept pictures.
pub fn folder(state: &Path) -> PathBuf {
    let [folder] = files(state, "slots").try_into().unwrap();
    folder
}

/// The films in all folders.
pub fn films(state: &Path) -> Vec<PathBuf> {
    files(state, "slots").iter().flat_map(|folder| files(folder, "exr")).collect()
}

/// Draws frames until there are this many films, all of them listed.
pub fn until_written(harness: &mut Harness<'_, Window>, state: &Path, count: usize) {
    until(harness, "films of kept pictures", |_| {
        let films = films(state);
        let lists = files(state, "slots").into_iter().map(|folder| folder.join("slots.json"));
        let listed: String = lists.filter_map(|list| fs::read_to_string(list).ok()).collect();
        let is_listed = |film: &PathBuf| listed.contains(film.file_stem().unwrap().to_str().unwrap());
        films.len() == count && films.iter().all(is_listed)
    });
}

/// The film of a slot with its description, as the window saves it.
pub fn saved(harness: &mut Harness<'_, Window>, number: SlotNumber, path: &Path) -> FilmFile {
    send(harness, Command::Slot(SlotCommand::Look(number)));
    save(harness, Command::Save(OutputFormat::Exr), path);
    checkpoint::load(path).unwrap()
}

pub fn until_back(harness: &mut Harness<'_, Window>, numbers: &[SlotNumber]) {
    until(harness, "the slots", |window| numbers.iter().all(|number| window.slot(*number).is_some()));
}

pub fn told(harness: &Harness<'_, Window>, part: &str) -> Option<String> {
    harness.state().messages().into_iter().find(|text| text.contains(part))
}

/// A window with a finished picture that is kept in these slots, and the directory with its files.
pub fn keeping(numbers: &[SlotNumber]) -> (TempDir, Harness<'static, Window>) {
    let state = tempfile::tempdir().unwrap();
    let mut harness = finished(state.path());
    numbers.iter().for_each(|number| keep_in(&mut harness, *number));
    (state, harness)
}
