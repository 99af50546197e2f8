//! Renders the pictures that are missing, damaged, or made from other settings or by another tracer.

use crate::options::Options;
use crate::picture::{FOLDER, Picture, Tracer};
use anyhow::{Context, Result, bail};
use image::RgbImage;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::imageops::crop_imm;
use std::io::Write as _;
use std::path::Path;
use std::process::ExitCode;
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use weekender::batch::Studio;
use weekender::comparison::check::{self, Hypothesis, Mistake};
use weekender::denoise;
use weekender::job::output::write_small_png;
use weekender::progressive::describe::{counted, describe};
use weekender::progressive::{Phase, Progressive, Status};
use weekender::system::console;
use weekender::system::failure::Failure;
use weekender::system::files::{check_writable, make_directory, replace_file};
use weekender::system::interrupt::Interrupt;
use weekender::system::terminal::{Display, print};

/// Interval of progress lines without a terminal.
const LINE_INTERVAL: Duration = Duration::from_secs(5);

/// The progress bar, which counts paths.
const TEMPLATE: &str = "[{bar:24}] {eta} left, {wide_msg}";

#[derive(Debug)]
pub struct Outcome {
    /// How many were rendered.
    pub rendered: usize,
    /// How many were up to date.
    pub kept: usize,
    /// How many are missing because of a signal.
    pub missing: usize,
}

impl Outcome {
    /// Reports what was done, and where the result is or how to continue.
    pub fn report(&self, options: &Options, interrupt: &Interrupt) -> Result<ExitCode, Failure> {
        if self.missing > 0 {
            let missing = counted(self.missing as u64, "picture");
            console::note(&format!("interrupted: {missing} missing; run the same command again to continue"));
            return Ok(interrupt.exit_code());
        }
        let rendered = counted(self.rendered as u64, "picture");
        print(&format!("{rendered} rendered, {} unchanged\nopen {}\n", self.kept, options.made().display()))
            .map_err(Failure::Run)?;
        Ok(ExitCode::SUCCESS)
    }
}

/// Checks everything that may be refused, and only then makes the directory and calls `write_page`. Then renders the
/// pictures that are not up to date, and writes each as soon as it is finished. Ctrl-C drops the picture in progress.
///
/// # Errors
/// [`Failure::Input`] if a picture cannot be rendered or written; later [`Failure::Run`], or [`Failure::BrokeOff`] if some
/// are finished, which are kept.
pub fn render(
    options: &Options,
    interrupt: &Interrupt,
    mut pictures: Vec<Picture>,
    write_page: impl FnOnce() -> Result<(), Failure>,
) -> Result<Outcome, Failure> {
    let all = pictures.len();
    pictures.retain(|picture| !picture.is_done(&options.out));
    for picture in &pictures {
        picture.recipe.job().map_err(Failure::input)?.check_memory(1, 0).map_err(Failure::input)?;
    }
    let backend = options.backend.choice().map_err(Failure::input)?;
    let mut studio = Studio::open(&backend, interrupt)?;
    make_directory(&options.out.join(FOLDER)).map_err(Failure::Input)?;
    let mut paths = pictures.iter().map(|picture| options.out.join(picture.file()));
    paths.try_for_each(|path| check_writable(&path)).map_err(Failure::input)?;
    write_page()?;
    let steps = pictures.iter().map(Picture::paths).sum();
    let mut display = Display::new(options.progress, steps, TEMPLATE, "", LINE_INTERVAL);
    let (mut rendered, mut before) = (0, 0);
    for picture in pictures.iter().take_while(|_| !interrupt.is_set()) {
        let (number, id, planned) = (rendered + 1, picture.stage.id, picture.recipe.samples_per_pixel);
        let path = options.out.join(picture.file());
        let mut warned = 0;
        let outcome = render_one(picture, &path, &mut studio, interrupt, |_, status| {
            status.messages.iter().skip(warned).for_each(|message| display.warn(message));
            warned = status.messages.len();
            let done = status.samples_per_pixel;
            display.update(before + done * picture.pixels(), || {
                format!("{number} of {}, {id}: {done} of {planned} spp", pictures.len())
            });
        });
        match outcome {
            Ok(true) => rendered += 1,
            Ok(false) => break,
            Err(error) => {
                display.clear();
                let kept = format!("broke off; kept: {}", counted(rendered as u64, "picture"));
                return Err(match rendered {
                    0 => Failure::Run(error),
                    _ => Failure::BrokeOff(error.context(kept)),
                });
            }
        }
        before += picture.paths();
    }
    display.clear();
    Ok(Outcome { rendered, kept: all - pictures.len(), missing: pictures.len() - rendered })
}

/// Renders and writes a picture; `false` after a signal.
fn render_one(
    picture: &Picture,
    path: &Path,
    studio: &mut Studio<'_>,
    interrupt: &Interrupt,
    look: impl FnMut(&Progressive, &Status),
) -> Result<bool> {
    if let Tracer::Plain(mistake) = picture.tracer {
        write_part(path, picture, mistaken(picture, mistake)?)?;
        return Ok(true);
    }
    let recipe = &picture.recipe;
    let planned = recipe.samples_per_pixel;
    let (status, film) = studio.render(recipe.job()?, Studio::plan(planned), None, look);
    if let Phase::Failed(reason) = &status.phase {
        bail!("{}: {reason}", picture.stage.id);
    }
    let Some(film) = film.filter(|film| film.sample_count() >= planned) else { return Ok(false) };
    let _writing = interrupt.while_writing(path.display().to_string());
    let transfer = recipe.rules.transfer;
    if picture.is_still() {
        let description = describe(recipe, Some(picture.stage), &film, &status, Some(0.0));
        write_small_png(path, &film, transfer, &description)?;
    } else {
        // A few samples are to be seen as they are.
        let is_denoised = matches!(picture.tracer, Tracer::Denoised) && planned >= 16;
        let film = if is_denoised { denoise::of_film(&film)?.film } else { film };
        write_part(path, picture, film.to_rgb8(transfer))?;
    }
    Ok(true)
}

/// The bytes of a picture by the plain tracer, with or without a mistake.
fn mistaken(picture: &Picture, mistake: Option<&'static Mistake>) -> Result<Vec<u8>> {
    let settings = &picture.recipe.settings;
    let size = [settings.width, settings.height];
    let mut shown = Hypothesis::right(picture.stage, picture.recipe.clone(), size);
    if let Some(mistake) = mistake {
        shown = mistake.pictures(&shown).into_iter().next().context("a mistake without a picture")?;
    }
    let stop = AtomicBool::new(false);
    let linear = check::Studio::new(&stop)?.picture(&shown, picture.recipe.samples_per_pixel)?;
    let mut bytes = shown.written.bytes_of(&linear, size).concat();
    if shown.written.wraps {
        let values = bytes.iter_mut().zip(linear.as_flattened());
        values.filter(|(_, linear)| **linear >= 1.0).for_each(|(byte, _)| *byte = 0);
    }
    Ok(bytes)
}

/// Writes the part of a picture that is shown.
fn write_part(path: &Path, picture: &Picture, bytes: Vec<u8>) -> Result<()> {
    let [width, height] = [picture.recipe.settings.width, picture.recipe.settings.height];
    let whole = RgbImage::from_raw(width, height, bytes).context("too few bytes")?;
    let [left, top, width, height] = picture.part();
    let mut png = Vec::new();
    let encoder = PngEncoder::new_with_quality(&mut png, CompressionType::Best, FilterType::Adaptive);
    crop_imm(&whole, left, top, width, height).to_image().write_with_encoder(encoder)?;
    Ok(replace_file(path, |writer| writer.write_all(&png))?)
}
