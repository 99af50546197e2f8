//! Render settings, and their names in flags and scene files.

use serde::{Deserialize, Serialize};

/// The sampler, which generates the numbers of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, Default, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum SamplerKind {
    /// Independent random numbers, as in the book.
    Independent,
    /// Scrambled Sobol points, which need fewer samples for the same quality.
    #[default]
    Sobol,
}

impl SamplerKind {
    /// All samplers, the default first.
    pub const ALL: [SamplerKind; 2] = [SamplerKind::Sobol, SamplerKind::Independent];

    /// The sampler's name on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            SamplerKind::Independent => "independent",
            SamplerKind::Sobol => "sobol",
        }
    }
}

/// The numbers of a job besides those of scene and camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct RenderSettings {
    /// Picture width in pixels, `1..=16384`.
    pub width: u32,
    /// Picture height in pixels, `1..=16384`.
    pub height: u32,
    /// Maximum number of rays per path, including the camera ray, `1..=10000`. A path that is cut off contributes
    /// nothing.
    pub max_depth: u32,
    pub sampler: SamplerKind,
    /// Seed of the sampler: it changes only the noise.
    pub seed: u32,
}

impl Default for RenderSettings {
    /// The settings for a scene file that specifies none.
    fn default() -> Self {
        RenderSettings { width: 800, height: 450, max_depth: 50, sampler: SamplerKind::Sobol, seed: 0 }
    }
}
