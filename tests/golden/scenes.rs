//! Scenes, cameras and prepared scenes as data.

use crate::common::{at_once, check, digest, digest_of};
use std::fmt::Write as _;
use weekender::kernel::Real;
use weekender::prepared::PreparedScene;
use weekender::prepared::wide_bvh::WideBvh;
use weekender::recipe::Recipe;
use weekender::recipe::file::{to_picture_toml, to_toml};
use weekender::scene::builtin::BuiltinScene;
use weekender::stages::Stage;
use weekender::stress::{Form, cases};

/// What is prepared of a picture: numbers as they are, lists as digests.
pub fn prepared<R: Real + std::fmt::Debug>(recipe: &Recipe) -> String {
    let job = recipe.job().unwrap();
    let prepared = PreparedScene::<R>::new(&job);
    let mut text = String::new();
    let bits = |rows: &[[R; 4]]| digest(rows.iter().flatten().map(|x| x.to_f64().to_bits()));
    let list = PreparedScene::<R>::as_list(&job);
    writeln!(
        text,
        "  rows {} {} {}, list {} {}, block limit {}, origin {:.6}",
        prepared.opaque.len(),
        prepared.two_root.len(),
        prepared.anchored.len(),
        list.opaque.len(),
        list.two_root.len(),
        prepared.block_limit,
        prepared.origin
    )
    .unwrap();
    writeln!(
        text,
        "  opaque {} two-root {} anchored {} records {}",
        bits(&prepared.opaque),
        bits(&prepared.two_root),
        digest_of(format!("{:?}", prepared.anchored).as_bytes()),
        digest_of(format!("{:?}", prepared.records).as_bytes())
    )
    .unwrap();
    writeln!(
        text,
        "  order {} hierarchy {} camera {} sky {:?} {:?}",
        digest(prepared.scene_index.iter().map(|index| u64::from(*index))),
        digest_of(format!("{:?}", prepared.hierarchy).as_bytes()),
        digest_of(format!("{:?}", prepared.camera).as_bytes()),
        prepared.sky_middle,
        prepared.sky_slope
    )
    .unwrap();
    writeln!(text, "  {:?} bytes {} {:?}", prepared.features, prepared.bytes(), prepared.warnings()).unwrap();
    text
}

#[test]
fn prepared_scenes_are_as_kept() {
    let fields = ["field:23", "field:24", "field:60"].map(|name| Recipe::find(name).unwrap());
    let scenes = BuiltinScene::ALL.iter().map(|scene| Recipe::find(scene.name).unwrap());
    let recipes: Vec<Recipe> = Stage::ALL.iter().map(Stage::recipe).chain(scenes).chain(fields).collect();
    let texts = at_once(&recipes, |recipe| {
        let wide = WideBvh::build(recipe.scene.spheres.iter(), recipe.camera.look_from);
        format!(
            "{}, {}x{}, {} samples, scene {}, picture {}\n  wide {} nodes, depth {}, order {}\n{}  in f64 {}\n",
            recipe.name,
            recipe.settings.width,
            recipe.settings.height,
            recipe.samples_per_pixel,
            digest_of(to_toml(recipe).as_bytes()),
            digest_of(to_picture_toml(recipe).as_bytes()),
            wide.nodes.len(),
            wide.depth(),
            digest(wide.order.iter().map(|index| u64::from(*index))),
            prepared::<f32>(recipe),
            digest_of(prepared::<f64>(recipe).as_bytes())
        )
    });
    check("prepared", &texts.concat());
}

#[test]
fn stages_are_as_kept() {
    let mut text = String::new();
    for stage in Stage::ALL {
        let all = format!("{stage:?}");
        writeln!(text, "{} {} {} {:?}", stage.id, stage.section, stage.title, stage.pair).unwrap();
        let recipe = stage.recipe();
        writeln!(text, "  {} samples, {:?}", recipe.samples_per_pixel, recipe.settings).unwrap();
        writeln!(text, "  {:?}\n  {:?}", recipe.camera, recipe.rules).unwrap();
        writeln!(text, "  all {}", digest_of(all.as_bytes())).unwrap();
    }
    check("stages", &text);
}

#[test]
fn cases_of_the_stress_suite_are_as_kept() {
    let mut text = String::new();
    for case in cases() {
        let recipe = |form: Form| digest_of(to_picture_toml(&case.recipe_in(form)).as_bytes());
        let forms: Vec<String> =
            case.forms().iter().map(|form| format!("{} {}", form.name(), recipe(*form))).collect();
        writeln!(text, "{} {} [{}] {}", case.id, case.title(), case.expected, forms.join(", ")).unwrap();
        let (unit, tolerance) = (case.unit, case.tolerance);
        let watch = case.watch.as_ref().map(|watch| watch.look_for);
        let stiff = digest_of(case.stiff.as_bytes());
        writeln!(text, "  unit {unit:e}, tolerance {tolerance:.6e}, quick {}, {stiff}", case.is_quick)
            .unwrap();
        if let Some(watch) = watch {
            writeln!(text, "  {watch}").unwrap();
        }
    }
    check("stress_cases", &text);
}
