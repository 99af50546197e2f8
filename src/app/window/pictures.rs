//! Which pictures are shown, and beside which: stages, comparisons, checks, and sights.

use super::Window;
use crate::app::commands::Command;
use crate::app::model::{Device, Dock, Document, Mode, Model, Origin, Partner, Show, Source, Tab};
use crate::app::viewport::sight::Sight;
use eframe::egui::Context;
use std::sync::Arc;

impl Window {
    /// Shows another picture. The user's own way to stop stays, unless the picture has its own.
    pub(super) fn show_origin(&mut self, origin: Origin) {
        let document = self.fresh(origin);
        let before = self.document();
        if before.is_changed() {
            let words = format!("Your changes to {} are kept in Undo", before.place());
            self.shell.toasts.good_with(words, &[Command::Undo]);
        }
        self.show_document(document);
    }

    /// A picture from this origin, with what the user has chosen for it.
    pub(super) fn fresh(&self, origin: Origin) -> Document {
        let mut document = Document::new(origin);
        if let Some(stop) = self.model.own_stop.filter(|_| document.stop.samples.is_none()) {
            document.stop = stop;
        }
        // Bookmarks and the end of a picture are there again when one comes back to it.
        let known = self.changes.last_of(&document.origin.source);
        if let Some(known) = known.filter(|known| known.origin.source != Source::New) {
            document.keyframes.clone_from(&known.keyframes);
            if known.stop != known.origin.usual_stop() {
                document.stop = known.stop;
            }
        }
        document
    }

    pub(super) fn show_document(&mut self, document: Document) {
        self.end_sight();
        let is_with_stage =
            |model: &Model| matches!(model.view.compared(&model.document), Some(Partner::Stage(_)));
        let was_with_stage = is_with_stage(&self.model);
        if !Arc::ptr_eq(&document.origin, &self.document().origin) {
            self.leave_picture();
        }
        self.model.document = document;
        // The next stage has a partner of its own; what has none is not compared with something of another kind.
        if was_with_stage && !is_with_stage(&self.model) {
            self.model.view.end_comparison();
        }
        self.model.selected = None;
        if self.model.remembered.tab == Tab::Check {
            self.model.remembered.tab = Tab::Stage;
        }
    }

    /// Leaves what belongs to the picture that was shown.
    pub(super) fn leave_picture(&mut self) {
        self.model.view.leave_partner();
        self.display.viewport.placement.leave_part();
        self.display.check = None;
    }

    pub(super) fn compare_with(&mut self, partner: Partner) {
        if partner == Partner::Mine {
            self.visit_checked();
        }
        self.model.view.compare_with(partner);
        if partner == Partner::Mine && self.display.check.is_none() && !self.model.view.is_hidden() {
            self.model.view.toggle(Mode::Flip);
        }
        if matches!(partner, Partner::Device(_)) {
            self.model.remembered.dock = Some(Dock::Error);
        }
    }

    /// Compares CPU and GPU, or ends that.
    pub(super) fn compare_devices(&mut self) {
        let other = if self.model.remembered.device == Device::Gpu { Device::Cpu } else { Device::Gpu };
        if self.model.other_device() == Some(other) {
            self.model.view.end_comparison();
            return;
        }
        if !matches!(self.model.remembered.device, Device::Cpu | Device::Gpu) {
            self.model.remembered.device = Device::Cpu;
        }
        self.compare_with(Partner::Device(other));
    }

    /// Traces the stage of the picture that is checked, in its size. The end of the check returns to what is shown now.
    pub(super) fn visit_checked(&mut self) {
        let Some((stage, mine)) = self.tools.check.found() else { return };
        let size = mine.size();
        let is_of = |[_, of]: &[Document; 2]| Arc::ptr_eq(&of.origin, &self.document().origin);
        let begun = self.display.check.clone().filter(is_of);
        let is_shown = self.document().stage() == Some(stage) && self.document().size() == size;
        if begun.is_some() && is_shown {
            return;
        }
        self.end_sight();
        let before = begun.map_or_else(|| self.document().clone(), |[before, _]| before);
        let tab = self.model.remembered.tab;
        let mut document = self.fresh(Origin::of_stage(stage));
        document.give_size(size);
        self.show_document(document);
        self.model.remembered.tab = tab;
        self.display.viewport.placement.fit();
        self.display.check = Some([before, self.document().clone()]);
    }

    /// Takes what a check has read or found, and shows it if the check is in sight.
    pub(super) fn take_checked(&mut self) {
        let before = std::mem::replace(&mut self.model.view.kept.mine, self.tools.check.mine.clone());
        let is_compared = self.model.view.compared(self.document()) == Some(Partner::Mine);
        if self.model.view.kept.mine.is_none() {
            self.end_check();
        } else if before.is_none() && self.model.shows(Tab::Check) || is_compared {
            // The first finding shows it beside ours.
            if before.is_none() || self.display.check.is_none() {
                self.model.view.end_comparison();
            }
            self.compare_with(Partner::Mine);
        }
    }

    /// Ends the pictures of a check that was closed.
    pub(super) fn follow_check(&mut self) {
        let mine = self.model.view.kept.mine.as_ref();
        if mine.is_some_and(|mine| mine.name != self.tools.check.name()) {
            self.end_check();
        }
    }

    /// Returns to the picture that was shown before a check, unless the one of the check was changed.
    pub(super) fn end_check(&mut self) {
        self.model.view.kept.mine = None;
        let Some([before, of_check]) = self.display.check.take() else { return };
        self.end_sight();
        self.model.view.leave_partner();
        if self.document().has_same_film(&of_check) {
            self.show_document(before);
        }
    }

    /// Leaves views and comparisons that the picture of now cannot have.
    pub(super) fn leave_useless_views(&mut self) {
        let show = self.model.view.show();
        if let Some(reason) = self.model.useless_show(show).filter(|_| show != Show::Picture) {
            self.refuse(show.name(), &reason);
            self.model.view.leave_show();
        }
        if self.model.view.mode() == Some(Mode::Difference)
            && let Some(reason) = self.model.not_subtractable()
        {
            self.shell.toasts.good_with(reason, &[Command::RenderAtPartnerSize]);
            self.model.view.end_comparison();
        }
        let Some(sight) = &self.display.sight else { return };
        if !sight.is_of(&self.model.document) {
            self.end_sight();
        } else if !sight.lasts(&self.model.document, &self.model.view) {
            self.display.sight = None;
            self.display.viewport.placement.leave_part();
        }
    }

    pub(super) fn toggle_sight(&mut self) {
        if self.display.sight.is_some() {
            self.end_sight();
            return;
        }
        let Some(stage) = self.document().stage() else { return };
        let (document, view) = (&mut self.model.document, &mut self.model.view);
        self.display.sight = Some(Sight::show(stage, document, view, &mut self.display.viewport.placement));
    }

    pub(super) fn end_sight(&mut self) {
        if let Some(sight) = self.display.sight.take() {
            let (document, view) = (&mut self.model.document, &mut self.model.view);
            sight.end(document, view, &mut self.display.viewport.placement);
        }
    }

    pub(super) fn list_paths(&mut self, context: &Context) {
        if let Some(pixel) = self.tools.inspector.hovered {
            self.tools.paths.list(&self.model.document, pixel, context);
            self.model.remembered.dock = Some(Dock::Path);
        }
    }
}
