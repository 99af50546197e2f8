//! The stills of a directory and what its `gallery.json` says about them.

use crate::cli::JsonTarget;
use crate::describe::{counted, seconds};
use crate::files::{self, InputError};
use crate::film::Checksum;
use crate::recipe::Recipe;
use crate::stages::Stage;
use crate::terminal::write_json;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// The name of the file that describes the stills of a directory.
pub const INDEX: &str = "gallery.json";

/// Version of the JSON. It is raised when a key changes its meaning or is removed.
const SCHEMA: u32 = 1;

/// Longest `gallery.json` and longest still that are read, bytes.
const LENGTH_LIMIT: u64 = 64 << 20;

/// A rendered still.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Still {
    /// The id of the stage that it shows.
    pub stage: String,
    /// The name of its file.
    pub file: String,
    /// Width, pixels.
    pub width: u32,
    /// Height, pixels.
    pub height: u32,
    /// Most rays per path, including the camera's.
    pub max_depth: u32,
    /// The sampler's name.
    pub sampler: String,
    /// The sampler's seed.
    pub seed: u32,
    /// Samples per pixel.
    pub samples_per_pixel: u64,
    /// Wall time of tracing, seconds.
    pub trace_seconds: f64,
    /// Root of the mean squared error, linear radiance, estimated from two halves of the samples; `None` if there was
    /// one sample.
    pub rmse_estimate: Option<f64>,
    /// One standard deviation of `rmse_estimate`.
    pub rmse_deviation: Option<f64>,
    /// The backend that rendered it.
    pub backend: String,
    /// See [`super::Fingerprints`].
    pub fingerprint: String,
    /// Checksum of the file.
    pub checksum: String,
}

impl Still {
    /// The file name of a stage's still.
    pub fn file_name(stage: &Stage) -> String {
        format!("{}.png", stage.id)
    }

    /// The still of `recipe` in the file of `stage`, before it is rendered.
    pub(super) fn new(stage: &Stage, recipe: &Recipe, fingerprint: String) -> Still {
        let settings = &recipe.settings;
        Still {
            stage: stage.id.to_owned(),
            file: Still::file_name(stage),
            width: settings.width,
            height: settings.height,
            max_depth: settings.max_depth,
            sampler: settings.sampler.name().to_owned(),
            seed: settings.seed,
            samples_per_pixel: recipe.samples_per_pixel,
            trace_seconds: 0.0,
            rmse_estimate: None,
            rmse_deviation: None,
            backend: String::new(),
            fingerprint,
            checksum: String::new(),
        }
    }

    /// Size, samples and rays in words.
    pub fn settings_words(&self) -> String {
        let samples = match self.samples_per_pixel {
            1 => "1 ray through the centre of each pixel".to_owned(),
            samples => format!("{} per pixel", counted(samples, "sample")),
        };
        let depth = match self.max_depth {
            1 => String::new(),
            depth => format!(", at most {depth} rays per path"),
        };
        format!("{} × {} pixels, {samples}{depth}", self.width, self.height)
    }

    /// The tracing time in words.
    pub fn time_words(&self) -> String {
        if self.trace_seconds < 0.1 { "less than 0.1 s".to_owned() } else { seconds(self.trace_seconds) }
    }

    /// The estimated error in words.
    pub fn error_words(&self) -> String {
        match (self.rmse_estimate, self.rmse_deviation) {
            (Some(rmse), Some(deviation)) if rmse > 0.0 => {
                format!("error {rmse:.1e} ± {:.1} %", (100.0 * deviation / rmse).max(0.1))
            }
            _ => "no noise".to_owned(),
        }
    }
}

/// The stills of a directory, in the book's order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stills {
    directory: PathBuf,
    pictures: Vec<Still>,
}

#[derive(Serialize, Deserialize)]
struct Json {
    schema: u32,
    version: String,
    pictures: Vec<Still>,
}

impl Stills {
    /// Reads what a directory's `gallery.json` says. Stills of stages that no longer exist are left out. The second
    /// value is a note for the user if the file exists and cannot be used; there are no stills then.
    pub fn read(directory: &Path) -> (Stills, Option<String>) {
        let path = directory.join(INDEX);
        let empty = Stills { directory: directory.to_owned(), pictures: Vec::new() };
        if path.symlink_metadata().is_err() {
            return (empty, None);
        }
        let read = files::read(&path, "the description of a gallery", LENGTH_LIMIT)
            .map_err(|error: InputError| error.to_string())
            .and_then(|bytes| {
                let unreadable =
                    |reason: serde_json::Error| format!("cannot read {}: {reason}", path.display());
                serde_json::from_slice::<Json>(&bytes).map_err(unreadable)
            })
            .and_then(|json| match json.schema {
                SCHEMA => Ok(json.pictures),
                other => Err(format!("{} has version {other}, not {SCHEMA}", path.display())),
            });
        match read {
            Ok(pictures) => {
                let mut stills = empty;
                pictures.into_iter().for_each(|still| stills.set(still));
                (stills, None)
            }
            Err(reason) => (empty, Some(format!("{reason}; every picture is rendered again"))),
        }
    }

    /// The directory of the stills.
    pub fn directory(&self) -> &Path {
        &self.directory
    }

    /// All stills, in the book's order.
    pub fn all(&self) -> &[Still] {
        &self.pictures
    }

    /// The still of a stage.
    pub fn of(&self, stage: &Stage) -> Option<&Still> {
        self.pictures.iter().find(|still| still.stage == stage.id)
    }

    /// Adds a still, or replaces that of the same stage.
    pub(super) fn set(&mut self, still: Still) {
        let index = |still: &Still| Stage::find(&still.stage).ok().map(Stage::index);
        if index(&still).is_none() || still.file.contains(['/', '\\']) {
            return;
        }
        self.pictures.retain(|other| other.stage != still.stage);
        self.pictures.push(still);
        self.pictures.sort_by_key(index);
    }

    /// Writes `gallery.json`.
    pub(super) fn write(&self) -> anyhow::Result<()> {
        let version = env!("CARGO_PKG_VERSION").to_owned();
        let json = Json { schema: SCHEMA, version, pictures: self.pictures.clone() };
        write_json(&json, &JsonTarget::File(self.directory.join(INDEX)))
    }

    /// Whether the still of `stage` has one of these fingerprints and its file is as it was written.
    pub(super) fn is_fresh(&self, stage: &Stage, fingerprints: &[String]) -> bool {
        self.of(stage).is_some_and(|still| {
            fingerprints.contains(&still.fingerprint)
                && checksum(&self.directory.join(&still.file)).is_ok_and(|found| found == still.checksum)
        })
    }
}

/// The checksum of a file.
pub(super) fn checksum(path: &Path) -> Result<String, InputError> {
    let mut checksum = Checksum::default();
    checksum.text(&files::read(path, "a picture", LENGTH_LIMIT)?);
    Ok(checksum.finish())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gallery::Quality;

    fn still(id: &str) -> Still {
        let stage = Stage::find(id).unwrap();
        Still::new(stage, &Quality::Full.recipe(stage), format!("of {id}"))
    }

    #[test]
    fn what_was_written_is_read_and_foreign_entries_are_left_out() {
        let directory = tempfile::tempdir().unwrap();
        let mut stills = Stills::read(directory.path()).0;
        assert_eq!((stills.all(), stills.directory()), (&[][..], directory.path()));
        for id in ["metal", "sky", "metal"] {
            stills.set(Still { rmse_estimate: Some(0.1 + 0.2), ..still(id) });
        }
        stills.set(Still { stage: "no-stage".to_owned(), ..still("book") });
        stills.set(Still { file: "../book.png".to_owned(), ..still("book") });
        stills.write().unwrap();
        let (read, note) = Stills::read(directory.path());
        assert_eq!((&read, note), (&stills, None));
        assert_eq!(read.all().iter().map(|still| still.stage.as_str()).collect::<Vec<_>>(), ["sky", "metal"]);

        for damaged in ["", "{", "{\"schema\": 2, \"version\": \"\", \"pictures\": []}"] {
            std::fs::write(directory.path().join(INDEX), damaged).unwrap();
            let (read, note) = Stills::read(directory.path());
            assert!(read.all().is_empty() && note.unwrap().contains(INDEX), "{damaged:?}");
        }
    }

    #[test]
    fn a_still_is_fresh_if_fingerprint_and_file_are_the_same() {
        let directory = tempfile::tempdir().unwrap();
        let stage = Stage::find("sky").unwrap();
        let path = directory.path().join("sky.png");
        std::fs::write(&path, "picture").unwrap();
        let mut stills = Stills::read(directory.path()).0;
        stills.set(Still { checksum: checksum(&path).unwrap(), ..still("sky") });
        let is_fresh =
            |fingerprint: &str| stills.is_fresh(stage, &["other".to_owned(), fingerprint.to_owned()]);
        assert!(is_fresh("of sky") && !is_fresh("of it"));
        std::fs::write(&path, "Picture").unwrap();
        assert!(!is_fresh("of sky"), "damaged");
        std::fs::remove_file(&path).unwrap();
        assert!(!is_fresh("of sky"), "gone");
    }

    #[test]
    fn words_are_short() {
        let mut still = still("metal");
        assert_eq!(
            still.settings_words(),
            "880 × 495 pixels, 1024 samples per pixel, at most 50 rays per path"
        );
        assert_eq!(
            (still.time_words().as_str(), still.error_words().as_str()),
            ("less than 0.1 s", "no noise")
        );
        (still.rmse_estimate, still.rmse_deviation) = (Some(0.001_234), Some(1e-5));
        still.trace_seconds = 8.26;
        assert_eq!(
            (still.time_words().as_str(), still.error_words().as_str()),
            ("8.3 s", "error 1.2e-3 ± 0.8 %")
        );
        let sky = self::still("sky").settings_words();
        assert_eq!(sky, "880 × 495 pixels, 1 ray through the centre of each pixel");
    }

    #[test]
    fn an_error_has_its_deviation_only_if_there_is_one() {
        let words = |rmse_estimate, rmse_deviation| {
            Still { rmse_estimate, rmse_deviation, ..still("metal") }.error_words()
        };
        assert_eq!(words(Some(0.0), Some(0.0)), "no noise");
        assert_eq!(words(Some(0.25), Some(0.0)), "error 2.5e-1 ± 0.1 %");
        assert_eq!(words(Some(0.25), None), "no noise");
    }

    #[test]
    fn a_time_is_told_from_a_tenth_of_a_second_on() {
        let words = |trace_seconds| Still { trace_seconds, ..still("metal") }.time_words();
        assert_eq!([0.099, 0.1, 0.12].map(words), ["less than 0.1 s", "0.1 s", "0.1 s"]);
    }
}
