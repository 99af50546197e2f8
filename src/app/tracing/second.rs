//! The other picture of a comparison: one that is traced beside this one, or a kept one.

use super::tracer::{Tracer, Want};
use crate::app::model::{CheckedScene, Document, Kept, Mode, Model, Origin, Partner};
use crate::app::toolkit::{Query, Texture};
use crate::film::Film;
use crate::progressive::{Phase, ReferenceMeans};
use crate::stages::Transfer;
use eframe::egui::Context;
use std::sync::Arc;
use std::thread;

/// Tells other pictures and their states apart: the partner, its run and its samples per pixel.
pub type OtherId = (Partner, u64, u64);

/// The other picture, to read its numbers.
#[derive(Clone, Copy)]
pub enum Other<'a> {
    Kept(&'a Arc<Kept>),
    Traced(Partner, &'a Tracer, &'a Document),
}

impl<'a> Other<'a> {
    /// The document that it shows; `None` for the picture of a file.
    pub fn document(&self) -> Option<&'a Document> {
        match self {
            Other::Kept(kept) => kept.document.as_ref(),
            Other::Traced(.., document) => Some(document),
        }
    }

    pub fn transfer(&self) -> Transfer {
        match self {
            Other::Kept(kept) => kept.transfer,
            Other::Traced(.., document) => document.rules().transfer,
        }
    }

    pub fn id(&self) -> OtherId {
        match self {
            Other::Kept(kept) => (Partner::Kept(kept.number), 0, kept.samples()),
            Other::Traced(partner, tracer, _) => (*partner, tracer.status().run, tracer.shown_samples()),
        }
    }

    /// Whether its film has samples, at full size.
    pub fn is_ready(&self) -> bool {
        match self {
            Other::Kept(_) => true,
            Other::Traced(_, tracer, document) => tracer.has_samples(document),
        }
    }

    /// Runs `look` with the film, on the render thread or another one.
    pub fn inspect(&self, look: impl FnOnce(&Film) + Send + 'static) {
        match self {
            Other::Kept(kept) => {
                let film = Arc::clone(&kept.film);
                let _ = thread::Builder::new().name("kept".to_owned()).spawn(move || look(&film));
            }
            Other::Traced(_, tracer, _) => tracer.inspect(look),
        }
    }
}

/// The partner that was traced last, the origin and the scene of this picture then, and the origin of the other one.
type Of = (Partner, Arc<Origin>, Arc<CheckedScene>, Arc<Origin>);

/// The other picture of a comparison.
#[derive(Default)]
pub struct Second {
    /// `None` until another picture is traced.
    pub tracer: Option<Tracer>,
    of: Option<Of>,
    /// Its light, to subtract.
    means: Query<OtherId, (OtherId, Arc<ReferenceMeans>)>,
    /// The picture of a film that is not traced for the comparison, by its exposure.
    resolved: Query<(OtherId, f64), (Partner, Texture)>,
}

impl Second {
    /// The other picture, once it has samples.
    pub fn other<'a>(&'a self, model: &'a Model) -> Option<Other<'a>> {
        other(self.tracer.as_ref(), self.of.as_ref(), model)
    }

    /// The other picture as it is drawn, and whether it is a preview.
    pub fn texture<'a>(&'a self, other: &Other<'a>) -> Option<(&'a Texture, bool)> {
        match other {
            Other::Traced(_, tracer, _) => tracer.shown().map(|shown| (&shown.texture, shown.divisor > 1)),
            Other::Kept(_) => {
                let found = self.resolved.answer.as_ref().filter(|(of, _)| *of == other.id().0);
                found.map(|(_, texture)| (texture, false))
            }
        }
    }

    /// The light of the other film, if it is known and of this size.
    pub fn means<'a>(&'a self, model: &'a Model, size: [u32; 2]) -> Option<&'a Arc<ReferenceMeans>> {
        let means = match self.other(model)? {
            Other::Kept(kept) => &kept.means,
            other => {
                let ((of, means), id) = (self.means.answer.as_ref()?, other.id());
                Some(means).filter(|_| (of.0, of.1) == (id.0, id.1))?
            }
        };
        Some(means).filter(|means| [means.width, means.height] == size)
    }

    /// Makes the other picture, if one is needed; `want` is this one. Returns whether there is one.
    pub fn follow(&mut self, context: &Context, model: &Model, want: &Want<'_>) -> bool {
        let partner = model.view.compared(want.document);
        let is_there = self.trace(context, partner, model, want);
        self.means.follow();
        self.resolved.follow();
        let Some(other) = other(self.tracer.as_ref(), self.of.as_ref(), model) else { return is_there };
        let (id, tone) = (other.id(), model.view.tone);
        if matches!(other, Other::Kept(_)) {
            if let Some(answer) = self.resolved.ask(context, (id, tone.exposure)) {
                let transfer = other.transfer();
                other.inspect(move |film| {
                    let rgb8 = tone.of_picture().resolve(film, transfer);
                    answer.give(Ok((id.0, Texture::new([film.width(), film.height()], &rgb8, None))));
                });
            }
        } else if model.view.mode() == Some(Mode::Difference)
            && other.is_ready()
            && let Some(answer) = self.means.ask(context, id)
        {
            other.inspect(move |film| answer.give(Ok((id, Arc::new(ReferenceMeans::of(film))))));
        }
        is_there
    }

    /// Traces the partner, if its picture is one to trace. Returns whether there is another picture.
    fn trace(&mut self, context: &Context, partner: Option<Partner>, model: &Model, want: &Want<'_>) -> bool {
        let Some((partner, origin)) =
            partner.and_then(|partner| Some((partner, self.origin_of(partner, want.document)?)))
        else {
            self.rest(context, want.document);
            return model.view.kept_partner().is_some();
        };
        if self.tracer.is_none() {
            // Without a thread there is no second picture, but everything else works.
            self.tracer = Tracer::new().ok();
            self.tracer.iter().for_each(|tracer| tracer.wake(context));
        }
        let Some(tracer) = &mut self.tracer else { return false };
        tracer.poll(context);
        // Two devices take turns.
        if !want.is_paused && !matches!(partner, Partner::Device(_)) && tracer.status().phase == Phase::Paused
        {
            tracer.progressive.resume();
        }
        let document = partner.document(&origin, want.document);
        let own_backend;
        let backend = match partner {
            Partner::Device(device) => {
                own_backend = model.backend_of(device);
                &own_backend
            }
            _ => want.backend,
        };
        // Otherwise both pictures have the same stop condition, so that they do not differ in their noise.
        let stop = if partner.has_same_samples() { want.stop } else { document.stop };
        let view = model.view.tone.of_picture();
        tracer.want(&Want { document: &document, backend, stop, view, ..*want }, None).is_ok()
    }

    /// Keeps the film for the next comparison of the same picture.
    fn rest(&mut self, context: &Context, mine: &Document) {
        let is_of = |(_, origin, scene, _): &Of| {
            Arc::ptr_eq(origin, &mine.origin) && Arc::ptr_eq(scene, &mine.checked)
        };
        if !self.of.as_ref().is_some_and(is_of) {
            self.tracer.iter_mut().for_each(Tracer::abandon);
            self.of = None;
        } else if let Some(tracer) = &mut self.tracer {
            tracer.poll(context);
            if tracer.status().phase.is_working() {
                tracer.progressive.pause();
            }
        }
    }

    fn origin_of(&mut self, partner: Partner, mine: &Document) -> Option<Arc<Origin>> {
        let is_known = |(of, origin, scene, _): &&Of| {
            let is_same = Arc::ptr_eq(origin, &mine.origin) && Arc::ptr_eq(scene, &mine.checked);
            *of == partner && (is_same || matches!(partner, Partner::Stage(_)))
        };
        if let Some((.., origin)) = self.of.as_ref().filter(is_known) {
            return Some(Arc::clone(origin));
        }
        let origin = partner.origin(mine)?;
        if self.of.as_ref().is_some_and(|(of, ..)| *of != partner) {
            // Its film may be of the same document, but from another device.
            self.tracer.iter_mut().for_each(Tracer::abandon);
        }
        let of = (partner, Arc::clone(&mine.origin), Arc::clone(&mine.checked), Arc::clone(&origin));
        self.of = Some(of);
        Some(origin)
    }
}

fn other<'a>(tracer: Option<&'a Tracer>, of: Option<&Of>, model: &'a Model) -> Option<Other<'a>> {
    match model.view.compared(&model.document)? {
        Partner::Kept(_) | Partner::Mine => model.view.kept_partner().map(Other::Kept),
        partner => {
            let tracer = tracer.filter(|_| of.is_some_and(|(of, ..)| *of == partner))?;
            Some(Other::Traced(partner, tracer, &tracer.shown()?.document))
        }
    }
}
