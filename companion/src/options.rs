//! The command line.

use crate::figure::{FIGURES, Figure};
use crate::picture::Picture;
use clap::Parser;
use clap::builder::PossibleValuesParser;
use std::path::PathBuf;
use weekender::cli::BackendFlags;
use weekender::stages::Stage;
use weekender::system::terminal::ProgressChoice;

/// Writes the companion: a web page that follows the book in pictures, in code and live
///
/// The page is index.html in the directory --out, with its figures beside it. It needs no server and no network. Its
/// texts, styles and scripts are those of the checkout. Only figures that changed are rendered again.
#[derive(Clone, Debug, Parser)]
#[command(version)]
pub struct Options {
    /// Write index.html and its figures to this directory
    #[arg(long, value_name = "DIRECTORY", default_value = "target/companion")]
    pub out: PathBuf,
    /// Small figures with some noise, within a minute; finished full ones are kept
    #[arg(long)]
    pub quick: bool,
    /// Render only these figures or stages, and write no page
    #[arg(long, value_name = "ID,...", value_delimiter = ',', value_parser = ids(), hide_possible_values = true)]
    pub only: Vec<String>,
    /// Show progress on standard error; auto: if it is a terminal
    #[arg(long, value_enum, default_value = "auto")]
    pub progress: ProgressChoice,
    #[command(flatten)]
    pub backend: BackendFlags,
}

impl Options {
    /// The file or folder for a reader to open.
    pub fn made(&self) -> PathBuf {
        self.out.join(if self.only.is_empty() { "index.html" } else { "figures" })
    }

    /// The stills to render, in the book's order.
    pub fn stills(&self) -> Vec<Picture> {
        let shows = |id: &str, stage: &Stage| Figure::find(id).is_some_and(|figure| figure.shows(stage.id));
        let is_named = |stage: &Stage| self.only.iter().any(|id| stage.id == id || shows(id, stage));
        let chosen = Stage::ALL.iter().filter(|stage| self.only.is_empty() || is_named(stage));
        chosen.map(|stage| Picture::still(stage, self.quick)).collect()
    }
}

/// The ids of all figures and stages.
fn ids() -> PossibleValuesParser {
    let figures = FIGURES.iter().map(|figure| figure.id.as_str());
    PossibleValuesParser::new(figures.chain(Stage::ALL.iter().map(|stage| stage.id)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_and_stages_can_be_chosen() {
        let stages = |only: &[&str]| {
            let options = Options::try_parse_from([&["companion"], only].concat());
            options.map(|options| options.stills().iter().map(|picture| picture.stage.id).collect::<Vec<_>>())
        };
        assert_eq!(stages(&[]).unwrap().len(), Stage::ALL.len());
        assert_eq!(stages(&["--only", "book,fuzz,metal"]).unwrap(), ["metal", "metal-fuzzy", "book"]);
        assert_eq!(stages(&["--only", "aliased"]).unwrap(), ["aliased"]);
        let message = stages(&["--only", "shadow-akne"]).unwrap_err().to_string();
        assert!(message.contains("shadow-acne"), "{message}");
    }
}
