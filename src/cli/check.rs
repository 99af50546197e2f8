//! The flags of `weekender check`.

use super::error::CliError;
use super::paths::Paths;
use super::values::JsonTarget;
use crate::stages::Stage;
use clap::Args;
use clap::builder::{PathBufValueParser, TypedValueParser};
use std::path::PathBuf;

#[derive(Clone, Debug, Args)]
pub struct CheckOptions {
    /// The picture that your own program has written: PPM (P3 or P6) or PNG, of any shape, from 16 x 9 to 4 million
    /// pixels
    #[arg(value_name = "PICTURE")]
    pub picture: PathBuf,
    /// The stage of the book that it shows [default: the one that it looks like]
    #[arg(long, value_name = "ID", value_parser = Stage::find)]
    pub stage: Option<&'static Stage>,
    /// Write mine.png, ours.png and difference.png to this directory
    #[arg(long, value_name = "DIRECTORY")]
    pub out: Option<PathBuf>,
    /// Write the finding as JSON; - for standard output
    #[arg(long, value_name = "FILE|-", value_parser = PathBufValueParser::new().map(JsonTarget::from))]
    pub json: Option<JsonTarget>,
}

impl CheckOptions {
    /// The files of `--out`: mine, ours and their difference.
    pub fn pictures(&self) -> Vec<PathBuf> {
        let names = ["mine.png", "ours.png", "difference.png"];
        self.out.iter().flat_map(|out| names.map(|name| out.join(name))).collect()
    }

    /// Refuses files that would replace the picture or each other.
    pub(super) fn checked(self) -> Result<Self, CliError> {
        self.pictures()
            .iter()
            .fold(Paths::default(), |paths, picture| paths.write("a file of --out,", Some(picture)))
            .read("the picture to check", Some(&self.picture))
            .write_json(self.json.as_ref())
            .check(&[])?;
        Ok(self)
    }
}
