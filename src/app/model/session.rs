//! What a window shows, as text: the next window can show it again.

use super::checked::CheckedScene;
use super::document::Document;
use super::framing::Framing;
use super::kept_view::{KeptView, ShownSlots};
use super::origin::{Origin, Source};
use super::view::ViewState;
use crate::job::recipe::{Recipe, file};
use crate::measure::stress::shown_cases;
use crate::progressive::Stop;
use crate::progressive::describe::SOFTWARE;
use crate::scene::Scene;
use crate::stages::Stage;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use std::sync::Arc;

/// The most spheres whose text is kept. More are kept only if the origin says what they are.
pub const SPHERES_LIMIT: usize = 50_000;

/// The label of texts in messages.
const LABEL: &str = "what was kept of the last window";

/// Origin, changes and view of a picture, without its samples.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Session {
    /// The program that wrote this.
    pub software: String,
    /// The name of the picture in the window.
    pub title: String,
    /// Camera, settings or spheres differ from those of the origin.
    pub is_changed: bool,
    /// The film that is kept beside this is of this picture.
    pub has_film: bool,
    origin: KeptOrigin,
    /// A scene file with camera and settings, and with the scene if that was changed.
    recipe: String,
    has_changed_scene: bool,
    has_own_size: bool,
    samples: Option<u64>,
    seconds: Option<f64>,
    noise: Option<f64>,
    is_paused: bool,
    /// A [`KeptView`]. A view that another version of the program does not know costs only the view.
    view: serde_json::Value,
    framing: Option<Framing>,
}

/// An [`Origin`] as text.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
enum KeptOrigin {
    #[default]
    None,
    Stage(String),
    Builtin(String),
    Extreme(String),
    File {
        path: Option<PathBuf>,
        name: String,
        recipe: Option<String>,
    },
    Recipe {
        name: String,
        recipe: String,
    },
    /// Too many spheres to be kept.
    TooLarge {
        spheres: usize,
    },
}

/// A session that can be shown again.
#[derive(Debug)]
pub struct Restored {
    /// The picture.
    pub document: Document,
    /// How it is shown.
    pub view: ViewState,
    /// The slots that were shown, once their pictures are there.
    pub slots: ShownSlots,
    /// Zoom and pan, unless the whole picture was shown.
    pub framing: Option<Framing>,
    /// Whether tracing was paused.
    pub is_paused: bool,
    /// What could not be restored, in words.
    pub note: Option<String>,
}

impl Session {
    /// What a window with this picture and view shows. Takes seconds for a scene of many spheres.
    pub fn of(document: &Document, view: &ViewState, is_paused: bool) -> Self {
        let origin = &document.origin;
        let Stop { samples, seconds, noise } = document.stop;
        let has_changed_scene = document.has_changed_scene();
        let is_large = |scene: &Scene| scene.spheres.len() > SPHERES_LIMIT;
        let text_of = |recipe: &Recipe| (!is_large(&recipe.scene)).then(|| file::to_picture_toml(recipe));
        let too_large = |scene: &Scene| KeptOrigin::TooLarge { spheres: scene.spheres.len() };
        let name = origin.recipe.name.clone();
        let kept = match &origin.source {
            _ if has_changed_scene && is_large(document.scene()) => too_large(document.scene()),
            Source::Stage(stage) => KeptOrigin::Stage(stage.id.to_owned()),
            Source::Builtin => KeptOrigin::Builtin(name),
            Source::Extreme(case) => KeptOrigin::Extreme(case.id.clone()),
            Source::File(path) => {
                // JSON has no place for a path that is not Unicode.
                let path = std::path::absolute(path).ok().filter(|path| path.to_str().is_some());
                match (path, text_of(&origin.recipe)) {
                    (None, None) => too_large(&origin.recipe.scene),
                    (path, recipe) => KeptOrigin::File { path, name, recipe },
                }
            }
            Source::ByTheBook | Source::Embedded => match text_of(&origin.recipe) {
                Some(recipe) => KeptOrigin::Recipe { name, recipe },
                None => too_large(&origin.recipe.scene),
            },
        };
        let mut recipe = Recipe { camera: document.camera, keyframes: Vec::new(), ..document.recipe() };
        if !has_changed_scene || is_large(&recipe.scene) {
            recipe.scene = Arc::default();
        }
        Session {
            software: SOFTWARE.to_owned(),
            title: document.title(),
            is_changed: document.is_changed(),
            has_film: false,
            origin: kept,
            recipe: file::to_toml(&recipe),
            has_changed_scene,
            has_own_size: document.has_own_size,
            samples,
            seconds,
            noise,
            is_paused,
            view: serde_json::to_value(KeptView::of(view)).unwrap_or_default(),
            framing: None,
        }
    }

    /// The same, with or without a film beside it.
    pub fn with_film(self, has_film: bool) -> Self {
        Session { has_film, ..self }
    }

    /// The same with zoom and pan.
    pub fn with_framing(self, framing: Option<Framing>) -> Self {
        Session { framing, ..self }
    }

    /// Makes the picture and the view again.
    ///
    /// # Errors
    /// Why that is impossible, in words.
    pub fn restore(&self) -> Result<Restored, String> {
        let (origin, note) = self.origin.origin(&self.software)?;
        let changes = parse(&self.recipe)?;
        let mut document = Document::new(origin);
        document.camera = changes.camera;
        (document.settings, document.has_own_size) = (changes.settings, self.has_own_size);
        document.stop = Stop { samples: self.samples, seconds: self.seconds, noise: self.noise };
        if self.has_changed_scene && changes.scene != document.origin.recipe.scene {
            let checked = CheckedScene::new(changes.scene, *document.rules());
            checked.check().map_err(|error| error.to_string())?;
            document.checked = Arc::new(checked);
        }
        document.job(1).map_err(|error| error.to_string())?;
        let view: KeptView = serde_json::from_value(self.view.clone()).unwrap_or_default();
        let slots = view.slots();
        let view = view.view(document.size());
        let framing = self.framing.filter(|framing| framing.is_of(document.size()));
        Ok(Restored { document, view, slots, framing, is_paused: self.is_paused, note })
    }

    /// The document of a film that was kept with this, whose file has `recipe` and `stage`. What is noted here counts as far
    /// as it is of the same samples: a scene file may have been changed since.
    pub fn document_of_film(&self, recipe: &Recipe, stage: Option<&'static Stage>) -> Document {
        let is_of_film = |document: &Document| match (document.job(1), recipe.job()) {
            (Ok(mine), Ok(theirs)) => mine == theirs,
            _ => false,
        };
        if let Some(document) = self.restore().ok().map(|found| found.document).filter(is_of_film) {
            return document;
        }
        let stop = Stop { samples: self.samples, seconds: self.seconds, noise: self.noise };
        let document = Document::of_film(recipe, stage);
        if self.software.is_empty() {
            return document;
        }
        Document { stop, has_own_size: self.has_own_size, ..document }
    }
}

impl KeptOrigin {
    /// The origin, and what is different about it.
    fn origin(&self, software: &str) -> Result<(Origin, Option<String>), String> {
        let of_text = |name: &str, text: &str| {
            parse(text)
                .map(|recipe| Origin::new(Recipe { name: name.to_owned(), ..recipe }, Source::Embedded))
        };
        let unknown = |kind: &str, name: &str| {
            format!("{software} showed the {kind} {name:?}, which {SOFTWARE} does not have")
        };
        let origin = match self {
            KeptOrigin::None => return Err(format!("what {software} wrote names no picture")),
            KeptOrigin::Stage(id) => Origin::of_stage(Stage::find(id).map_err(|_| unknown("stage", id))?),
            KeptOrigin::Builtin(name) => {
                Origin::new(Recipe::find(name).map_err(|error| error.to_string())?, Source::Builtin)
            }
            KeptOrigin::Extreme(id) => {
                let case = shown_cases().iter().find(|case| case.id == *id);
                Origin::of_case(case.ok_or_else(|| unknown("extreme scene", id))?)
            }
            KeptOrigin::File { path: Some(path), name, recipe } => match (file::load(path), recipe) {
                (Ok(recipe), _) => Origin::new(recipe, Source::File(path.clone())),
                (Err(error), Some(text)) => {
                    return Ok((of_text(name, text)?, Some(format!("{error}; this is the scene as it was"))));
                }
                (Err(error), None) => return Err(error.to_string()),
            },
            KeptOrigin::File { path: None, name, recipe: Some(text) }
            | KeptOrigin::Recipe { name, recipe: text } => of_text(name, text)?,
            KeptOrigin::File { path: None, recipe: None, .. } => {
                return Err("the path of its scene file could not be kept".to_owned());
            }
            KeptOrigin::TooLarge { spheres } => {
                return Err(format!(
                    "its {spheres} spheres are in no file, and no more than {SPHERES_LIMIT} are kept; save the scene \
                     file of such a scene"
                ));
            }
        };
        Ok((origin, None))
    }
}

fn parse(text: &str) -> Result<Recipe, String> {
    file::parse(text, LABEL).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests;
