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
    /// Most rays per path, including the camera ray, `1..=10000`. A path that is cut off contributes nothing.
    pub max_depth: u32,
    pub sampler: SamplerKind,
    /// Seed of the sampler: it changes only the noise.
    pub seed: u32,
    /// Whether samples are divided between two halves with separate scramblings, so that the error can be estimated.
    pub estimate_error: bool,
}

impl Default for RenderSettings {
    /// The settings for a scene file that specifies none.
    fn default() -> Self {
        RenderSettings {
            width: 800,
            height: 450,
            max_depth: 50,
            sampler: SamplerKind::Sobol,
            seed: 0,
            estimate_error: true,
        }
    }
}

impl RenderSettings {
    /// Number of halves of the film: 2 if the error is estimated, else 1.
    pub fn half_count(&self) -> usize {
        if self.estimate_error { 2 } else { 1 }
    }
}

/// A setting with a name in flags and scene files. Width and height are excluded, because they are written together.
pub struct NamedSetting {
    /// The name of its flag, without dashes.
    pub flag: &'static str,
    /// The key in scene files.
    pub key: &'static str,
    /// The comment after it in scene files; may be empty.
    pub comment: &'static str,
    /// Reads the value from the settings, as the flag takes it.
    pub value: fn(&RenderSettings) -> String,
}

impl RenderSettings {
    /// All settings except the picture size.
    pub const NAMED: &[NamedSetting] = &[
        NamedSetting {
            flag: "depth",
            key: "max_depth",
            comment: "rays of a path",
            value: |settings| settings.max_depth.to_string(),
        },
        NamedSetting {
            flag: "sampler",
            key: "sampler",
            comment: "",
            value: |settings| settings.sampler.name().to_owned(),
        },
        NamedSetting { flag: "seed", key: "seed", comment: "", value: |settings| settings.seed.to_string() },
        NamedSetting {
            flag: "estimate-error",
            key: "estimate_error",
            comment: "",
            value: |settings| if settings.estimate_error { "on" } else { "off" }.to_owned(),
        },
    ];
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two settings that differ in every field must differ in every named value; otherwise the list lacks a setting.
    #[test]
    fn all_settings_but_the_size_are_named() {
        let settings = RenderSettings::default();
        let RenderSettings { width, height, max_depth, sampler, seed, estimate_error } = settings;
        assert_eq!(sampler, SamplerKind::Sobol);
        let sampler = SamplerKind::Independent;
        let others = [
            RenderSettings { max_depth: max_depth + 1, ..settings },
            RenderSettings { sampler, ..settings },
            RenderSettings { seed: seed + 1, ..settings },
            RenderSettings { estimate_error: !estimate_error, ..settings },
        ];
        for other in others {
            let differs = |named: &&NamedSetting| (named.value)(&settings) != (named.value)(&other);
            assert_eq!(RenderSettings::NAMED.iter().filter(differs).count(), 1, "{other:?}");
        }
        assert_eq!(RenderSettings::NAMED.len(), others.len());
        assert_eq!((width, height), (800, 450));
        let values = RenderSettings::NAMED.iter().map(|named| (named.value)(&settings));
        assert_eq!(values.collect::<Vec<_>>(), ["50", "sobol", "0", "on"]);
    }
}
