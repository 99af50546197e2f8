//! The settings of a render, and their names for whatever writes or compares them.

use serde::{Deserialize, Serialize};
use std::fmt;

/// Where the numbers of a sample come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, Default)]
#[serde(rename_all = "lowercase")]
pub enum SamplerKind {
    /// Independent numbers, as in the book.
    Independent,
    /// Scrambled Sobol points: the same picture with fewer samples.
    #[default]
    Sobol,
}

impl SamplerKind {
    /// All of them.
    pub const ALL: [SamplerKind; 2] = [SamplerKind::Sobol, SamplerKind::Independent];

    /// The name used on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            SamplerKind::Independent => "independent",
            SamplerKind::Sobol => "sobol",
        }
    }
}

/// Numbers of a job that are neither scene nor camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct RenderSettings {
    /// Pixels across, `1..=16384`.
    pub width: u32,
    /// Pixels down, `1..=16384`.
    pub height: u32,
    /// Most rays of a path, the camera's included, `1..=10000`. A path that is cut off brings nothing.
    pub max_depth: u32,
    /// Where the numbers come from.
    pub sampler: SamplerKind,
    /// Chooses among pictures that differ in their noise alone.
    pub seed: u32,
    /// Whether samples go to two halves with scramblings of their own, so that the error can be estimated.
    pub estimate_error: bool,
}

impl Default for RenderSettings {
    /// What a scene file that does not say gets.
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
    /// Halves of the film: 2 if the error is estimated, else 1.
    pub fn half_count(&self) -> usize {
        if self.estimate_error { 2 } else { 1 }
    }
}

/// A setting that flags and scene files name. Width and height are written together and are not among them.
pub struct NamedSetting {
    /// Its flag, without dashes.
    pub flag: &'static str,
    /// Its key in scene files.
    pub key: &'static str,
    /// What a scene file says next to it; may be empty.
    pub comment: &'static str,
    /// Its value.
    pub value: fn(&RenderSettings) -> SettingValue,
}

/// The value of a setting. Displayed as a flag takes it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SettingValue {
    /// A whole number.
    Number(u32),
    /// One of several names.
    Name(&'static str),
    /// On or off.
    Switch(bool),
}

impl fmt::Display for SettingValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            SettingValue::Number(number) => write!(f, "{number}"),
            SettingValue::Name(name) => f.write_str(name),
            SettingValue::Switch(is_on) => f.write_str(if *is_on { "on" } else { "off" }),
        }
    }
}

impl RenderSettings {
    /// All settings but the size.
    pub const NAMED: &[NamedSetting] = &[
        NamedSetting {
            flag: "depth",
            key: "max_depth",
            comment: "rays of a path",
            value: |settings| SettingValue::Number(settings.max_depth),
        },
        NamedSetting {
            flag: "sampler",
            key: "sampler",
            comment: "",
            value: |settings| SettingValue::Name(settings.sampler.name()),
        },
        NamedSetting {
            flag: "seed",
            key: "seed",
            comment: "",
            value: |settings| SettingValue::Number(settings.seed),
        },
        NamedSetting {
            flag: "estimate-error",
            key: "estimate_error",
            comment: "",
            value: |settings| SettingValue::Switch(settings.estimate_error),
        },
    ];
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two settings that differ in everything must differ in every named value: else one is missing from the list.
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
        let words = RenderSettings::NAMED.iter().map(|named| (named.value)(&settings).to_string());
        assert_eq!(words.collect::<Vec<_>>(), ["50", "sobol", "0", "on"]);
    }
}
