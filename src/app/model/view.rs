//! The view in the viewport: a view of the film, or a comparison with another picture.

use super::{CheckedScene, Document, Kept, KeptList, Origin, Show, Tone};
use crate::denoise::Denoised;
use crate::job::recipe::Recipe;
use crate::progressive::{ReferenceMeans, Stop, View};
use crate::stages::Stage;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// How two pictures are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// The pictures are on the two sides of a divider.
    Wipe,
    /// A heat map of the difference.
    Difference,
}

/// The kind of picture to compare with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum With {
    /// The stage that belongs to this one; without a stage, the book's own arithmetic.
    #[default]
    Stage,
    /// The book's own arithmetic, even if there is another stage to compare with.
    Book,
    /// The chosen kept picture.
    Kept,
}

/// The picture that is traced for comparison with the main picture.
#[derive(Clone)]
pub enum Other {
    /// Another stage.
    Stage(&'static Stage),
    /// The same picture, with its scene as edited, by the book's own arithmetic.
    ByTheBook(Arc<Origin>, Arc<CheckedScene>),
}

impl PartialEq for Other {
    /// Origins and scenes are immutable, so comparing their addresses is enough.
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Other::Stage(a), Other::Stage(b)) => a == b,
            (Other::ByTheBook(a, of_a), Other::ByTheBook(b, of_b)) => {
                Arc::ptr_eq(a, b) && Arc::ptr_eq(of_a, of_b)
            }
            _ => false,
        }
    }
}

impl Other {
    /// The origin of the other picture.
    pub fn origin(&self) -> Origin {
        match self {
            Other::Stage(stage) => Origin::of_stage(stage),
            Other::ByTheBook(mine, scene) => mine.by_the_book(scene),
        }
    }
}

/// The denoised picture of a run's film, or why there is none.
pub type Found = (u64, Result<Arc<Denoised>, String>);

/// The current view, which is exactly one.
#[derive(Clone, Default, Serialize, Deserialize)]
pub struct ViewState {
    show: Show,
    #[serde(skip)]
    mode: Option<Mode>,
    #[serde(skip)]
    with: With,
    /// Position of the wipe's divider, `0..=1` of the picture's width.
    #[serde(skip)]
    pub divider: f32,
    /// How bright the picture is shown.
    pub tone: Tone,
    /// Whether the picture is denoised.
    pub is_denoised: bool,
    /// The latest denoised picture.
    #[serde(skip)]
    pub denoised: Option<Found>,
    /// Pictures that are kept.
    #[serde(skip)]
    pub kept: KeptList,
}

impl ViewState {
    /// The current view of the film.
    pub fn show(&self) -> Show {
        self.show
    }

    /// The comparison mode, if two pictures are compared.
    pub fn mode(&self) -> Option<Mode> {
        self.mode
    }

    /// The kind of picture to compare with. Without a comparison it is the stage.
    pub fn with(&self) -> With {
        self.with
    }

    /// The kept picture that this one is compared with, if it is.
    pub fn compared_kept(&self) -> Option<&Arc<Kept>> {
        self.kept.meant().filter(|_| self.mode.is_some() && self.with == With::Kept)
    }

    /// Keeps a picture, and chooses it unless another one is compared with. Returns its place.
    pub fn keep(&mut self, kept: Kept) -> usize {
        let place = self.kept.add(kept);
        if self.compared_kept().is_none() {
            self.kept.choose(place);
        }
        place
    }

    /// Shows only this view of the film.
    pub fn choose(&mut self, show: Show) {
        self.end_comparison();
        self.show = show;
    }

    /// Returns from another view of the film to the picture. A comparison continues.
    pub fn leave_show(&mut self) {
        self.show = Show::Picture;
    }

    /// Starts a comparison, or ends it if it is already active.
    pub fn toggle(&mut self, mode: Mode, with: With) {
        let is_on = self.mode == Some(mode) && self.with == with && self.looked().is_none();
        self.show = Show::Picture;
        (self.mode, self.with) = if is_on { (None, With::Stage) } else { (Some(mode), with) };
        self.divider = 0.5;
    }

    /// Shows a kept picture in place of the traced one: a wipe whose divider is at the right edge.
    pub fn look(&mut self, place: usize) {
        self.kept.choose(place);
        (self.mode, self.with, self.show) = (Some(Mode::Wipe), With::Kept, Show::Picture);
        self.divider = 1.0;
    }

    /// The place of the kept picture that hides the traced one.
    pub fn looked(&self) -> Option<usize> {
        let is_hidden = self.mode == Some(Mode::Wipe) && self.with == With::Kept && self.divider == 1.0;
        self.kept.chosen().filter(|_| is_hidden)
    }

    /// Shows the traced picture, if a kept one hides it.
    pub fn end_look(&mut self) {
        if self.looked().is_some() {
            self.end_comparison();
        }
    }

    /// Shows the traced picture and the chosen kept one in turn.
    pub fn flip(&mut self) {
        match self.kept.chosen() {
            Some(place) if self.looked().is_none() => self.look(place),
            _ => self.end_look(),
        }
    }

    /// Deletes the chosen kept picture. A comparison with it ends.
    pub fn delete_kept(&mut self) {
        let Some(place) = self.kept.chosen() else { return };
        if self.with == With::Kept {
            self.end_comparison();
        }
        self.kept.delete(place);
    }

    /// Ends the comparison. The next one does not begin with its picture.
    pub fn end_comparison(&mut self) {
        (self.mode, self.with) = (None, With::Stage);
    }

    /// The view for resolving the film of this run, or its denoised picture; `other` is the film of the second picture, once
    /// there is one.
    pub fn of_film(&self, run: u64, other: Option<&Arc<ReferenceMeans>>) -> View {
        let view = match (self.mode, other) {
            (Some(Mode::Difference), Some(other)) => View::Difference(Arc::clone(other)),
            _ => self.show.of_film(&self.tone),
        };
        match self.denoised_of(run) {
            Some(denoised) if !matches!(view, View::Occupancy) => {
                View::Denoised(Arc::clone(denoised), Box::new(view))
            }
            _ => view,
        }
    }

    /// The denoised picture of a run's film, if it is to be shown.
    pub fn denoised_of(&self, run: u64) -> Option<&Arc<Denoised>> {
        match &self.denoised {
            Some((of, Ok(denoised))) if self.is_denoised && *of == run => Some(denoised),
            _ => None,
        }
    }

    /// When the render of this run ends that should end at `stop`: as soon as the picture that is shown has the error of
    /// its goal.
    pub fn stop(&self, run: u64, stop: Stop) -> Stop {
        let reached = self.denoised_of(run).zip(stop.noise);
        match reached.filter(|(denoised, goal)| denoised.error.rmse() <= *goal) {
            Some((denoised, _)) => Stop { samples: Some(denoised.film.sample_count()), ..stop },
            None => stop,
        }
    }

    /// The picture that is traced for comparison with `document`.
    pub fn compared(&self, document: &Document) -> Option<Other> {
        let origin = &document.origin;
        let by_the_book = || Other::ByTheBook(Arc::clone(origin), Arc::clone(&document.checked));
        match (self.mode?, self.with, document.stage()) {
            (_, With::Kept, _) => None,
            (_, With::Stage, Some(stage)) => partner(stage).map(Other::Stage),
            _ => origin.is_other_by_the_book().then(by_the_book),
        }
    }
}

/// The stage that `stage` is compared with, if one teaches something.
pub fn partner(stage: &Stage) -> Option<&'static Stage> {
    Stage::find(stage.pair?).ok()
}

/// Whether the recipes differ only in their cameras.
pub fn differ_in_camera(a: &Recipe, b: &Recipe) -> bool {
    a.camera != b.camera && a.rules == b.rules && a.scene == b.scene
}
