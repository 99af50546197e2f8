//! Parses the values of flags. An error message says what is allowed; clap puts the value and the flag before it.

use crate::backends::BackendChoice;
use crate::film::ROUNDING_LIMIT;
use crate::job::render::SIZE_LIMIT;
use crate::render_cpu::{CpuError, Isa};
use anyhow::{Context, Result};
use clap::builder::{PathBufValueParser, TypedValueParser};
use glam::DVec3;
use std::fmt::Display;
use std::ops::{Range, RangeBounds, RangeInclusive};
use std::path::PathBuf;
use std::str::FromStr;
use std::time::Duration;

/// A value or `auto`, which is `None`. Under the name `Option`, clap would take it for a flag without a default.
pub(super) type Auto<T> = Option<T>;

/// A parser of file names that end in `ending`, with the dot, in upper or lower case.
pub(super) fn file_ending(ending: &'static str) -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(move |path| {
        let own = path.extension().unwrap_or_default();
        let is_so = own.eq_ignore_ascii_case(ending.trim_start_matches('.'));
        if is_so { Ok(path) } else { Err(format!("its name must end in {ending}")) }
    })
}

/// A number of lanes.
pub(super) fn parse_simd(text: &str) -> Result<Auto<usize>, String> {
    match text {
        "auto" => Ok(None),
        "off" | "1" => Ok(Some(1)),
        "4" | "8" | "16" => Ok(text.parse().ok()),
        _ => Err("must be auto, off, 4, 8 or 16 lanes".to_owned()),
    }
}

pub(super) fn parse_isa(text: &str) -> Result<Auto<Isa>, String> {
    if text == "auto" { Ok(None) } else { parse_level(text).map(Some) }
}

fn parse_level(name: &str) -> Result<Isa, String> {
    Isa::ALL.into_iter().find(|isa| isa.name() == name).ok_or_else(|| {
        format!("unknown level {name:?}: choose auto or among {}", Isa::ALL.map(Isa::name).join(", "))
    })
}

/// Instruction levels of this processor, the least capable first.
pub(super) fn parse_levels(text: &str) -> Result<Auto<Vec<Isa>>, String> {
    let available = Isa::available();
    match text {
        "auto" => return Ok(None),
        "all" => return Ok(Some(available)),
        _ => {}
    }
    let named: Result<Vec<Isa>, String> = text.split(',').map(|name| parse_level(name.trim())).collect();
    let mut named = named.map_err(|error| format!("{error}; or all, or some separated by commas"))?;
    named.sort_unstable();
    named.dedup();
    match named.iter().find(|isa| !available.contains(isa)) {
        Some(isa) => Err(CpuError::Isa { isa: *isa, available }.to_string()),
        None => Ok(Some(named)),
    }
}

pub(super) fn parse_size(text: &str) -> Result<(u32, u32), String> {
    let pixels = |text: &str| text.parse::<u32>().ok().filter(|pixels| (1..=SIZE_LIMIT).contains(pixels));
    text.split_once('x')
        .and_then(|(width, height)| Some((pixels(width)?, pixels(height)?)))
        .ok_or_else(|| format!("must be WIDTHxHEIGHT, each from 1 to {SIZE_LIMIT} pixels, such as 800x450"))
}

/// A parser of whole numbers within `limits`.
pub(super) fn whole<T: TryFrom<u64>>(
    limits: RangeInclusive<u64>,
) -> impl Fn(&str) -> Result<T, String> + Clone + Send + Sync {
    move |text: &str| {
        let number = text.parse().ok().filter(|number| limits.contains(number));
        number
            .and_then(|number| T::try_from(number).ok())
            .ok_or_else(|| format!("must be a whole number from {} to {}", limits.start(), limits.end()))
    }
}

/// A parser of numbers within `limits`, which messages describe as `allowed`.
pub(super) fn number(
    limits: impl RangeBounds<f64> + Clone + Send + Sync,
    allowed: &'static str,
) -> impl Fn(&str) -> Result<f64, String> + Clone + Send + Sync {
    move |text: &str| {
        finite(text).filter(|number| limits.contains(number)).ok_or_else(|| format!("must be {allowed}"))
    }
}

fn finite(text: &str) -> Option<f64> {
    text.trim().parse().ok().filter(|number: &f64| number.is_finite())
}

pub(super) fn parse_vector(text: &str) -> Result<DVec3, String> {
    let parts: Vec<f64> = text.split(',').map(finite).collect::<Option<_>>().unwrap_or_default();
    <[f64; 3]>::try_from(parts)
        .map(DVec3::from)
        .map_err(|_| "must be three numbers separated by commas, such as 13,2,3".to_owned())
}

pub(super) fn parse_seconds(text: &str) -> Result<f64, String> {
    number(f64::MIN_POSITIVE..=1e9, "above 0 and at most 1e9 seconds, such as 60")(text)
}

/// A target for the stated error of a film, which is never below what rounding can cost.
pub(super) fn parse_noise_target(text: &str) -> Result<f64, String> {
    finite(text).filter(|target| *target > ROUNDING_LIMIT && *target <= 100.0).ok_or_else(|| {
        format!("must be above {ROUNDING_LIMIT:.0e}, which rounding can cost, and at most 100, such as 0.005")
    })
}

/// Shortest and longest duration for [`parse_duration`], seconds.
const DURATION_LIMITS: RangeInclusive<f64> = 0.1..=30.0 * 86_400.0;

/// A duration with a unit, by default seconds.
pub(super) fn parse_duration(text: &str) -> Result<Duration, String> {
    let text = text.trim();
    let units = [("ms", 1e-3), ("s", 1.0), ("min", 60.0), ("m", 60.0), ("h", 3600.0), ("d", 86_400.0)];
    let with_unit = units.into_iter().find_map(|(unit, seconds)| Some((text.strip_suffix(unit)?, seconds)));
    let (number, unit_seconds) = with_unit.unwrap_or((text, 1.0));
    let seconds = number.trim_end().parse().ok().map(|number: f64| number * unit_seconds);
    let seconds = seconds.filter(|seconds| DURATION_LIMITS.contains(seconds));
    seconds
        .map(Duration::from_secs_f64)
        .ok_or_else(|| "must be from 0.1s to 30d, with s, m, h or d after the number, such as 90s".to_owned())
}

/// A parser of ranges that end at `limit` at most; messages show `example`.
pub(super) fn range<T>(
    limit: T,
    example: &'static str,
) -> impl Fn(&str) -> Result<Range<T>, String> + Clone + Send + Sync
where
    T: Copy + Display + FromStr + PartialOrd + Send + Sync,
{
    move |text: &str| {
        let ends =
            text.split_once("..").and_then(|(a, b)| Some(a.trim().parse().ok()?..b.trim().parse().ok()?));
        ends.filter(|range: &Range<T>| range.start < range.end && range.end <= limit)
            .ok_or_else(|| format!("must be A..B with A below B and B at most {limit}, such as {example}"))
    }
}

/// The backend of this name, one of [`BackendChoice::NAMES`].
pub(super) fn backend_named(name: &str, adapter: Option<&str>) -> Result<BackendChoice> {
    BackendChoice::named(name, adapter).with_context(|| {
        format!("unknown backend {name:?}; choose among {}", BackendChoice::NAMES.join(", "))
    })
}

#[cfg(test)]
mod tests;
