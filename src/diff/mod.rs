//! `weekender diff`: shows a path as two backends trace it, side by side, and where the paths part.

mod compare;
mod find;
mod side;
mod text;
mod words;

pub use compare::{Departure, Difference, PathComparison, Quantity, compare};
pub use find::{Found, find};
pub use side::{Side, SideError};
pub use words::Told;

use crate::cli::{DiffOptions, JsonTarget, PathChoice};
use crate::console::printable;
use crate::failure::Failure;
use crate::files::check_writable;
use crate::record::PathRecord;
use crate::terminal::{is_taken, print_painted_beside, write_json};
use serde::Serialize;
use std::io::IsTerminal;
use std::process::ExitCode;
use text::{Paint, Tone};

/// Version of the JSON. It is raised when a key changes its meaning or is removed.
const SCHEMA: u32 = 2;

#[derive(Serialize)]
struct DiffJson<'a> {
    schema: u32,
    version: &'static str,
    scene: &'a str,
    width: u32,
    height: u32,
    pixel: [u32; 2],
    sample: u64,
    tolerance: f64,
    sides: [SideJson<'a>; 2],
    #[serde(flatten)]
    comparison: PathComparison,
    verdict: String,
}

#[derive(Serialize)]
struct SideJson<'a> {
    name: &'a str,
    about: &'a str,
    path: &'a PathRecord,
}

/// Compares a path and prints it. The exit code is 0 if the sides agree within the tolerance, otherwise 1.
///
/// # Errors
/// [`Failure::Input`], even if a backend fails on the way, because exit code 1 means that the paths differ.
pub fn run(options: &DiffOptions) -> Result<ExitCode, Failure> {
    if let Some(JsonTarget::File(path)) = &options.json {
        check_writable(path).map_err(Failure::input)?;
    }
    let [a, b] = &options.sides;
    let mut sides = [Side::open(a).map_err(Failure::input)?, Side::open(b).map_err(Failure::input)?];
    if sides[0].name == sides[1].name {
        sides[0].name.push_str(" (left)");
        sides[1].name.push_str(" (right)");
    }
    let job = &options.job;
    let (pixel, sample, found) = match options.path {
        PathChoice::Given { pixel, sample } => (pixel, sample, None),
        PathChoice::Find { samples } => {
            let found = find(job, &mut sides, samples, options.tolerance).map_err(Failure::input)?;
            (found.pixel, found.sample, Some(found))
        }
    };
    let mut record = |side: usize| sides[side].record(job, pixel, sample).map_err(Failure::input);
    let (path_a, path_b) = (record(0)?, record(1)?);
    let paths = [&path_a, &path_b];
    let comparison = compare(job, paths, options.tolerance);
    let told = Told {
        job,
        names: [sides[0].name.as_str(), sides[1].name.as_str()],
        paths,
        tolerance: options.tolerance,
    };

    let json = options.json.as_ref();
    let is_terminal =
        if is_taken(json) { std::io::stderr().is_terminal() } else { std::io::stdout().is_terminal() };
    let paint = Paint::on(is_terminal, std::env::var_os("NO_COLOR"));
    let mut text = opening(options, &sides, pixel, sample, found, paint);
    text.push('\n');
    text.push_str(&text::rays(&told, &comparison, paint));
    text.push_str(&text::closing(&told, &comparison, paint));
    print_painted_beside(json, &text).map_err(Failure::Input)?;

    if let Some(target) = json {
        let [about_a, about_b] = [0, 1].map(|side: usize| sides[side].about.as_str());
        let figures = DiffJson {
            schema: SCHEMA,
            version: env!("CARGO_PKG_VERSION"),
            scene: &options.scene,
            width: job.settings().width,
            height: job.settings().height,
            pixel,
            sample,
            tolerance: options.tolerance,
            sides: [
                SideJson { name: told.names[0], about: about_a, path: paths[0] },
                SideJson { name: told.names[1], about: about_b, path: paths[1] },
            ],
            comparison,
            verdict: told.verdict(&comparison),
        };
        write_json(&figures, target).map_err(Failure::Input)?;
    }
    Ok(if comparison.first.is_some() { ExitCode::FAILURE } else { ExitCode::SUCCESS })
}

/// The lines that say what is compared.
fn opening(
    options: &DiffOptions,
    sides: &[Side; 2],
    [x, y]: [u32; 2],
    sample: u64,
    found: Option<Found>,
    paint: Paint,
) -> String {
    let settings = options.job.settings();
    let (width, height) = (settings.width, settings.height);
    let mut lines = vec![(
        "scene",
        format!(
            "{}, {width}x{height}, depth {}, {}, seed {}",
            options.scene,
            settings.max_depth,
            settings.sampler.name(),
            settings.seed
        ),
    )];
    if let Some(found) = found {
        let of = u64::from(width) * u64::from(height) * found.searched;
        lines.push((
            "search",
            format!("{} of {of} samples differ by more than {:.0e}", found.differing, options.tolerance),
        ));
        lines.push(("again", format!("--size {width}x{height} --pixel {x},{y} --sample {sample}")));
    }
    lines.push(("path", format!("pixel {x},{y}, sample {sample}")));
    lines.push(("left", sides[0].about.clone()));
    lines.push(("right", sides[1].about.clone()));
    let line = |(label, content): &(&str, String)| {
        format!("{}{}\n", paint.paint(Tone::Strong, &format!("{label:<9}")), printable(content))
    };
    lines.iter().map(line).collect()
}
