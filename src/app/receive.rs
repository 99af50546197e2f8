//! Handles the answers of background threads.

use super::command::Command;
use super::files::{NotOpened, Resumed};
use super::model::device::Device;
use super::model::document::Document;
use super::model::origin::{Origin, Source};
use super::model::show::Show;
use super::window::Window;
use super::wording::in_window_words;
use crate::job::saved::{Content, Opened};
use crate::progressive::{ReferenceMeans, Status, Stop};
use eframe::egui;
use std::path::{Path, PathBuf};
use std::sync::Arc;

impl Window {
    /// Takes all answers that have arrived.
    pub(super) fn receive(&mut self, context: &egui::Context) {
        while let Some(outcome) = self.files.saved.take() {
            match outcome {
                Ok(path) => {
                    self.remember_directory(&path);
                    // A plot cannot be opened.
                    if path.extension().is_none_or(|ending| !ending.eq_ignore_ascii_case("csv")) {
                        self.model.remembered.note_recent(&path);
                    }
                    self.toasts.good(format!("Saved {}", path.display()));
                }
                Err(reason) => self.toasts.bad(format!("Not saved: {reason}")),
            }
        }
        while let Some(outcome) = self.files.opened.take() {
            match outcome {
                Ok(opened) => self.show_opened(opened),
                Err(NotOpened { path, is_picture: true, .. }) if path.exists() => {
                    self.check.begin(context, &path, None);
                }
                Err(NotOpened { reason, .. }) => self.toasts.bad(format!("Not opened: {reason}")),
            }
        }
        match self.check.follow() {
            Some(Ok(path)) => self.model.remembered.note_recent(&path),
            Some(Err(reason)) => self.toasts.bad(format!("Not checked: {reason}")),
            None => {}
        }
        while let Some((picture, what)) = self.files.copied.take() {
            self.toasts.good(format!("Copied the {what}"));
            context.copy_image(picture);
        }
        self.receive_for_slots();
        while let Some(outcome) = self.files.resumed.take() {
            match outcome {
                Ok(resumed) => self.go_on(resumed),
                Err(reason) => self.toasts.bad(format!("Not resumed: {reason}")),
            }
        }
        while let Some(outcome) = self.files.references.take() {
            match outcome {
                Ok((path, reference)) => self.take_reference(path, reference),
                Err(reason) => self.toasts.bad(format!("Reference not loaded: {reason}")),
            }
        }
        while let Some(outcome) = self.dialogs.browsed() {
            match outcome {
                Ok((purpose, path)) => self.use_path(context, purpose, path),
                Err(reason) => self.toasts.bad(reason),
            }
        }
        self.tell_messages();
    }

    /// The next dialog starts where this file is.
    fn remember_directory(&mut self, path: &Path) {
        // A bare name is one of a file in the working directory.
        if let Some(directory) = std::path::absolute(path).ok().as_deref().and_then(Path::parent) {
            self.model.remembered.directory = Some(directory.to_owned());
        }
    }

    fn show_opened(&mut self, opened: Opened) {
        let Opened { path, recipe, stage, content, .. } = opened;
        self.remember_directory(&path);
        self.model.remembered.note_recent(&path);
        let mut document = match content {
            Content::Scene => Document::new(Origin::new(recipe, Source::File(path.clone()))),
            _ => Document::of_film(&recipe, stage),
        };
        document.has_own_size = true;
        if let Content::Picture { samples: Some(samples) } = content {
            // A picture is restored with its stop condition; a film continues.
            document.stop = Stop::at_samples(samples);
        }
        let animation = document.animation().map_or_else(String::new, |(frames, _)| {
            format!("; its animation has {frames} frames, and the panel at the right says how to render them")
        });
        self.show_document(document);
        self.toasts.good(format!("Opened {}{animation}", path.display()));
        if let Content::Film(film) = content {
            self.adopt(film);
        }
    }

    fn go_on(&mut self, resumed: Resumed) {
        let path = resumed.path.display();
        if self.document().has_same_film(&resumed.begun) {
            self.toasts.good(format!("Continuing {path}"));
            self.model.remembered.note_recent(&resumed.path);
            self.adopt(resumed.film);
        } else {
            self.toasts.bad(format!(
                "Not resumed: the picture was changed before {path} had been read; open the file to continue it"
            ));
        }
    }

    fn take_reference(&mut self, path: PathBuf, reference: ReferenceMeans) {
        self.remember_directory(&path);
        let (mine, theirs) = (self.document().size(), [reference.width, reference.height]);
        self.model.view.reference = Some(Arc::new(reference));
        if mine == theirs {
            self.send(Command::Show(Show::Difference));
            self.toasts.good(format!("Showing the difference from {}", path.display()));
        } else {
            let ([a, b], [x, y]) = (theirs, mine);
            self.toasts.bad(format!(
                "No difference yet: {} is {a}x{b} and the picture is {x}x{y}; choose File > Set the picture to the \
                 reference's size, then View > Show difference to reference",
                path.display()
            ));
        }
    }

    /// Shows the render thread's messages.
    fn tell_messages(&mut self) {
        let status = self.main.status().clone();
        for message in untold(self.told_messages, &status) {
            let message = in_window_words(message);
            // Which device has failed is worth knowing whatever is shown next.
            if status.given_up.is_empty() {
                self.toasts.warn(message, status.run);
            } else {
                self.toasts.bad(message);
            }
        }
        if status.samples_per_pixel > 0 {
            self.toasts.end_warnings(status.run);
        }
        self.told_messages = (status.run, status.messages.len());
        self.follow_failures();
    }

    /// After the chosen device has failed, the one that continues becomes the chosen one.
    fn follow_failures(&mut self) {
        let status = self.main.status();
        let (run, known) = self.known_failures;
        let known = if run == status.run { known } else { 0 };
        let (device, known) = device_after(self.model.remembered.device, known, status);
        self.model.remembered.device = device;
        self.known_failures = (status.run, known);
    }
}

/// The messages of a status without those that were told: so many of a run.
fn untold((run, told): (u64, usize), status: &Status) -> &[String] {
    let told = if run == status.run { told } else { 0 };
    status.messages.get(told..).unwrap_or_default()
}

/// The device to choose after the failures that are not among the `known` first ones, and the failures that are known
/// then. Without a failure of the chosen device the choice stays: it may still be preparing.
fn device_after(chosen: Device, known: usize, status: &Status) -> (Device, usize) {
    let has_failed = status.given_up.iter().skip(known).any(|name| *name == chosen.name());
    let name = status.backend.as_ref().map(|backend| backend.name);
    let present = Device::ALL.into_iter().find(|device| Some(device.name()) == name);
    match present {
        Some(present) if has_failed && present != chosen => (present, status.given_up.len()),
        // The next backend has not taken over yet.
        _ if has_failed => (chosen, known),
        _ => (chosen, status.given_up.len()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::app::tests::window;
    use crate::film::Film;
    use crate::job::recipe::Recipe;
    use crate::job::render::BackendInfo;
    use crate::job::saved::SavedFilm;
    use eframe::egui::Context;

    #[test]
    fn a_film_is_not_resumed_after_the_picture_was_changed() {
        let mut window = window("weekender --stage normals --size 16x9 --samples 1");
        let resumed = |begun: &Document| Resumed {
            path: PathBuf::from("/of/mine.exr"),
            begun: begun.clone(),
            film: SavedFilm { film: Film::new(16, 9, 1), seconds: None, backend: None },
        };
        window.go_on(resumed(&Document::new(Origin::usual())));
        let told = window.messages();
        let reason = "Not resumed: the picture was changed before /of/mine.exr had been read";
        assert!(told[0].starts_with(reason) && window.pending_film.is_none(), "{told:?}");
        assert!(window.model.remembered.recent.is_empty());
        let mine = window.document().clone();
        window.go_on(resumed(&mine));
        assert!(window.pending_film.is_some());
        assert_eq!(window.messages().pop().as_deref(), Some("Continuing /of/mine.exr"));
        assert_eq!(window.model.remembered.recent, [PathBuf::from("/of/mine.exr")]);
    }

    #[test]
    fn each_message_of_a_run_is_told_once() {
        let messages = ["a", "b"].map(str::to_owned).to_vec();
        let status = Status { run: 2, messages, ..Status::default() };
        assert_eq!(untold((1, 1), &status), ["a", "b"], "those of another run");
        assert_eq!(untold((2, 1), &status), ["b"]);
        assert!(untold((2, 2), &status).is_empty());
    }

    #[test]
    fn only_a_failure_of_the_chosen_device_changes_the_choice() {
        let status = |name, given_up: &[&'static str]| {
            let backend = BackendInfo { name, device: String::new(), lanes: 1, threads: 1 };
            let messages = vec!["the estimate is doubtful".to_owned()];
            Status { backend: Some(backend), given_up: given_up.to_vec(), messages, ..Status::default() }
        };
        let (cpu, gpu) = (Device::Cpu, Device::Gpu);
        assert_eq!(device_after(gpu, 0, &status("cpu", &[])), (gpu, 0), "the GPU is being prepared");
        assert_eq!(device_after(cpu, 0, &status("gpu", &[])), (cpu, 0));
        assert_eq!(device_after(gpu, 0, &status("gpu", &["gpu"])), (gpu, 0), "nothing has taken over yet");
        assert_eq!(device_after(gpu, 0, &status("cpu", &["gpu"])), (cpu, 1));
        assert_eq!(device_after(gpu, 1, &status("cpu", &["gpu"])), (gpu, 1), "it is tried again");
        assert_eq!(device_after(cpu, 0, &status("cpu", &["cpu"])), (cpu, 0), "its plainer code goes on");
    }

    #[test]
    fn what_was_written_or_read_is_told_and_remembered() {
        let (mut window, context) = (window("weekender --stage normals --size 16x9"), Context::default());
        let path = |name: &str| PathBuf::from("/of").join(name);
        window.files.saved.answer(&context).give(Ok(path("a.png")));
        window.files.saved.answer(&context).give(Ok(path("b.CSV")));
        window.files.saved.answer(&context).give(Err("there is no room".to_owned()));
        window.files.resumed.answer(&context).give(Err("there is no film".to_owned()));
        window.files.references.answer(&context).give(Err("it is not a film".to_owned()));
        let reason = "it cannot be read".to_owned();
        let not_opened = NotOpened { path: path("not there.png"), reason, is_picture: true };
        window.files.opened.answer(&context).give(Err(not_opened));
        let copied =
            (egui::ColorImage::from_rgb([1, 1], &[0; 3]), "picture: 1x1, 4 samples per pixel".to_owned());
        window.files.copied.answer(&context).give(copied);
        window.receive(&context);
        let told = [
            "Saved /of/a.png",
            "Saved /of/b.CSV",
            "Not saved: there is no room",
            "Not opened: it cannot be read",
            "Copied the picture: 1x1, 4 samples per pixel",
            "Not resumed: there is no film",
            "Reference not loaded: it is not a film",
        ];
        assert_eq!(window.messages(), told);
        assert_eq!(window.model.remembered.recent, [path("a.png")], "a plot cannot be opened");
        assert_eq!(window.model.remembered.directory, Some(PathBuf::from("/of")));
        window.remember_directory(Path::new("c.png"));
        let here = std::env::current_dir().unwrap();
        assert_eq!(window.model.remembered.directory.as_ref(), Some(&here), "a bare name");
        window.remember_directory(Path::new("to/c.png"));
        assert_eq!(window.model.remembered.directory, Some(here.join("to")));
    }

    #[test]
    fn what_is_opened_keeps_its_size_and_a_picture_its_end() {
        let recipe = Recipe::builtin("three-spheres").unwrap();
        for (content, samples) in [
            (Content::Scene, None),
            (Content::Picture { samples: Some(7) }, Some(7)),
            (Content::Picture { samples: None }, None),
        ] {
            let mut window = window("weekender --stage normals --size 16x9");
            let is_scene = matches!(content, Content::Scene);
            let path = PathBuf::from("/of/mine.toml");
            let (recipe, job) = (recipe.clone(), recipe.job().unwrap());
            window.show_opened(Opened { path: path.clone(), recipe, job, stage: None, content });
            let document = window.document();
            assert!(document.has_own_size);
            assert_eq!(document.stop.samples, samples);
            assert_eq!(document.origin.source == Source::File(path.clone()), is_scene);
            assert_eq!(window.model.remembered.recent, [path]);
            assert_eq!(window.model.remembered.directory, Some(PathBuf::from("/of")));
            assert_eq!(window.messages(), ["Opened /of/mine.toml"]);
        }
    }
}
