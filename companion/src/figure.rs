//! Figures: the book's stages as pictures with captions, alone or side by side.

use serde::Deserialize;
use std::collections::BTreeMap;
use std::sync::LazyLock;
use weekender::stages::Stage;

/// One or more pictures with a caption.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Figure {
    /// The identifier in texts, addresses and on the command line. It never changes.
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

/// All figures in the book's order. Every stage is in at least one. A test finds them.
pub static FIGURES: LazyLock<Vec<Figure>> = LazyLock::new(|| {
    let file: Option<BTreeMap<String, _>> = toml::from_str(include_str!("../assets/figures.toml")).ok();
    file.and_then(|mut file| file.remove("figure")).unwrap_or_default()
});

impl Figure {
    pub fn find(id: &str) -> Option<&'static Figure> {
        FIGURES.iter().find(|figure| figure.id == id)
    }

    /// Whether the stage with this id is in the figure.
    pub fn shows(&self, stage: &str) -> bool {
        self.panels.iter().any(|panel| panel.stage_id == stage)
    }
}

impl Panel {
    /// The stage shown.
    pub fn stage(&self) -> &'static Stage {
        // A test finds the stage of every panel.
        Stage::find(&self.stage_id).unwrap_or(&Stage::ALL[0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn figures_cover_every_stage_in_order() {
        let panels = || FIGURES.iter().flat_map(|figure| &figure.panels);
        let shown: HashSet<&str> = panels().map(|panel| panel.stage_id.as_str()).collect();
        assert_eq!(shown, Stage::ALL.iter().map(|stage| stage.id).collect());
        let ids: HashSet<&str> = FIGURES.iter().map(|figure| figure.id.as_str()).collect();
        assert_eq!(ids.len(), FIGURES.len());
        let latest = |figure: &Figure| figure.panels.iter().map(|panel| panel.stage().index()).max();
        assert!(FIGURES.is_sorted_by_key(latest));
    }
}
