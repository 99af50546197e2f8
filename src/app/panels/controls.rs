//! The left panel: camera, lens, sphere, render.

use crate::app::commands::{Command, PanelContext};
use crate::app::model::spheres::Selected;
use crate::app::model::{Body, Document, Edit, Remembered, Sizing};
use crate::app::toolkit::number::{Number, colour, point_words, vector};
use crate::app::toolkit::widgets::{
    About, above, entry, fold, hint, list, panel_line, row, small, switch, tip,
};
use crate::job::render::{DEPTH_LIMIT, SAMPLE_LIMIT, SIZE_LIMIT, SamplerKind};
use crate::progressive::Stop;
use crate::scene::{
    Camera, DEFOCUS_LIMIT_DEGREES, FOCUS_LIMITS, LENGTH_LIMIT, Material, RADIUS_LIMITS,
    REFRACTION_INDEX_LIMITS, VFOV_LIMITS_DEGREES,
};
use crate::stages::Shading;
use eframe::egui::Ui;
use glam::DVec3;
use std::ops::RangeInclusive;

/// Limits of a coordinate, scene units.
const POSITIONS: RangeInclusive<f64> = -LENGTH_LIMIT..=LENGTH_LIMIT;

/// What to try, as long as no sphere is selected.
const FIRST_STEPS: [&str; 3] = [
    "Drag the picture to look around it. Home returns.",
    "Click a sphere, then drag it or change its material.",
    "Page Up and Page Down turn the pages of the book.",
];

/// Draws the panel.
pub fn ui(ui: &mut Ui, document: &mut Document, remembered: &mut Remembered, cx: &PanelContext) {
    let has_rays = document.no_rays().is_none();
    if has_rays {
        camera(ui, document);
        lens(ui, document);
        sphere(ui, document, cx);
        sky(ui, document, cx);
        panel_line(ui);
    }
    ui.spacing_mut().item_spacing.y = 0.0;
    render(ui, document, remembered, cx);
}

fn camera(ui: &mut Ui, document: &mut Document) {
    let camera = &mut document.camera;
    fold(ui, ["Camera", ""], true, |ui| {
        let help = "How wide the camera sees, from the lower to the upper edge, in degrees (vfov)";
        let [narrowest, widest] = VFOV_LIMITS_DEGREES;
        let number = Number::new(About::new("Field of view", help), narrowest..=widest);
        number.unit("°").slider(ui, &mut camera.vfov_degrees, narrowest..=widest, false);
        let place = point_words(camera.look_from);
        fold(ui, ["Position", &place], false, |ui| position(ui, camera));
    });
}

fn position(ui: &mut Ui, camera: &mut Camera) {
    let speed = (camera.look_from.distance(camera.look_at) * 0.005).max(1e-4);
    let about = About::new("Look from", "Where the eye is, in units of the scene (lookfrom)");
    vector(ui, about, &mut camera.look_from, POSITIONS, speed);
    let about = About::new("Look at", "The point in the middle of the picture (lookat)");
    vector(ui, about, &mut camera.look_at, POSITIONS, speed);
    let about = About::new("Up", "Which way is up in the picture; the length does not matter (vup)");
    vector(ui, about, &mut camera.vup, POSITIONS, 0.01);
}

fn lens(ui: &mut Ui, document: &mut Document) {
    /// The widest lens of the slider blurs what is far away by this share of the picture's height.
    const BLUR: f64 = 0.1;
    let original = document.origin.recipe.camera.defocus_angle_degrees;
    let camera = &mut document.camera;
    let is_pinhole = camera.defocus_angle_degrees == 0.0;
    fold(ui, ["Lens", if is_pinhole { "pinhole" } else { "" }], original > 0.0, |ui| {
        let help = "How wide the lens is open: 0 is a pinhole, which is sharp everywhere (defocus_angle)";
        let limits = 0.0..=DEFOCUS_LIMIT_DEGREES.next_down();
        let widest = 2.0 * (BLUR * (camera.vfov_degrees.to_radians() / 2.0).tan()).atan().to_degrees();
        let number = Number::new(About::new("Defocus angle", help), limits).unit("°").speed(0.02);
        number.slider(ui, &mut camera.defocus_angle_degrees, 0.0..=widest.max(original), true);
        let help = "How far away things are sharp; Ctrl and a click on the picture set it too (focus_dist)";
        let reason = "A pinhole is sharp everywhere; set a defocus angle above 0 first";
        let about = About::new("Focus distance", help).disabled_if(is_pinhole.then_some(reason));
        let (usual, before) = (camera.look_from.distance(camera.look_at), camera.effective_focus_distance());
        let mut distance = before;
        Number::new(about, FOCUS_LIMITS).slider(ui, &mut distance, 0.1 * usual..=10.0 * usual, true);
        if distance != before {
            camera.focus_distance = Some(distance);
        }
    });
}

fn sphere(ui: &mut Ui, document: &Document, cx: &PanelContext) {
    fold(ui, ["Sphere", ""], true, |ui| {
        let Some(selected) = Selected::of(&cx.model) else {
            FIRST_STEPS.iter().for_each(|step| _ = hint(ui, step));
            return;
        };
        small(ui, format!("Number {}, {}", selected.sphere + 1, selected.material));
        let body = body(ui, &selected, document);
        if body != selected.body {
            cx.send(Command::Edit(Edit::Change(selected.sphere, body)));
        }
    });
}

/// The sky, which is the only lamp of the book.
fn sky(ui: &mut Ui, document: &Document, cx: &PanelContext) {
    let mut sky = document.scene().sky;
    fold(ui, ["Sky", ""], false, |ui| {
        colour(ui, About::new("Overhead", "The light from straight above"), &mut sky.top);
        let help = "The light from straight below, which fades upwards";
        colour(ui, About::new("At the horizon", help), &mut sky.bottom);
    });
    if sky != document.scene().sky {
        cx.send(Command::Edit(Edit::Sky(sky)));
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
    let [width, height] = document.size();
    let size = format!("{width} × {height}");
    fold(ui, ["Render", &size], document.no_rays().is_some(), |ui| {
        sizing(ui, document, remembered, cx);
        let usual = document.origin.recipe.samples_per_pixel;
        stop(ui, &mut document.stop, usual);
        if document.is_random() {
            tracer(ui, document);
        }
    });
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
    let check = ui.checkbox(&mut keeps, "Keep the shape");
    tip(ui, check, "Width and height change together", None);
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
