//! The measurements of a report, as stored in `report.json`.

use serde::{Deserialize, Serialize};

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Data {
    /// Settings that determine the figures.
    pub settings: Settings,
    /// One entry per scene that has runs.
    pub references: Vec<ReferenceUsed>,
    /// One entry per curve and seed.
    pub runs: Vec<Run>,
}

/// Settings common to all runs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// Program and version.
    pub software: String,
    /// Width and height of all pictures.
    pub size: (u32, u32),
    /// Number of pictures per curve, which differ only in their noise.
    pub seeds: u32,
    /// Tracing time for all seeds of a curve, seconds.
    pub time_limit: f64,
    /// Maximum number of samples per pixel.
    pub max_samples: u64,
}

/// The picture that errors are measured against.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ReferenceUsed {
    pub scene: String,
    /// The backend that rendered it.
    pub about: String,
    /// Samples per pixel.
    pub samples: u64,
    /// Its own mean squared error, estimated from its halves and subtracted from the pictures' errors.
    pub mse: f64,
    /// Its own relative mean squared error.
    pub rel_mse: f64,
}

/// Identifies a line of the plot.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Curve {
    pub scene: String,
    /// The backend, as `weekender report --backends` names it.
    pub backend: String,
    pub sampler: String,
}

impl Curve {
    const DENOISED: &str = " denoised";

    /// The curve of the denoised pictures.
    pub fn denoised(&self) -> Curve {
        Curve { backend: self.backend.clone() + Curve::DENOISED, ..self.clone() }
    }

    pub fn is_denoised(&self) -> bool {
        self.backend.ends_with(Curve::DENOISED)
    }
}

/// A picture, measured as samples are added.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Run {
    #[serde(flatten)]
    pub curve: Curve,
    pub seed: u32,
    /// Full name of the backend.
    pub about: String,
    /// Measured at powers of two of samples.
    pub points: Vec<Measured>,
}

/// A picture at one sample count.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// Samples per pixel.
    pub samples: u64,
    /// Time of tracing, adding to the film, and denoising.
    pub wall_seconds: f64,
    /// Mean squared error over pixels and channels, linear radiance, minus the reference's own; negative if the picture
    /// is better than the reference.
    pub mse: f64,
    /// Mean of the squared error over `reference^2 + 0.01`, minus the reference's own.
    pub rel_mse: f64,
    /// Mean squared error estimated from the picture's halves.
    pub mse_estimate: Option<f64>,
    /// Number of rejected samples.
    pub rejected: u64,
}
