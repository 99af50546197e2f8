//! Tests of what is told about commands.

use super::*;
use crate::app::drawn::change;
use crate::app::model::checked::CheckedScene;
use crate::app::model::crop::Crop;
use crate::app::model::device::DeviceOptions;
use crate::app::model::kept::Kept;
use crate::app::model::origin::{Origin, Source};
use crate::app::model::presentation::Presentation;
use crate::app::model::remembered::{Bookmark, Remembered};
use crate::app::model::slots::{Coming, Slot};
use crate::app::model::view::{ViewState, With};
use crate::app::tests::Case;
use crate::film::Film;
use crate::kept;
use crate::measure::stress::shown_cases;
use crate::progressive::{EndReason, HistoryPoint, Phase, ReferenceMeans, Stop};
use crate::recipe::Recipe;
use crate::scene::Camera;
use crate::stages::{Rules, SurfaceRule};

/// A window with this view in which nothing has been traced yet.
fn early(document: Document, view: ViewState) -> Facts {
    let model = Model {
        document,
        selected: None,
        view,
        remembered: Remembered::default(),
        devices: DeviceOptions::default(),
        is_paused: false,
        is_full_screen: false,
        has_first_steps: false,
        presentation: None,
        has_recovered: false,
    };
    Facts {
        model,
        status: Arc::default(),
        speed: None,
        seconds_before: Some(0.0),
        can_undo: false,
        can_redo: false,
        has_pixel: false,
        has_paths: false,
        has_sight: false,
        invalid: None,
    }
}

#[test]
fn two_kept_pictures_are_compared_before_anything_is_traced() {
    let [one, two] = [SlotNumber::ALL[0], SlotNumber::ALL[1]];
    let mut document = Document::new(Origin::of_stage(Stage::find("metal").unwrap()));
    document.give_size([4, 2]);
    let mut view = ViewState::default();
    for number in [one, two] {
        let mut film = Film::new(4, 2, 1);
        film.record(0..1, 0).unwrap();
        let kept = Kept::new(document.clone(), film, Arc::default(), None);
        view.slots.put(number, Slot { name: String::new(), kept: Arc::new(kept) });
    }
    let mut facts = early(document, view);
    let reason = |facts: &Facts| facts.disabled_reason(Command::Slot(SlotCommand::OnlyNoise));
    assert!(reason(&facts).unwrap().starts_with("Nothing has been traced yet"));
    facts.model.view.slots.look(Some(one));
    assert!(reason(&facts).unwrap().starts_with("Nothing has been traced yet"), "it is the live one again");
    facts.model.view.slots.choose(two);
    assert_eq!(reason(&facts), None);
}

const ONE: SlotNumber = SlotNumber::ALL[0];
const TWO: SlotNumber = SlotNumber::ALL[1];

fn stage(id: &str) -> Document {
    let mut document = Document::new(Origin::of_stage(Stage::find(id).unwrap()));
    document.give_size([4, 2]);
    document
}

fn slot([width, height]: [u32; 2], name: &str) -> Slot {
    let mut film = Film::new(width, height, 1);
    film.record(0..1, 0).unwrap();
    let kept = Kept::new(stage("metal"), film, Arc::default(), None);
    Slot { name: name.to_owned(), kept: Arc::new(kept) }
}

fn reference([width, height]: [u32; 2]) -> Option<Arc<ReferenceMeans>> {
    let means = vec![[0.5; 3]; (width * height) as usize];
    Some(Arc::new(ReferenceMeans { width, height, means, identity: None }))
}

/// What is told, one a line. Devices depend on the machine, and stages and extreme scenes are always enabled.
fn told(facts: &Facts) -> Vec<String> {
    let mut lines = vec![
        format!("title: {}", facts.title()),
        format!("further: {:?}", facts.further().map(|further| further.words)),
        format!("working: {}", facts.is_working()),
        format!("rays: {:?}", facts.no_rays()),
    ];
    for command in Command::all() {
        if matches!(command, Command::Device(_) | Command::SwitchDevice) {
            continue;
        }
        if let Some(reason) = facts.disabled_reason(command) {
            lines.push(format!("{}: {reason}", command.name()));
        }
        if !facts.is_listed(command) {
            lines.push(format!("{} is not listed", command.name()));
        }
        if facts.name(command) != command.name() {
            lines.push(format!("{} is called {}", command.name(), facts.name(command)));
        }
    }
    lines
}

fn done(facts: &mut Facts) {
    let status = Status {
        phase: Phase::Done(EndReason::Samples),
        samples_per_pixel: 100,
        history: vec![HistoryPoint {
            backend: "cpu",
            samples_per_pixel: 4,
            trace_seconds: 1.0,
            rmse_estimate: 0.1,
            rel_mse_estimate: 0.1,
        }],
        ..Status::default()
    };
    facts.status = Arc::new(status);
    facts.model.document.stop = Stop::at_samples(100);
}

/// Says what each state of the window disables, and why.
#[test]
fn every_disabled_command_says_why() {
    let early = || early(stage("metal"), ViewState::default());
    let before = told(&early());
    let mut text = format!("nothing has happened\n{}\n", before.join("\n"));
    let states: [Case<Facts>; 38] = [
        ("something to undo", |facts| facts.can_undo = true),
        ("something to redo", |facts| facts.can_redo = true),
        ("a pixel", |facts| facts.has_pixel = true),
        ("paths", |facts| facts.has_paths = true),
        ("a sphere", |facts| facts.model.selected = Some(0)),
        ("the end", done),
        ("the end, but paused", |facts| {
            done(facts);
            facts.model.is_paused = true;
        }),
        ("tracing", |facts| {
            facts.status = Arc::new(Status { phase: Phase::Tracing, ..Status::default() });
        }),
        ("another camera", |facts| facts.model.document.camera.vfov_degrees = 33.0),
        ("other spheres", |facts| {
            let scene = Arc::clone(facts.document().checked.scene());
            let rules = *facts.document().rules();
            facts.model.document.checked = Arc::new(CheckedScene::new(scene, rules));
        }),
        ("a bookmark", |facts| facts.model.remembered.bookmarks = bookmarks(1)),
        ("two bookmarks", |facts| facts.model.remembered.bookmarks = bookmarks(2)),
        ("brighter", |facts| facts.model.view.tone.exposure = 0.5),
        ("normals", |facts| facts.model.view.choose(Show::Normals)),
        ("a wipe", |facts| facts.model.view.toggle(Mode::Wipe, With::Stage)),
        ("a difference", |facts| facts.model.view.toggle(Mode::Difference, With::Stage)),
        ("a presentation", |facts| {
            facts.model.presentation =
                Some(Presentation { was_full_screen: false, has_captions: true, is_blank: false });
        }),
        ("a crop begins", |facts| facts.model.view.crop = Some(None)),
        ("a crop", |facts| facts.model.view.crop = Some(Some(Crop { first: [0, 0], size: [1, 1] }))),
        ("one half", |facts| facts.model.document.settings.estimate_error = false),
        ("a reference", |facts| facts.model.view.reference = reference([4, 2])),
        ("a higher reference", |facts| facts.model.view.reference = reference([4, 3])),
        ("a wider reference", |facts| facts.model.view.reference = reference([5, 2])),
        ("the reference device", |facts| facts.model.remembered.device = Device::Reference),
        ("the graphics adapter", |facts| facts.model.remembered.device = Device::Gpu),
        ("both devices", |facts| facts.model.remembered.device = Device::Both),
        ("the first stage", |facts| facts.model.document = stage("ppm-tiny")),
        ("the last stage", |facts| facts.model.document = stage("book")),
        ("a stage without spheres", |facts| facts.model.document = stage("sky")),
        ("a stage of first hits", |facts| facts.model.document = stage("normals")),
        ("an extreme scene", |facts| {
            facts.model.document = Document::new(Origin::of_case(&shown_cases()[0]))
        }),
        ("a built-in scene", |facts| {
            let recipe = Recipe::builtin("field:20").unwrap();
            facts.model.document = Document::new(Origin::new(recipe, Source::Builtin));
        }),
        ("a slot", |facts| facts.model.view.slots.put(ONE, slot([4, 2], "mine"))),
        ("slots of other sizes", |facts| {
            facts.model.view.slots.put(ONE, slot([4, 3], "a name of more than 22 characters"));
            facts.model.view.slots.put(TWO, slot([5, 2], "22 characters, no more"));
            facts.model.view.look(Some(ONE));
            facts.model.view.slots.choose(TWO);
        }),
        ("a slot that is looked at", |facts| {
            done(facts);
            facts.model.view.slots.put(ONE, slot([4, 2], "mine"));
            facts.model.view.look(Some(ONE));
        }),
        ("a slot that is compared", |facts| {
            done(facts);
            facts.model.view.slots.put(ONE, slot([4, 2], "mine"));
            facts.model.view.toggle(Mode::Wipe, With::Slot(ONE));
        }),
        ("a slot that comes and one that is gone", |facts| {
            let (name, id) = ("mine".to_owned(), "1".to_owned());
            let coming = Coming { name, id, size: [4, 2], samples: 1, has_own_size: true };
            facts.model.view.slots.expect(ONE, coming);
            facts.model.view.slots.put(TWO, slot([4, 2], "mine"));
            facts.model.view.slots.delete(TWO);
        }),
        ("nine slots", |facts| {
            SlotNumber::ALL
                .into_iter()
                .for_each(|number| facts.model.view.slots.put(number, slot([4, 2], "mine")));
        }),
    ];
    for (name, set) in states {
        let mut facts = early();
        set(&mut facts);
        text.push_str(&format!("\n{name}\n{}", change(&before, &told(&facts))));
    }
    kept::check("reasons", &text);
}

#[test]
fn a_slot_is_not_brought_back_while_there_is_no_place_for_it() {
    let mut facts = early(stage("metal"), ViewState::default());
    let reason = |facts: &Facts| facts.disabled_reason(Command::Slot(SlotCommand::BringBack));
    for number in SlotNumber::ALL {
        facts.model.view.slots.put(number, slot([4, 2], "mine"));
    }
    facts.model.view.slots.delete(ONE);
    assert_eq!(reason(&facts), None);
    let (name, id) = ("mine".to_owned(), "1".to_owned());
    let coming = Coming { name, id, size: [4, 2], samples: 1, has_own_size: true };
    facts.model.view.slots.expect(ONE, coming);
    let told = "Slot 1 is still being read from disk, and no other slot is free; try again in a moment";
    assert_eq!(reason(&facts).as_deref(), Some(told));
    facts.model.view.slots.arrive("1", None);
    assert_eq!(reason(&facts), None);
}

fn bookmarks(count: usize) -> Vec<Bookmark> {
    (0..count).map(|number| Bookmark::new(format!("place {number}"), &Camera::BOOK)).collect()
}

#[test]
fn files_and_bookmarks_have_names() {
    let mut facts = early(stage("metal"), ViewState::default());
    facts.model.remembered.bookmarks = bookmarks(2);
    let names: Vec<String> = facts.bookmarks().map(|command| facts.name(command)).collect();
    assert_eq!(names, ["Go to place 0", "Go to place 1"]);
    facts.model.remembered.recent =
        ["/of/a.png", "/of/b.exr", "/in/a.png", "c.toml"].map(PathBuf::from).to_vec();
    let names: Vec<String> = facts.recent().map(|command| facts.name(command)).collect();
    assert_eq!(names, ["Open a.png in /of", "Open b.exr", "Open a.png in /in", "Open c.toml"]);
    let paths = [Command::Recent(1), Command::Recent(4), Command::Open].map(|command| facts.path(command));
    assert_eq!(paths, [Some(Path::new("/of/b.exr")), None, None]);
}

#[test]
fn the_neighbours_of_a_stage_are_those_of_the_book() {
    let id = |document: &Document, is_next| neighbour(document, is_next).map(|stage| stage.id);
    let (first, middle) = (stage("ppm-tiny"), stage("metal"));
    assert_eq!((id(&first, false), id(&first, true)), (None, Some("ppm-gradient")));
    assert_eq!((id(&middle, false), id(&middle, true)), (Some("gamut"), Some("metal-fuzzy")));
    let other = Document::new(Origin::of_case(&shown_cases()[0]));
    assert_eq!((id(&other, false), id(&other, true)), (None, Some("ppm-tiny")));
}

const THREE: SlotNumber = SlotNumber::ALL[2];

/// A slot with the picture of a document.
fn slot_of(document: &Document) -> Slot {
    let [width, height] = document.size();
    let mut film = Film::new(width, height, document.settings.half_count());
    film.record(0..2, 0).unwrap();
    let kept = Kept::new(document.clone(), film, Arc::default(), None);
    Slot { name: "mine".to_owned(), kept: Arc::new(kept) }
}

/// A window at the picture of a document, with these slots.
fn with_slots(live: Document, documents: &[Document]) -> Facts {
    let mut facts = early(live, ViewState::default());
    for (number, document) in SlotNumber::ALL.into_iter().zip(documents) {
        facts.model.view.slots.put(number, slot_of(document));
    }
    done(&mut facts);
    facts
}

#[test]
fn slots_are_compared_by_the_sizes_of_the_two_pictures() {
    let sized = |size| {
        let mut document = stage("metal");
        document.give_size(size);
        document
    };
    let mut facts = with_slots(sized([4, 2]), &[sized([5, 2]), sized([5, 2]), sized([4, 2])]);
    // What is looked at, which slot is meant, and the sizes that are told.
    for (looked, chosen, told) in [
        (None, ONE, Some("Slot 1 is 5x2 and the picture is 4x2, so ")),
        (None, THREE, None),
        (Some(ONE), ONE, Some("Slot 1 is 5x2 and the picture is 4x2, so ")),
        (Some(ONE), TWO, None),
        (Some(ONE), THREE, Some("Slot 3 is 4x2 and slot 1 is 5x2, so ")),
        (Some(THREE), THREE, None),
        (Some(THREE), TWO, Some("Slot 2 is 5x2 and slot 3 is 4x2, so ")),
    ] {
        facts.model.view.look(looked);
        facts.model.view.slots.choose(chosen);
        for command in [SlotCommand::Difference, SlotCommand::OnlyNoise] {
            let reason = facts.disabled_reason(Command::Slot(command));
            assert_eq!(reason.is_some(), told.is_some(), "{looked:?} {chosen}: {reason:?}");
            assert!(reason.unwrap_or_default().starts_with(told.unwrap_or_default()), "{looked:?} {chosen}");
        }
        // It is the live picture that gets the size of a slot.
        let has_size = facts.disabled_reason(Command::Slot(SlotCommand::TakeSize)).is_some();
        assert_eq!(has_size, chosen == THREE, "{looked:?} {chosen}");
    }
}

#[test]
fn views_are_those_of_the_picture_on_the_screen() {
    let mut one_half = stage("metal");
    one_half.settings.estimate_error = false;
    let mut wide = stage("metal");
    wide.give_size([5, 2]);
    for (other, show, reason) in [
        (one_half, Show::Error, "The film has one half"),
        (wide, Show::Difference, "The reference film is 4x2 and the picture is 5x2"),
        (stage("normals"), Show::Bounces, "In this stage rays end at their first hit"),
        (stage("ppm-gradient"), Show::Normals, "This stage traces no rays"),
    ] {
        for is_live in [true, false] {
            // One of them is live, and the other one is in a slot.
            let (live, kept) =
                if is_live { (other.clone(), stage("metal")) } else { (stage("metal"), other.clone()) };
            let mut facts = with_slots(live, &[kept]);
            facts.model.view.reference = reference([4, 2]);
            for looked in [None, Some(ONE)] {
                facts.model.view.look(looked);
                let is_other = is_live == looked.is_none();
                let told = facts.disabled_reason(Command::Show(show));
                assert_eq!(told.is_some(), is_other, "{show:?} {is_live} {looked:?}: {told:?}");
                assert!(!is_other || told.is_some_and(|told| told.starts_with(reason)), "{show:?}");
            }
        }
    }
}

#[test]
fn pictures_by_the_books_arithmetic_have_nothing_to_be_compared_with() {
    let recipe = Recipe::builtin("two-spheres").unwrap();
    let rules = Rules { surface: SurfaceRule::Book, ..recipe.rules };
    let by_the_book = Recipe { rules, ..recipe.clone() };
    let built_in = |recipe| Document::new(Origin::new(recipe, Source::Builtin));
    for (document, has_other, has_book) in [
        (built_in(recipe), true, true),
        (built_in(by_the_book), false, false),
        (stage("metal"), true, true),
        // The stage has a neighbour, but another threshold than the book.
        (stage("shadow-acne"), true, false),
    ] {
        let facts = early(document, ViewState::default());
        let is_enabled = |command| facts.disabled_reason(command).is_none();
        let found = [Command::Wipe, Command::WipeDifference, Command::BookArithmetic].map(is_enabled);
        assert_eq!(found, [has_other, has_other, has_book], "{}", facts.title());
    }
}

#[test]
fn what_to_look_for_needs_its_view() {
    // The sight of this stage is a view of the standard error.
    let mut document = stage("three-spheres");
    let reason =
        |document: &Document| early(document.clone(), ViewState::default()).disabled_reason(Command::ShowMe);
    assert_eq!(reason(&document), None);
    document.settings.estimate_error = false;
    assert_eq!(reason(&document).as_deref(), Some("The film has one half; switch on Estimate error"));
}

#[test]
fn a_bookmark_needs_rays_and_a_reload_a_scene_file() {
    let is_enabled =
        |document, command| early(document, ViewState::default()).disabled_reason(command).is_none();
    assert!(is_enabled(stage("metal"), Command::Bookmark(0)));
    assert!(!is_enabled(stage("ppm-tiny"), Command::Bookmark(0)));
    let origin = Origin::new(stage("metal").recipe(), Source::File("a.toml".into()));
    assert!(is_enabled(Document::new(origin), Command::Reload));
}
