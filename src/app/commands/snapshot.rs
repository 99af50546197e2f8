//! A snapshot of the window for the panels, which show it but do not change it.

use crate::app::model::{Document, Model};
use crate::progressive::{Phase, Status, Stop};
use std::sync::Arc;
use std::time::Duration;

/// Whether two pictures differ by more than noise, in two sentences.
#[derive(Clone)]
pub struct Verdict {
    /// `None` as long as nothing is known.
    pub is_equal: Option<bool>,
    pub headline: &'static str,
    pub words: String,
}

/// The films that are kept in files.
#[derive(Clone, Copy, Default)]
pub struct Films {
    pub count: usize,
    pub bytes: u64,
    /// How long it took to write the last one.
    pub took: Duration,
}

/// A snapshot of the window at the start of the frame.
pub struct Snapshot {
    /// The user's choices.
    pub model: Model,
    /// The status of the render.
    pub status: Arc<Status>,
    /// The status of the render that it is compared with, if that is traced.
    pub other: Option<Arc<Status>>,
    /// What is known about the difference of the two.
    pub verdict: Option<Verdict>,
    /// Seconds of tracing that the film's samples took before this run, if known.
    pub seconds_before: Option<f64>,
    /// The films that are kept.
    pub films: Films,
    /// What Undo and Redo would change.
    pub undo: Option<&'static str>,
    pub redo: Option<&'static str>,
    /// The render is a preview, and the camera or a sphere is being moved.
    pub is_coarse: bool,
    /// There is a picture of the document, at any size.
    pub has_picture: bool,
    pub is_moving: bool,
    /// The render began during the current pause, and stops early.
    pub is_held: bool,
    /// Whether the pointer is over the traced picture, or was so last.
    pub has_pixel: bool,
    /// Whether there is a list of paths.
    pub has_paths: bool,
    /// Whether the stage's sight is shown.
    pub has_sight: bool,
    /// Why the document cannot be rendered; `None` if it can.
    pub invalid: Option<String>,
}

impl Snapshot {
    /// The document that is shown.
    pub fn document(&self) -> &Document {
        &self.model.document
    }

    /// How a finished render can continue.
    pub fn further(&self) -> Option<Stop> {
        self.document().further(&self.status).filter(|_| !self.model.is_paused)
    }

    /// Whether samples are being added, or will be when another device has had its turn.
    pub fn is_working(&self) -> bool {
        self.status.phase.is_working() || self.status.phase == Phase::Paused && !self.model.is_paused
    }

    /// Why the document's camera has no effect; `None` if it has one.
    pub fn no_rays(&self) -> Option<&'static str> {
        self.document().no_rays()
    }
}
