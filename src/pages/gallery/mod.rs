//! Figures: the book's stages as pictures with captions, alone or side by side. `weekender gallery` renders them into a
//! directory with a page.

mod page;
mod rendering;
mod still;

pub use rendering::{Order, Outcome, Work};
pub use still::has_few_pixels;

use crate::cli::GalleryOptions;
use crate::stages::Stage;
use crate::system::failure::Failure;
use crate::system::files::write_text;
use crate::system::interrupt::Interrupt;
use crate::system::suggest::{or_nearest, similar_names};
use anyhow::{Result, bail};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::process::ExitCode;
use std::sync::LazyLock;
use still::stills_in;

/// One or more pictures with a caption.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Figure {
    /// The identifier in pages and on the command line. It never changes.
    pub id: String,
    pub title: String,
    /// One or two sentences.
    pub caption: String,
    /// Left to right, at least one.
    pub panels: Vec<Panel>,
}

/// One picture of a figure.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Panel {
    #[serde(rename = "stage")]
    stage_id: String,
    /// A few words that distinguish the picture from its neighbours.
    pub label: String,
}

impl Figure {
    /// All figures in the book's order. Every stage is in at least one.
    pub fn all() -> &'static [Figure] {
        static ALL: LazyLock<Vec<Figure>> = LazyLock::new(|| {
            // A test finds the figures of every stage.
            let text = include_str!("../../../assets/gallery/figures.toml");
            toml::from_str(text)
                .map(|mut file: BTreeMap<String, _>| file.remove("figure").unwrap_or_default())
                .unwrap_or_default()
        });
        &ALL
    }

    pub fn find(id: &str) -> Option<&'static Figure> {
        Self::all().iter().find(|figure| figure.id == id)
    }

    /// The stage whose section the figure belongs to: its latest.
    pub fn stage(&self) -> &'static Stage {
        let latest = self.panels.iter().map(Panel::stage).max_by_key(|stage| stage.index());
        latest.unwrap_or(&Stage::ALL[0])
    }
}

impl Panel {
    /// The stage shown.
    pub fn stage(&self) -> &'static Stage {
        // A test finds the stage of every panel.
        Stage::find(&self.stage_id).unwrap_or(&Stage::ALL[0])
    }
}

/// Renders missing stills and writes the page. [`Failure::Input`] if nothing was rendered, [`Failure::BrokeOff`] or
/// [`Failure::Run`] otherwise.
pub fn run(options: &GalleryOptions) -> Result<ExitCode, Failure> {
    let stages = chosen(&options.only).map_err(Failure::Input)?;
    let index = options.out.join("index.html");
    let interrupt = Interrupt::install().map_err(Failure::Run)?;
    let order = Order {
        directory: &options.out,
        page: &index,
        stages: &stages,
        is_quick: options.quick,
        backend: &options.backend,
        progress: options.progress,
        prints_stills: true,
    };
    let outcome = Work::begin(&order, &interrupt)?.render()?;
    write_text(&index, &page::page(&stills_in(&options.out))).map_err(Failure::run)?;
    outcome.report(&index, &interrupt)
}

/// The stages with these figure or stage ids, in the book's order; all stages if no ids are given.
fn chosen(ids: &[String]) -> Result<Vec<&'static Stage>> {
    let mut chosen: Vec<&str> = Vec::new();
    for id in ids {
        let panels = Figure::find(id).map_or(&[][..], |figure| &figure.panels);
        let stages = panels.iter().map(Panel::stage).chain(Stage::find(id).ok());
        let before = chosen.len();
        chosen.extend(stages.map(|stage| stage.id));
        if chosen.len() == before {
            let ids = Figure::all().iter().map(|figure| figure.id.as_str());
            let mut near = similar_names(id, ids.chain(Stage::ALL.iter().map(|stage| stage.id)));
            near.dedup();
            bail!("--only names {id:?}, which is neither a figure nor a stage; {}", or_nearest(&near));
        }
    }
    Ok(Stage::ALL.iter().filter(|stage| ids.is_empty() || chosen.contains(&stage.id)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn figures_cover_every_stage_in_order() {
        let shown: HashSet<&str> = Figure::all()
            .iter()
            .flat_map(|figure| &figure.panels)
            .map(|panel| panel.stage_id.as_str())
            .collect();
        assert_eq!(shown, Stage::ALL.iter().map(|stage| stage.id).collect());
        let ids: HashSet<&str> = Figure::all().iter().map(|figure| figure.id.as_str()).collect();
        assert_eq!(ids.len(), Figure::all().len());
        assert!(Figure::all().is_sorted_by_key(|figure| figure.stage().index()));
        assert_eq!(Figure::find("gamma").map(|figure| figure.stage().id), Some("lambertian-gamma"));
    }

    #[test]
    fn figures_and_stages_can_be_chosen() {
        let ids = |only: &[&str]| {
            let only: Vec<String> = only.iter().map(|id| (*id).to_owned()).collect();
            chosen(&only).map(|stages| stages.iter().map(|stage| stage.id).collect::<Vec<_>>())
        };
        assert_eq!(ids(&[]).unwrap().len(), Stage::ALL.len());
        assert_eq!(ids(&["book", "fuzz", "metal"]).unwrap(), ["metal", "metal-fuzzy", "book"]);
        assert_eq!(ids(&["aliased"]).unwrap(), ["aliased"]);
        let message = ids(&["hollow"]).unwrap_err().to_string();
        assert!(
            message.contains("\"hollow\"") && message.contains("did you mean hollow-glass?"),
            "{message}"
        );
    }
}
