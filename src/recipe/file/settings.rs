//! The render settings of a scene file.

use super::error::{Refusal, refuse};
use super::numbers::Whole;
use crate::recipe::DEFAULT_SAMPLES_PER_PIXEL;
use crate::render::{DEPTH_LIMIT, RenderSettings, SAMPLE_LIMIT, SIZE_LIMIT, SamplerKind};
use serde::Deserialize;

/// The table `[render]`.
#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct RawSettings {
    width: Option<Whole>,
    height: Option<Whole>,
    samples_per_pixel: Option<Whole>,
    max_depth: Option<Whole>,
    sampler: Option<SamplerKind>,
    seed: Option<Whole>,
    estimate_error: Option<bool>,
}

pub(super) fn settings_of(raw: &RawSettings) -> Result<(RenderSettings, u64), Refusal> {
    let whole = |key: &'static str, value: Option<Whole>, default: u64, limits: [u64; 2], remedy| match value
    {
        None => Ok(default),
        Some(value) => value.within(key, limits, remedy).map_err(|reason| refuse(&["render", key], reason)),
    };
    let small = |key, value, default: u32, limits: [u32; 2], remedy| {
        let wide = whole(key, value, u64::from(default), limits.map(u64::from), remedy)?;
        Ok(u32::try_from(wide).unwrap_or(limits[1]))
    };
    let default = RenderSettings::default();
    let size = [1, SIZE_LIMIT];
    let settings = RenderSettings {
        width: small("width", raw.width, default.width, size, "give pixels, such as 800")?,
        height: small("height", raw.height, default.height, size, "give pixels, such as 450")?,
        max_depth: small(
            "max_depth",
            raw.max_depth,
            default.max_depth,
            [1, DEPTH_LIMIT],
            "the book uses 50 rays per path",
        )?,
        sampler: raw.sampler.unwrap_or(default.sampler),
        seed: small("seed", raw.seed, default.seed, [0, u32::MAX], "choose any number in this range")?,
        estimate_error: raw.estimate_error.unwrap_or(default.estimate_error),
    };
    let samples = whole(
        "samples_per_pixel",
        raw.samples_per_pixel,
        DEFAULT_SAMPLES_PER_PIXEL,
        [1, SAMPLE_LIMIT],
        "try 100",
    )?;
    Ok((settings, samples))
}
