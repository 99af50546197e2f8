//! The view in the viewport: a view of the film, or a comparison with another picture.

use super::{Document, Kept, KeptList, Partner, Show, Tone};
use crate::denoise::Denoised;
use crate::progressive::{ReferenceMeans, Stop, View};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// How two pictures are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// The pictures are on the two sides of a divider.
    Wipe,
    /// The other picture hides this one.
    Flip,
    /// A heat map of the difference.
    Difference,
}

/// The denoised picture of a run's film, or why there is none.
pub type Found = (u64, Result<Arc<Denoised>, String>);

/// The current view, which is exactly one.
#[derive(Clone, Default, Serialize, Deserialize)]
pub struct ViewState {
    show: Show,
    #[serde(skip)]
    mode: Option<Mode>,
    /// The other picture of a comparison.
    #[serde(skip)]
    pub partner: Partner,
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

    /// The other picture if that of `document` is compared.
    pub fn partner(&self, document: &Document) -> Option<Partner> {
        match self.partner {
            Partner::Usual => Partner::usual(document),
            Partner::Kept(_) | Partner::Mine if self.kept_partner().is_none() => Partner::usual(document),
            chosen => Some(chosen),
        }
    }

    /// The other picture, if that of `document` is compared now.
    pub fn compared(&self, document: &Document) -> Option<Partner> {
        self.mode().and_then(|_| self.partner(document))
    }

    /// The picture that does not change which is compared with.
    pub fn kept_partner(&self) -> Option<&Arc<Kept>> {
        match self.partner {
            Partner::Kept(number) => self.kept.find(number),
            Partner::Mine => self.kept.mine.as_ref(),
            _ => None,
        }
    }

    /// Keeps a picture, to compare with unless another one is compared with.
    pub fn keep(&mut self, kept: Kept) -> Arc<Kept> {
        if self.mode.is_none() {
            self.partner = Partner::Kept(kept.number);
        }
        self.kept.add(kept)
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
    pub fn toggle(&mut self, mode: Mode) {
        self.show = Show::Picture;
        self.mode = (self.mode != Some(mode)).then_some(mode);
        self.divider = 0.5;
    }

    /// Compares with this partner.
    pub fn compare_with(&mut self, partner: Partner) {
        self.partner = partner;
        if self.mode.is_none() {
            self.toggle(Mode::Wipe);
        }
    }

    /// Whether the other picture hides the traced one.
    pub fn is_hidden(&self) -> bool {
        self.mode == Some(Mode::Flip)
    }

    /// Whether the other picture lies over this place, `0..=1` of the width.
    pub fn is_other(&self, x: f64) -> bool {
        self.is_hidden() || self.mode == Some(Mode::Wipe) && x < f64::from(self.divider)
    }

    /// Shows the traced picture, if another one hides it.
    pub fn end_look(&mut self) {
        if self.is_hidden() {
            self.end_comparison();
        }
    }

    /// Deletes the chosen kept picture. A comparison with it ends.
    pub fn delete_kept(&mut self) {
        if let Partner::Kept(number) = self.partner {
            self.end_comparison();
            self.kept.delete(number);
            self.partner = self.kept.iter().last().map_or(Partner::Usual, |last| Partner::Kept(last.number));
        }
    }

    /// Another picture is shown, which has its own partner, unless one of another kind is compared with. The user's own
    /// picture is compared with its stage alone.
    pub fn leave_partner(&mut self) {
        if self.partner == Partner::Mine {
            self.end_comparison();
        }
        if self.mode.is_none() || matches!(self.partner, Partner::Stage(_)) {
            self.partner = Partner::Usual;
        }
    }

    /// Ends the comparison.
    pub fn end_comparison(&mut self) {
        self.mode = None;
    }

    /// The view for resolving the film of this run, or its denoised picture; `other` is the film of the second picture, once
    /// there is one.
    pub fn of_film(&self, run: u64, other: Option<&Arc<ReferenceMeans>>) -> View {
        let view = match (self.mode, other) {
            (Some(Mode::Difference), Some(other)) => View::Difference(Arc::clone(other)),
            _ => self.show.of_film(&self.tone),
        };
        match self.denoised_of(run) {
            Some(denoised) => View::Denoised(Arc::clone(denoised), Box::new(view)),
            None => view,
        }
    }

    /// Whether the denoised picture is to be shown. Of pictures that are compared, both are raw.
    pub fn shows_denoised(&self) -> bool {
        self.is_denoised && self.mode.is_none()
    }

    /// The denoised picture of a run's film, if it is to be shown.
    pub fn denoised_of(&self, run: u64) -> Option<&Arc<Denoised>> {
        match &self.denoised {
            Some((of, Ok(denoised))) if self.shows_denoised() && *of == run => Some(denoised),
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
}
