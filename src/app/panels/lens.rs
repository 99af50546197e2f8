//! Controls for the lens: defocus and focus distance.

use super::reset::Reset;
use crate::app::facts::Facts;
use crate::app::model::document::Document;
use crate::app::widgets::{About, check, slider};
use crate::scene::{Camera, DEFOCUS_LIMIT_DEGREES, FOCUS_LIMITS};
use eframe::egui::Ui;

pub(super) const RESET: Reset = Reset { is_changed, reset };

/// The limit itself is excluded.
const WIDEST_DEFOCUS_DEGREES: f64 = DEFOCUS_LIMIT_DEGREES - 0.1;

fn lens(camera: &Camera) -> (f64, Option<f64>) {
    (camera.defocus_angle_degrees, camera.focus_distance)
}

fn is_changed(document: &Document) -> bool {
    lens(&document.camera) != lens(&document.origin.recipe.camera)
}

fn reset(document: &mut Document) {
    let (angle, focus) = lens(&document.origin.recipe.camera);
    let camera = &mut document.camera;
    camera.defocus_angle_degrees = angle;
    camera.focus_distance = focus;
}

pub(super) fn ui(ui: &mut Ui, camera: &mut Camera, facts: &Facts) {
    let no_rays = facts.no_rays();
    let defocus = About::new(
        "Defocus angle",
        "Angle of the cone from the focus point to the lens, degrees; 0 is a pinhole (defocus_angle)",
    );
    let defocus = defocus.disabled_if(no_rays);
    let ranges = (0.0..=30.0, 0.0..=WIDEST_DEFOCUS_DEGREES);
    slider(ui, defocus, &mut camera.defocus_angle_degrees, ranges, "°", |slider| slider.max_decimals(2));
    let pinhole = (camera.defocus_angle_degrees == 0.0)
        .then_some("A pinhole is sharp everywhere: set a defocus angle above 0");
    let disabled_reason = no_rays.or(pinhole);
    let mut follows = camera.focus_distance.is_none();
    let about = About::new("Focus on Look at", "Keep the point that the camera looks at in focus");
    if check(ui, about.disabled_if(disabled_reason), &mut follows).changed() {
        camera.focus_distance = (!follows).then(|| camera.effective_focus_distance());
    }
    let about = About::new(
        "Focus distance",
        "Distance to the plane in focus, scene units (focus_distance). Ctrl and a click on the picture set it too",
    );
    let mut distance = camera.effective_focus_distance();
    let (about, ranges) = (about.disabled_if(disabled_reason), (0.01..=1000.0, FOCUS_LIMITS));
    let slider = slider(ui, about, &mut distance, ranges, "", |slider| slider.logarithmic(true));
    if slider.changed() {
        camera.focus_distance = Some(distance);
    }
}
