//! Times ways to divide the same samples among threads and lanes: the tables of docs/companion/21-mappings.md.
//!
//! `mappings gpu [samples=N] [runs=N] [adapter=NAME]` traces the three spheres on the GPU with one thread per pixel and
//! with one per sample, and prints JSON. `mappings cpu [samples=N] [runs=N]` traces them with packets that wait for their
//! longest path and with packets that are refilled. All films of one command must be equal to the bit.

mod gpu;
mod packets;

use serde::Serialize;
use std::time::Instant;
use weekender::film::PixelSum;
use weekender::job::recipe::Recipe;
use weekender::job::render::{RenderJob, RenderSettings};
use weekender::numbers::statistics;

/// Width and height of the picture.
const SIZE: [u32; 2] = [400, 225];

/// The scene.
const SCENE: &str = "three-spheres";

fn main() -> anyhow::Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let Some((mode, rest)) = arguments.split_first() else {
        anyhow::bail!("the first argument must be gpu or cpu");
    };
    let mut options = Options { samples: 64, runs: 9, adapter: None };
    for option in rest {
        match option.split_once('=') {
            Some(("samples", count)) => options.samples = count.parse()?,
            Some(("runs", count)) => options.runs = count.parse()?,
            Some(("adapter", name)) => options.adapter = Some(name.to_owned()),
            _ => anyhow::bail!("unknown option {option}"),
        }
    }
    let comparison = match mode.as_str() {
        "gpu" => gpu::measure(&options)?,
        "cpu" => packets::measure(&options)?,
        _ => anyhow::bail!("the first argument must be gpu or cpu, not {mode}"),
    };
    println!("{}", serde_json::to_string_pretty(&comparison)?);
    Ok(())
}

/// Options from the command line.
struct Options {
    /// Samples per pixel.
    samples: u64,
    /// Runs of each row, after an untimed warm-up.
    runs: usize,
    adapter: Option<String>,
}

/// The rows of the companion's table.
#[derive(Serialize)]
struct Comparison {
    about: String,
    machine: String,
    rows: Vec<Row>,
}

#[derive(Serialize)]
struct Row {
    name: String,
    paths_per_second: Spread,
    in_use: Option<f64>,
}

#[derive(Serialize)]
struct Spread {
    median: f64,
    min: f64,
    max: f64,
}

/// A way to trace all samples.
trait Mapping {
    fn name(&self) -> String;
    /// Traces the picture; returns the film, and the fraction of lanes in use where that is known.
    fn trace(&mut self) -> anyhow::Result<Traced>;
}

struct Traced {
    seconds: f64,
    film: Vec<PixelSum>,
    in_use: Option<f64>,
}

fn job() -> anyhow::Result<RenderJob> {
    let mut recipe = Recipe::find(SCENE)?;
    let [width, height] = SIZE;
    recipe.settings = RenderSettings { width, height, max_depth: 24, ..RenderSettings::default() };
    Ok(recipe.job()?)
}

/// Runs the mappings in turn, so that drift affects all of them alike.
fn compare(
    options: &Options,
    machine: String,
    mappings: &mut [Box<dyn Mapping>],
) -> anyhow::Result<Comparison> {
    let paths = f64::from(SIZE[0]) * f64::from(SIZE[1]) * options.samples as f64;
    let mut speeds = vec![Vec::new(); mappings.len()];
    let mut in_use = vec![None; mappings.len()];
    let mut film: Option<Vec<PixelSum>> = None;
    for run in 0..=options.runs {
        for (place, mapping) in mappings.iter_mut().enumerate() {
            let traced = mapping.trace()?;
            let first = film.get_or_insert_with(|| traced.film.clone());
            anyhow::ensure!(*first == traced.film, "{}: the film differs from the first one", mapping.name());
            if run > 0 {
                speeds[place].push(paths / traced.seconds);
            }
            in_use[place] = traced.in_use;
        }
    }
    let rows = mappings.iter().zip(speeds).zip(in_use).map(|((mapping, speeds), in_use)| Row {
        name: mapping.name(),
        paths_per_second: Spread {
            median: statistics::median(speeds.iter().copied()).unwrap_or(f64::NAN),
            min: speeds.iter().copied().fold(f64::INFINITY, f64::min),
            max: speeds.iter().copied().fold(0.0, f64::max),
        },
        in_use,
    });
    let [width, height] = SIZE;
    let about = format!(
        "The three spheres, {width} × {height}, {} samples per pixel, at most 23 bounces.",
        options.samples
    );
    Ok(Comparison { about, machine, rows: rows.collect() })
}

fn processor() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = info.lines().find_map(|line| line.strip_prefix("model name")?.trim_start().strip_prefix(':'));
    name.map_or("unnamed processor", str::trim).to_owned()
}

fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let begin = Instant::now();
    let result = work();
    (result, begin.elapsed().as_secs_f64())
}
