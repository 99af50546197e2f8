//! Layers of the picture, traced on their own thread: a coarse one at once, then finer ones.

use super::answers::caught;
use super::model::document::Document;
use super::texture::Texture;
use crate::backends::layers::{Layer, LayerImage};
use crate::film::to_byte;
use crate::job::render::{JobError, RenderJob, RenderSettings};
use crate::numbers::heat::HeatScale;
use crate::render_cpu::{Isa, PathRecorder};
use crate::stages::Transfer;
use eframe::egui::Context;
use std::io;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};

/// Samples per pixel of a finished layer.
const SAMPLES: u64 = 16;

/// Largest number of pixels in the coarse layer, which has one sample each.
const COARSE_PIXELS: u32 = 20_000;

/// A layer for the thread to trace.
struct Order {
    number: u64,
    layer: Layer,
    job: RenderJob,
    is_coarse: bool,
    cancel: Arc<AtomicBool>,
}

/// A layer that the thread has traced.
struct Traced {
    number: u64,
    image: LayerImage,
    rgb8: Vec<u8>,
    divisor: u32,
}

/// A layer, or why it cannot be traced and the number of its order.
type Outcome = Result<Traced, (u64, String)>;

type Slot = Arc<Mutex<Option<Outcome>>>;

struct Ordered {
    layer: Layer,
    document: Document,
    is_coarse: bool,
    is_pictured: bool,
}

/// A layer on the screen.
pub struct ShownLayer {
    /// The texture of the layer's picture.
    pub texture: Texture,
    /// 1, or the factor by which the layer is smaller than the picture.
    pub divisor: u32,
    layer: Layer,
    image: LayerImage,
}

/// The layer that is displayed.
#[derive(Default)]
pub struct Layers {
    orders: Option<Sender<Order>>,
    slot: Slot,
    number: u64,
    ordered: Option<Ordered>,
    cancel: Arc<AtomicBool>,
    shown: Option<ShownLayer>,
}

impl Layers {
    /// The newest version of a layer.
    pub fn shown(&self, layer: Layer) -> Option<&ShownLayer> {
        self.shown.as_ref().filter(|shown| shown.layer == layer)
    }

    /// The newest version of a layer.
    pub fn shown_mut(&mut self, layer: Layer) -> Option<&mut ShownLayer> {
        self.shown.as_mut().filter(|shown| shown.layer == layer)
    }

    /// The layer and its mean at a pixel of the full-size picture.
    pub fn value_at(&self, [x, y]: [u32; 2]) -> Option<(Layer, [f64; 3])> {
        let shown = self.shown.as_ref()?;
        let (image, at) = (&shown.image, [x / shown.divisor, y / shown.divisor]);
        let is_inside = at[0] < image.width && at[1] < image.height;
        is_inside.then(|| (shown.layer, image.mean(at)))
    }

    /// Samples per pixel of a full-size layer; 0 while there is none.
    pub fn samples(&self, layer: Layer) -> u64 {
        let shown = self.shown.as_ref().filter(|shown| shown.layer == layer && shown.divisor == 1);
        shown.map_or(0, |shown| shown.image.samples)
    }

    /// Starts to trace `layer` of the document and takes new results. Returns why the layer cannot be traced, once.
    pub fn follow(
        &mut self,
        context: &Context,
        layer: Option<Layer>,
        document: &Document,
        is_moving: bool,
    ) -> Option<String> {
        let Some(layer) = layer else {
            if self.ordered.take().is_some() {
                self.cancel.store(true, Ordering::Relaxed);
                self.shown = None;
            }
            return None;
        };
        let fault = self.fetch();
        let is_at_it = self.ordered.as_ref().is_some_and(|ordered| {
            ordered.layer == layer
                && ordered.document.has_same_film(document)
                && (is_moving || !ordered.is_coarse)
        });
        // Until a coarse layer has been displayed, starting another one would only delay it.
        let is_unseen =
            self.ordered.as_ref().is_some_and(|ordered| ordered.layer == layer && !ordered.is_pictured);
        let has_to_wait = is_moving && is_unseen;
        if !is_at_it && !has_to_wait {
            // An invalid document is reported elsewhere.
            let _ = self.order(context, layer, document, is_moving);
        }
        fault
    }

    /// Takes a layer. Returns why there is none, if so.
    fn fetch(&mut self) -> Option<String> {
        let outcome = self.slot.lock().unwrap_or_else(PoisonError::into_inner).take()?;
        let ordered = self.ordered.as_mut()?;
        match outcome {
            Ok(Traced { number, image, rgb8, divisor }) if number == self.number => {
                ordered.is_pictured = true;
                let earlier = self.shown.take().map(|shown| shown.texture);
                let texture = Texture::new([image.width, image.height], &rgb8, earlier);
                self.shown = Some(ShownLayer { texture, divisor, layer: ordered.layer, image });
                None
            }
            Err((number, reason)) if number == self.number => {
                // The next one need not wait for this one.
                ordered.is_pictured = true;
                Some(reason)
            }
            Ok(_) | Err(_) => None,
        }
    }

    fn order(
        &mut self,
        context: &Context,
        layer: Layer,
        document: &Document,
        is_coarse: bool,
    ) -> Result<(), JobError> {
        let job = document.job(1)?;
        self.cancel.store(true, Ordering::Relaxed);
        self.cancel = Arc::default();
        self.number += 1;
        let document = document.clone();
        self.ordered = Some(Ordered { layer, document, is_coarse, is_pictured: false });
        let cancel = Arc::clone(&self.cancel);
        let order = Order { number: self.number, layer, job, is_coarse, cancel };
        if self.orders.is_none() {
            match start_thread(Arc::clone(&self.slot), context.clone()) {
                Ok(orders) => self.orders = Some(orders),
                Err(error) => {
                    let reason = format!("no thread could be started ({error})");
                    publish(&self.slot, context, Err((self.number, reason)));
                }
            }
        }
        if let Some(orders) = &self.orders {
            // The thread lives as long as this.
            let _ = orders.send(order);
        }
        Ok(())
    }
}

impl Drop for Layers {
    fn drop(&mut self) {
        self.cancel.store(true, Ordering::Relaxed);
    }
}

fn publish(slot: &Slot, context: &Context, outcome: Outcome) {
    *slot.lock().unwrap_or_else(PoisonError::into_inner) = Some(outcome);
    context.request_repaint();
}

fn start_thread(slot: Slot, context: Context) -> io::Result<Sender<Order>> {
    let (sender, orders): (_, Receiver<Order>) = channel();
    let work = move || {
        let mut recorder = None;
        while let Ok(mut order) = orders.recv() {
            while let Ok(newer) = orders.try_recv() {
                order = newer;
            }
            order.answer(&mut recorder, &slot, &context);
        }
    };
    std::thread::Builder::new().name("layers".into()).spawn(work)?;
    Ok(sender)
}

impl Order {
    /// Traces the layer, or says why it cannot be traced.
    fn answer(&self, recorder: &mut Option<PathRecorder>, slot: &Slot, context: &Context) {
        let outcome = caught(|| self.trace(recorder, slot, context).map_err(|error| error.to_string()));
        if let Err(reason) = outcome.unwrap_or_else(Err) {
            *recorder = None;
            publish(slot, context, Err((self.number, reason)));
        }
    }

    fn trace(
        &self,
        recorder: &mut Option<PathRecorder>,
        slot: &Slot,
        context: &Context,
    ) -> Result<(), JobError> {
        let job = self.layer.job(&self.job)?;
        let settings = *job.settings();
        let pixels = f64::from(settings.width) * f64::from(settings.height);
        let divisor = (pixels / f64::from(COARSE_PIXELS)).sqrt().ceil().max(1.0) as u32;
        let coarse = RenderSettings {
            width: settings.width.div_ceil(divisor),
            height: settings.height.div_ceil(divisor),
            ..settings
        };
        let coarse = job.seen_by(*job.camera(), coarse)?;
        let is_whole = self.refine(recorder, &coarse, divisor, 1, slot, context);
        if is_whole && !self.is_coarse {
            self.refine(recorder, &job, 1, SAMPLES, slot, context);
        }
        Ok(())
    }

    /// Adds samples and publishes the layer each time the sample count has doubled. Returns false if it was cancelled.
    fn refine(
        &self,
        recorder: &mut Option<PathRecorder>,
        job: &RenderJob,
        divisor: u32,
        samples: u64,
        slot: &Slot,
        context: &Context,
    ) -> bool {
        let isa = Isa::available().into_iter().max().unwrap_or(Isa::Portable);
        let earlier = recorder.take();
        let paths = recorder.insert(PathRecorder::new(job, isa, earlier));
        let mut image = LayerImage::new(self.layer, job);
        for index in 0..samples {
            if !image.add_sample(paths, &self.cancel) {
                return false;
            }
            if (index + 1).is_power_of_two() {
                let rgb8 = coloured(self.layer, &image, job.rules().transfer);
                let traced = Traced { number: self.number, image: image.clone(), rgb8, divisor };
                publish(slot, context, Ok(traced));
            }
        }
        true
    }
}

/// Converts a layer to three bytes per pixel.
fn coloured(layer: Layer, image: &LayerImage, transfer: Transfer) -> Vec<u8> {
    let mut rgb8 = Vec::with_capacity(image.width as usize * image.height as usize * 3);
    for y in 0..image.height {
        for x in 0..image.width {
            let mean = image.mean([x, y]);
            let byte = |v, transfer| to_byte(v, transfer, y as usize, image.height as usize);
            rgb8.extend(match layer {
                Layer::Normals => mean.map(|v| byte(v, Transfer::Linear)),
                Layer::Albedo => mean.map(|v| byte(v, transfer)),
                Layer::RaysPerPath => HeatScale::RAYS.colour(mean[0]),
            });
        }
    }
    rgb8
}

#[cfg(test)]
mod tests;
