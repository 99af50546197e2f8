//! Controls for the device and the render settings.

use super::reset::Reset;
use crate::app::facts::Facts;
use crate::app::model::device::{Device, core_count, lane_counts};
use crate::app::model::document::Document;
use crate::app::model::remembered::Remembered;
use crate::app::tips;
use crate::app::widgets::{About, check, choice, control, whole};
use crate::job::render::{DEPTH_LIMIT, RenderSettings, SamplerKind};
use crate::stages::Shading;
use eframe::egui::{self, ComboBox, Ui};

pub(super) const RESET: Reset = Reset { is_changed, reset };

fn is_changed(document: &Document) -> bool {
    document.settings != of_origin(document)
}

fn reset(document: &mut Document) {
    document.settings = of_origin(document);
}

/// The origin's settings at the present size, which belongs to another group.
fn of_origin(document: &Document) -> RenderSettings {
    let RenderSettings { width, height, .. } = document.settings;
    RenderSettings { width, height, ..document.origin.recipe.settings }
}

pub(super) fn ui(ui: &mut Ui, settings: &mut RenderSettings, remembered: &mut Remembered, facts: &Facts) {
    device(ui, &mut remembered.device);
    lanes_and_threads(ui, remembered);
    let rules = facts.document().rules();
    let shading = rules.shading;
    let no_rays = facts.no_rays();
    let one_ray = (shading != Shading::Path).then_some("In this stage rays end at their first hit");
    let no_chance =
        (!rules.antialiasing && shading != Shading::Path).then_some("In this stage nothing is random");

    let mut depth = u64::from(settings.max_depth);
    let about = About::new("Depth", "Largest number of rays per path, including the camera ray (max_depth)");
    whole(ui, about.disabled_if(no_rays.or(one_ray)), &mut depth, 1..=u64::from(DEPTH_LIMIT), 0.2);
    settings.max_depth = u32::try_from(depth).unwrap_or(DEPTH_LIMIT);

    let about = About::new(
        "Sampler",
        "Source of the random numbers: Sobol points need fewer samples, independent numbers are the book's",
    );
    control(ui, about.disabled_if(no_chance), |ui| {
        ComboBox::from_id_salt("sampler")
            .width(ui.available_width())
            .selected_text(settings.sampler.name())
            .show_ui(ui, |ui| {
                for sampler in SamplerKind::ALL {
                    choice(ui, &mut settings.sampler, sampler, sampler.name());
                }
            })
            .response
    });
    let mut seed = u64::from(settings.seed);
    let about = About::new("Seed", "Pictures with different seeds differ only in their noise");
    whole(ui, about.disabled_if(no_chance), &mut seed, 0..=u64::from(u32::MAX), 0.05);
    settings.seed = u32::try_from(seed).unwrap_or(u32::MAX);
    let about = About::new(
        "Estimate error",
        "Keep the samples in two halves, whose difference shows the error; without it, the film takes half the memory",
    );
    check(ui, about, &mut settings.estimate_error);
}

fn device(ui: &mut Ui, chosen: &mut Device) {
    let about = About::new(
        "Device",
        "What traces. Switching does not restart the render: the same film continues (G)",
    );
    control(ui, about, |ui| {
        ComboBox::from_id_salt("device")
            .width(ui.available_width())
            .selected_text(chosen.label())
            .show_ui(ui, |ui| {
                for device in Device::ALL {
                    let reason = device.unavailable();
                    let button = egui::Button::selectable(device == *chosen, device.label());
                    let response = ui.add_enabled(reason.is_none(), button);
                    let column = response.rect.x_range();
                    let help = device.long_help();
                    if tips::explain_in_column(response, column, &help, reason.as_deref()).clicked() {
                        *chosen = device;
                        ui.close();
                    }
                }
            })
            .response
    });
}

fn lanes_and_threads(ui: &mut Ui, remembered: &mut Remembered) {
    let scalar = (remembered.device == Device::Reference).then_some("The reference traces one ray at a time");
    let not_cpu =
        (remembered.device == Device::Gpu).then_some("The graphics adapter has its own lanes and threads");
    let word = |count: Option<usize>| count.map_or_else(|| "automatic".to_owned(), |count| count.to_string());
    let about = About::new(
        "Lanes",
        "Rays per packet. Switching does not restart the render: the samples are the same to the bit",
    );
    control(ui, about.disabled_if(not_cpu.or(scalar)), |ui| {
        ComboBox::from_id_salt("lanes")
            .width(ui.available_width())
            .selected_text(word(remembered.lanes))
            .show_ui(ui, |ui| {
                for lanes in [None].into_iter().chain(lane_counts().into_iter().map(Some)) {
                    choice(ui, &mut remembered.lanes, lanes, word(lanes));
                }
            })
            .response
    });
    let about = About::new(
        "Threads",
        "Threads that trace. Automatic leaves one core to the window if there are more than two",
    );
    control(ui, about.disabled_if(not_cpu), |ui| {
        ComboBox::from_id_salt("threads")
            .width(ui.available_width())
            .selected_text(word(remembered.threads))
            .show_ui(ui, |ui| {
                for threads in [None].into_iter().chain((1..=core_count()).map(Some)) {
                    choice(ui, &mut remembered.threads, threads, word(threads));
                }
            })
            .response
    });
}
