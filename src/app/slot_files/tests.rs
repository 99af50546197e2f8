//! Tests of the files of kept pictures.

use super::folder::{Entry, Folder, Listing, WriteFault};
use super::keeper::{Keeper, News};
use crate::app::model::checked::CheckedScene;
use crate::app::model::document::Document;
use crate::app::model::kept::Kept;
use crate::app::model::origin::{Origin, Source};
use crate::app::model::slots::{Slot, SlotNumber, Slots};
use crate::film::{Film, PixelSum};
use crate::progressive::{Contribution, Status, Stop};
use crate::recipe::{Recipe, file};
use crate::render::BackendInfo;
use crate::stages::Stage;
use eframe::egui::Context;
use std::sync::Arc;
use std::time::{Duration, Instant};

fn folder(directory: &tempfile::TempDir) -> Folder {
    Folder::of(directory.path(), "window-1-1")
}

/// A kept picture whose every field differs from what it is by default.
fn kept(mut document: Document, halves: usize) -> Kept {
    (document.settings.width, document.settings.height) = (5, 3);
    document.settings.estimate_error = halves == 2;
    let mut film = Film::new(5, 3, halves);
    for (place, sum) in film.halves_mut().iter_mut().flatten().enumerate() {
        *sum = PixelSum([0, 1, 2].map(|channel| (place as u64 * 7919 + channel * 104_729) * 331));
    }
    film.record(3..9, 2).unwrap();
    film.record(11..12, 0).unwrap();
    let info = |name, lanes| BackendInfo { name, device: "some \"device\"".to_owned(), lanes, threads: 3 };
    let part = |backend, samples_per_pixel| Contribution { backend, samples_per_pixel };
    let status = Status {
        backend: Some(info("gpu", 64)),
        samples_per_pixel: 7,
        trace: Duration::new(3, 141_592_653),
        contributions: vec![part(info("cpu", 8), 4), part(info("gpu", 64), 2)],
        ..Status::default()
    };
    Kept::new(document, film, status.into(), Some(0.1 + 0.2))
}

fn of_stage(id: &str) -> Document {
    let mut document = Document::new(Origin::of_stage(Stage::find(id).unwrap()));
    (document.camera.vfov_degrees, document.settings.seed) = (33.3, 7);
    (document.has_own_size, document.stop) = (true, Stop::at_samples(77));
    document
}

fn assert_same(found: &Kept, kept: &Kept) {
    assert!(found.film == kept.film);
    assert_eq!(found.document.job(1).unwrap(), kept.document.job(1).unwrap());
    let facts = |kept: &Kept| {
        let Document { camera, settings, has_own_size, stop, origin, .. } = kept.document.clone();
        let titles = (kept.document.title(), kept.document.name(), origin.source.clone());
        (camera, settings, has_own_size, stop, titles, kept.status.clone())
    };
    assert_eq!(facts(found), facts(kept));
    assert_eq!(found.seconds_before.map(f64::to_bits), kept.seconds_before.map(f64::to_bits));
    assert_eq!((&found.thumbnail, &found.id), (&kept.thumbnail, &kept.id));
    assert_eq!((found.samples(), found.bytes()), (kept.samples(), kept.bytes()));
}

/// The pictures in a folder, and what is wrong with its list.
fn found_in(folder: &Folder) -> (Vec<Entry>, Vec<String>) {
    let Listing { entries, faults } = folder.listing().unwrap();
    (entries, faults)
}

fn written(folder: &Folder, kept: &Kept) {
    folder.write(kept, u64::MAX).unwrap();
}

#[test]
fn all_of_a_kept_picture_comes_back_to_the_bit() {
    let directory = tempfile::tempdir().unwrap();
    let folder = folder(&directory);
    let of_scene = Recipe { name: "mine".to_owned(), ..Stage::find("metal").unwrap().recipe() };
    for (document, halves) in [
        (of_stage("glass-schlick"), 2),
        (of_stage("normals"), 1),
        (Document::new(Origin::new(of_scene, Source::Embedded)), 2),
    ] {
        let kept = kept(document, halves);
        let bytes = folder.write(&kept, u64::MAX).unwrap();
        assert_same(&folder.read(&kept.id, &[]).unwrap(), &kept);
        let opened = crate::saved::open(&folder.film(&kept.id)).unwrap();
        assert_eq!(opened.recipe.samples_per_pixel, 7, "a recipe renders as many");
        assert_eq!(folder.bytes_of_all(), bytes);
        folder.delete(&kept.id);
        assert_eq!(folder.bytes_of_all(), 0);
    }
}

#[test]
fn a_scene_file_that_was_changed_meanwhile_does_not_change_the_kept_picture() {
    let directory = tempfile::tempdir().unwrap();
    let (folder, path) = (folder(&directory), directory.path().join("mine.toml"));
    let recipe = Stage::find("metal").unwrap().recipe();
    std::fs::write(&path, file::to_toml(&recipe)).unwrap();
    let mut document = Document::new(Origin::new(file::load(&path).unwrap(), Source::File(path.clone())));
    (document.stop, document.has_own_size) = (Stop::at_samples(77), false);
    let kept = kept(document, 2);
    written(&folder, &kept);
    assert_same(&folder.read(&kept.id, &[]).unwrap(), &kept);
    let other = Recipe { scene: Stage::find("metal-fuzzy").unwrap().recipe().scene, ..recipe };
    std::fs::write(&path, file::to_toml(&other)).unwrap();
    for _ in 0..2 {
        let found = folder.read(&kept.id, &[]).unwrap();
        assert!(found.film == kept.film && found.document.stop == kept.document.stop);
        assert_eq!(found.document.job(1).unwrap(), kept.document.job(1).unwrap());
        assert!(!found.document.has_own_size);
        let _ = std::fs::remove_file(&path);
    }
}

#[test]
fn equal_scenes_are_in_memory_once() {
    let directory = tempfile::tempdir().unwrap();
    let folder = folder(&directory);
    let live = of_stage("metal");
    let mut moved = live.scene().clone();
    moved.spheres[0].center.x += 0.5;
    let moved = CheckedScene::new(Arc::new(moved), *live.rules());
    let changed = Document { checked: Arc::new(moved), ..live.clone() };
    for (mine, other) in [(&live, &live), (&changed, &changed), (&changed, &live)] {
        let kept = kept(mine.clone(), 2);
        written(&folder, &kept);
        let found = folder.read(&kept.id, std::slice::from_ref(other)).unwrap().document;
        assert!(Arc::ptr_eq(&found.origin, &other.origin));
        assert_eq!(found.has_same_film(&kept.document), std::ptr::eq(mine, other));
        assert_eq!(found.job(1).unwrap(), kept.document.job(1).unwrap());
    }
}

#[test]
fn no_film_meets_the_description_of_another_wherever_writing_ends() {
    let directory = tempfile::tempdir().unwrap();
    let folder = folder(&directory);
    let (first, second) = (kept(of_stage("metal"), 2), kept(of_stage("glass-schlick"), 2));
    let entry = |kept: &Kept| Entry {
        number: Some(SlotNumber::ALL[2]),
        id: kept.id.clone(),
        name: format!("mine {}", kept.id),
        size: kept.size(),
        samples: kept.samples(),
        has_own_size: true,
    };
    written(&folder, &first);
    folder.write_list(&[entry(&first)]).unwrap();
    // The program ends after the note, before the film.
    std::fs::write(folder.note(&second.id), "{}").unwrap();
    assert_eq!(found_in(&folder), (vec![entry(&first)], vec![]));
    assert!(!folder.note(&second.id).exists());
    // After the film, before the list.
    written(&folder, &second);
    let (found, faults) = found_in(&folder);
    assert_eq!((found.len(), faults.len(), &found[0]), (2, 0, &entry(&first)));
    assert_eq!((&found[1].id, found[1].number, found[1].samples), (&second.id, None, 7));
    assert_same(&folder.read(&found[1].id, &[]).unwrap(), &second);
    // After the list, before the film that was replaced is deleted.
    folder.write_list(&[entry(&second)]).unwrap();
    let (found, _) = found_in(&folder);
    assert_eq!([&found[0].id, &found[1].id], [&second.id, &first.id]);
    // After the film was deleted, before its note is.
    std::fs::remove_file(folder.film(&first.id)).unwrap();
    assert_eq!(found_in(&folder), (vec![entry(&second)], vec![]));
    // Unfinished files of a program that is gone.
    let part = folder.path().join(".weekender-a1b2c3.part");
    std::fs::write(&part, "x").unwrap();
    found_in(&folder);
    assert!(!part.exists());
    // A film that has disappeared is named, and so is a list that cannot be read.
    folder.delete(&second.id);
    let (found, faults) = found_in(&folder);
    assert!(
        found.is_empty() && faults[0].contains("of slot 3") && faults[0].contains(&second.id),
        "{faults:?}"
    );
    written(&folder, &first);
    std::fs::write(folder.list(), "{").unwrap();
    let (found, faults) = found_in(&folder);
    assert_eq!((found.len(), &found[0].id), (1, &first.id));
    assert!(faults[0].contains("slots.json cannot be understood"), "{faults:?}");
    folder.clear();
    assert!(folder.film(&first.id).exists() && folder.list().exists(), "more than a list is there");
    folder.delete_all().unwrap();
    assert!(!folder.exists());
}

#[test]
fn only_what_is_known_is_deleted() {
    let directory = tempfile::tempdir().unwrap();
    let folder = folder(&directory);
    written(&folder, &kept(of_stage("metal"), 2));
    let other = folder.path().join("mine.txt");
    std::fs::write(&other, "a note of the user").unwrap();
    folder.delete_all().unwrap();
    assert!(other.exists() && std::fs::read_dir(folder.path()).unwrap().count() == 1);
}

#[cfg(unix)]
#[test]
fn what_cannot_be_looked_at_is_not_deleted() {
    use std::os::unix::fs::symlink;
    let directory = tempfile::tempdir().unwrap();
    // A link to itself: the system refuses to open it.
    let gone = Folder::of(directory.path(), "window-2-1");
    symlink(gone.path(), gone.path()).unwrap();
    let told = gone.listing().unwrap_err();
    assert!(told.starts_with(&format!("cannot list {}: ", gone.path().display())), "{told}");
    assert!(gone.delete_all().is_err() && gone.exists() && gone.may_have("1"));
    gone.clear();
    assert!(gone.path().is_symlink());
    // The list alone.
    let folder = folder(&directory);
    let kept = kept(of_stage("metal"), 2);
    written(&folder, &kept);
    std::fs::write(folder.note("unfinished"), "{}").unwrap();
    symlink(folder.list(), folder.list()).unwrap();
    let told = folder.listing().unwrap_err();
    assert!(told.contains("slots.json"), "{told}");
    assert!(folder.delete_all().is_err());
    assert!(folder.note("unfinished").exists() && folder.film(&kept.id).exists());
    assert!(folder.may_have(&kept.id) && !folder.may_have("unfinished"));
}

#[test]
fn two_pictures_of_one_slot_do_not_meet_there() {
    let directory = tempfile::tempdir().unwrap();
    let folder = folder(&directory);
    let entries = ["metal", "glass-schlick"].map(|id| {
        let kept = kept(of_stage(id), 2);
        written(&folder, &kept);
        let (number, name) = (Some(SlotNumber::ALL[2]), id.to_owned());
        Entry { number, name, size: kept.size(), samples: 7, has_own_size: true, id: kept.id }
    });
    folder.write_list(&entries).unwrap();
    let [first, second] = entries;
    assert_eq!(found_in(&folder), (vec![first, Entry { number: None, ..second }], vec![]));
}

#[test]
fn a_picture_moves_with_its_note_or_not_at_all() {
    let directory = tempfile::tempdir().unwrap();
    let [mine, theirs] = ["window-1-1", "window-2-1"].map(|name| Folder::of(directory.path(), name));
    let [whole, noteless, blocked] = ["metal", "sky", "defocus"].map(|id| kept(of_stage(id), 2));
    for kept in [&whole, &noteless, &blocked] {
        written(&theirs, kept);
    }
    std::fs::remove_file(theirs.note(&noteless.id)).unwrap();
    std::fs::create_dir_all(mine.note(&blocked.id).join("full")).unwrap();
    for (kept, is_taken) in [(&whole, true), (&noteless, true), (&blocked, false)] {
        assert_eq!(mine.take(&theirs, &kept.id).is_ok(), is_taken);
        let places = [&mine, &theirs].map(|folder| folder.film(&kept.id).exists());
        assert_eq!(places, [is_taken, !is_taken]);
    }
    assert_same(&mine.read(&whole.id, &[]).unwrap(), &whole);
}

#[test]
fn what_does_not_fit_leaves_nothing() {
    let directory = tempfile::tempdir().unwrap();
    let folder = folder(&directory);
    let kept = kept(of_stage("metal"), 2);
    let bytes = folder.write(&kept, u64::MAX).unwrap();
    folder.delete(&kept.id);
    let refused = folder.write(&kept, bytes - 1);
    assert!(matches!(refused, Err(WriteFault::TooLarge(needed)) if needed == bytes), "{refused:?}");
    assert_eq!(folder.bytes_of_all(), 0);
    assert_eq!(folder.write(&kept, bytes).unwrap(), bytes);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_named_and_leaves_no_note() {
    let directory = tempfile::tempdir().unwrap();
    let folder = folder(&directory);
    let kept = kept(of_stage("metal"), 2);
    std::fs::create_dir(folder.path()).unwrap();
    std::os::unix::fs::symlink("/dev/full", folder.film(&kept.id)).unwrap();
    let Err(WriteFault::Failed(reason)) = folder.write(&kept, u64::MAX) else { panic!("written") };
    assert!(reason.contains(&kept.id) && reason.contains("free some space"), "{reason}");
    assert!(!folder.note(&kept.id).exists());
}

const ONE: SlotNumber = SlotNumber::ALL[0];
const TWO: SlotNumber = SlotNumber::ALL[1];

/// Two slots in use.
fn two_slots() -> Slots {
    let mut slots = Slots::default();
    for (number, id) in [(ONE, "metal"), (TWO, "sky")] {
        slots.put(number, Slot { name: format!("my {id}"), kept: Arc::new(kept(of_stage(id), 2)) });
    }
    slots
}

/// The next news: the picture, whether it was written, and the words for the user.
fn news(keeper: &Keeper) -> (Option<String>, bool, Option<String>) {
    let begin = Instant::now();
    loop {
        match keeper.news() {
            Some(News::Written(id)) => return (Some(id), true, None),
            Some(News::NotWritten { id, words }) => return (id, false, words),
            None => assert!(begin.elapsed() < Duration::from_secs(60), "no news"),
        }
        std::thread::sleep(Duration::from_millis(1));
    }
}

#[test]
fn the_files_are_those_of_the_slots() {
    let directory = tempfile::tempdir().unwrap();
    let (folder, context) = (folder(&directory), Context::default());
    let mut keeper = Keeper::new(folder.clone(), u64::MAX);
    keeper.finish(&Slots::default());
    keeper.follow(&context, &Slots::default());
    assert!(!folder.path().exists(), "nothing is kept");
    let mut slots = two_slots();
    let [first, second] = [ONE, TWO].map(|number| slots.get(number).unwrap().clone());
    keeper.follow(&context, &slots);
    assert_eq!(news(&keeper), (Some(first.kept.id.clone()), true, None));
    assert_eq!(news(&keeper), (Some(second.kept.id.clone()), true, None));
    *slots.name_mut(ONE).unwrap() = "another name".to_owned();
    slots.delete(TWO);
    keeper.follow(&context, &slots);
    keeper.finish(&slots);
    assert_eq!(found_in(&folder), (vec![Entry::of(ONE, slots.get(ONE).unwrap())], vec![]));
    assert!(!folder.film(&second.kept.id).exists() && !folder.note(&second.kept.id).exists());
    assert_same(&folder.read(&first.kept.id, &[]).unwrap(), &first.kept);

    let mut keeper = Keeper::new(folder.clone(), u64::MAX);
    keeper.follow(&context, &slots);
    news(&keeper);
    slots.delete(ONE);
    keeper.finish(&slots);
    assert!(!folder.path().exists(), "the last one was deleted");
}

#[test]
fn a_picture_without_room_is_told_of_once_and_written_when_there_is_some() {
    let directory = tempfile::tempdir().unwrap();
    let (folder, context, mut slots) = (folder(&directory), Context::default(), two_slots());
    let kept = [ONE, TWO].map(|number| Arc::clone(&slots.get(number).unwrap().kept));
    let bytes = kept.each_ref().map(|kept| {
        let bytes = folder.write(kept, u64::MAX).unwrap();
        folder.delete(&kept.id);
        bytes
    });
    // The list takes some bytes, too.
    let mut keeper = Keeper::new(folder.clone(), bytes[0].max(bytes[1]) + 2000);
    keeper.follow(&context, &slots);
    assert!(news(&keeper).1);
    let (id, is_written, words) = news(&keeper);
    let words = words.unwrap();
    assert_eq!((id.as_deref(), is_written), (Some(kept[1].id.as_str()), false));
    let begin = "Slot 2 (my sky) will not come back in the next window: its film takes ";
    assert!(words.starts_with(begin) && words.ends_with("or save this one as a film"), "{words}");
    *slots.name_mut(ONE).unwrap() = "another name".to_owned();
    keeper.follow(&context, &slots);
    slots.delete(ONE);
    keeper.follow(&context, &slots);
    assert_eq!(news(&keeper), (Some(kept[1].id.clone()), true, None), "now there is room");
    keeper.finish(&slots);
    assert!(keeper.news().is_none());
    assert_eq!(found_in(&folder).0.len(), 1);
}

#[test]
fn that_nothing_can_be_written_is_told_of_once() {
    let directory = tempfile::tempdir().unwrap();
    let (folder, context, slots) = (folder(&directory), Context::default(), two_slots());
    std::fs::write(folder.path(), "in the way").unwrap();
    let mut keeper = Keeper::new(folder.clone(), u64::MAX);
    keeper.follow(&context, &slots);
    let (id, is_written, words) = news(&keeper);
    assert_eq!((id, is_written), (Some(slots.get(ONE).unwrap().kept.id.clone()), false));
    let begin = "Slot 1 (my metal) will not come back in the next window: cannot write to ";
    assert!(words.as_ref().is_some_and(|words| words.starts_with(begin)), "{words:?}");
    assert_eq!(news(&keeper), (Some(slots.get(TWO).unwrap().kept.id.clone()), false, None));
    // It is tried once more at the end.
    std::fs::remove_file(folder.path()).unwrap();
    keeper.finish(&slots);
    assert_eq!(found_in(&folder).0.len(), 2);
}

#[test]
fn a_failure_after_a_success_is_told_again() {
    let directory = tempfile::tempdir().unwrap();
    let (folder, context, mut slots) = (folder(&directory), Context::default(), two_slots());
    std::fs::write(folder.path(), "in the way").unwrap();
    let mut keeper = Keeper::new(folder.clone(), u64::MAX);
    keeper.follow(&context, &slots);
    assert!(news(&keeper).2.is_some() && news(&keeper).2.is_none());
    std::fs::remove_file(folder.path()).unwrap();
    *slots.name_mut(ONE).unwrap() = "another name".to_owned();
    keeper.follow(&context, &slots);
    assert!(news(&keeper).1 && news(&keeper).1);
    std::fs::remove_dir_all(folder.path()).unwrap();
    std::fs::write(folder.path(), "in the way").unwrap();
    let third = Slot { name: "third".to_owned(), kept: Arc::new(kept(of_stage("metal"), 2)) };
    slots.put(SlotNumber::ALL[2], third);
    keeper.follow(&context, &slots);
    let words = news(&keeper).2;
    assert!(words.as_ref().is_some_and(|words| words.starts_with("Slot 3 (third) will not")), "{words:?}");
}
