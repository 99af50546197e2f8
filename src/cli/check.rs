//! The flags of `weekender check` and their validation.

use super::error::CliError;
use super::paths::Paths;
use super::values::JsonTarget;
use crate::stages::Stage;
use clap::Args;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(super) struct RawCheck {
    /// The picture that your own program has written: PPM (P3 or P6) or PNG, of any shape, from 16 x 9 to 4 million
    /// pixels
    #[arg(value_name = "PICTURE")]
    pub picture: PathBuf,
    /// The stage of the book that it shows [default: the one that it looks like]
    #[arg(long, value_name = "ID")]
    pub stage: Option<String>,
    /// Write mine.png, ours.png and difference.png to this directory
    #[arg(long, value_name = "DIRECTORY")]
    pub out: Option<PathBuf>,
    /// Write the finding as JSON; - for standard output
    #[arg(long, value_name = "FILE|-")]
    pub json: Option<PathBuf>,
}

/// Options of `weekender check`.
#[derive(Clone, Debug)]
pub struct CheckOptions {
    /// The picture.
    pub picture: PathBuf,
    /// The stage that it shows, if given.
    pub stage: Option<&'static Stage>,
    /// Directory for the pictures.
    pub out: Option<PathBuf>,
    /// Where the JSON is written.
    pub json: Option<JsonTarget>,
}

/// Validates the flags of `weekender check`.
pub(super) fn check(raw: RawCheck) -> Result<CheckOptions, CliError> {
    let stage = raw.stage.as_deref().map(Stage::find).transpose()?;
    let json = raw.json.map(JsonTarget::from);
    let pictures = ["mine.png", "ours.png", "difference.png"];
    let pictures = raw.out.iter().flat_map(|out| pictures.map(|name| out.join(name)));
    pictures
        .fold(Paths::default(), |paths, picture| paths.write("a file of --out,", Some(&picture)))
        .read("the picture to check", Some(&raw.picture))
        .write_json(json.as_ref())
        .check(&[])?;
    Ok(CheckOptions { picture: raw.picture, stage, out: raw.out, json })
}
