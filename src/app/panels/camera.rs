//! Controls for the camera's position and direction.

use super::reset::Reset;
use crate::app::facts::Facts;
use crate::app::model::document::Document;
use crate::app::widgets::{About, slider, vector};
use crate::scene::{Camera, LENGTH_LIMIT, VFOV_LIMITS_DEGREES};
use eframe::egui::Ui;
use std::ops::RangeInclusive;

pub(super) const RESET: Reset = Reset { is_changed, reset };

/// What a coordinate can be, scene units.
pub(super) const POSITIONS: RangeInclusive<f64> = -LENGTH_LIMIT..=LENGTH_LIMIT;

fn placed(camera: &Camera) -> (glam::DVec3, glam::DVec3, glam::DVec3, f64) {
    (camera.look_from, camera.look_at, camera.vup, camera.vfov_degrees)
}

fn is_changed(document: &Document) -> bool {
    placed(&document.camera) != placed(&document.origin.recipe.camera)
}

fn reset(document: &mut Document) {
    let Camera { look_from, look_at, vup, vfov_degrees, .. } = document.origin.recipe.camera;
    let camera = &mut document.camera;
    *camera = Camera { look_from, look_at, vup, vfov_degrees, ..*camera };
}

pub(super) fn ui(ui: &mut Ui, camera: &mut Camera, facts: &Facts) {
    let disabled_reason = facts.no_rays();
    let speed = (camera.look_from.distance(camera.look_at) * 0.005).max(1e-4);
    let about = |name, help| About::new(name, help).disabled_if(disabled_reason);
    vector(
        ui,
        about("Look from", "Position of the eye, scene units (look_from)"),
        &mut camera.look_from,
        POSITIONS,
        speed,
    );
    vector(
        ui,
        about("Look at", "A point in the middle of the picture, scene units (look_at)"),
        &mut camera.look_at,
        POSITIONS,
        speed,
    );
    vector(
        ui,
        about("Up", "The direction that is up in the picture; its length does not matter (vup)"),
        &mut camera.vup,
        POSITIONS,
        0.01,
    );
    let vfov = about("Field of view", "From the lower to the upper edge, degrees (vfov)");
    let [narrowest, widest] = VFOV_LIMITS_DEGREES;
    let limits = narrowest..=widest;
    slider(ui, vfov, &mut camera.vfov_degrees, (limits.clone(), limits), "°", |slider| {
        slider.max_decimals(1)
    });
}
