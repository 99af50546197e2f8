//! The command line that renders a document.

use super::{Document, Source};
use crate::job::recipe::plain_name;
use crate::system::shell;
use std::fmt::Write;

impl Document {
    /// The command line that renders the same picture with `samples` samples per pixel; on the CPU it is identical to
    /// the bit. A changed scene is read from the scene file that it was saved in. Everything else is then repeated,
    /// because the file may have been saved with another camera or other settings.
    pub fn command_line(&self, samples: u64, device: &str, adapter: Option<&str>) -> String {
        let (origin, name) = (&self.origin.recipe, self.name());
        let mut line = String::from("weekender --batch");
        // Writing to a string cannot fail.
        let mut add = |flag: &str, value: &dyn std::fmt::Display| {
            let _ = write!(line, " {flag}={}", shell::quoted(&value.to_string()));
        };
        let mut repeats = false;
        match &self.origin.source {
            Source::Stage(stage) if !self.has_changed_scene() => add("--stage", &stage.id),
            Source::Builtin if !self.has_changed_scene() => add("--scene", &origin.name),
            Source::File(path) if !self.has_changed_scene() => add("--scene", &path.display()),
            _ => {
                let unsaved = || format!("{}.toml", plain_name(&self.name())).into();
                let file = self.checked.file().unwrap_or_else(unsaved);
                add("--scene", &file.display());
                repeats = true;
            }
        }
        let (mine, theirs) = (&self.settings, &origin.settings);
        if repeats || (mine.width, mine.height) != (theirs.width, theirs.height) {
            add("--size", &format!("{}x{}", mine.width, mine.height));
        }
        for ((flag, value), (_, base)) in mine.flags().into_iter().zip(theirs.flags()) {
            if repeats || value != base {
                add(&format!("--{flag}"), &value);
            }
        }
        let (camera, base) = (self.acting_camera(), &origin.camera);
        for (flag, value, default) in [
            ("--look-from", camera.look_from, base.look_from),
            ("--look-at", camera.look_at, base.look_at),
            ("--vup", camera.vup, base.vup),
        ] {
            if repeats || value != default {
                add(flag, &format!("{},{},{}", value.x, value.y, value.z));
            }
        }
        if repeats || camera.vfov_degrees != base.vfov_degrees {
            add("--vfov", &camera.vfov_degrees);
        }
        if repeats || camera.defocus_angle_degrees != base.defocus_angle_degrees {
            add("--defocus-angle", &camera.defocus_angle_degrees);
        }
        // No flag removes a focus distance, but a flag can set the equivalent distance.
        let has_lens = camera.defocus_angle_degrees > 0.0;
        if (repeats && has_lens) || camera.focus_distance != base.focus_distance {
            add("--focus-distance", &camera.effective_focus_distance());
        }
        add("--samples", &samples);
        if device != "cpu" {
            add("--device", &device);
        }
        if let Some(adapter) = adapter {
            add("--adapter", &adapter);
        }
        add("--out", &format!("{}.png", plain_name(&name)));
        line
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::{CheckedScene, Origin};
    use crate::cli::{Request, parse};
    use crate::job::recipe::{Recipe, file};
    use crate::job::render::{RenderJob, RenderSettings, SamplerKind};
    use crate::scene::Camera;

    use crate::stages::Stage;
    use glam::DVec3;
    use std::sync::Arc;

    /// The job that a command line renders.
    fn job_of(line: &str) -> RenderJob {
        match parse(line.replace('"', "").split_whitespace().map(Into::into)).unwrap() {
            Request::Batch(options) => options.job.clone(),
            other => panic!("{line}: {other:?}"),
        }
    }

    #[test]
    fn the_command_line_gives_the_same_job() {
        for stage in Stage::ALL {
            let mut document = Document::new(Origin::of_stage(stage));
            assert_eq!(
                job_of(&document.command_line(4, "cpu", None)),
                document.job(1).unwrap(),
                "{}",
                stage.id
            );
            document.camera.look_from = DVec3::new(-1.1, 1e-20, 1.0 / 3.0);
            document.camera.look_at = DVec3::new(0.25, -7.0, 1e9);
            document.camera.vup = DVec3::new(0.0, 1.0, -0.5);
            document.camera.vfov_degrees = 33.3;
            document.settings.width = 31;
            document.settings.max_depth = 7;
            document.settings.seed = 9;
            document.settings.sampler = crate::job::render::SamplerKind::Independent;
            document.settings.estimate_error = false;
            for (defocus, focus) in [(0.0, Some(3.0)), (2.5, Some(3.0)), (2.5, None)] {
                document.camera.defocus_angle_degrees = defocus;
                document.camera.focus_distance = focus;
                let line = document.command_line(4, "cpu", None);
                let (theirs, mine) = (job_of(&line), document.job(1).unwrap());
                let same_focus =
                    |a: &Camera| Camera { focus_distance: Some(a.effective_focus_distance()), ..*a };
                assert_eq!(same_focus(theirs.camera()), same_focus(mine.camera()), "{line}");
                assert_eq!((theirs.settings(), theirs.rules()), (mine.settings(), mine.rules()), "{line}");
            }
        }
    }

    #[test]
    fn a_built_in_scene_is_named_until_it_is_changed() {
        let origin = Origin::new(Recipe::builtin("book").unwrap(), Source::Builtin);
        let mut document = Document::new(origin);
        let line = document.command_line(4, "cpu", None);
        assert!(line.starts_with("weekender --batch --scene=book --samples=4 "), "{line}");
        assert_eq!(job_of(&line), document.job(1).unwrap());
        document.checked = Document::new(Origin::of_stage(&Stage::ALL[0])).checked;
        let line = document.command_line(4, "cpu", None);
        assert!(line.starts_with("weekender --batch --scene=book-changed.toml --size="), "{line}");
    }

    #[test]
    fn all_but_the_scene_is_repeated_for_a_changed_scene() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("saved.toml");
        let mut document = Document::new(Origin::of_stage(Stage::find("metal").unwrap()));
        let mut scene = document.scene().clone();
        scene.spheres[0].radius = 7.0;
        document.checked = Arc::new(CheckedScene::new(Arc::new(scene), *document.rules()));
        // It was saved with a camera and settings that all differ from the present ones, which are the stage's.
        let camera = Camera {
            look_from: DVec3::new(1.0, 2.0, 3.0),
            look_at: DVec3::new(4.0, 5.0, -6.0),
            vup: DVec3::new(0.25, 1.0, 0.0),
            vfov_degrees: 20.0,
            defocus_angle_degrees: 3.0,
            focus_distance: Some(9.0),
        };
        let settings = RenderSettings {
            width: 31,
            height: 17,
            max_depth: 7,
            sampler: SamplerKind::Independent,
            seed: 9,
            estimate_error: false,
        };
        let saved = Recipe { camera, settings, ..document.recipe() };
        std::fs::write(&path, file::to_toml(&saved)).unwrap();
        document.checked.note_file(&path);
        for (defocus_angle_degrees, focus_distance) in [(0.0, None), (2.5, None), (2.5, Some(3.0))] {
            document.camera = Camera { defocus_angle_degrees, focus_distance, ..document.camera };
            let line = document.command_line(4, "cpu", None);
            let (theirs, mine) = (job_of(&line), document.job(1).unwrap());
            let acting = |camera: &Camera| {
                let has_lens = camera.defocus_angle_degrees > 0.0;
                Camera { focus_distance: has_lens.then(|| camera.effective_focus_distance()), ..*camera }
            };
            assert_eq!(acting(theirs.camera()), acting(mine.camera()), "{line}");
            assert_eq!((theirs.scene(), theirs.settings()), (mine.scene(), mine.settings()), "{line}");
            assert_eq!(theirs.rules(), mine.rules(), "{line}");
        }
    }

    #[test]
    fn a_scene_file_is_named_as_long_as_it_holds_the_picture() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("mine.toml");
        std::fs::write(&path, file::to_toml(&Stage::find("metal").unwrap().recipe())).unwrap();
        let document = Document::new(Origin::new(file::load(&path).unwrap(), Source::File(path.clone())));
        let line = document.command_line(4, "cpu", None);
        let begin = format!("weekender --batch --scene={} --samples=4 ", path.display());
        assert!(line.starts_with(&begin) && line.ends_with(" --out=mine.png"), "{line}");
        assert_eq!(job_of(&line), document.job(1).unwrap());
    }
}
