//! How the picture is shown: the viewport, the layers and numbers over it, and the pictures that were kept.

use super::Viewport;
use super::sight::Sight;
use crate::app::model::{Document, Model};
use crate::app::toolkit::Toasts;
use crate::app::tracing::kept::KeptActions;
use crate::app::tracing::layers::Layers;
use crate::app::tracing::subject::Denoising;
use eframe::egui::Context;

#[derive(Default)]
pub struct Display {
    pub viewport: Viewport,
    pub layers: Layers,
    pub denoising: Denoising,
    pub kept: KeptActions,
    pub sight: Option<Sight>,
    /// The picture that was shown before a check, and that of the check.
    pub check: Option<[Document; 2]>,
}

impl Display {
    /// Asks background threads for what the screen shows beside the picture.
    pub fn follow(&mut self, context: &Context, model: &Model, toasts: &mut Toasts) {
        let (document, view) = (&model.document, &model.view);
        let fault = self.layers.follow(context, view.show().layer(), document);
        if let Some(reason) = fault {
            toasts.bad(format!("This view cannot be traced: {reason}"));
        } else if view.show().layer().is_none() {
            toasts.end_error("This view cannot be traced");
        }
    }
}
