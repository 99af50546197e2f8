//! Layers of the picture, traced on their own thread: a coarse one at once, then finer ones.

use super::model::document::Document;
use super::texture::Texture;
use crate::film::to_byte;
use crate::heat::HeatScale;
use crate::layers::{Layer, LayerImage};
use crate::render::{JobError, RenderJob, RenderSettings};
use crate::render_cpu::{Isa, PathRecorder};
use crate::stages::Transfer;
use eframe::egui::Context;
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

type Slot = Arc<Mutex<Option<Traced>>>;

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

    /// Starts to trace `layer` of the document and takes new results.
    pub fn follow(&mut self, context: &Context, layer: Option<Layer>, document: &Document, is_moving: bool) {
        let Some(layer) = layer else {
            if self.ordered.take().is_some() {
                self.cancel.store(true, Ordering::Relaxed);
                self.shown = None;
            }
            return;
        };
        self.fetch();
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
    }

    fn fetch(&mut self) {
        let traced = self.slot.lock().unwrap_or_else(PoisonError::into_inner).take();
        let Some(Traced { number, image, rgb8, divisor }) = traced else { return };
        if let Some(ordered) = &mut self.ordered
            && number == self.number
        {
            ordered.is_pictured = true;
            let earlier = self.shown.take().map(|shown| shown.texture);
            let texture = Texture::new([image.width, image.height], &rgb8, earlier);
            self.shown = Some(ShownLayer { texture, divisor, layer: ordered.layer, image });
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
        let slot = &self.slot;
        let orders = self.orders.get_or_insert_with(|| start_thread(Arc::clone(slot), context.clone()));
        // Without a thread there are no layers, but everything else works.
        let _ = orders.send(order);
        Ok(())
    }
}

impl Drop for Layers {
    fn drop(&mut self) {
        self.cancel.store(true, Ordering::Relaxed);
    }
}

fn start_thread(slot: Slot, context: Context) -> Sender<Order> {
    let (sender, orders): (_, Receiver<Order>) = channel();
    let work = move || {
        let mut recorder = None;
        while let Ok(mut order) = orders.recv() {
            while let Ok(newer) = orders.try_recv() {
                order = newer;
            }
            // This job differs from a validated one only in size and depth.
            let _ = order.trace(&mut recorder, &slot, &context);
        }
    };
    let _ = std::thread::Builder::new().name("layers".into()).spawn(work);
    sender
}

impl Order {
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
                *slot.lock().unwrap_or_else(PoisonError::into_inner) = Some(traced);
                context.request_repaint();
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
mod tests {
    use super::*;
    use crate::app::model::origin::Origin;
    use crate::recipe::Recipe;
    use std::time::{Duration, Instant};

    #[test]
    fn of_many_orders_the_last_one_is_traced() {
        let (mut layers, context) = (Layers::default(), Context::default());
        let mut document = small();
        for step in 0..20 {
            document.camera.vfov_degrees = 30.0 + f64::from(step);
            layers.follow(&context, Some(Layer::Normals), &document, false);
        }
        finish(&mut layers, Layer::Normals, &document);
    }

    #[test]
    fn a_coarse_layer_is_the_picture_made_smaller() {
        // The divisor is the smallest one for which the coarse layer has at most 20,000 pixels.
        for ([width, height], divisor, size) in
            [([640, 360], 4, [160, 90]), ([203, 101], 2, [102, 51]), ([160, 90], 1, [160, 90])]
        {
            let mut recipe = Recipe::builtin("three-spheres").unwrap();
            (recipe.settings.width, recipe.settings.height) = (width, height);
            let order = Order {
                number: 1,
                layer: Layer::Normals,
                job: recipe.job().unwrap(),
                is_coarse: true,
                cancel: Arc::default(),
            };
            let (slot, context) = (Slot::default(), Context::default());
            order.trace(&mut None, &slot, &context).unwrap();
            let Traced { image, rgb8, divisor: found, .. } = slot.lock().unwrap().take().unwrap();
            assert_eq!((found, [image.width, image.height]), (divisor, size), "{width}x{height}");
            let texture = Texture::new(size, &rgb8, None);
            let [column, row] = size.map(|length| length / 2);
            let middle = image.mean([column, row]);
            // The ball in the middle faces the camera; the sky above has a different colour.
            assert!(middle[2] > 0.9 && image.mean([column, 0])[2] > 0.99, "{middle:?}");
            let shown = ShownLayer { texture, divisor: found, layer: Layer::Normals, image };
            let mut layers = Layers::default();
            layers.shown = Some(shown);
            for [x, y] in [[column, row], [column, 0], [size[0] - 1, size[1] - 1]] {
                let expected = layers.shown.as_ref().unwrap().image.mean([x, y]);
                let pixel = [x * divisor, y * divisor];
                assert_eq!(layers.value_at(pixel), Some((Layer::Normals, expected)), "{pixel:?}");
            }
            assert_eq!(layers.samples(Layer::Normals), u64::from(divisor == 1));
        }
    }

    fn small() -> Document {
        let mut document = Document::new(Origin::usual());
        document.set_size([32, 18]);
        document
    }

    /// Follows until the layer has all its samples.
    fn finish(layers: &mut Layers, layer: Layer, document: &Document) {
        let (begin, context) = (Instant::now(), Context::default());
        while layers.samples(layer) < SAMPLES {
            assert!(begin.elapsed() < Duration::from_secs(60), "it never came");
            std::thread::sleep(Duration::from_millis(1));
            layers.follow(&context, Some(layer), document, false);
        }
    }

    #[test]
    fn a_layer_is_ordered_when_it_or_its_picture_changes() {
        let (mut layers, context, document) = (Layers::default(), Context::default(), small());
        layers.follow(&context, None, &document, false);
        assert_eq!(layers.number, 0);
        finish(&mut layers, Layer::Normals, &document);
        assert_eq!(layers.number, 1, "once");
        assert!(layers.shown_mut(Layer::Normals).is_some() && layers.shown_mut(Layer::Albedo).is_none());
        assert_eq!((layers.samples(Layer::Normals), layers.samples(Layer::Albedo)), (SAMPLES, 0));
        layers.follow(&context, Some(Layer::Normals), &document, true);
        assert_eq!(layers.number, 1, "a finished layer stays while something else moves");
        finish(&mut layers, Layer::Albedo, &document);
        assert_eq!(layers.number, 2);
        let cancel = Arc::clone(&layers.cancel);
        layers.follow(&context, None, &document, false);
        assert!(cancel.load(Ordering::Relaxed) && layers.shown.is_none() && layers.ordered.is_none());
        assert_eq!((layers.samples(Layer::Albedo), layers.value_at([0, 0])), (0, None));
        finish(&mut layers, Layer::Albedo, &document);
        let cancel = Arc::clone(&layers.cancel);
        drop(layers);
        assert!(cancel.load(Ordering::Relaxed), "the thread has nothing more to do");
    }

    #[test]
    fn a_coarse_layer_is_seen_before_the_next_one_is_ordered() {
        let (mut layers, context, mut document) = (Layers::default(), Context::default(), small());
        // Nobody traces what is ordered.
        let (sender, orders) = channel();
        layers.orders = Some(sender);
        let mut follow = |layers: &mut Layers, is_moving: bool| {
            document.camera.vfov_degrees += 1.0;
            layers.follow(&context, Some(Layer::Normals), &document, is_moving);
            layers.number
        };
        assert_eq!(follow(&mut layers, true), 1);
        assert_eq!(follow(&mut layers, true), 1, "the first has not been seen");
        assert_eq!(follow(&mut layers, false), 2, "the move has ended");
        assert_eq!(follow(&mut layers, true), 2);
        let image = LayerImage::new(Layer::Normals, &small().job(1).unwrap());
        let traced = Traced { number: 2, image, rgb8: vec![0; 32 * 18 * 3], divisor: 1 };
        *layers.slot.lock().unwrap() = Some(traced);
        assert_eq!(follow(&mut layers, true), 3);
        let orders: Vec<Order> = orders.try_iter().collect();
        assert_eq!(orders.iter().map(|order| order.is_coarse).collect::<Vec<_>>(), [true, false, true]);
        let is_cancelled = |order: &Order| order.cancel.load(Ordering::Relaxed);
        assert_eq!(orders.iter().map(is_cancelled).collect::<Vec<_>>(), [true, true, false]);
    }

    #[test]
    fn what_an_earlier_order_has_traced_is_not_shown() {
        let (mut layers, context, document) = (Layers::default(), Context::default(), small());
        finish(&mut layers, Layer::Normals, &document);
        let image = layers.shown.as_ref().unwrap().image.clone();
        let rgb8 = coloured(Layer::Normals, &image, Transfer::Linear);
        assert_eq!(rgb8.len(), 32 * 18 * 3);
        for (number, is_shown) in [(layers.number - 1, false), (layers.number, true)] {
            layers.shown = None;
            let traced = Traced { number, image: image.clone(), rgb8: rgb8.clone(), divisor: 1 };
            *layers.slot.lock().unwrap() = Some(traced);
            layers.follow(&context, Some(Layer::Normals), &document, false);
            assert_eq!(layers.shown.is_some(), is_shown);
        }
    }

    #[test]
    fn each_layer_has_its_colours() {
        let document = small();
        let job = document.job(1).unwrap();
        for layer in [Layer::Normals, Layer::Albedo, Layer::RaysPerPath] {
            let job = layer.job(&job).unwrap();
            let mut image = LayerImage::new(layer, &job);
            let recorder = PathRecorder::new(&job, Isa::Portable, None);
            assert!(image.add_sample(&recorder, &AtomicBool::new(false)));
            let rgb8 = coloured(layer, &image, Transfer::Gamma2);
            for at in [[0, 0], [31, 0], [16, 9], [3, 17]] {
                let start = 3 * (at[1] * 32 + at[0]) as usize;
                let mean = image.mean(at);
                let byte = |value: f64, transfer| to_byte(value, transfer, at[1] as usize, 18);
                let expected = match layer {
                    Layer::Normals => mean.map(|value| byte(value, Transfer::Linear)),
                    Layer::Albedo => mean.map(|value| byte(value, Transfer::Gamma2)),
                    Layer::RaysPerPath => HeatScale::RAYS.colour(mean[0]),
                };
                assert_eq!(rgb8[start..start + 3], expected, "{layer:?} {at:?}");
            }
        }
    }
}
