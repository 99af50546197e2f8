//! Tests of what the next window shows again.

use super::*;
use crate::app::model::show::Show;
use crate::app::model::tone::Tone;
use crate::app::model::view::{Mode, With};
use crate::scene::Camera;
use glam::DVec3;

/// What comes back of a document after it was written and read.
fn again(document: &Document, view: &ViewState) -> Restored {
    let text = serde_json::to_string(&Session::of(document, view, false)).unwrap();
    serde_json::from_str::<Session>(&text).unwrap().restore().unwrap()
}

fn changed(mut document: Document) -> Document {
    document.camera = Camera {
        look_from: DVec3::new(-1.1, 1e-20, 1.0 / 3.0),
        vfov_degrees: 33.3,
        // A pinhole has no focus, but the number comes back.
        focus_distance: Some(0.1 + 0.2),
        ..Camera::BOOK
    };
    (document.settings.width, document.settings.seed) = (31, 9);
    document.stop = Stop { samples: None, seconds: Some(1e3), noise: Some(1e-3) };
    document
}

fn assert_same(mine: &Document, found: &Document, what: &str) {
    assert_eq!(found.job(1).unwrap(), mine.job(1).unwrap(), "{what}");
    assert_eq!((found.camera, found.stop), (mine.camera, mine.stop), "{what}");
    assert_eq!((&found.origin.source, found.title()), (&mine.origin.source, mine.title()), "{what}");
    assert_eq!(found.origin.recipe, mine.origin.recipe, "{what}");
}

fn with_a_sphere_moved(mut document: Document) -> Document {
    let mut scene = document.scene().clone();
    scene.spheres[0].center.x += 1.0 / 3.0;
    document.checked = Arc::new(CheckedScene::new(Arc::new(scene), *document.rules()));
    document
}

#[test]
fn every_kind_of_picture_comes_back_as_it_was() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("mine.toml");
    let scene = Recipe { name: "mine".to_owned(), ..Stage::find("glass-schlick").unwrap().recipe() };
    std::fs::write(&path, file::to_toml(&scene)).unwrap();
    let mut origins: Vec<Origin> = Stage::ALL.iter().map(Origin::of_stage).collect();
    origins.extend(shown_cases().iter().map(Origin::of_case));
    origins.push(Origin::new(Recipe::builtin("field:60000").unwrap(), Source::Builtin));
    origins.push(Origin::new(file::load(&path).unwrap(), Source::File(path.clone())));
    origins.push(Origin::new(Recipe { name: "x".to_owned(), ..scene }, Source::Embedded));
    let view = ViewState::default();
    for origin in origins {
        let document = Document::new(origin);
        let what = document.title();
        assert_same(&document, &again(&document, &view).document, &what);
        let document = changed(document);
        assert_same(&document, &again(&document, &view).document, &what);
        if !document.scene().spheres.is_empty() && document.scene().spheres.len() < SPHERES_LIMIT {
            let document = with_a_sphere_moved(document);
            let found = again(&document, &view).document;
            assert_same(&document, &found, &what);
            assert!(found.has_changed_scene(), "{what}");
        }
    }
}

#[test]
fn the_view_comes_back() {
    let document = Document::new(Origin::of_stage(Stage::find("metal").unwrap()));
    let mut view = ViewState::default();
    view.choose(Show::Luminance);
    view.tone = Tone { exposure: -1.5, range: [-3.0, 2.5] };
    let found = again(&document, &view).view;
    assert_eq!((found.show(), found.tone), (Show::Luminance, view.tone));
    view.toggle(Mode::Wipe, With::Book);
    (view.divider, view.is_with_next) = (0.25, true);
    let found = again(&document, &view).view;
    assert_eq!((found.mode(), found.with(), found.divider), (Some(Mode::Wipe), With::Book, 0.25));
    assert!(found.is_with_next && !found.is_divider_unplaced);
}

#[test]
fn what_another_version_wrote_costs_as_little_as_possible() {
    let document = Document::new(Origin::of_stage(Stage::find("metal").unwrap()));
    let mut session = Session::of(&document, &ViewState::default(), true);
    session.view = serde_json::json!({ "show": "Smell", "divider": 3 });
    let found = session.restore().unwrap();
    assert_eq!((found.view.show(), found.view.divider, found.is_paused), (Show::Picture, 0.5, true));
    let (mut strange, known) = (session.clone(), session.recipe.clone());
    strange.software = "Weekender 9".to_owned();
    strange.origin = KeptOrigin::Stage("radiosity".to_owned());
    let told = strange.restore().unwrap_err();
    assert!(told.contains("Weekender 9") && told.contains("radiosity"), "{told}");
    for recipe in ["", "vfov_degrees = 3", &known.replace("vup = [0.0, 1.0, 0.0]", "vup = [0.0, 0.0, 0.0]")] {
        assert!(Session { recipe: recipe.to_owned(), ..session.clone() }.restore().is_err(), "{recipe}");
    }
    // Neither a new field nor a missing one matters.
    let mut value = serde_json::to_value(&session).unwrap();
    value.as_object_mut().unwrap().insert("mood".to_owned(), "fine".into());
    value.as_object_mut().unwrap().remove("is_paused");
    let found: Session = serde_json::from_value(value).unwrap();
    assert_eq!(found, Session { is_paused: false, ..session });
}
