//! `weekender merge`: adds films of the same picture, and says which of the requested samples are missing.

use super::files::denoised;
use crate::denoise;
use crate::film::{CheckpointError, Film, FilmSum, SampleRanges, checkpoint, key};
use crate::job::output::{OutputFormat, write_image_as};
use crate::job::recipe::file;
use crate::job::saved::{Replaced, same_job};
use crate::progressive::describe::counted;
use crate::system::console;
use crate::system::failure::{FAILED, Failure};
use crate::system::files::{FileLock, ShownPath};
use crate::system::memory;
use crate::system::shell;
use crate::system::terminal::print;
use anyhow::bail;
use std::ffi::OsString;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Options of `weekender merge`.
#[derive(Clone, Debug, clap::Args)]
pub struct MergeOptions {
    /// Film files (.exr), as --checkpoint, --out and merge write them
    #[arg(required = true, num_args = 1.., value_name = "FILM")]
    pub films: Vec<PathBuf>,
    /// Where the result is written: .exr for the film, .png or .ppm for the picture; may be repeated
    #[arg(long, value_name = "FILE", required_unless_present = "samples")]
    pub out: Vec<PathBuf>,
    /// Samples per pixel that the picture should have, 1 to 4294967296: list which are missing, which films are damaged
    /// or do not fit, and the commands that render what is missing
    #[arg(long, value_name = "COUNT")]
    pub samples: Option<u64>,
    /// Denoise the picture, with an estimate of its error; an .exr keeps its film and gains it as a layer
    #[arg(long, requires = "out")]
    pub denoise: bool,
    /// How commands call this program.
    #[arg(skip)]
    pub program: String,
    /// The command line, as files record it.
    #[arg(skip)]
    pub command: String,
}

/// Merges the films, or tells what is missing.
///
/// # Errors
/// [`Failure::Input`] if the films do not belong together, [`Failure::Run`] if the result cannot be written.
pub fn run(options: &MergeOptions) -> Result<ExitCode, Failure> {
    let is_film = |out: &&PathBuf| matches!(OutputFormat::from_path(out), Ok(OutputFormat::Exr));
    let locks = options.out.iter().filter(is_film).map(|out| FileLock::take(out, FileLock::PATIENCE));
    let _locks = locks.collect::<Result<Vec<_>, _>>().map_err(Failure::input)?;
    let (sum, left_out) = add_up(options).map_err(Failure::Input)?;
    let missing = options.samples.map_or_else(Vec::new, |samples| missing(&sum, &left_out, samples));
    let wrote = write(options, &sum)?;

    let (samples, from) = (sum.film().samples(), counted(sum.parts().len() as u64, "film"));
    let mut lines = vec![format!("{} per pixel ({samples}) from {from}", counted(samples.count(), "sample"))];
    lines.extend(left_out.iter().map(|(_, reason)| format!("left out: {reason:#}")));
    if let Some(all) = options.samples.filter(|_| !missing.is_empty()) {
        let count = missing.iter().map(|(range, _)| range.end - range.start).sum();
        lines.push(format!("{} of {all} per pixel missing; to render them:", counted(count, "sample")));
        lines.extend(missing.iter().map(|(range, film)| command(&options.program, range, film)));
    }
    print(&(lines.join("\n") + "\n" + &wrote)).map_err(Failure::Run)?;
    Ok(if missing.is_empty() { ExitCode::SUCCESS } else { ExitCode::from(FAILED) })
}

/// A film that does not fit or cannot be read, and why.
type LeftOut<'a> = (&'a Path, anyhow::Error);

/// Adds the films up. Only with `--samples` are films left out.
fn add_up(options: &MergeOptions) -> anyhow::Result<(FilmSum, Vec<LeftOut<'_>>)> {
    let heads = options.films.iter().filter_map(|film| checkpoint::read_head(film).ok());
    let film = heads.map(|head| Film::bytes(head.width, head.height)).max().unwrap_or(0);
    let count = options.films.len().min(2) as u64;
    let denoising = if options.denoise { denoise::BYTES_PER_PIXEL } else { 0 };
    let bytes = film * count + film / Film::bytes(1, 1) * denoising;
    memory::check(|| "merging these films".to_owned(), bytes, "merge them on a larger machine")?;
    let (mut sum, mut left_out) = (None::<FilmSum>, Vec::new());
    for film in &options.films {
        let added = match &mut sum {
            Some(sum) => sum.add(film, same_job),
            None => FilmSum::read(film).map(|first| sum = Some(first)).map_err(Into::into),
        };
        match added {
            Err(reason) if options.samples.is_some() => left_out.push((film.as_path(), reason)),
            added => added?,
        }
    }
    let Some(sum) = sum else {
        let reasons: Vec<String> = left_out.iter().map(|(_, reason)| format!("{reason:#}")).collect();
        bail!("no film can be read: {}", reasons.join("; "));
    };
    Ok((sum, left_out))
}

/// The missing samples up to `end`, and for each range the film to continue: the last one that begins there or before,
/// or the first.
fn missing(sum: &FilmSum, left_out: &[LeftOut], end: u64) -> Vec<(Range<u64>, PathBuf)> {
    let mut films: Vec<(PathBuf, SampleRanges)> = sum.parts().to_vec();
    // The head of a damaged film may be whole.
    films.extend(left_out.iter().filter_map(|(path, reason)| {
        let is_damaged = matches!(reason.downcast_ref()?, CheckpointError::Damaged { .. });
        let head = checkpoint::read_head(path).ok().filter(|_| is_damaged)?;
        same_job(sum.description().recipe(), head.description.recipe()).ok()?;
        Some((path.to_path_buf(), head.samples))
    }));
    let mut starts: Vec<(u64, &PathBuf)> = vec![(0, &sum.parts()[0].0)];
    starts.extend(
        films.iter().flat_map(|(path, samples)| samples.iter().map(move |range| (range.start, path))),
    );
    starts.sort_by_key(|(start, _)| *start);
    let (mut found, mut from) = (Vec::new(), 0);
    while let Some(gap) = sum.film().samples().first_gap(from..end, u64::MAX) {
        let next = starts.partition_point(|(start, _)| *start <= gap.start);
        from = starts.get(next).map_or(gap.end, |(start, _)| gap.end.min(*start));
        found.push((gap.start..from, starts[next - 1].1.clone()));
    }
    found
}

/// Writes the sum, and returns a line for each file. Warns of samples that are lost because it replaces a film that has
/// others.
fn write(options: &MergeOptions, sum: &FilmSum) -> Result<String, Failure> {
    let (out, film, mut description) = (&options.out, sum.film(), sum.description());
    description.set(key::COMMAND, &options.command);
    let recipe = file::parse(description.recipe(), "the films' recipe").map_err(Failure::input)?;
    let is_kept = |samples: &SampleRanges| film.samples().contains(samples);
    for out in out {
        let found = Replaced::at(out, description.recipe());
        if let Some(warning) = found.and_then(|found| found.warning(out, is_kept)) {
            console::note(&format!("warning: {warning}"));
        }
    }
    let denoised = denoised(film, options.denoise, |reason| console::note(&format!("warning: {reason}")));
    if let Some(denoised) = &denoised {
        description.set(key::DENOISED, denoised.error.words());
    }
    let (transfer, denoised) = (recipe.rules.transfer, denoised.map(|denoised| denoised.film));
    for out in out {
        OutputFormat::from_path(out)
            .and_then(|format| write_image_as(out, format, (film, denoised.as_ref()), transfer, &description))
            .map_err(Failure::Run)?;
    }
    Ok(out.iter().map(|out| format!("wrote {}\n", out.shown())).collect())
}

/// The command that adds samples to a film, or renders them again if it is damaged.
fn command(program: &str, Range { start, end }: &Range<u64>, film: &Path) -> String {
    let [range, mut checkpoint] =
        [format!("--sample-range={start}..{end}"), "--checkpoint=".to_owned()].map(OsString::from);
    checkpoint.push(film);
    let words = [program.into(), "--batch".into(), range, checkpoint, "--continue".into()];
    shell::line(words)
}
