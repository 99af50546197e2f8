//! The left panel: camera, lens, sphere, render.

use super::spheres;
use crate::app::commands::{Command, PanelContext};
use crate::app::model::spheres::Selected;
use crate::app::model::{Body, Document, Edit, Remembered, Sizing};
use crate::app::toolkit::number::{Number, colour, point_words, vector};
use crate::app::toolkit::widgets::{
    About, Header, above, check, command_button, entry, fold, group, hint, list, panel_line, row, switch,
};
use crate::job::render::{DEPTH_LIMIT, RenderSettings, SAMPLE_LIMIT, SIZE_LIMIT, SamplerKind};
use crate::progressive::Stop;
use crate::progressive::describe::counted;
use crate::scene::{
    Camera, DEFOCUS_LIMIT_DEGREES, FOCUS_LIMITS, LENGTH_LIMIT, Material, RADIUS_LIMITS,
    REFRACTION_INDEX_LIMITS, VFOV_LIMITS_DEGREES,
};
use crate::stages::Shading;
use eframe::egui::Ui;
use glam::DVec3;
use std::ops::RangeInclusive;
use std::sync::Arc;

/// Limits of a coordinate, scene units.
const POSITIONS: RangeInclusive<f64> = -LENGTH_LIMIT..=LENGTH_LIMIT;

/// What to try, as long as no sphere is selected.
const FIRST_STEPS: [&str; 3] = [
    "Drag the picture to look around it. Home returns.",
    "Click a sphere, then drag it or change its material.",
    "Page Up and Page Down turn the pages of the book.",
];

/// The first chapter whose pictures need another up vector or a lens.
const LENS_CHAPTER: u32 = 12;

/// Draws the panel.
pub fn ui(ui: &mut Ui, document: &mut Document, remembered: &mut Remembered, cx: &PanelContext) {
    let has_rays = document.no_rays().is_none();
    if has_rays {
        camera(ui, document);
        lens(ui, document);
        scene(ui, document, cx);
        sphere(ui, document, cx);
        panel_line(ui);
    }
    ui.spacing_mut().item_spacing.y = 0.0;
    render(ui, document, remembered, cx);
}

/// Whether the picture is a stage before the chapters about the camera.
fn is_early(document: &Document) -> bool {
    let chapter = document.stage().and_then(|stage| stage.section.split('.').next()?.parse().ok());
    chapter.is_some_and(|chapter: u32| chapter < LENS_CHAPTER)
}

fn camera(ui: &mut Ui, document: &mut Document) {
    let is_early = is_early(document);
    let (original, camera) = (document.origin.recipe.camera, &mut document.camera);
    let Camera { defocus_angle_degrees, focus_distance, .. } = *camera;
    let home = Camera { defocus_angle_degrees, focus_distance, ..original };
    let reset = (*camera != home).then_some("Reset camera");
    let header = Header { title: "Camera", reset, ..Header::default() };
    let is_reset = group(ui, header, |ui| {
        let help = "How wide the camera sees, from the lower to the upper edge, in degrees (vfov)";
        let [narrowest, widest] = VFOV_LIMITS_DEGREES;
        let number = Number::new(About::new("Field of view", help), narrowest..=widest);
        number.unit("°").slider(ui, &mut camera.vfov_degrees, narrowest..=widest, false);
        let summary = point_words(camera.look_from);
        let header = Header { title: "Position", summary: &summary, is_minor: true, ..Header::default() };
        fold(ui, header, false, |ui| position(ui, camera, is_early));
    });
    if is_reset {
        *camera = home;
    }
}

fn position(ui: &mut Ui, camera: &mut Camera, is_early: bool) {
    let speed = (camera.look_from.distance(camera.look_at) * 0.005).max(1e-4);
    let about = About::new("Look from", "Where the eye is, in units of the scene (lookfrom)");
    vector(ui, about, &mut camera.look_from, POSITIONS, speed);
    let about = About::new("Look at", "The point in the middle of the picture (lookat)");
    vector(ui, about, &mut camera.look_at, POSITIONS, speed);
    if !is_early {
        let about = About::new("Up", "Which way is up in the picture; the length does not matter (vup)");
        vector(ui, about, &mut camera.vup, POSITIONS, 0.01);
    }
}

fn lens(ui: &mut Ui, document: &mut Document) {
    let is_early = is_early(document);
    let (original, camera) = (document.origin.recipe.camera, &mut document.camera);
    let Camera { defocus_angle_degrees, focus_distance, .. } = original;
    let home = Camera { defocus_angle_degrees, focus_distance, ..*camera };
    let summary = if camera.defocus_angle_degrees == 0.0 { "pinhole" } else { "" };
    let reset = (*camera != home).then_some("Reset lens");
    let header = Header { title: "Lens", summary, reset, ..Header::default() };
    let controls = |ui: &mut Ui| lens_controls(ui, camera, defocus_angle_degrees);
    let is_reset = if is_early { fold(ui, header, false, controls) } else { group(ui, header, controls) };
    if is_reset {
        *camera = home;
    }
}

fn lens_controls(ui: &mut Ui, camera: &mut Camera, original: f64) {
    /// The widest lens of the slider blurs what is far away by this share of the picture's height.
    const BLUR: f64 = 0.1;
    let help = "How wide the lens is open: 0 is a pinhole, which is sharp everywhere (defocus_angle)";
    let limits = 0.0..=DEFOCUS_LIMIT_DEGREES.next_down();
    let widest = 2.0 * (BLUR * (camera.vfov_degrees.to_radians() / 2.0).tan()).atan().to_degrees();
    let number = Number::new(About::new("Defocus angle", help), limits).unit("°").speed(0.02);
    number.slider(ui, &mut camera.defocus_angle_degrees, 0.0..=widest.max(original), true);
    let help = "How far away things are sharp; Ctrl and a click on the picture set it too (focus_dist)";
    let pinhole = (camera.defocus_angle_degrees == 0.0)
        .then_some("A pinhole is sharp everywhere; set a defocus angle above 0 first");
    let number = Number::new(About::new("Focus distance", help).disabled_if(pinhole), FOCUS_LIMITS);
    let (usual, mut distance) =
        (camera.look_from.distance(camera.look_at), camera.effective_focus_distance());
    number.slider(ui, &mut distance, 0.1 * usual..=10.0 * usual, true);
    if distance != camera.effective_focus_distance() {
        camera.focus_distance = Some(distance);
    }
}

fn sphere(ui: &mut Ui, document: &mut Document, cx: &PanelContext) {
    let selected = Selected::of(&cx.model);
    let title = selected.as_ref().map_or("Sphere".to_owned(), |selected| {
        format!("Sphere {}: {}", selected.sphere + 1, selected.material)
    });
    let reset = document.has_changed_scene().then_some("Reset spheres");
    let is_reset = group(ui, Header { title: &title, reset, ..Header::default() }, |ui| {
        let Some(selected) = selected else {
            FIRST_STEPS.iter().for_each(|step| _ = hint(ui, step));
            return;
        };
        let body = body(ui, &selected, document);
        if body != selected.body {
            cx.edit(Edit::Change(selected.sphere, body));
        }
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 4.0;
            command_button(ui, cx, Command::FocusSphere, "Focus");
            command_button(ui, cx, Command::DeleteSphere, "Delete");
        });
    });
    if is_reset {
        document.checked = Arc::clone(&document.origin.scene);
    }
}

/// All spheres, and the sky, which is the only lamp of the book.
fn scene(ui: &mut Ui, document: &Document, cx: &PanelContext) {
    let (mut sky, own) = (document.scene().sky, document.origin.recipe.scene.sky);
    let reset = (sky != own).then_some("Reset sky");
    let summary = counted(document.scene().spheres.len() as u64, "sphere");
    let header = Header { title: "Scene", summary: &summary, reset, ..Header::default() };
    let is_reset = fold(ui, header, false, |ui| {
        spheres::ui(ui, cx);
        ui.add_space(8.0);
        ui.spacing_mut().item_spacing.y = 8.0;
        colour(ui, About::new("Sky overhead", "The light from straight above"), &mut sky.top);
        let help = "The light from straight below, which fades upwards";
        colour(ui, About::new("Sky at the horizon", help), &mut sky.bottom);
    });
    let sky = if is_reset { own } else { sky };
    if sky != document.scene().sky {
        cx.edit(Edit::Sky(sky));
    }
}

/// The values of the sphere after this frame.
fn body(ui: &mut Ui, selected: &Selected, document: &Document) -> Body {
    let mut body = selected.body;
    let rules = document.rules();
    let unused = match rules.shading {
        Shading::Path | Shading::ImageGradient => None,
        Shading::FirstHitRed => Some("In this stage every sphere is red"),
        Shading::Normals => Some("In this stage the colour shows the normal"),
    };
    let strips = rules.reflectance_strips.then_some("In this stage the strips have the colours");
    body.material = kind(ui, body.material, unused);
    match &mut body.material {
        Material::Lambertian { albedo } => colour(ui, albedo_words().disabled_if(unused.or(strips)), albedo),
        Material::Metal { albedo, fuzz } => {
            colour(ui, albedo_words().disabled_if(unused.or(strips)), albedo);
            let about = About::new("Fuzz", "How rough the metal is: 0 is a mirror, 1 is brushed (fuzz)");
            Number::new(about.disabled_if(unused), 0.0..=1.0).speed(0.005).slider(ui, fuzz, 0.0..=1.0, false);
        }
        Material::Dielectric { refraction_index } => {
            let help =
                "How strongly glass bends light: 1 not at all, glass 1.5, diamond 2.4 (refraction_index)";
            let number = Number::new(About::new("Index", help).disabled_if(unused), REFRACTION_INDEX_LIMITS);
            number.speed(0.005).slider(ui, refraction_index, 0.4..=2.6, false);
        }
    }
    let speed = (document.camera.look_from.distance(body.center) * 0.003).max(1e-6);
    let about = About::new("Centre", "The middle of the sphere");
    vector(ui, about, &mut body.center, POSITIONS, speed);
    let help = "Half its width; dragging the dot on its outline changes it too";
    Number::new(About::new("Radius", help), RADIUS_LIMITS).row(ui, &mut body.radius);
    body
}

fn albedo_words() -> About<'static> {
    About::new("Colour", "The share of red, green and blue light that it gives back (albedo)")
}

/// The kinds of material. Another kind keeps the colour.
fn kind(ui: &mut Ui, material: Material, disabled_reason: Option<&str>) -> Material {
    let albedo = material.albedo().unwrap_or(DVec3::splat(0.8));
    let help = "Matte scatters light everywhere, metal mirrors it, glass lets it through";
    let options = [
        ("Matte", Material::Lambertian { albedo }),
        ("Metal", Material::Metal { albedo, fuzz: 0.0 }),
        ("Glass", Material::Dielectric { refraction_index: 1.5 }),
    ]
    .map(|(name, other)| {
        let is_it = other.kind() == material.kind();
        (if is_it { material } else { other }, About::new(name, help).disabled_if(disabled_reason))
    });
    let width = (ui.available_width() / 3.0).floor();
    switch(ui, width, material, &options).unwrap_or(material)
}

/// Size, end and settings of the render.
fn render(ui: &mut Ui, document: &mut Document, remembered: &mut Remembered, cx: &PanelContext) {
    let (origin, size) = (Arc::clone(&document.origin), document.size());
    let is_own = document.has_own_size;
    let is_resized = is_own != origin.keeps_size() || (is_own && size != origin.size());
    let usual = RenderSettings { width: size[0], height: size[1], ..origin.recipe.settings };
    let is_changed = is_resized || document.stop != origin.usual_stop() || document.settings != usual;
    let summary = format!("{} × {}", size[0], size[1]);
    let header = Header {
        title: "Render",
        summary: &summary,
        reset: is_changed.then_some("Reset size, samples and tracer"),
        ..Header::default()
    };
    let is_reset = fold(ui, header, document.no_rays().is_some(), |ui| {
        sizing(ui, document, remembered, cx);
        stop(ui, &mut document.stop, origin.recipe.samples_per_pixel);
        if document.is_random() {
            tracer(ui, document);
        }
    });
    if is_reset {
        document.settings = usual;
        (document.has_own_size, document.stop) = (origin.keeps_size(), origin.usual_stop());
        if document.has_own_size {
            document.set_size(origin.size());
        }
    }
}

fn sizing(ui: &mut Ui, document: &mut Document, remembered: &mut Remembered, cx: &PanelContext) {
    let names = [
        ("Fill the window", Some(Sizing::Viewport)),
        ("As in the book", Some(Sizing::Book)),
        ("Other", None),
    ];
    let is_of_origin = document.origin.keeps_size() && document.size() == document.origin.size();
    let own = is_of_origin.then_some(Sizing::Book);
    let chosen = if document.has_own_size { own } else { Some(remembered.sizing) };
    let shown = names.iter().find(|(_, sizing)| *sizing == chosen).map_or("", |(name, _)| name);
    ui.spacing_mut().combo_width = 136.0;
    list(ui, About::new("Size", "How many pixels are rendered"), shown, |ui| {
        for (name, sizing) in names {
            if entry(ui, sizing == chosen, About::new(name, "")) {
                match sizing {
                    Some(sizing) => {
                        remembered.sizing = sizing;
                        cx.send(Command::RenderAtSize);
                    }
                    None => document.has_own_size = true,
                }
            }
        }
    });
    let before = document.size();
    let mut size = before;
    for (name, pixels) in ["Width", "Height"].into_iter().zip(&mut size) {
        whole(ui, About::new(name, "Pixels"), pixels, 1..=SIZE_LIMIT, 64.0);
    }
    let place = ui.scope_id().with("keeps its shape");
    let mut keeps = ui.data(|data| data.get_temp(place)).unwrap_or(true);
    check(ui, About::new("Keep the shape", "Width and height change together"), &mut keeps);
    ui.data_mut(|data| data.insert_temp(place, keeps));
    if size != before {
        document.give_size(if keeps { in_shape(before, before, size) } else { size });
    }
}

/// A size of this shape; one side of it was changed since `before`.
pub fn in_shape(shape: [u32; 2], before: [u32; 2], size: [u32; 2]) -> [u32; 2] {
    let axis = usize::from(size[0] == before[0]);
    let factor = f64::from(size[axis]) / f64::from(shape[axis]);
    // The other side has limits, too.
    let most = f64::from(SIZE_LIMIT) / f64::from(shape[1 - axis]);
    shape.map(|side| ((f64::from(side) * factor.min(most)).round() as u32).max(1))
}

/// A row for a whole number.
fn whole(ui: &mut Ui, about: About<'_>, value: &mut u32, limits: RangeInclusive<u32>, width: f32) {
    let limits = f64::from(*limits.start())..=f64::from(*limits.end());
    row(ui, about, |ui| Number::new(about, limits).whole_field(ui, width, value));
}

/// The stop condition. A choice replaces the one of the command line.
fn stop(ui: &mut Ui, stop: &mut Stop, usual: u64) {
    let choices = [
        ("Error", Stop { noise: Some(Stop::NOISE), ..Stop::default() }),
        ("Samples", Stop::at_samples(usual)),
        ("Time", Stop { seconds: Some(60.0), ..Stop::default() }),
        ("Never", Stop::default()),
    ];
    let chosen = match stop {
        Stop { noise: Some(_), .. } => 0,
        Stop { samples: Some(_), .. } => 1,
        Stop { seconds: Some(_), .. } => 2,
        _ => 3,
    };
    list(ui, About::new("Stop at", "When the render is done"), choices[chosen].0, |ui| {
        for (index, (name, other)) in choices.into_iter().enumerate() {
            if entry(ui, index == chosen, About::new(name, "")) && index != chosen {
                *stop = other;
            }
        }
    });
    if let Some(noise) = &mut stop.noise {
        let help = "How far pixels may still be from the finished picture, in per cent of white";
        let mut percent = 100.0 * *noise;
        let number = Number::new(About::new("Error", help), 1e-4..=100.0);
        if number.unit(" %").speed(0.005).row(ui, &mut percent).changed() {
            *noise = percent / 100.0;
        }
    }
    if let Some(samples) = &mut stop.samples {
        let help = "A sample is one random path through a pixel; a pixel is the mean of its samples";
        let mut count = *samples as f64;
        Number::new(About::new("Samples per pixel", help), 1.0..=SAMPLE_LIMIT as f64)
            .whole()
            .row(ui, &mut count);
        *samples = count as u64;
    }
    if let Some(seconds) = &mut stop.seconds {
        let about = About::new("Time", "Seconds of tracing, without pauses");
        Number::new(about, 0.1..=1e6).unit(" s").speed(0.5).row(ui, seconds);
    }
}

/// How paths are traced.
fn tracer(ui: &mut Ui, document: &mut Document) {
    let is_path = document.rules().shading == Shading::Path;
    let settings = &mut document.settings;
    if is_path {
        let help = "A path that has not ended by then brings back no light (max_depth)";
        let about = About::new("Rays per path, at most", help);
        whole(ui, about, &mut settings.max_depth, 1..=DEPTH_LIMIT, 48.0);
    }
    ui.scope(|ui| {
        above(ui, About::new("Random numbers", ""));
        let even = "Even ones (Sobol) spread over the pixel and need fewer samples";
        let options = [
            (SamplerKind::Sobol, About::new("Even (Sobol)", even)),
            (SamplerKind::Independent, About::new("Independent", "Independent ones are those of the book")),
        ];
        let width = (ui.available_width() / 2.0).floor();
        settings.sampler = switch(ui, width, settings.sampler, &options).unwrap_or(settings.sampler);
    });
    let about = About::new("Seed", "Another seed gives the same picture with other noise");
    whole(ui, about, &mut settings.seed, 0..=u32::MAX, 112.0);
}

#[cfg(test)]
mod tests;
