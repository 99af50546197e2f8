//! The registry of stages: complete, in order, valid, and each with everything that a lesson needs.

use std::sync::Arc;
use weekender::job::recipe::Recipe;
use weekender::stages::{DielectricLaws, Means, Rules, Shading, Stage, SurfaceRule, Transfer};

fn stage(id: &str) -> &'static Stage {
    Stage::find(id).unwrap_or_else(|error| panic!("{error}"))
}

fn recipe(id: &str) -> Recipe {
    stage(id).recipe()
}

#[test]
fn every_stage_can_be_rendered_shown_and_compared() {
    let number = |stage: &Stage| -> Vec<u32> {
        stage.section.split('.').map(|part| part.parse().expect("a number")).collect()
    };
    assert!(Stage::ALL.is_sorted_by_key(number));
    for stage in Stage::ALL {
        let recipe = stage.recipe();
        assert_eq!(recipe.name, stage.id);
        recipe.job().expect(stage.id);
        assert_eq!(recipe, stage.recipe(), "{} differs from itself", stage.id);
        if let Some(pair) = stage.pair {
            let other = self::stage(pair).recipe();
            let spheres = |recipe: &Recipe| recipe.scene.spheres.clone();
            assert_eq!(spheres(&recipe), spheres(&other), "{}: another scene teaches nothing", stage.id);
            let looks = |recipe: &Recipe| (recipe.camera, recipe.rules, recipe.scene.clone());
            assert!(looks(&recipe) != looks(&other), "{}: the same picture", stage.id);
        }
        // "Show me" must not show the picture as it is, or something outside of it.
        let [left, top, right, bottom] = stage.sight.part.unwrap_or([0.0, 0.0, 1.0, 1.0]);
        assert!(0.0 <= left && left < right && right <= 1.0, "{}", stage.id);
        assert!(0.0 <= top && top < bottom && bottom <= 1.0, "{}", stage.id);
        match stage.sight.means {
            Means::Picture => {
                assert!(stage.sight.part.is_some(), "{}: this is what is shown anyway", stage.id)
            }
            Means::Wipe(at) => assert!(left < f64::from(at) && f64::from(at) < right, "{}", stage.id),
            Means::RaysPerPath => assert_eq!(stage.setup.rules.shading, Shading::Path, "{}", stage.id),
            _ => {}
        }
    }
}

#[test]
fn only_the_rules_of_the_finished_renderer_are_finished() {
    let are_finished = |id: &str| recipe(id).rules.are_finished();
    for id in ["lambertian-linear", "lambertian-gamma", "glass-schlick", "book"] {
        assert!(are_finished(id), "{id}");
    }
    for id in ["aliased", "diffuse", "shadow-acne", "gamut", "glass-refract", "glass-tir"] {
        assert!(!are_finished(id), "{id}");
    }
    // The stage compares linear values above with gamma-corrected ones below.
    let rows = (0..4).filter(|row| !Transfer::LinearAboveGamma2.is_gamma(*row, 4));
    assert_eq!(rows.collect::<Vec<_>>(), [0, 1]);
}

#[test]
fn links_lead_to_the_books_sections() {
    let book = "https://raytracing.github.io/books/RayTracingInOneWeekend.html";
    for (id, anchor) in [
        ("sky", "rays,asimplecamera,andbackground/sendingraysintothescene"),
        ("glass-refract", "dielectrics/snell'slaw"),
        ("book", "wherenext?/afinalrender"),
    ] {
        assert_eq!(stage(id).url(), format!("{book}#{anchor}"));
    }
    assert_eq!(stage("glass-tir").chapter(), "11");
}

#[test]
fn unknown_ids_are_answered_with_a_guess() {
    let message = |id: &str| Stage::find(id).expect_err("unknown").to_string();
    assert_eq!(
        message("shadow-akne"),
        "there is no stage \"shadow-akne\"; did you mean shadow-acne? --list shows all"
    );
    for id in ["glass-refract", "glass-tir", "glass-schlick", "hollow-glass"] {
        assert!(message("glass").contains(id), "{}", message("glass"));
    }
    assert_eq!(message("quux-corge"), "there is no stage \"quux-corge\"; --list shows all");
}

/// Equal jobs have equal samples, so a film may go on only if nothing of them differs.
#[test]
fn a_job_with_another_part_is_another_job() {
    let base = recipe("lambertian-gamma");
    let changed = |change: &dyn Fn(&mut Recipe)| {
        let mut recipe = base.clone();
        change(&mut recipe);
        recipe.job().expect("valid")
    };
    let same = changed(&|_| {});
    assert!(same == changed(&|recipe| recipe.samples_per_pixel += 1));
    let changes: [&dyn Fn(&mut Recipe); 9] = [
        &|recipe| recipe.settings.seed += 1,
        &|recipe| recipe.settings.max_depth += 1,
        &|recipe| recipe.settings.width += 1,
        &|recipe| recipe.settings.estimate_error = false,
        &|recipe| recipe.camera.vfov_degrees += 1.0,
        &|recipe| recipe.rules.surface = SurfaceRule::Book,
        &|recipe| recipe.rules.transfer = Transfer::Linear,
        &|recipe| Arc::make_mut(&mut recipe.scene).spheres[0].radius *= 2.0,
        &|recipe| Arc::make_mut(&mut recipe.scene).sky.top *= 0.5,
    ];
    for (number, change) in changes.into_iter().enumerate() {
        assert!(same != changed(change), "change {number}");
    }
}

/// Otherwise there is nothing to compare.
#[test]
fn every_strip_of_grey_has_surfaces_above_and_below_the_middle() {
    let recipe = recipe("gamut");
    let aspect = f64::from(recipe.settings.width) / f64::from(recipe.settings.height);
    for strip in 0..5 {
        for y in [0.25, 0.35, 0.49, 0.51, 0.75, 0.99] {
            let at = [(f64::from(strip) + 0.5) / 5.0, y];
            let direction = recipe.camera.direction_through(at, aspect);
            assert!(recipe.scene.pick(recipe.camera.look_from, direction).is_some(), "strip {strip} at {y}");
        }
    }
}

/// A comparison teaches most if only one thing differs.
#[test]
fn paired_stages_differ_in_what_they_teach() {
    let (limited, acne) = (recipe("diffuse-limited"), recipe("shadow-acne"));
    assert_eq!(acne.rules, Rules { surface: SurfaceRule::Acne, ..limited.rules });
    assert_eq!(Recipe { name: limited.name.clone(), rules: limited.rules, ..acne }, limited);

    let (linear, gamma) = (recipe("lambertian-linear"), recipe("lambertian-gamma"));
    assert_eq!(Rules { transfer: Transfer::Gamma2, ..linear.rules }, gamma.rules);
    assert_eq!(linear.scene, gamma.scene);

    let (refract, schlick) = (recipe("glass-refract"), recipe("glass-schlick"));
    assert_eq!(refract.scene, schlick.scene);
    assert_eq!(refract.rules, Rules { dielectric: DielectricLaws::RefractOnly, ..schlick.rules });

    let (wide, narrow) = (recipe("fov-wide"), recipe("fov-narrow"));
    assert_eq!(wide.scene, narrow.scene);
    assert_eq!((wide.camera.vfov_degrees, narrow.camera.vfov_degrees), (90.0, 30.0));

    let (sharp, blurred) = (recipe("view-close"), recipe("defocus"));
    assert_eq!((sharp.camera.defocus_angle_degrees, blurred.camera.defocus_angle_degrees), (0.0, 10.0));
    assert_eq!(sharp.scene, blurred.scene);

    let (aliased, antialiased) = (recipe("aliased"), recipe("antialiased"));
    assert_eq!((aliased.samples_per_pixel, antialiased.samples_per_pixel), (1, 64));
    assert_eq!(aliased.rules, Rules { antialiasing: false, ..antialiased.rules });
}

#[test]
fn scenes_that_are_stages_too_are_the_same() {
    for name in ["three-spheres", "book"] {
        assert_eq!(Recipe::builtin(name).expect("a scene"), recipe(name));
    }
    let measured = recipe("three-spheres");
    assert_eq!((measured.settings.width, measured.settings.height), (800, 450));
    assert_eq!((measured.samples_per_pixel, measured.settings.max_depth), (200, 24));
}
