//! The final figures of an animation, as text and as JSON.

use crate::console::printable;
use crate::describe::{counted, seconds};
use crate::files::{JsonPath, ShownPath};
use serde::Serialize;
use std::fmt;
use std::path::PathBuf;

/// Version of the JSON. It is raised when a key changes its meaning or is removed.
pub(super) const SCHEMA: u32 = 1;

/// The figures of an animation.
#[derive(Serialize)]
pub(super) struct Summary {
    pub schema: u32,
    pub version: &'static str,
    pub scene: String,
    pub width: u32,
    pub height: u32,
    pub samples_per_pixel: u64,
    pub first_frame: u32,
    pub last_frame: u32,
    pub frames: u32,
    pub frames_done: u32,
    pub rendered: u32,
    pub kept: u32,
    pub rendering_seconds: f64,
    pub total_seconds: f64,
    pub directory: JsonPath,
    pub first_file: Option<JsonPath>,
    pub last_file: Option<JsonPath>,
    pub animation: Option<JsonPath>,
    pub warnings: Vec<String>,
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Summary { scene, width, height, samples_per_pixel, .. } = self;
        writeln!(
            f,
            "scene    {}, {width}x{height}, {} per pixel",
            printable(scene),
            counted(*samples_per_pixel, "sample")
        )?;
        let Summary { frames, frames_done, rendered, kept, .. } = self;
        writeln!(f, "frames   {frames_done} of {frames} done: {rendered} rendered, {kept} already there")?;
        write!(f, "time     {}", seconds(self.total_seconds))?;
        if self.rendered > 0 {
            let each = self.rendering_seconds / f64::from(self.rendered);
            write!(f, " ({each:.3} s for each frame rendered)")?;
        }
        writeln!(f)?;
        if self.frames_done < self.frames {
            return writeln!(
                f,
                "files    in {}; run the same command again to go on",
                self.directory.0.shown()
            );
        }
        if let (Some(first), Some(last)) = (&self.first_file, &self.last_file) {
            writeln!(f, "files    {} to {}", first.0.shown(), last.0.shown())?;
        }
        match &self.animation {
            Some(path) => writeln!(f, "         {}", path.0.shown()),
            None => Ok(()),
        }
    }
}

/// The first and the last file of the `done` frames from `first` on, if there are any. Frames are done in their order.
pub(super) fn files_of_done(first: u32, done: u32, file: impl Fn(u32) -> PathBuf) -> [Option<JsonPath>; 2] {
    let last = done.checked_sub(1).map(|more| first + more);
    [last.map(|_| first), last].map(|frame| frame.map(|frame| file(frame).into()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_files_of_whole_frames_are_named() {
        let named = |frame: u32| PathBuf::from(frame.to_string());
        let told = |done| files_of_done(2, done, named).map(|file| file.map(|path| path.0));
        let file = |frame: u32| Some(named(frame));
        assert_eq!(told(0), [None, None]);
        assert_eq!(told(1), [file(2), file(2)]);
        assert_eq!(told(6), [file(2), file(7)]);
        assert_eq!(told(28), [file(2), file(29)]);
    }

    #[test]
    fn the_summary_counts_frames_and_names_files() {
        let mut summary = Summary {
            schema: SCHEMA,
            version: "",
            scene: "turn".to_owned(),
            width: 24,
            height: 14,
            samples_per_pixel: 1,
            first_frame: 2,
            last_frame: 6,
            frames: 5,
            frames_done: 3,
            rendered: 2,
            kept: 1,
            rendering_seconds: 3.0,
            total_seconds: 75.0,
            directory: PathBuf::from("d").into(),
            first_file: Some(PathBuf::from("d/2.png").into()),
            last_file: Some(PathBuf::from("d/6.png").into()),
            animation: None,
            warnings: Vec::new(),
        };
        let head = "scene    turn, 24x14, 1 sample per pixel\n";
        assert_eq!(
            summary.to_string(),
            format!(
                "{head}frames   3 of 5 done: 2 rendered, 1 already there\n\
                 time     1 min 15 s (1.500 s for each frame rendered)\n\
                 files    in d; run the same command again to go on\n"
            )
        );
        (summary.frames_done, summary.rendered, summary.kept) = (5, 0, 5);
        let whole = format!(
            "{head}frames   5 of 5 done: 0 rendered, 5 already there\n\
             time     1 min 15 s\n\
             files    d/2.png to d/6.png\n"
        );
        assert_eq!(summary.to_string(), whole);
        summary.animation = Some(PathBuf::from("a.png").into());
        assert_eq!(summary.to_string(), format!("{whole}         a.png\n"));
    }
}
