//! Everything that is saved comes back: each field is set to another value than the usual one, written, read and
//! compared. Structures are written out in full here, so that a new field has to be added to these tests.

use super::checked::CheckedScene;
use super::crop::Crop;
use super::device::Device;
use super::document::Document;
use super::first_steps::{FirstSteps, Step};
use super::framing::Framing;
use super::kept::Kept;
use super::origin::Origin;
use super::remembered::{Bookmark, Remembered, Theme};
use super::session::Session;
use super::show::Show;
use super::sizing::Sizing;
use super::slots::{Slot, SlotNumber};
use super::tone::Tone;
use super::view::{Mode, ViewState, With};
use crate::film::Film;
use crate::progressive::Stop;
use crate::render::{RenderSettings, SamplerKind};
use crate::scene::Camera;
use crate::stages::Stage;
use glam::DVec3;
use serde::Serialize;
use serde_json::Value;
use std::collections::BTreeMap;
use std::sync::Arc;

const CAMERA: Camera = Camera {
    look_from: DVec3::new(-1.5, 1.25, 2.5),
    look_at: DVec3::new(0.25, 0.5, -1.5),
    vup: DVec3::new(0.125, 2.0, 0.375),
    vfov_degrees: 33.0,
    defocus_angle_degrees: 1.75,
    focus_distance: Some(2.25),
};

const SETTINGS: RenderSettings = RenderSettings {
    width: 31,
    height: 17,
    max_depth: 7,
    sampler: SamplerKind::Independent,
    seed: 9,
    estimate_error: false,
};

/// The values of a text, with the way to each.
fn leaves(value: &impl Serialize) -> BTreeMap<String, Value> {
    fn gather(value: &Value, path: &str, all: &mut BTreeMap<String, Value>) {
        match value {
            Value::Object(fields) => {
                fields.iter().for_each(|(name, value)| gather(value, &format!("{path}.{name}"), all))
            }
            _ => _ = all.insert(path.to_owned(), value.clone()),
        }
    }
    let mut all = BTreeMap::new();
    gather(&serde_json::to_value(value).unwrap(), "", &mut all);
    all
}

/// The values that are the same in both.
fn unchanged(usual: &impl Serialize, set: &impl Serialize) -> Vec<String> {
    let set = leaves(set);
    leaves(usual)
        .into_iter()
        .filter(|(path, value)| set.get(path) == Some(value))
        .map(|(path, _)| path)
        .collect()
}

fn document() -> Document {
    let mut document = Document::new(Origin::of_stage(Stage::find("metal").unwrap()));
    let mut scene = document.scene().clone();
    scene.spheres[0].center.x += 0.5;
    scene.spheres[1].radius += 0.25;
    document.checked = Arc::new(CheckedScene::new(Arc::new(scene), *document.rules()));
    (document.camera, document.settings, document.has_own_size) = (CAMERA, SETTINGS, true);
    document.stop = Stop { samples: Some(77), seconds: Some(12.5), noise: Some(0.0125) };
    document
}

/// A picture of one sample.
fn slot(name: &str) -> Slot {
    let mut film = Film::new(SETTINGS.width, SETTINGS.height, 1);
    film.record(0..1, 0).unwrap();
    let kept = Kept::new(document(), film, Arc::default(), None);
    Slot { name: name.to_owned(), kept: Arc::new(kept) }
}

/// A view with everything set, by views, by a comparison and by slots.
fn views() -> [ViewState; 3] {
    let mut shown = ViewState::default();
    shown.choose(Show::Luminance);
    shown.tone = Tone { exposure: 1.5, range: [-3.0, 2.5] };
    (shown.divider, shown.is_with_next, shown.is_divider_unplaced) = (0.25, true, false);
    shown.crop = Some(Some(Crop { first: [2, 3], size: [4, 5] }));
    let mut compared = shown.clone();
    compared.toggle(Mode::Wipe, With::Book);
    (compared.divider, compared.is_divider_unplaced) = (0.25, false);
    let mut slots = shown.clone();
    let [one, two, ..] = SlotNumber::ALL;
    slots.slots.put(one, slot("one"));
    slots.slots.put(two, slot("two"));
    slots.look(Some(one));
    slots.look(Some(two));
    slots.toggle(Mode::Wipe, With::Slot(one));
    (slots.divider, slots.is_divider_unplaced) = (0.25, false);
    [shown, compared, slots]
}

#[test]
fn every_field_of_a_session_comes_back() {
    let usual = Session::of(&Document::new(Origin::usual()), &ViewState::default(), false);
    let framing = Framing { times: 3.0, middle: [0.25, 0.75], size: [31, 17] };
    let mut never_set: Option<Vec<String>> = None;
    for view in views() {
        let noted = |document: &Document, view: &ViewState, is_paused, framing| {
            Session::of(document, view, is_paused).with_film(true).with_framing(framing)
        };
        let session = noted(&document(), &view, true, Some(framing));
        let text = serde_json::to_string(&session).unwrap();
        let read: Session = serde_json::from_str(&text).unwrap();
        assert_eq!(leaves(&read), leaves(&session));
        let mut found = read.restore().unwrap();
        // The pictures of slots come later.
        view.slots.used().for_each(|(number, slot)| found.view.slots.put(number, slot.clone()));
        found.slots.show_in(&mut found.view);
        assert_eq!(
            leaves(&noted(&found.document, &found.view, found.is_paused, found.framing)),
            leaves(&session)
        );
        assert_eq!((found.document.camera, found.document.settings), (CAMERA, SETTINGS));
        assert_eq!((found.document.stop, found.document.has_own_size), (document().stop, true));
        assert_eq!(found.document.scene(), document().scene());
        assert_eq!((found.framing, found.is_paused, found.note), (Some(framing), true, None));
        assert_eq!(
            (found.view.show(), found.view.mode(), found.view.with()),
            (view.show(), view.mode(), view.with())
        );
        assert_eq!((found.view.tone, found.view.crop), (view.tone, view.crop));
        assert_eq!((found.view.divider, found.view.is_with_next), (0.25, true));
        assert!(!found.view.is_divider_unplaced);
        let same = unchanged(&usual, &session);
        never_set = Some(match never_set {
            Some(earlier) => earlier.into_iter().filter(|path| same.contains(path)).collect(),
            None => same,
        });
    }
    assert_eq!(never_set, Some(vec![".software".to_owned()]), "set these to another value, too");
}

#[test]
fn every_remembered_setting_comes_back() {
    let mut first_steps = FirstSteps::default();
    Step::ALL.into_iter().for_each(|step| first_steps.note(step));
    let remembered = Remembered {
        theme: Theme::Light,
        has_panels: false,
        has_controls: false,
        has_info: false,
        has_plot: true,
        has_packet: true,
        has_code: true,
        sizing: Sizing::Book,
        has_gizmo: false,
        has_flights: false,
        device: Device::Reference,
        lanes: Some(1),
        threads: Some(1),
        bookmarks: vec![Bookmark::new("near".to_owned(), &CAMERA)],
        directory: Some("/of/pictures".into()),
        recent: vec!["/of/pictures/a.png".into(), "/of/b.exr".into()],
        first_steps,
    };
    assert_eq!(unchanged(&Remembered::default(), &remembered), Vec::<String>::new(), "set these, too");
    let text = serde_json::to_string(&remembered).unwrap();
    let found: Remembered = serde_json::from_str(&text).unwrap();
    assert_eq!(found, remembered);
    assert_eq!(found.bookmarks[0].camera(), CAMERA);
    // A window never opens without panels; nothing else has to be mended.
    assert_eq!(found.mended(), Remembered { has_panels: true, ..remembered });
}
