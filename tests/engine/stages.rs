//! The registry of stages: complete, in order, valid, and each with everything that a lesson needs.

use weekender::job::recipe::Recipe;
use weekender::stages::{Means, Shading, Stage};

fn stage(id: &str) -> &'static Stage {
    Stage::find(id).unwrap_or_else(|error| panic!("{error}"))
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
        let headings = [stage.section_title(), stage.chapter_title()];
        assert!(headings.iter().all(|title| !title.is_empty()), "{}: {headings:?}", stage.id);
        recipe.job().expect(stage.id);
        assert_eq!(recipe, stage.recipe(), "{} differs from itself", stage.id);
        if let Some(pair) = stage.pair {
            let other = self::stage(pair).recipe();
            let spheres = |recipe: &Recipe| recipe.scene.spheres.clone();
            assert_eq!(spheres(&recipe), spheres(&other), "{}: another scene teaches nothing", stage.id);
            let looks = |recipe: &Recipe| (recipe.camera, recipe.rules, recipe.scene.clone());
            assert!(looks(&recipe) != looks(&other), "{}: the same picture", stage.id);
        }
        // "Show me" must not show the picture as it is, or something outside it.
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
fn a_stage_is_found_by_its_section() {
    assert_eq!((stage("11.4").id, stage("11.5").id), ("glass-schlick", "hollow-glass"));
    let refused = |id| Stage::find(id).unwrap_err().to_string();
    assert!(refused("12.1").contains("fov-wide, fov-narrow"), "{}", refused("12.1"));
    assert!(refused("11.9").contains("--list"), "{}", refused("11.9"));
}
