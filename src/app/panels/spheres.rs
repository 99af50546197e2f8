//! Controls for the selected sphere: its place, size and material.

use super::camera::POSITIONS;
use super::reset::Reset;
use crate::app::command::Command;
use crate::app::facts::Facts;
use crate::app::model::document::Document;
use crate::app::model::edit::{Body, Edit};
use crate::app::spheres::Selected;
use crate::app::tips::{self, Side};
use crate::app::widgets::{About, choice, control, explained, named, number, slider, under_name, vector};
use crate::scene::{Material, RADIUS_LIMITS, REFRACTION_INDEX_LIMITS};
use crate::stages::Shading;
use eframe::egui::{self, ComboBox, RichText, Ui, vec2};
use glam::DVec3;
use std::sync::Arc;

pub(super) const RESET: Reset = Reset { is_changed: Document::has_changed_scene, reset };

fn reset(document: &mut Document) {
    document.checked = Arc::clone(&document.origin.scene);
}

pub(super) fn ui(
    ui: &mut Ui,
    selected: Option<&Selected>,
    facts: &Facts,
    edits: &mut Vec<Edit>,
    commands: &mut Vec<Command>,
) {
    match selected {
        None => {
            let text = match facts.no_rays() {
                Some(_) => "This stage has no spheres.",
                None => "Click a sphere to select it.",
            };
            ui.add(egui::Label::new(RichText::new(text).color(ui.visuals().weak_text_color())).wrap());
            ui.add_space(2.0);
        }
        Some(selected) => {
            name(ui, selected, facts, commands);
            let body = edited(ui, selected, facts);
            if body != selected.body {
                edits.push(Edit::Change(selected.sphere, body));
            }
        }
    }
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        let row: &[(Command, &str)] = match selected {
            None => &[(Command::AddSphere, "Add a sphere")],
            Some(_) => &[
                (Command::AddSphere, "Add"),
                (Command::DuplicateSphere, "Duplicate"),
                (Command::DeleteSphere, "Delete"),
                (Command::FocusSphere, "Focus"),
                (Command::LookAtSphere, "Look at"),
            ],
        };
        for (command, name) in row {
            button(ui, facts, commands, *command, name);
        }
    });
}

fn button(ui: &mut Ui, facts: &Facts, commands: &mut Vec<Command>, command: Command, name: &str) {
    let disabled_reason = facts.disabled_reason(command);
    let help = match command.keys(ui.ctx()) {
        Some(keys) => format!("{} ({keys})", command.help()),
        None => command.help().to_owned(),
    };
    let response = ui.add_enabled(disabled_reason.is_none(), egui::Button::new(name));
    let response = tips::explain(ui, response, Side::Beside, &help, disabled_reason.as_deref());
    if response.accessible_name(command.name()).clicked() {
        commands.push(command);
    }
}

/// The name of the sphere, between buttons that lead to its neighbours.
fn name(ui: &mut Ui, selected: &Selected, facts: &Facts, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        button(ui, facts, commands, Command::PreviousSphere, "‹");
        button(ui, facts, commands, Command::NextSphere, "›");
        let text = format!("sphere {}, {}", selected.sphere, selected.material);
        let help = format!("Sphere {} of {}, counted from 0", selected.sphere, selected.count);
        let response = ui.add(egui::Label::new(RichText::new(text).strong()).truncate());
        tips::beside(ui, response, &help);
    });
    ui.add_space(3.0);
}

/// The values of the sphere after this frame.
fn edited(ui: &mut Ui, selected: &Selected, facts: &Facts) -> Body {
    let mut body = selected.body;
    let eye = facts.document().camera.look_from;
    let no_rays = facts.no_rays();
    let speed = (eye.distance(body.center) * 0.003).max(1e-6);
    let about = About::new("Centre", "Centre of the sphere, scene units. In the picture, drag the sphere");
    vector(ui, about.disabled_if(no_rays), &mut body.center, POSITIONS, speed);
    let about = About::new(
        "Radius",
        "Radius of the sphere, scene units. In the picture, drag the handle on the outline",
    );
    let about = about.disabled_if(no_rays);
    under_name(ui, about, |ui| {
        let size = vec2(ui.available_width(), ui.spacing().interact_size.y);
        let speed = 0.01 * body.radius;
        let response =
            number(ui, (about.name, size), &mut body.radius, RADIUS_LIMITS, |drag| drag.speed(speed));
        explained(ui, response, about)
    });
    let unused = match facts.document().rules().shading {
        Shading::Path => None,
        Shading::FirstHitRed => Some("In this stage every sphere is red, whatever its material"),
        Shading::Normals => Some("In this stage the colour shows the normal, whatever the material"),
        Shading::ImageGradient => no_rays,
    };
    let strips = facts.document().rules().reflectance_strips;
    let strips = strips.then_some("In this stage the strips replace the albedo of every material");
    body.material = kind(ui, body.material, unused);
    match &mut body.material {
        Material::Lambertian { albedo } => colour(ui, albedo, unused.or(strips)),
        Material::Metal { albedo, fuzz } => {
            colour(ui, albedo, unused.or(strips));
            let about = About::new(
                "Fuzz",
                "How much the reflection is blurred: 0 is a mirror. Values above 1 act as 1 (fuzz)",
            );
            let ranges = (0.0..=1.0, 0.0..=f64::MAX);
            slider(ui, about.disabled_if(unused), fuzz, ranges, "", |slider| slider.max_decimals(3));
        }
        Material::Dielectric { refraction_index } => {
            let about = About::new(
                "Refraction index",
                "Relative to the surroundings: glass 1.5, water 1.33, diamond 2.4, air in glass 0.67 (refraction_index)",
            );
            let (about, ranges) = (about.disabled_if(unused), (0.4..=2.6, REFRACTION_INDEX_LIMITS));
            slider(ui, about, refraction_index, ranges, "", |slider| slider.max_decimals(3));
        }
    }
    body
}

/// A list of the kinds of material. Another kind keeps the albedo.
fn kind(ui: &mut Ui, material: Material, disabled_reason: Option<&str>) -> Material {
    let albedo = material.albedo().unwrap_or(DVec3::splat(0.8));
    let kinds = [
        Material::Lambertian { albedo },
        Material::Metal { albedo, fuzz: 0.0 },
        Material::Dielectric { refraction_index: 1.5 },
    ];
    let mut chosen = material;
    let about =
        About::new("Material", "How the surface scatters light. Other spheres of this material keep theirs");
    control(ui, about.disabled_if(disabled_reason), |ui| {
        ComboBox::from_id_salt("material")
            .width(ui.available_width())
            .selected_text(material.kind())
            .show_ui(ui, |ui| {
                for other in kinds {
                    let is_it = other.kind() == material.kind();
                    choice(ui, &mut chosen, if is_it { material } else { other }, other.kind());
                }
            })
            .response
    });
    chosen
}

/// A colour, with its components as the scene file has them.
fn colour(ui: &mut Ui, albedo: &mut DVec3, disabled_reason: Option<&str>) {
    let about = About::new(
        "Albedo",
        "Share of the light that is reflected: red, green, blue; linear, 0 to 1 (albedo)",
    )
    .disabled_if(disabled_reason);
    under_name(ui, about, |ui| {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 4.0;
            let height = ui.spacing().interact_size.y;
            ui.spacing_mut().interact_size.x = height + 8.0;
            let before = albedo.to_array().map(|component| component as f32);
            let mut rgb = before;
            let mut all = ui.color_edit_button_rgb(&mut rgb);
            named(&all, "Albedo");
            all = explained(ui, all, about);
            // The button rounds a colour that nobody changes, too.
            if all.changed() {
                *albedo = picked(*albedo, before, rgb);
            }
            let width = (ui.available_width() - 8.0) / 3.0;
            for (name, component) in ["red", "green", "blue"].into_iter().zip(albedo.as_mut()) {
                let (name, size) = (format!("Albedo {name}"), vec2(width, height));
                let response = number(ui, (&name, size), component, 0.0..=1.0, |drag| drag.speed(0.005));
                all = all.union(explained(ui, response, about));
            }
            all
        })
        .inner
    });
}

/// The colour after the user has picked another one. Components that stay keep all their digits; the others get as many
/// as a scene file needs.
fn picked(albedo: DVec3, before: [f32; 3], after: [f32; 3]) -> DVec3 {
    let component = |index: usize| match after[index] {
        same if same == before[index] => albedo[index],
        other => ((f64::from(other) * 1e4).round() / 1e4).clamp(0.0, 1.0),
    };
    DVec3::from_array([0, 1, 2].map(component))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::tests::{dressed, part};
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;

    #[test]
    fn a_colour_that_nobody_changes_keeps_its_digits() {
        let component = |index: u32| f64::from(index % 101) / 101.0 + 1e-9;
        let colours: Vec<DVec3> =
            (0..100).map(|index| DVec3::from_array([7, 31, 53].map(|by| component(index * by)))).collect();
        let mut shown = colours.clone();
        let mut harness = part([240.0, 200.0], |ui| {
            for albedo in &mut shown {
                ui.push_id(albedo.to_string(), |ui| colour(ui, albedo, None));
            }
        });
        harness.run_steps(3);
        drop(harness);
        assert_eq!(shown, colours);
    }

    #[test]
    fn another_kind_of_material_keeps_the_albedo_and_the_same_kind_everything() {
        let gold = DVec3::new(0.8, 0.6, 0.2);
        let grey = DVec3::splat(0.8);
        let metal = Material::Metal { albedo: gold, fuzz: 0.3 };
        let water = Material::Dielectric { refraction_index: 1.33 };
        for (material, chosen, expected) in [
            (metal, "lambertian", Material::Lambertian { albedo: gold }),
            (metal, "metal", metal),
            (metal, "dielectric", Material::Dielectric { refraction_index: 1.5 }),
            (Material::Lambertian { albedo: gold }, "metal", Material::Metal { albedo: gold, fuzz: 0.0 }),
            (water, "lambertian", Material::Lambertian { albedo: grey }),
            (water, "metal", Material::Metal { albedo: grey, fuzz: 0.0 }),
            (water, "dielectric", water),
        ] {
            let draw = |ui: &mut Ui, material: &mut Material| *material = kind(ui, *material, None);
            let mut harness: Harness<'_, Material> = dressed([260.0, 300.0]).build_ui_state(draw, material);
            harness.get_by_role(egui::Role::ComboBox).click();
            harness.run_steps(3);
            harness.get_all_by_label(chosen).last().unwrap().click();
            harness.run_steps(3);
            assert_eq!(*harness.state(), expected, "{material:?}: {chosen}");
        }
    }
}
