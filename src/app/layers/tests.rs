//! Tests of layers.

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
        let Traced { image, rgb8, divisor: found, .. } = slot.lock().unwrap().take().unwrap().ok().unwrap();
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
        let beyond = [[size[0] * divisor, 0], [0, size[1] * divisor]];
        assert_eq!(beyond.map(|pixel| layers.value_at(pixel)), [None; 2], "below and beside it is nothing");
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
    *layers.slot.lock().unwrap() = Some(Ok(traced));
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
        *layers.slot.lock().unwrap() = Some(Ok(traced));
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

#[test]
fn a_layer_that_cannot_be_traced_is_told_of_once() {
    let (mut layers, context, document) = (Layers::default(), Context::default(), small());
    // Nobody traces what is ordered.
    let (sender, orders) = channel();
    layers.orders = Some(sender);
    let follow = |layers: &mut Layers, outcome: Option<(u64, &str)>| {
        if let Some((number, reason)) = outcome {
            publish(&layers.slot, &context, Err((number, reason.to_owned())));
        }
        layers.follow(&context, Some(Layer::Normals), &document, false)
    };
    assert_eq!(follow(&mut layers, None), None);
    assert_eq!(follow(&mut layers, Some((0, "an earlier one"))), None);
    assert_eq!(follow(&mut layers, Some((1, "it fell"))).as_deref(), Some("it fell"));
    assert_eq!(follow(&mut layers, None), None);
    assert_eq!(orders.try_iter().count(), 1, "it is not tried again and again");
}
