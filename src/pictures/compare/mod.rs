//! `weekender compare`: whether two pictures are the same except for noise.

mod heat_map;
mod paired;
mod verdict;

pub use paired::{PairedSamples, PairedSums};
pub use verdict::{Comparison, Evidence, NonFinite, ROUNDING_BIAS, compare};

use super::answer::{Verdict, check_outputs, deliver, lines};
use super::picture::{Picture, about_film, check_memory};
use crate::backends::{self, BackendChoice};
use crate::cli::{CompareOptions, CompareSide};
use crate::failure::Failure;
use crate::files::replace_file;
use crate::film::Film;
use crate::recipe::Recipe;
use crate::render::{RenderJob, RenderSettings, Renderer};
use crate::statistics::blocks::{Block, SUM_DEVIATIONS};
use anyhow::{Context, Result, bail};
use paired::PARTED;
use serde_json::json;
use std::ops::Range;
use std::process::ExitCode;
use std::sync::atomic::AtomicBool;

/// Number of blocks that the output names.
const NAMED_BLOCKS: usize = 5;

/// Compares two pictures and prints how they differ. The exit code is 0 if they differ only by noise, 1 if by more, and 2
/// if that cannot be told.
///
/// # Errors
/// [`Failure::Input`] if they cannot be compared, because exit code 1 means that they differ.
pub fn run(options: &CompareOptions) -> Result<ExitCode, Failure> {
    compared(options).map_err(Failure::Input)
}

fn compared(options: &CompareOptions) -> Result<ExitCode> {
    let json = options.json.as_ref();
    check_outputs(json, options.heat_map.as_deref())?;
    let (sides, paired) = sides(options)?;
    let comparison = compare_sides(&sides, paired)?;
    if let Some(path) = &options.heat_map {
        let [a, b] = &sides;
        replace_file(path, |writer| heat_map::write(a, b, &comparison.test, writer))?;
    }
    deliver(json, &text(&sides, &comparison), 1, &figures(&sides, &comparison))?;
    Ok(comparison.verdict().exit_code())
}

/// Compares two pictures, with a note on their jobs if that explains the result.
///
/// # Errors
/// If their sizes differ.
pub fn compare_sides(sides: &[Picture; 2], paired: Option<PairedSamples>) -> Result<Comparison> {
    let [a, b] = sides;
    if (a.width, a.height) != (b.width, b.height) {
        bail!(
            "{} has {}x{} pixels and {} has {}x{}; render both at the same size",
            a.name,
            a.width,
            a.height,
            b.name,
            b.width,
            b.height
        );
    }
    let mut comparison = compare(a, b, paired);
    comparison.notes.extend(note_on_jobs(a, b).map(str::to_owned));
    Ok(comparison)
}

/// A note on the jobs of the pictures, if they explain the result.
fn note_on_jobs(a: &Picture, b: &Picture) -> Option<&'static str> {
    let (job_a, job_b) = (a.job.as_ref()?, b.job.as_ref()?);
    let (film_a, film_b) = (a.film.as_ref()?, b.film.as_ref()?);
    if job_a == job_b {
        let is_paired = film_a.samples() == film_b.samples();
        return is_paired.then_some("both hold the same samples, so they can differ only by rounding");
    }
    let is_other_picture =
        job_a.scene() != job_b.scene() || job_a.camera() != job_b.camera() || job_a.rules() != job_b.rules();
    is_other_picture
        .then_some("the recipes differ in scene, camera or rules: these should be different pictures")
}

/// A side that was read, or a backend that waits for the scene and size of the other side.
enum Opened {
    Read(Box<Picture>),
    Backend(Rendering),
}

/// Both sides. If backends render both, also their comparison sample by sample.
fn sides(options: &CompareOptions) -> Result<([Picture; 2], Option<PairedSamples>)> {
    let open = |side: &CompareSide| match side {
        CompareSide::File(path) => Ok(Opened::Read(Box::new(Picture::read(path, options.encoding)?))),
        CompareSide::Backend { name, choice } => Rendering::start(choice, name).map(Opened::Backend),
    };
    let [first, second] = &options.sides;
    Ok(match (open(first)?, open(second)?) {
        (Opened::Read(a), Opened::Read(b)) => ([*a, *b], None),
        (Opened::Read(a), Opened::Backend(mut b)) => {
            let b = beside(options, &a, &mut b)?;
            ([*a, b], None)
        }
        (Opened::Backend(mut a), Opened::Read(b)) => {
            let a = beside(options, &b, &mut a)?;
            ([a, *b], None)
        }
        (Opened::Backend(mut a), Opened::Backend(mut b)) => {
            let samples = options.samples.unwrap_or(options.recipe.samples_per_pixel);
            let (sides, paired) = both(&options.recipe, samples, [&mut a, &mut b])?;
            (sides, Some(paired))
        }
    })
}

/// Renders the counterpart of `read` at its size, and with the same samples if `read` is a film of the same job.
fn beside(options: &CompareOptions, read: &Picture, rendering: &mut Rendering) -> Result<Picture> {
    let mut recipe = options.recipe.clone();
    (recipe.settings.width, recipe.settings.height) = (read.width, read.height);
    let job = recipe.job()?;
    job.check_memory(2)?;
    check_memory(read.width, read.height, 2)?;
    let ranges: Vec<Range<u64>> = match (&read.film, &read.job) {
        (Some(film), Some(other)) if *other == job && options.samples.is_none() => {
            film.samples().iter().collect()
        }
        (film, _) => {
            let of_film = film.as_ref().map(|film| film.sample_count());
            vec![0..options.samples.or(of_film).unwrap_or(recipe.samples_per_pixel)]
        }
    };
    let mut film = new_film(&job)?;
    for range in ranges {
        film.merge(&rendering.samples(&job, range)?)?;
    }
    Ok(rendering.picture(&recipe, &job, film))
}

/// Renders the same samples with both backends.
fn both(
    recipe: &Recipe,
    samples: u64,
    renderings: [&mut Rendering; 2],
) -> Result<([Picture; 2], PairedSamples)> {
    let job = recipe.job()?;
    let RenderSettings { width, height, .. } = *job.settings();
    // Two films of all samples, and two of the last sample.
    job.check_memory(4)?;
    check_memory(width, height, 4)?;
    let (mut film_a, mut film_b) = (new_film(&job)?, new_film(&job)?);
    let mut sums = PairedSums::default();
    let [a, b] = renderings;
    for index in 0..samples {
        let (sample_a, sample_b) = (a.samples(&job, index..index + 1)?, b.samples(&job, index..index + 1)?);
        sums.add(&sample_a, &sample_b);
        film_a.merge(&sample_a)?;
        film_b.merge(&sample_b)?;
    }
    let mut sides = [a.picture(recipe, &job, film_a), b.picture(recipe, &job, film_b)];
    if sides[0].name == sides[1].name {
        sides[0].name.push_str(" (first)");
        sides[1].name.push_str(" (second)");
    }
    Ok((sides, sums.finish()))
}

fn new_film(job: &RenderJob) -> Result<Film> {
    let RenderSettings { width, height, .. } = *job.settings();
    Ok(Film::try_new(width, height, job.settings().half_count())?)
}

/// A backend that renders a side.
struct Rendering {
    name: String,
    renderer: Box<dyn Renderer>,
}

impl Rendering {
    fn start(choice: &BackendChoice, name: &str) -> Result<Self> {
        let renderer = backends::create(choice).with_context(|| format!("{name} is not available"))?;
        Ok(Rendering { name: name.to_owned(), renderer })
    }

    fn samples(&mut self, job: &RenderJob, range: Range<u64>) -> Result<Film> {
        let mut film = new_film(job)?;
        self.renderer.accumulate(job, range, &mut film, &AtomicBool::new(false))?;
        Ok(film)
    }

    fn picture(&self, recipe: &Recipe, job: &RenderJob, film: Film) -> Picture {
        let info = self.renderer.info();
        let about = format!("{} {}, {}", info.name, info.device, about_film(&film, Some(recipe)));
        let (job, recipe) = (Some(job.clone()), Some(recipe.clone()));
        Picture { job, recipe, ..Picture::of_film(self.name.clone(), about, film) }
    }
}

/// The full text of a comparison.
pub fn text(sides: &[Picture; 2], comparison: &Comparison) -> String {
    let Comparison { test, rms, bias, .. } = comparison;
    let side = |side: &Picture| format!("{}: {}", side.name, side.about);
    let mut text = vec![("first", side(&sides[0])), ("second", side(&sides[1]))];
    let measure = if comparison.evidence == Evidence::Halves { "noise" } else { "noise, in blocks" };
    let noise = comparison.noise.map_or_else(String::new, |noise| format!("; noise of both {noise:.2e}"));
    let deviation = comparison.bias_deviation.map_or_else(String::new, |x| format!(" ± {x:.1e}"));
    let times = comparison.times_noise();
    text.push((
        "difference",
        format!("{times:.2} x {measure} ({rms:.2e} RMS{noise}), {bias:+.1e}{deviation} on average"),
    ));
    if let Some(paired) = &comparison.paired {
        let PairedSamples { count, parted, rms, bias } = paired;
        let words = format!(
            "{parted} of {count} ({:.1e}) differ by more than {PARTED:.0e}: a different path; the others by {rms:.1e} RMS, \
             {bias:+.1e} on average",
            paired.parted_share()
        );
        text.push(("samples", words));
    }
    let blocks = format!(
        "{} of about 8x8 pixels: sum of z^2 {:+.1} deviations from that of noise (at most {SUM_DEVIATIONS:+.0}), largest |z| \
         {:.2} (at most {:.2})",
        test.blocks.len(),
        test.largest_excess(),
        test.largest,
        test.largest_limit
    );
    text.push(("blocks", blocks));
    if !comparison.is_same {
        let name = |block: &Block| format!("{},{} ({:.1})", block.x.start, block.y.start, block.largest());
        let worst: Vec<String> = test.worst(NAMED_BLOCKS).into_iter().map(name).collect();
        text.push(("worst at", worst.join("  ")));
    }
    text.extend(comparison.notes.iter().map(|note| ("note", note.clone())));
    text.extend(comparison.reasons.iter().chain(&comparison.unclear).map(|why| ("because", why.clone())));
    let verdict = match comparison.verdict() {
        Verdict::Same if comparison.is_same => "equal to the bit",
        Verdict::Same => "equal: they differ only by noise and rounding",
        Verdict::Different => "different",
        Verdict::Unclear => "cannot tell",
    };
    text.push(("verdict", verdict.to_owned()));
    lines(text)
}

/// The comparison for other programs.
fn figures(sides: &[Picture; 2], comparison: &Comparison) -> serde_json::Value {
    let test = &comparison.test;
    let block = |block: &Block| {
        json!({
            "x": [block.x.start, block.x.end],
            "y": [block.y.start, block.y.end],
            "z": block.z,
            "mean_difference": block.means,
        })
    };
    let mut figures = json!(comparison);
    let more = json!({
        "sides": sides.each_ref().map(|side| json!({ "name": side.name, "about": side.about })),
        "width": sides[0].width,
        "height": sides[0].height,
        "is_equal": comparison.is_equal(),
        "times_noise": comparison.times_noise(),
        "blocks": test.blocks.len(),
        "known_blocks": test.counts,
        "sums_of_squares": test.sums,
        "excess": test.excess,
        "largest": test.largest,
        "largest_limit": test.largest_limit,
        "worst_blocks": test.worst(NAMED_BLOCKS).into_iter().map(block).collect::<Vec<_>>(),
    });
    if let (Some(figures), serde_json::Value::Object(more)) = (figures.as_object_mut(), more) {
        figures.extend(more);
    }
    figures
}

#[cfg(test)]
mod tests;
