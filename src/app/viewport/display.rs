//! How the picture is shown: the viewport, the layers and numbers over it, and the pictures that were kept.

use super::Viewport;
use super::sight::Sight;
use crate::app::model::spheres::is_lost;
use crate::app::model::{CheckedScene, Document, Model};
use crate::app::toolkit::Toasts;
use crate::app::tracing::kept::KeptActions;
use crate::app::tracing::layers::Layers;
use crate::app::tracing::subject::Denoising;
use crate::scene::Camera;
use eframe::egui::Context;
use std::sync::Arc;

#[derive(Default)]
pub struct Display {
    pub viewport: Viewport,
    pub layers: Layers,
    pub denoising: Denoising,
    pub kept: KeptActions,
    /// Only sky and ground are in sight, unlike from the stage's camera.
    pub is_lost: bool,
    /// The camera and scene that were judged.
    judged: Option<(Camera, Arc<CheckedScene>)>,
    pub sight: Option<Sight>,
    /// The picture that was shown before a check, and that of the check.
    pub check: Option<[Document; 2]>,
}

impl Display {
    /// Asks background threads for what the screen shows beside the picture.
    pub fn follow(&mut self, context: &Context, model: &Model, is_moving: bool, toasts: &mut Toasts) {
        let (document, view) = (&model.document, &model.view);
        let is_known = |(camera, scene): &(Camera, Arc<CheckedScene>)| {
            *camera == document.camera && Arc::ptr_eq(scene, &document.checked)
        };
        if !is_moving && !self.judged.as_ref().is_some_and(is_known) {
            self.judged = Some((document.camera, Arc::clone(&document.checked)));
            self.is_lost = is_lost(document);
        }
        let fault = self.layers.follow(context, view.show().layer(), document);
        if let Some(reason) = fault {
            toasts.bad(format!("This view cannot be traced: {reason}"));
        } else if view.show().layer().is_none() {
            toasts.end_error("This view cannot be traced");
        }
    }
}
