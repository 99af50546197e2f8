//! Scene files round-trip to the bit.

use super::common::{CAMERA, assert_round_trip};
use std::path::Path;
use std::sync::Arc;
use weekender::job::recipe::Recipe;
use weekender::job::recipe::file::{load, parse, to_picture_toml, to_toml};
use weekender::scene::builtin::BuiltinScene;
use weekender::stages::{Rules, Stage};

#[test]
fn every_scene_and_stage_is_read_back_to_the_bit() {
    for builtin in BuiltinScene::ALL {
        assert_round_trip(&Recipe::builtin(builtin.name).expect("in the registry"));
    }
    for stage in Stage::ALL {
        assert_round_trip(&stage.recipe());
    }
}

#[test]
fn the_example_scenes_are_valid() {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/scenes");
    let mut count = 0;
    let files =
        |folder| std::fs::read_dir(folder).expect("the folder").map(|entry| entry.expect("an entry").path());
    for path in files(scenes.clone()).filter(|path| path.is_file()).chain(files(scenes.join("stress"))) {
        let recipe = load(&path).unwrap_or_else(|error| panic!("{error}"));
        assert!(!recipe.scene.spheres.is_empty(), "{}", path.display());
        assert_eq!(recipe.rules, Rules::default(), "{}", path.display());
        assert_round_trip(&recipe);
        count += 1;
    }
    assert!(count >= 10);
}

#[test]
fn a_picture_names_a_large_field_and_restores_it() {
    let field = Recipe::builtin("field:20000").expect("a field");
    let text = to_picture_toml(&field);
    assert!(text.len() < 1000 && text.starts_with("scene = \"field:20000\""), "{text}");
    assert_eq!(parse(&text, "field:20000").expect("valid"), field);
    // A changed field has its spheres in a table.
    let mut changed = field.clone();
    Arc::make_mut(&mut changed.scene).spheres[3].radius = 0.25;
    assert_eq!(parse(&to_picture_toml(&changed), "field:20000").expect("valid"), changed);
    assert!(to_picture_toml(&changed).len() > 500_000);
    let small = Recipe::builtin("field:500").expect("a field");
    assert_eq!(to_picture_toml(&small), to_toml(&small), "it needs no name");

    let message = |text: &str| parse(text, "x").expect_err("refused").to_string();
    let mark = text.lines().nth(1).expect("a mark");
    let other = message(&text.replace(mark, "scene_mark = \"0123456789abcdef\""));
    assert!(
        other.starts_with("x:2:") && other.contains("field:20000") && other.contains("scene_mark"),
        "{other}"
    );
    let named = CAMERA.replace("[camera]", "scene = \"three-spheres\"\n[camera]");
    assert_eq!(
        parse(&named, "x").expect("valid").scene,
        Recipe::builtin("three-spheres").expect("one").scene
    );
    let unknown = message(&named.replace("three-spheres", "three-sphere"));
    assert!(unknown.starts_with("x:1:") && unknown.contains("there is no scene"), "{unknown}");
    let both = message(&format!("{named}\n[sky]\ntop = [1, 1, 1]\n"));
    assert!(both.contains("cannot be combined with scene"), "{both}");
}
