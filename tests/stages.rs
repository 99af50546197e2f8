//! The registry of stages: complete, in order, valid, and each with everything that a lesson needs.

use std::collections::HashSet;
use std::sync::Arc;
use weekender::recipe::Recipe;
use weekender::scene::Material;
use weekender::stages::{DielectricLaws, Means, Rules, Shading, Stage, SurfaceRule, Transfer};

fn stage(id: &str) -> &'static Stage {
    Stage::find(id).unwrap_or_else(|error| panic!("{error}"))
}

fn recipe(id: &str) -> Recipe {
    stage(id).recipe()
}

/// `tests/golden/stages.txt` holds their ids, which are stable, because files and command lines contain them.
#[test]
fn the_stages_are_in_the_books_order() {
    let number = |stage: &Stage| -> Vec<u32> {
        stage.section.split('.').map(|part| part.parse().expect("a number")).collect()
    };
    assert!(Stage::ALL.is_sorted_by_key(number));
}

#[test]
fn every_stage_can_be_rendered() {
    for stage in Stage::ALL {
        let recipe = stage.recipe();
        assert_eq!(recipe.name, stage.id);
        recipe.job().expect(stage.id);
        assert_eq!(recipe, stage.recipe(), "{} differs from itself", stage.id);
    }
}

#[test]
fn every_stage_teaches() {
    for stage in Stage::ALL {
        for text in [stage.what_is_new, stage.why, stage.look_for] {
            assert!((40..400).contains(&text.len()), "{}: {text}", stage.id);
            assert!(text.ends_with('.'), "{}: {text}", stage.id);
            assert!(!text.contains("  "), "{}: {text}", stage.id);
        }
        assert!(!stage.title.is_empty() && !stage.title.ends_with('.'), "{}", stage.id);
    }
    let texts: HashSet<_> = Stage::ALL.iter().map(|stage| stage.title).collect();
    assert_eq!(texts.len(), Stage::ALL.len());
}

/// "Show me" must not show the picture as it is, or something outside of it.
#[test]
fn everything_to_look_for_can_be_shown() {
    let mut captions = HashSet::new();
    for stage in Stage::ALL {
        let sight = &stage.sight;
        if let Some([left, top, right, bottom]) = sight.part {
            for [low, high] in [[left, right], [top, bottom]] {
                assert!(0.0 <= low && low < high && high <= 1.0, "{}: {sight:?}", stage.id);
            }
            assert!(right - left < 0.6 && bottom - top < 0.75, "{}: nothing is enlarged", stage.id);
        }
        match sight.means {
            Means::Picture => assert!(sight.part.is_some(), "{}: this is what is shown anyway", stage.id),
            Means::Wipe(at) => {
                let [left, _, right, _] = sight.part.unwrap_or([0.0, 0.0, 1.0, 1.0]);
                let at = f64::from(at);
                assert!(left + 0.02 < at && at < right - 0.02, "{}: one side is not seen", stage.id);
                assert!(sight.caption.contains("eft, ") || sight.caption.contains("left as"), "{}", stage.id);
            }
            Means::Luminance([low, high]) => assert!(high - low >= 1.0, "{}", stage.id),
            Means::RaysPerPath => assert_eq!(stage.setup.rules.shading, Shading::Path, "{}", stage.id),
            Means::Albedo | Means::StandardError => {}
        }
        assert!((30..110).contains(&sight.caption.len()), "{}: {}", stage.id, sight.caption);
        assert!(sight.caption.ends_with('.'), "{}: {}", stage.id, sight.caption);
        assert!(captions.insert(sight.caption), "{}: {}", stage.id, sight.caption);
    }
}

#[test]
fn pairs_are_mutual() {
    let mut pairs = 0;
    for stage in Stage::ALL {
        let Some(other) = stage.pair else { continue };
        assert_ne!(other, stage.id);
        assert_eq!(self::stage(other).pair, Some(stage.id));
        pairs += 1;
    }
    assert_eq!(pairs, 14);
}

#[test]
fn stages_follow_one_another() {
    for pair in Stage::ALL.windows(2) {
        assert_eq!(pair[0].next(), Some(&pair[1]));
        assert_eq!(pair[1].previous(), Some(&pair[0]));
    }
    assert_eq!(Stage::ALL[0].previous(), None);
    assert_eq!(stage("book").next(), None);
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

/// The plain C program renders only these rules; how a picture is displayed is no rule of the tracer.
#[test]
fn rules_are_finished_whatever_the_display_does() {
    let are_finished = |id: &str| recipe(id).rules.are_finished();
    for id in ["lambertian-linear", "lambertian-gamma", "glass-schlick", "book"] {
        assert!(are_finished(id), "{id}");
    }
    for id in ["aliased", "diffuse", "shadow-acne", "gamut", "glass-refract", "glass-tir"] {
        assert!(!are_finished(id), "{id}");
    }
}

#[test]
fn the_nearest_guess_comes_first() {
    let message = Stage::find("diffuse-limit").expect_err("unknown").to_string();
    assert!(message.contains("did you mean diffuse-limited or diffuse?"), "{message}");
}

/// The stage compares linear values above with gamma-corrected ones below.
#[test]
fn half_of_the_rows_are_linear_where_the_upper_half_is() {
    let rows =
        |height: usize| (0..height).filter(move |row| !Transfer::LinearAboveGamma2.is_gamma(*row, height));
    assert_eq!(rows(4).collect::<Vec<_>>(), [0, 1]);
    assert_eq!(rows(450).count(), 225);
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

#[test]
fn numbers_in_words_are_those_of_the_pictures() {
    let gradient = stage("ppm-gradient");
    let size = |stage: &Stage| [stage.setup.width, stage.setup.height];
    let [width, height] = size(gradient);
    assert!(gradient.what_is_new.contains(&format!("most later pictures, {width} by {height} pixels")));
    let alike = Stage::ALL.iter().filter(|stage| size(stage) == size(gradient)).count();
    assert!(2 * alike > Stage::ALL.len());
    // What a display makes of one half as it is, and of its square root.
    for value in [0.5_f64, 0.5_f64.sqrt()] {
        let share = format!("{:.0} %", 100.0 * value.powf(2.2));
        assert!(stage("gamut").why.contains(&share), "{share}");
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
fn stages_have_the_books_rules() {
    let gamma_from = Stage::ALL.iter().position(|stage| stage.id == "lambertian-gamma").expect("there");
    for (index, stage) in Stage::ALL.iter().enumerate() {
        let transfer = match stage.id {
            "gamut" => Transfer::LinearAboveGamma2,
            _ if index < gamma_from => Transfer::Linear,
            _ => Transfer::Gamma2,
        };
        let recipe = stage.recipe();
        assert_eq!(recipe.rules.transfer, transfer, "{}", stage.id);
        assert_eq!(recipe.rules.antialiasing, recipe.samples_per_pixel > 1, "{}", stage.id);
        assert_eq!(recipe.rules.reflectance_strips, stage.id == "gamut");
        let gradient = recipe.rules.shading == Shading::ImageGradient;
        assert_eq!(gradient, stage.id.starts_with("ppm-"));
    }
    for id in ["metal", "hollow-glass", "three-spheres", "defocus", "book"] {
        assert_eq!(recipe(id).rules, Rules::default(), "{id}");
    }
    assert_eq!(recipe("diffuse-limited").settings.max_depth, 5);
    let tiny = recipe("ppm-tiny").settings;
    assert_eq!((tiny.width, tiny.height), (16, 9));
    let recipe = recipe("glass-tir");
    let glass = recipe.scene.materials.iter().find(|named| named.name == "left");
    let index = Material::Dielectric { refraction_index: 1.0 / 1.33 };
    assert_eq!(glass.map(|named| named.material), Some(index));
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
