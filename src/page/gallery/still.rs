//! The stills of a directory and their `gallery.json`.

use crate::cli::terminal::write_json;
use crate::film::{Checksum, checkpoint::SAMPLE_VERSION};
use crate::job::recipe::{Recipe, file::to_toml};
use crate::progressive::describe::{counted, seconds};
use crate::stages::Stage;
use crate::system::console;
use crate::system::files::{self, InputError};
use anyhow::{Context, Result, ensure};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// The file that describes a directory's stills.
pub const INDEX: &str = "gallery.json";

/// Version of the JSON, incremented when a key is removed or changes meaning.
const SCHEMA: u32 = 1;

/// Largest `gallery.json` and largest still read, bytes.
const LENGTH_LIMIT: u64 = 64 << 20;

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Still {
    /// Id of the stage.
    pub stage: String,
    /// File name.
    pub file: String,
    pub width: u32,
    pub height: u32,
    pub max_depth: u32,
    pub sampler: String,
    pub seed: u32,
    pub samples_per_pixel: u64,
    /// Wall time of tracing.
    pub trace_seconds: f64,
    /// Estimated RMSE, linear radiance, from two halves of the samples; `None` with a single sample.
    pub rmse_estimate: Option<f64>,
    /// One standard deviation of `rmse_estimate`.
    pub rmse_deviation: Option<f64>,
    /// The backend that rendered it.
    pub backend: String,
    /// See [`fingerprint`].
    pub fingerprint: String,
    /// Checksum of the file.
    pub checksum: String,
}

/// Identifies the picture that this program renders of a recipe: a checksum of the recipe and the version of the
/// samples.
pub fn fingerprint(recipe: &Recipe) -> String {
    let mut checksum = Checksum::default();
    checksum.text(to_toml(recipe).as_bytes());
    checksum.word(SAMPLE_VERSION.into());
    checksum.finish()
}

impl Still {
    pub fn file_name(stage: &Stage) -> String {
        format!("{}.png", stage.id)
    }

    /// The still on one line.
    pub(super) fn line(&self) -> String {
        let size = format!("{}x{}", self.width, self.height);
        let (stage, samples) = (&self.stage, self.samples_per_pixel);
        let (time, error) = (self.time_words(), self.error_words());
        format!("{stage:<18} {size:>9}, {samples:>4} spp, {time:>15}, {error}\n")
    }

    /// Size, samples and rays.
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

    /// The tracing time.
    pub fn time_words(&self) -> String {
        if self.trace_seconds < 0.1 { "less than 0.1 s".to_owned() } else { seconds(self.trace_seconds) }
    }

    /// The estimated error.
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
    /// Reads a directory's `gallery.json`, skipping stages that no longer exist. An unusable file only costs time: it
    /// gives a warning and no stills.
    pub fn read(directory: &Path) -> Stills {
        let path = directory.join(INDEX);
        let mut stills = Stills { directory: directory.to_owned(), pictures: Vec::new() };
        if path.symlink_metadata().is_ok() {
            let warn = |error| console::note(&format!("warning: {error:#}; every picture is rendered again"));
            read_index(&path).map_err(warn).into_iter().flatten().for_each(|still| stills.set(still));
        }
        stills
    }

    pub fn all(&self) -> &[Still] {
        &self.pictures
    }

    pub fn of(&self, stage: &Stage) -> Option<&Still> {
        self.pictures.iter().find(|still| still.stage == stage.id)
    }

    /// Adds a still, replacing the same stage's.
    pub(super) fn set(&mut self, still: Still) {
        let index = |still: &Still| Stage::find(&still.stage).ok().map(Stage::index);
        if index(&still).is_none() || still.file.contains(['/', '\\']) {
            return;
        }
        self.pictures.retain(|other| other.stage != still.stage);
        self.pictures.push(still);
        self.pictures.sort_by_key(index);
    }

    pub(super) fn write(&self) -> Result<()> {
        let version = env!("CARGO_PKG_VERSION").to_owned();
        let json = Json { schema: SCHEMA, version, pictures: self.pictures.clone() };
        write_json(&json, &self.directory.join(INDEX))
    }

    /// Whether the still of `stage` has one of these fingerprints and its file is as written.
    pub(super) fn is_fresh(&self, stage: &Stage, fingerprints: &[String]) -> bool {
        self.of(stage).is_some_and(|still| {
            fingerprints.contains(&still.fingerprint)
                && checksum(&self.directory.join(&still.file)).is_ok_and(|found| found == still.checksum)
        })
    }
}

fn read_index(path: &Path) -> Result<Vec<Still>> {
    let bytes = files::read(path, "the description of a gallery", LENGTH_LIMIT)?;
    let json: Json =
        serde_json::from_slice(&bytes).with_context(|| format!("cannot read {}", path.display()))?;
    ensure!(json.schema == SCHEMA, "{} has version {}, not {SCHEMA}", path.display(), json.schema);
    Ok(json.pictures)
}

pub(super) fn checksum(path: &Path) -> Result<String, InputError> {
    let mut checksum = Checksum::default();
    checksum.text(&files::read(path, "a picture", LENGTH_LIMIT)?);
    Ok(checksum.finish())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::page::gallery::Quality;
    use crate::scene::Sphere;
    use std::sync::Arc;

    impl Still {
        /// A full still, not rendered.
        pub fn of(id: &str) -> Still {
            let stage = Stage::find(id).unwrap();
            let Recipe { settings, samples_per_pixel, .. } = Quality::Full.recipe(stage);
            Still {
                stage: stage.id.to_owned(),
                file: Still::file_name(stage),
                width: settings.width,
                height: settings.height,
                max_depth: settings.max_depth,
                sampler: String::new(),
                seed: 0,
                samples_per_pixel,
                trace_seconds: 0.0,
                rmse_estimate: None,
                rmse_deviation: None,
                backend: String::new(),
                fingerprint: format!("of {id}"),
                checksum: String::new(),
            }
        }
    }

    #[test]
    fn fingerprint_covers_whole_recipe() {
        let recipe = Quality::Quick.recipe(Stage::find("metal-fuzzy").unwrap());
        let change = |change: &dyn Fn(&mut Recipe)| {
            let mut recipe = recipe.clone();
            change(&mut recipe);
            fingerprint(&recipe)
        };
        assert_eq!(change(&|_| {}), fingerprint(&recipe));
        let changes: [&dyn Fn(&mut Recipe); 4] = [
            &|recipe| recipe.samples_per_pixel += 1,
            &|recipe| recipe.settings.seed += 1,
            &|recipe| recipe.rules.transfer = crate::stages::Transfer::Linear,
            &|recipe| {
                let Sphere { radius, .. } = &mut Arc::make_mut(&mut recipe.scene).spheres[1];
                *radius += 1e-9;
            },
        ];
        for (number, one) in changes.into_iter().enumerate() {
            assert_ne!(change(one), fingerprint(&recipe), "change {number}");
        }
    }

    #[test]
    fn index_round_trips_without_unknown_stages() {
        let directory = tempfile::tempdir().unwrap();
        let mut stills = Stills::read(directory.path());
        assert_eq!(stills.all(), []);
        for id in ["metal", "sky", "metal"] {
            stills.set(Still { rmse_estimate: Some(0.1 + 0.2), ..Still::of(id) });
        }
        stills.set(Still { stage: "no-stage".to_owned(), ..Still::of("book") });
        stills.set(Still { file: "../book.png".to_owned(), ..Still::of("book") });
        stills.write().unwrap();
        let read = Stills::read(directory.path());
        assert_eq!(read, stills);
        assert_eq!(read.all().iter().map(|still| still.stage.as_str()).collect::<Vec<_>>(), ["sky", "metal"]);
        for damaged in ["", "{", "{\"schema\": 2, \"version\": \"\", \"pictures\": []}"] {
            let path = directory.path().join(INDEX);
            std::fs::write(&path, damaged).unwrap();
            assert!(
                read_index(&path).is_err() && Stills::read(directory.path()).all().is_empty(),
                "{damaged:?}"
            );
        }
    }

    #[test]
    fn a_still_describes_itself() {
        let metal = Still {
            trace_seconds: 8.26,
            rmse_estimate: Some(0.001_234),
            rmse_deviation: Some(1e-5),
            ..Still::of("metal")
        };
        let line = "metal                800x450, 1024 spp,           8.3 s, error 1.2e-3 ± 0.8 %\n";
        assert_eq!(metal.line(), line);
        let settings = "800 × 450 pixels, 1024 samples per pixel, at most 50 rays per path";
        assert_eq!(metal.settings_words(), settings);
        let sky = Still::of("sky");
        assert_eq!(sky.settings_words(), "800 × 450 pixels, 1 ray through the centre of each pixel");
        assert_eq!((sky.time_words().as_str(), sky.error_words().as_str()), ("less than 0.1 s", "no noise"));
    }
}
