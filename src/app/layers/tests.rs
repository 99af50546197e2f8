//! Tests of layers.

use super::*;
use crate::app::model::origin::Origin;
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
