//! Layers of the picture, traced on their own thread: a coarse one at once, then finer ones.

use crate::app::model::{Document, best_isa};
use crate::app::toolkit::{Answers, Texture};
use crate::backends::layers::{Layer, LayerImage};
use crate::film::to_byte;
use crate::job::render::{JobError, RenderJob, RenderSettings};
use crate::numbers::heat::HeatScale;
use crate::render_cpu::PathRecorder;
use crate::stages::Transfer;
use eframe::egui::Context;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// Samples per pixel of a finished layer.
const SAMPLES: u64 = 16;

/// Largest number of pixels in the coarse layer, which has one sample each.
const COARSE_PIXELS: u32 = 20_000;

/// The last order.
struct Ordered {
    layer: Layer,
    document: Document,
    is_pictured: bool,
}

/// A layer on the screen.
pub struct ShownLayer {
    /// The texture of the layer's picture.
    pub texture: Texture,
    /// 1, or the factor by which the layer is smaller than the picture.
    pub divisor: u32,
    layer: Layer,
    pub image: LayerImage,
}

/// The layer that is displayed.
#[derive(Default)]
pub struct Layers {
    /// A layer that was traced, or nothing more.
    traced: Answers<Option<ShownLayer>>,
    /// The recorder of paths, with the hierarchy of the last scene. Orders wait for it.
    recorder: Arc<Mutex<Option<PathRecorder>>>,
    ordered: Option<Ordered>,
    cancel: Arc<AtomicBool>,
    shown: Option<ShownLayer>,
}

impl Layers {
    /// The newest version of a layer.
    pub fn shown(&self, layer: Layer) -> Option<&ShownLayer> {
        self.shown.as_ref().filter(|shown| shown.layer == layer)
    }

    /// The layer and its mean at a pixel of the full-size picture.
    pub fn value_at(&self, [x, y]: [u32; 2]) -> Option<(Layer, [f64; 3])> {
        let shown = self.shown.as_ref()?;
        let (image, at) = (&shown.image, [x / shown.divisor, y / shown.divisor]);
        let is_inside = at[0] < image.width && at[1] < image.height;
        is_inside.then(|| (shown.layer, image.mean(at)))
    }

    /// Starts to trace `layer` of the document and takes new results. Returns why the layer cannot be traced, once.
    pub fn follow(&mut self, context: &Context, layer: Option<Layer>, document: &Document) -> Option<String> {
        let Some(layer) = layer else {
            self.cancel.store(true, Ordering::Relaxed);
            (self.ordered, self.shown) = (None, None);
            return None;
        };
        let mut fault = None;
        while let Some(outcome) = self.traced.take() {
            let Some(ordered) = self.ordered.as_mut() else { continue };
            // After a failure, the next one need not wait for this one.
            ordered.is_pictured = true;
            match outcome {
                Ok(Some(shown)) => self.shown = Some(shown),
                Ok(None) => {}
                Err(reason) => fault = Some(reason),
            }
        }
        let ordered = self.ordered.as_ref().filter(|ordered| ordered.layer == layer);
        let is_at_it = ordered.is_some_and(|ordered| ordered.document.has_same_film(document));
        // Until a coarse layer has been displayed, starting another one would only delay it.
        let has_to_wait = ordered.is_some_and(|ordered| !ordered.is_pictured);
        if !is_at_it && !has_to_wait {
            self.order(context, layer, document);
        }
        fault
    }

    fn order(&mut self, context: &Context, layer: Layer, document: &Document) {
        // An invalid document is reported elsewhere.
        let Ok(job) = document.job(1) else { return };
        self.cancel.store(true, Ordering::Relaxed);
        self.cancel = Arc::default();
        // A late answer is lost with its slot.
        self.traced = Answers::default();
        self.ordered = Some(Ordered { layer, document: document.clone(), is_pictured: false });
        let (cancel, recorder) = (Arc::clone(&self.cancel), Arc::clone(&self.recorder));
        let answer = self.traced.answer(context);
        let work = move || {
            let mut recorder = recorder.lock().unwrap_or_else(PoisonError::into_inner);
            let job = layer.job(&job)?;
            trace(layer, &job, &mut recorder, &cancel, |image, divisor| {
                let rgb8 = coloured(layer, image, job.rules().transfer);
                let texture = Texture::new([image.width, image.height], &rgb8, None);
                answer.give(Ok(Some(ShownLayer { texture, divisor, layer, image: image.clone() })));
            })?;
            Ok(None)
        };
        let work = move || work().map_err(|error: JobError| error.to_string());
        self.traced.ask("layers", context, work);
    }
}

impl Drop for Layers {
    fn drop(&mut self) {
        self.cancel.store(true, Ordering::Relaxed);
    }
}

/// Traces a layer coarsely, then at full size, and gives it each time the sample count has doubled.
fn trace(
    layer: Layer,
    job: &RenderJob,
    recorder: &mut Option<PathRecorder>,
    cancel: &AtomicBool,
    give: impl Fn(&LayerImage, u32),
) -> Result<(), JobError> {
    let settings = *job.settings();
    let pixels = f64::from(settings.width) * f64::from(settings.height);
    let divisor = (pixels / f64::from(COARSE_PIXELS)).sqrt().ceil().max(1.0) as u32;
    let [width, height] = [settings.width, settings.height].map(|along| along.div_ceil(divisor));
    let coarse = job.seen_by(*job.camera(), RenderSettings { width, height, ..settings })?;
    for (job, divisor, samples) in [(&coarse, divisor, 1), (job, 1, SAMPLES)] {
        let earlier = recorder.take();
        let paths = recorder.insert(PathRecorder::new(job, best_isa(), earlier));
        let mut image = LayerImage::new(layer, job);
        for index in 0..samples {
            if !image.add_sample(paths, cancel) {
                return Ok(());
            }
            if (index + 1_u64).is_power_of_two() {
                give(&image, divisor);
            }
        }
    }
    Ok(())
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
mod tests {
    use super::*;
    use crate::app::model::Origin;
    use std::time::{Duration, Instant};

    fn small() -> Document {
        let mut document = Document::new(Origin::usual());
        document.set_size([32, 18]);
        document
    }

    /// Follows until the layer has all its samples.
    fn finish(layers: &mut Layers, layer: Layer, document: &Document) {
        let (begin, context) = (Instant::now(), Context::default());
        let is_full = |shown: &ShownLayer| shown.divisor == 1 && shown.image.samples == SAMPLES;
        while !layers.shown(layer).is_some_and(is_full) {
            assert!(begin.elapsed() < Duration::from_secs(60), "it never came");
            std::thread::sleep(Duration::from_millis(1));
            layers.follow(&context, Some(layer), document);
        }
    }

    #[test]
    fn of_many_orders_the_last_one_is_traced() {
        let (mut layers, context, mut document) = (Layers::default(), Context::default(), small());
        for step in 0..20 {
            document.camera.vfov_degrees = 30.0 + f64::from(step);
            layers.follow(&context, Some(Layer::Normals), &document);
        }
        finish(&mut layers, Layer::Normals, &document);
    }

    #[test]
    fn a_layer_is_ordered_when_it_or_its_picture_changes() {
        let (mut layers, context, document) = (Layers::default(), Context::default(), small());
        layers.follow(&context, None, &document);
        assert!(layers.ordered.is_none());
        finish(&mut layers, Layer::Normals, &document);
        let cancel = Arc::clone(&layers.cancel);
        assert!(layers.shown(Layer::Normals).is_some() && layers.shown(Layer::Albedo).is_none());
        layers.follow(&context, Some(Layer::Normals), &document);
        assert!(Arc::ptr_eq(&cancel, &layers.cancel), "a finished layer stays");
        finish(&mut layers, Layer::Albedo, &document);
        assert!(!Arc::ptr_eq(&cancel, &layers.cancel));
        layers.follow(&context, None, &document);
        assert!(layers.cancel.load(Ordering::Relaxed) && layers.value_at([0, 0]).is_none());
        finish(&mut layers, Layer::Albedo, &document);
    }

    #[test]
    fn a_layer_that_cannot_be_traced_is_reported_once() {
        let (mut layers, context, document) = (Layers::default(), Context::default(), small());
        let recorder = Arc::clone(&layers.recorder);
        // Nothing is traced while this lasts.
        let _guard = recorder.lock().unwrap();
        let mut follow = |outcome: Option<&str>| {
            if let Some(reason) = outcome {
                layers.traced.answer(&context).give(Err(reason.to_owned()));
            }
            layers.follow(&context, Some(Layer::Normals), &document)
        };
        assert_eq!(follow(None), None);
        assert_eq!(follow(Some("it fell")).as_deref(), Some("it fell"));
        assert_eq!(follow(None), None, "it is not tried again and again");
    }
}
