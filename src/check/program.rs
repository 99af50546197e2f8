//! `weekender check`: reads the picture, prints the finding, writes the pictures.

use super::judge::{Finding, judge};
use super::likeness::stages;
use super::picture::Mine;
use super::views::pictures;
use super::words::{FindingJson, text};
use crate::cli::{CheckOptions, JsonTarget};
use crate::failure::{FAILED, Failure};
use crate::files::{check_writable, replace_file};
use crate::terminal::{print_beside, write_json};
use anyhow::{Context, Result, bail};
use image::{ImageFormat, RgbImage};
use std::fs;
use std::io::{self, Cursor, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Names of the pictures that `--out` writes.
pub const FILES: [&str; 3] = ["mine.png", "ours.png", "difference.png"];

/// Checks a picture. The exit code is 0 if it is right and 1 if there is a mistake.
///
/// # Errors
/// [`Failure::Input`] if it could not be checked.
pub fn run(options: &CheckOptions) -> Result<ExitCode, Failure> {
    checked(options).map_err(Failure::Input)
}

fn checked(options: &CheckOptions) -> Result<ExitCode> {
    if let Some(stage) = options.stage
        && !stages().any(|known| known == stage)
    {
        bail!(
            "{} cannot be checked: its small spheres are placed at random, so every program's picture of it is another; \
             check an earlier section, such as --stage defocus",
            stage.id
        );
    }
    if let Some(JsonTarget::File(path)) = &options.json {
        check_writable(path)?;
    }
    if let Some(directory) = &options.out {
        fs::create_dir_all(directory).with_context(|| {
            format!("cannot create the directory {}; choose another with --out", directory.display())
        })?;
        for name in FILES {
            check_writable(&directory.join(name))?;
        }
    }
    let mine = Mine::read(&options.picture)?;
    let finding = judge(&mine, options.stage)?;
    let files = match &options.out {
        Some(directory) => write_pictures(directory, &mine, &finding)?,
        None => Vec::new(),
    };
    print_beside(options.json.as_ref(), &text(&options.picture, &mine, &finding, &files))?;
    if let Some(target) = &options.json {
        write_json(&FindingJson::new(&options.picture, &mine, &finding, &files), target)?;
    }
    let is_right = finding.is_right() && mine.damages.is_empty();
    Ok(if is_right { ExitCode::SUCCESS } else { ExitCode::from(FAILED) })
}

/// Writes mine, ours and their difference, and returns the files.
fn write_pictures(directory: &Path, mine: &Mine, finding: &Finding) -> Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for (name, pixels) in FILES.into_iter().zip(pictures(mine, finding)) {
        let path = directory.join(name);
        let image = RgbImage::from_raw(mine.width, mine.height, pixels.into_iter().flatten().collect());
        let image = image.context("a picture has another size than its pixels")?;
        let mut png = Cursor::new(Vec::new());
        image.write_to(&mut png, ImageFormat::Png).map_err(io::Error::other)?;
        replace_file(&path, |writer| writer.write_all(png.get_ref()))?;
        files.push(path);
    }
    Ok(files)
}
