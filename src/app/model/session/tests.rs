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
fn a_scene_file_that_is_gone_is_replaced_by_what_it_said() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("mine.toml");
    let recipe = Stage::find("metal").unwrap().recipe();
    std::fs::write(&path, file::to_toml(&recipe)).unwrap();
    let document = Document::new(Origin::new(file::load(&path).unwrap(), Source::File(path.clone())));
    let session = Session::of(&document, &ViewState::default(), false);
    // The file as it is now counts, unless the scene was changed in the window.
    let newer = Recipe { scene: Stage::find("metal-fuzzy").unwrap().recipe().scene, ..recipe };
    std::fs::write(&path, file::to_toml(&newer)).unwrap();
    let found = session.restore().unwrap();
    assert_eq!((found.document.scene(), found.note), (&*newer.scene, None));
    std::fs::remove_file(&path).unwrap();
    let found = session.restore().unwrap();
    assert_eq!(found.document.job(1).unwrap(), document.job(1).unwrap());
    assert_eq!(found.document.origin.source, Source::Embedded);
    assert!(found.note.is_some_and(|note| note.contains("mine.toml")));
}

#[test]
fn what_is_too_large_is_said() {
    let field = Document::new(Origin::new(Recipe::builtin("field:60000").unwrap(), Source::Builtin));
    let moved = with_a_sphere_moved(field.clone());
    let told = Session::of(&moved, &ViewState::default(), false).restore().unwrap_err();
    assert!(told.contains(&moved.scene().spheres.len().to_string()), "{told}");
    assert!(Session::of(&field, &ViewState::default(), false).restore().is_ok());
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

fn metal() -> Document {
    Document::new(Origin::of_stage(Stage::find("metal").unwrap()))
}

#[test]
fn the_document_of_a_kept_film_is_what_was_noted_if_that_has_its_samples() {
    let (stage, document) = (Stage::find("metal").unwrap(), changed(metal()));
    let session = Session::of(&document, &ViewState::default(), false);
    let found = session.document_of_film(&document.recipe(), None);
    // Neither a focus without a lens nor the stop conditions are in the film.
    assert_eq!((found.camera, found.stop), (document.camera, document.stop));
    assert_eq!((found.stage(), found.has_own_size), (Some(stage), false));
    // Another film has its own camera and settings.
    let mut other = document.recipe();
    (other.camera.vfov_degrees, other.settings.seed) = (44.0, 10);
    let found = session.document_of_film(&other, Some(stage));
    assert_eq!((found.camera, found.settings), (other.camera, other.settings));
    assert_eq!((found.stop, found.has_own_size), (document.stop, false));
    // Nothing was noted.
    let found = Session::default().document_of_film(&other, Some(stage));
    assert_eq!((found.camera, found.settings), (other.camera, other.settings));
    assert_eq!((found.stop, found.has_own_size), (found.origin.usual_stop(), true));
}

#[test]
fn a_scene_that_was_changed_back_is_not_changed() {
    let mut document = metal();
    let scene = CheckedScene::new(Arc::clone(document.checked.scene()), *document.rules());
    document.checked = Arc::new(scene);
    let session = Session::of(&document, &ViewState::default(), false);
    assert!(document.has_changed_scene() && session.has_changed_scene && session.is_changed);
    let found = session.restore().unwrap().document;
    assert!(!found.has_changed_scene() && !found.is_changed());
}

#[test]
fn a_framing_comes_back_with_the_size_that_it_belongs_to() {
    let [mine, other] =
        [[480, 270], [480, 271]].map(|size| Framing { times: 3.0, middle: [0.25, 0.75], size });
    let session = Session::of(&metal(), &ViewState::default(), false);
    for (framing, expected) in [(None, None), (Some(mine), Some(mine)), (Some(other), None)] {
        assert_eq!(session.clone().with_framing(framing).restore().unwrap().framing, expected);
    }
}

#[test]
fn a_scene_file_is_found_from_another_directory() {
    let origin = Origin::new(metal().recipe(), Source::File("mine.toml".into()));
    let session = Session::of(&Document::new(origin), &ViewState::default(), false);
    let KeptOrigin::File { path, .. } = session.origin else { panic!("no file") };
    assert_eq!(path, Some(std::env::current_dir().unwrap().join("mine.toml")));
}

#[cfg(unix)]
#[test]
fn a_path_that_is_not_unicode_costs_only_the_path() {
    use std::os::unix::ffi::OsStrExt;
    let path = PathBuf::from(std::ffi::OsStr::from_bytes(b"/of/\xff.toml"));
    let document = Document::new(Origin::new(metal().recipe(), Source::File(path)));
    let found = again(&document, &ViewState::default());
    assert_eq!((found.document.origin.source.clone(), found.note), (Source::Embedded, None));
    assert_eq!(found.document.job(1).unwrap(), document.job(1).unwrap());
    assert_eq!(found.document.title(), document.title());
}

#[test]
fn what_cannot_be_shown_again_says_why() {
    let gone =
        KeptOrigin::File { path: Some("/of/none/mine.toml".into()), name: String::new(), recipe: None };
    let lost = KeptOrigin::File { path: None, name: String::new(), recipe: None };
    for (origin, reason) in [
        (KeptOrigin::None, "what Weekender 9 wrote names no picture"),
        (KeptOrigin::Extreme("pits".to_owned()), "Weekender 9 showed the extreme scene \"pits\""),
        (KeptOrigin::Builtin("pits".to_owned()), "\"pits\""),
        (KeptOrigin::TooLarge { spheres: 50_001 }, "its 50001 spheres are in no file"),
        (lost, "the path of its scene file could not be kept"),
        (gone, "mine.toml"),
    ] {
        let software = "Weekender 9".to_owned();
        let told = Session { origin, software, ..Session::default() }.restore().unwrap_err();
        assert!(told.contains(reason), "{told}");
    }
}

#[test]
fn a_large_scene_is_kept_only_as_the_path_of_its_file() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("mine.toml");
    let recipe = Recipe::builtin("field:60000").unwrap();
    let kept = |source| {
        let document = Document::new(Origin::new(recipe.clone(), source));
        Session::of(&document, &ViewState::default(), false).origin
    };
    let spheres = recipe.scene.spheres.len();
    assert_eq!(kept(Source::Embedded), KeptOrigin::TooLarge { spheres });
    let file = KeptOrigin::File { path: Some(path.clone()), name: recipe.name.clone(), recipe: None };
    assert_eq!(kept(Source::File(path)), file);
}
