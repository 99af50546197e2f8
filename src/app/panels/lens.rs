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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::tests::{dressed, facts_of};
    use eframe::egui::Role;
    use egui_kittest::Harness;
    use egui_kittest::kittest::{NodeT, Queryable};

    /// The controls of a lens of 10 degrees that is focused at 3.4, and their camera.
    fn controls() -> Harness<'static, Camera> {
        let facts = facts_of("--stage defocus --size 32x18");
        let camera = facts.document().camera;
        assert_eq!(lens(&camera), (10.0, Some(3.4)));
        let mut harness =
            dressed([260.0, 300.0]).build_ui_state(move |ui, camera| super::ui(ui, camera, &facts), camera);
        harness.run_steps(2);
        harness
    }

    #[test]
    fn a_typed_number_can_be_beyond_the_slider_beside_it() {
        let mut harness = controls();
        for (name, role, value, angle, focus) in [
            ("Defocus angle", Role::Slider, 100.0, 30.0, 3.4),
            ("Defocus angle", Role::SpinButton, 100.0, 100.0, 3.4),
            ("Defocus angle", Role::SpinButton, 1000.0, WIDEST_DEFOCUS_DEGREES, 3.4),
            ("Defocus angle", Role::SpinButton, 5.0, 5.0, 3.4),
            ("Focus distance", Role::Slider, 5000.0, 5.0, 1000.0),
            ("Focus distance", Role::SpinButton, 5000.0, 5.0, 5000.0),
            ("Focus distance", Role::Slider, 0.0, 5.0, 0.01),
            ("Focus distance", Role::SpinButton, 0.001, 5.0, 0.001),
        ] {
            let mut named = harness.get_all_by_label(name);
            named.find(|node| node.accesskit_node().role() == role).unwrap().set_value_accesskit(value);
            drop(named);
            harness.run_steps(3);
            let found = lens(harness.state());
            let error = (found.0 - angle).abs().max((found.1.unwrap() - focus).abs());
            assert!(error < 1e-9, "{name}, {role:?}, {value}: {found:?}");
        }
    }
}
