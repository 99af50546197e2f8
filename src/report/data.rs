//! What a report has measured, as it is kept in `report.json`.

use serde::{Deserialize, Serialize};

/// Version of the JSON: it grows when a key changes its meaning or goes away.
pub const SCHEMA: u32 = 1;

/// Everything that was measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Data {
    /// See [`SCHEMA`].
    pub schema: u32,
    /// What the figures depend on: runs of other settings are not mixed.
    pub settings: Settings,
    /// One for each scene that has runs.
    pub references: Vec<ReferenceUsed>,
    /// One for each curve and seed.
    pub runs: Vec<Run>,
    /// One for each scene and backend.
    pub rounding: Vec<Rounding>,
}

impl Data {
    /// Sets what errors are measured against, and forgets what was measured against anything else: a scene of the
    /// same name may have become another.
    pub fn take_references(&mut self, references: Vec<ReferenceUsed>) {
        let is_other =
            |old: &ReferenceUsed| references.iter().any(|new| new.scene == old.scene && new != old);
        let stale: Vec<String> =
            self.references.iter().filter(|old| is_other(old)).map(|old| old.scene.clone()).collect();
        self.runs.retain(|run| !stale.contains(&run.curve.scene));
        self.rounding.retain(|row| !stale.contains(&row.scene));
        self.references.retain(|old| references.iter().all(|new| new.scene != old.scene));
        self.references.splice(..0, references);
    }
}

/// What all runs have in common.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// Program and version.
    pub software: String,
    /// Width and height of all pictures.
    pub size: (u32, u32),
    /// Pictures of each curve, which differ in their noise alone.
    pub seeds: u32,
    /// Seconds of tracing for all seeds of a curve.
    pub time_limit: f64,
    /// Most samples per pixel.
    pub max_samples: u64,
    /// Whether samples are kept in two halves, which tell the error.
    pub estimate_error: bool,
    /// Samples per pixel of references that the report makes.
    pub reference_samples: u64,
    /// What makes them, or the file that is taken.
    pub reference: String,
}

/// The picture that errors are measured against.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ReferenceUsed {
    /// The scene.
    pub scene: String,
    /// What rendered it.
    pub about: String,
    /// Samples per pixel.
    pub samples: u64,
    /// Its own mean squared error, as its halves estimate it; it is subtracted from the others'.
    pub mse: f64,
    /// Its own relative mean squared error.
    pub rel_mse: f64,
}

/// What makes a line of the plot.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Curve {
    /// The scene.
    pub scene: String,
    /// The backend, as `weekender report --backends` names it.
    pub backend: String,
    /// The sampler.
    pub sampler: String,
}

/// One picture that grew.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// Its curve.
    #[serde(flatten)]
    pub curve: Curve,
    /// Its seed.
    pub seed: u32,
    /// The backend in full.
    pub about: String,
    /// Seconds of preparing.
    pub prepare_seconds: f64,
    /// At powers of two of samples.
    pub points: Vec<Measured>,
}

/// A picture at one number of samples.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// Samples per pixel.
    pub samples: u64,
    /// Seconds of tracing; the baseline tells those of its processor.
    pub trace_seconds: f64,
    /// Seconds of tracing and of adding to the film.
    pub wall_seconds: f64,
    /// Seconds that the device was at work, by its own clock; `None` where it has none.
    pub device_seconds: Option<f64>,
    /// Mean squared error over pixels and channels, linear radiance, less the reference's own; it can be below 0
    /// where the picture is better than the reference.
    pub mse: f64,
    /// Mean of the squared error over `reference^2 + 0.01`, likewise.
    pub rel_mse: f64,
    /// LDR-FLIP of the picture that is shown.
    pub flip: f64,
    /// Mean squared error as the picture's halves estimate it.
    pub mse_estimate: Option<f64>,
    /// Samples that were left out.
    pub rejected: u64,
}

/// The same samples in `f64` and on a backend.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rounding {
    /// The scene.
    pub scene: String,
    /// The backend.
    pub backend: String,
    /// Samples per pixel.
    pub samples: u64,
    /// Mean difference from `f64`.
    pub bias: f64,
    /// Root of the mean square difference of pixels at this many samples: most of it are paths that rounding sent
    /// another, equally likely way, and falls with more samples.
    pub rms: f64,
    /// What remains with endless samples: root of the mean square; `None` where it drowns in the above.
    pub floor: Option<f64>,
    /// The floor is below this (two deviations).
    pub floor_limit: f64,
}
