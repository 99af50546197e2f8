//! The measurements of a report, as stored in `report.json`.

use crate::measure::SCHEMA;
use serde::{Deserialize, Serialize};

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Data {
    /// See [`SCHEMA`].
    #[serde(skip_serializing)]
    pub schema: u32,
    /// Settings that determine the figures; runs with different settings are not mixed.
    pub settings: Settings,
    /// One entry per scene that has runs.
    pub references: Vec<ReferenceUsed>,
    /// One entry per curve and seed.
    pub runs: Vec<Run>,
    /// One entry per scene and backend.
    pub rounding: Vec<Rounding>,
}

impl Data {
    pub fn new(settings: Settings) -> Self {
        Data { schema: SCHEMA, settings, references: Vec::new(), runs: Vec::new(), rounding: Vec::new() }
    }

    /// Replaces the references and discards everything measured against a different one: a scene may have changed under
    /// the same name.
    pub fn take_references(&mut self, references: Vec<ReferenceUsed>) {
        let Data { references: old, runs, rounding, .. } = self;
        let is_stale = |scene: &str| references.iter().any(|new| new.scene == scene && !old.contains(new));
        runs.retain(|run| !is_stale(&run.curve.scene));
        rounding.retain(|row| !is_stale(&row.scene));
        old.retain(|old| references.iter().all(|new| new.scene != old.scene));
        old.splice(0..0, references);
    }
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
    /// Most samples per pixel.
    pub max_samples: u64,
    /// Whether films have two halves, as an error estimate needs.
    pub estimate_error: bool,
    /// Samples per pixel of the references that the report renders.
    pub reference_samples: u64,
    /// The backend that renders the references.
    pub reference: String,
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
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
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
    /// Time to prepare the scene.
    pub prepare_seconds: f64,
    /// Measured at powers of two of samples.
    pub points: Vec<Measured>,
}

/// A picture at one sample count.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// Samples per pixel.
    pub samples: u64,
    /// Seconds of tracing.
    pub trace_seconds: f64,
    /// Time of tracing and adding to the film.
    pub wall_seconds: f64,
    /// Time the device was busy, by its own clock; `None` if it has none.
    pub device_seconds: Option<f64>,
    /// Mean squared error over pixels and channels, linear radiance, minus the reference's own; negative if the picture
    /// is better than the reference.
    pub mse: f64,
    /// Mean of the squared error over `reference^2 + 0.01`, minus the reference's own.
    pub rel_mse: f64,
    /// LDR-FLIP of the displayed picture.
    pub flip: f64,
    /// Mean squared error estimated from the picture's halves.
    pub mse_estimate: Option<f64>,
    /// Number of rejected samples.
    pub rejected: u64,
}

/// Difference between the same samples in `f64` and on a backend.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rounding {
    pub scene: String,
    pub backend: String,
    /// Samples per pixel.
    pub samples: u64,
    /// Mean difference from `f64`, linear radiance.
    pub bias: f64,
    /// Root mean square pixel difference at this sample count. It comes mostly from paths that rounding sent a
    /// different but equally likely way, and falls with more samples.
    pub rms: f64,
    /// The root mean square difference that infinitely many samples would leave; `None` if too small to tell.
    pub floor: Option<f64>,
    /// Upper limit of the floor, at two standard deviations.
    pub floor_limit: f64,
}

#[cfg(test)]
mod tests {
    use super::super::tests::{curve, data};
    use super::*;

    #[test]
    fn changed_reference_discards_runs() {
        let run = |scene: &str| Run {
            curve: Curve { scene: scene.to_owned(), ..curve("cpu", "sobol") },
            seed: 0,
            about: String::new(),
            prepare_seconds: 0.0,
            points: Vec::new(),
        };
        let reference = |scene: &str, samples| {
            let (scene, about) = (scene.to_owned(), String::new());
            ReferenceUsed { scene, about, samples, mse: 1e-6, rel_mse: 2e-6 }
        };
        let mut found = Data { runs: vec![run("a"), run("b"), run("c")], ..data() };
        found.references = vec![reference("a", 512), reference("b", 512), reference("c", 512)];
        let same = found.clone();
        found.take_references(found.references.clone());
        assert_eq!(found, same);
        found.take_references(vec![reference("b", 1024), reference("a", 512)]);
        assert_eq!(found.runs, [run("a"), run("c")]);
        assert_eq!(found.references, [reference("b", 1024), reference("a", 512), reference("c", 512)]);
    }
}
