//! The spheres of the scene: editing them, and what becomes of a changed scene.

use crate::common::{control, drag_from, has_samples, open, save, send, until};
use crate::objects::{has_label, material, metal_sphere, middle_sphere, on_screen, opened, select, spheres};
use eframe::egui::{self, Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use weekender::app::{Command, Document, Window};
use weekender::cli::{self, Request};
use weekender::scene::Material;
use weekender::stages::Stage;

#[test]
fn numbers_of_the_panel_change_the_sphere_one_undo_step_each() {
    let mut harness = opened();
    let metal = metal_sphere(&harness);
    let first = spheres(&harness);
    let Material::Metal { albedo, fuzz } = material(&harness, metal) else { panic!("no metal") };
    select(&mut harness, metal);
    let set = |harness: &mut Harness<'_, Window>, name: &str, value: f64| {
        harness.run_steps(90);
        control(harness, name).set_value_accesskit(value);
        harness.run_steps(3);
    };
    set(&mut harness, "Fuzz", 0.5);
    assert_eq!(material(&harness, metal), Material::Metal { albedo, fuzz: 0.5 });
    assert_eq!(spheres(&harness), first, "only the material has changed");
    set(&mut harness, "Radius", 0.25);
    set(&mut harness, "Centre y", 0.125);
    set(&mut harness, "Albedo green", 0.0625);
    let sphere = spheres(&harness)[metal];
    assert_eq!((sphere.radius, sphere.center.y), (0.25, 0.125));
    assert_eq!(material(&harness, metal).albedo().unwrap().y, 0.0625);
    harness.state().document().job(1).unwrap();
    let undo = |harness: &mut Harness<'_, Window>| send(harness, Command::Undo);
    undo(&mut harness);
    assert_eq!(material(&harness, metal), Material::Metal { albedo, fuzz: 0.5 });
    undo(&mut harness);
    undo(&mut harness);
    assert_eq!(spheres(&harness), first);
    undo(&mut harness);
    assert_eq!(material(&harness, metal), Material::Metal { albedo, fuzz });
    assert!(!harness.state().document().has_changed_scene());
    assert_eq!(harness.state().selected(), Some(metal));
}

#[test]
fn a_slider_drag_is_one_undo_step() {
    let mut harness = opened();
    let metal = metal_sphere(&harness);
    select(&mut harness, metal);
    harness.run_steps(90);
    let before = material(&harness, metal);
    let slider = control(&harness, "Fuzz").rect();
    drag_from(&mut harness, slider.left_center() + egui::vec2(4.0, 0.0), egui::vec2(80.0, 0.0));
    let after = material(&harness, metal);
    assert!(after.effective_fuzz() > 0.2, "{after:?}");
    send(&mut harness, Command::Undo);
    assert_eq!(material(&harness, metal), before);
}

#[test]
fn spheres_are_added_copied_deleted_and_brought_back() {
    let mut harness = opened();
    let first = spheres(&harness);
    // On the sphere under the pointer.
    let metal = metal_sphere(&harness);
    let at = on_screen(&harness, first[metal].center);
    harness.event(egui::Event::PointerMoved(at));
    harness.run_steps(2);
    harness.key_press(Key::Insert);
    harness.run_steps(3);
    let added = *spheres(&harness).last().unwrap();
    assert_eq!((spheres(&harness).len(), harness.state().selected()), (first.len() + 1, Some(first.len())));
    let gap = added.center.distance(first[metal].center) - first[metal].radius - added.radius;
    assert!(gap.abs() < 1e-9, "it touches the sphere under the pointer: {gap}");

    harness.run_steps(90);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::D);
    harness.run_steps(3);
    let copied = *spheres(&harness).last().unwrap();
    assert_eq!(
        (spheres(&harness).len(), harness.state().selected()),
        (first.len() + 2, Some(first.len() + 1))
    );
    assert_eq!((copied.radius, copied.material), (added.radius, added.material));
    assert!(copied.center.distance(added.center) > 2.0 * added.radius, "beside it");

    harness.run_steps(90);
    let middle = middle_sphere(&harness);
    select(&mut harness, middle);
    harness.key_press(Key::Delete);
    harness.run_steps(3);
    assert_eq!((spheres(&harness).len(), harness.state().selected()), (first.len() + 1, None));
    until(&mut harness, "its picture", has_samples(1));
    send(&mut harness, Command::Undo);
    assert_eq!(harness.state().selected(), Some(middle), "what comes back is selected");
    send(&mut harness, Command::Undo);
    send(&mut harness, Command::Undo);
    assert_eq!(spheres(&harness), first);
    assert!(!harness.state().document().has_changed_scene());
}

#[test]
fn a_changed_stage_says_so_and_reset_returns_its_bits() {
    let stage = Stage::find("glass-schlick").unwrap();
    let mut harness = opened();
    let before = harness.state().document().job(1).unwrap();
    assert!(harness.state().disabled_reason(Command::ResetSpheres).is_some());
    for reset in ["the button of the panel", "the button of the stage", "the command", "all"] {
        let metal = metal_sphere(&harness);
        select(&mut harness, metal);
        control(&harness, "Fuzz").set_value_accesskit(0.5);
        harness.run_steps(3);
        assert!(has_label(&harness, "changed"), "{reset}");
        assert_eq!(harness.state().document().title(), "11.4 Windows at a slant (changed)");
        assert_eq!(harness.state().document().stage(), Some(stage));
        assert_ne!(harness.state().document().job(1).unwrap(), before);
        match reset {
            "the button of the panel" => harness.get_by_label("Reset spheres").click(),
            "the button of the stage" => harness.get_by_label("Reset the scene").click(),
            "all" => harness.state_mut().send(Command::ResetAll),
            _ => harness.state_mut().send(Command::ResetSpheres),
        }
        harness.run_steps(3);
        let after = harness.state().document().job(1).unwrap();
        assert_eq!(after.scene(), before.scene(), "{reset}");
        // Everything is also the size, which the flags have changed.
        assert!(after == before || reset == "all", "{reset}");
        assert!(!harness.state().document().has_changed_scene());
        assert!(!has_label(&harness, "(changed)"));
        assert_eq!(before.scene(), &*stage.recipe().scene);
    }
    // A value that is typed back is no change.
    let metal = metal_sphere(&harness);
    select(&mut harness, metal);
    for fuzz in [0.5, material(&harness, metal).effective_fuzz()] {
        control(&harness, "Fuzz").set_value_accesskit(fuzz);
        harness.run_steps(3);
    }
    assert!(!harness.state().document().has_changed_scene());
}

/// The text that the last frame copied.
fn copied(harness: &Harness<'_, Window>) -> Option<String> {
    harness.output().platform_output.commands.iter().find_map(|output| match output {
        egui::OutputCommand::CopyText(text) => Some(text.clone()),
        _ => None,
    })
}

fn same_picture(a: &Document, b: &Document) -> bool {
    a.job(1).unwrap() == b.job(1).unwrap()
}

#[test]
fn a_changed_scene_is_saved_opened_and_copied_as_a_command() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("mine.toml");
    let mut harness = open("--stage defocus --size 64x36");
    until(&mut harness, "a picture", has_samples(1));
    let metal = metal_sphere(&harness);
    send(&mut harness, Command::NextSphere);
    while harness.state().selected() != Some(metal) {
        send(&mut harness, Command::NextSphere);
    }
    control(&harness, "Fuzz").set_value_accesskit(0.53);
    control(&harness, "Centre y").set_value_accesskit(0.1 + 0.2);
    harness.run_steps(3);
    send(&mut harness, Command::DuplicateSphere);
    save(&mut harness, Command::SaveScene, &path);
    let mine = harness.state().document().clone();

    // The file gives the same picture, and so does the command, even after the camera was moved.
    let other = open(path.to_str().map(|path| format!("--scene {path}")).unwrap().as_str());
    assert!(same_picture(other.state().document(), &mine));
    for vfov in [mine.camera.vfov_degrees, 41.0] {
        harness.state_mut().document_mut().camera.vfov_degrees = vfov;
        harness.run_steps(2);
        harness.state_mut().send(Command::CopyCommand);
        harness.step();
        let line = copied(&harness).unwrap();
        assert!(line.contains(path.to_str().unwrap()), "{line}");
        let Request::Batch(options) = cli::parse(line.split_whitespace().map(Into::into)).unwrap() else {
            panic!("{line}")
        };
        assert_eq!(options.renders[0].job, harness.state().document().job(1).unwrap(), "{line}");
        let told = harness.state().messages();
        assert!(told.iter().all(|text| !text.contains("save the scene file")), "{told:?}");
    }
    // Changed again, it is in no file.
    send(&mut harness, Command::DuplicateSphere);
    harness.state_mut().send(Command::CopyCommand);
    harness.step();
    assert!(copied(&harness).unwrap().contains("--scene=defocus-changed.toml"));
    assert!(harness.state().messages().iter().any(|text| text.contains("save the scene file")));
}
