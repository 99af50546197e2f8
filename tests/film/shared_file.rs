//! A film file that several runs write.

use std::ops::Range;
use std::path::Path;
use weekender::film::{Description, Film, SampleRanges, SharedFile, checkpoint, fixed_point, key};

/// A film whose sample `i` has the radiance `(i + pixel) / 100` in each pixel.
fn film(samples: &[Range<u64>]) -> Film {
    let mut film = Film::new(3, 2, 2);
    for range in samples {
        for i in range.clone() {
            for (pixel, sum) in film.halves_mut()[(i % 2) as usize].iter_mut().enumerate() {
                sum.add(fixed_point([(i as f64 + pixel as f64) / 100.0; 3]).unwrap());
            }
        }
        film.record(range.clone(), 0).unwrap();
    }
    film
}

fn same(_: &str, _: &str) -> Result<(), String> {
    Ok(())
}

fn put(path: &Path, samples: &[Range<u64>]) {
    checkpoint::save(path, &film(samples), &Description::new("r")).unwrap();
}

fn at(path: &Path) -> Film {
    checkpoint::load(path).unwrap().film
}

#[test]
fn two_runs_that_go_on_with_one_film_lose_nothing() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("g.exr");
    let description = Description::new("r");
    let holds = |samples: &[Range<u64>]| assert!(at(&path) == film(samples), "{}", at(&path).samples());

    // The second run follows the first with fewer samples, all of which the first has.
    put(&path, &[0..4]);
    let (mut a, mut b) = (SharedFile::new(&path), SharedFile::new(&path));
    assert_eq!(a.save(&film(&[0..20]), &description, &same).unwrap().note, None);
    let left = b.save(&film(&[0..10]), &description, &same).unwrap();
    assert!(left.note.unwrap().contains("10..20"));
    holds(&[0..20]);
    // It continues, first still with fewer samples, then with more.
    b.save(&film(&[0..16]), &description, &same).unwrap();
    holds(&[0..20]);
    b.save(&film(&[0..24]), &description, &same).unwrap();
    holds(&[0..24]);
    // The first run returns with samples that the second does not have.
    let put_together = a.save(&film(&[0..20, 40..44]), &description, &same).unwrap();
    assert!(put_together.note.unwrap().contains("20..24"));
    holds(&[0..24, 40..44]);
    // The merged samples stay merged.
    a.save(&film(&[0..20, 40..48]), &description, &same).unwrap();
    holds(&[0..24, 40..48]);
    // Partly overlapping samples cannot be separated, so the film is saved under another name.
    let saved = a.save(&film(&[0..22, 40..48]), &description, &same).unwrap();
    assert!(saved.is_elsewhere && saved.path != path);
    assert!(at(&saved.path) == film(&[0..22, 40..48]));
    holds(&[0..24, 40..48]);
}

#[test]
fn a_film_that_began_anew_does_not_replace_what_it_had() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("g.exr");
    put(&path, &[0..4]);
    let mut resumed = SharedFile::new(&path);
    resumed.holds(&SampleRanges::from_ranges([0..4]).unwrap());
    resumed.save(&film(&[0..2]), &Description::new("r"), &same).unwrap();
    assert!(at(&path) == film(&[0..4]));
    resumed.save(&film(&[0..10]), &Description::new("r"), &same).unwrap();
    resumed.save(&film(&[0..6]), &Description::new("r"), &same).unwrap();
    assert!(at(&path) == film(&[0..10]));
    // A film that was not resumed may be replaced by one with fewer samples.
    SharedFile::new(&path).save(&film(&[0..2]), &Description::new("r"), &same).unwrap();
    assert!(at(&path) == film(&[0..2]));
}

#[test]
fn a_film_whose_file_was_deleted_is_written_again() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("g.exr");
    let mut run = SharedFile::new(&path);
    run.save(&film(&[0..2]), &Description::new("r"), &same).unwrap();
    std::fs::remove_file(&path).unwrap();
    let saved = run.save(&film(&[0..4]), &Description::new("r"), &same).unwrap();
    assert_eq!((saved.path, saved.note, saved.is_elsewhere), (path.clone(), None, false));
    assert!(at(&path) == film(&[0..4]));
}

#[test]
fn disjoint_samples_of_two_new_runs_are_added() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("g.exr");
    let (mut a, mut b) = (SharedFile::new(&path), SharedFile::new(&path));
    let description = |samples: u64| {
        let mut description = Description::new("r");
        description.set(key::SAMPLES, samples);
        description
    };
    a.save(&film(&[0..8]), &description(8), &same).unwrap();
    b.save(&film(&[8..12]), &description(4), &same).unwrap();
    assert!(at(&path) == film(&[0..12]));
    let told = checkpoint::load(&path).unwrap().description;
    assert_eq!(told.get(key::SAMPLES), Some("12"));
}

#[test]
fn what_does_not_go_together_is_kept_twice() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("g.exr");
    let mut run = SharedFile::new(&path);
    put(&path, &[0..4]);
    let other = |_: &str, _: &str| Err("seed is 0 here, 1 there".to_owned());
    let saved = run.save(&film(&[0..2]), &Description::new("r"), &other).unwrap();
    assert!(saved.is_elsewhere && saved.note.unwrap().contains("seed is 0"));
    assert_eq!(saved.path, directory.path().join("g-2.exr"));
    assert!(at(&path) == film(&[0..4]) && at(&saved.path) == film(&[0..2]));
    // Later saves go there too.
    let saved = run.save(&film(&[0..6]), &Description::new("r"), &other).unwrap();
    assert_eq!((saved.note, saved.path.file_name().unwrap().to_str()), (None, Some("g-2.exr")));

    std::fs::write(&path, "no film any more").unwrap();
    let mut run = SharedFile::new(&path);
    std::fs::write(&path, "nor this").unwrap();
    let saved = run.save(&film(&[0..2]), &Description::new("r"), &same).unwrap();
    assert!(saved.is_elsewhere, "{saved:?}");
    assert_eq!(std::fs::read(&path).unwrap(), b"nor this");
}

#[test]
fn writers_at_once_lose_nothing() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("g.exr");
    put(&path, &[0..2]);
    // All resume the film before any of them writes.
    let places = [(); 3].map(|()| SharedFile::new(&path));
    std::thread::scope(|scope| {
        for (writer, mut place) in (0_u64..).zip(places) {
            scope.spawn(move || {
                for turn in 1..8 {
                    let own = 100 * (writer + 1)..100 * (writer + 1) + 2 * turn;
                    let saved = place.save(&film(&[0..2, own]), &Description::new("r"), &same).unwrap();
                    assert!(!saved.is_elsewhere, "{saved:?}");
                }
            });
        }
    });
    assert!(at(&path) == film(&[0..2, 100..114, 200..214, 300..314]), "{}", at(&path).samples());
}

#[test]
fn a_film_that_must_go_elsewhere_takes_the_first_free_number() {
    let directory = tempfile::tempdir().unwrap();
    let at_name = |name: &str| directory.path().join(name);
    let path = at_name("g.exr");
    let mut run = SharedFile::new(&path);
    // A film of another shape has come.
    let mut other = Film::new(2, 3, 2);
    other.record(0..4, 0).unwrap();
    checkpoint::save(&path, &other, &Description::new("r")).unwrap();
    std::fs::write(at_name("g-2.exr"), "mine").unwrap();
    let saved = run.save(&film(&[0..2]), &Description::new("r"), &same).unwrap();
    assert_eq!((saved.path, saved.is_elsewhere), (at_name("g-3.exr"), true));
    let note = saved.note.unwrap();
    for part in ["it now holds a film of another shape", "g.exr in the meantime", "are in ", "g-3.exr"] {
        assert!(note.contains(part), "{part:?} is not in {note:?}");
    }
    assert!(at(&path) == other && at(&at_name("g-3.exr")) == film(&[0..2]));
    assert_eq!(std::fs::read(at_name("g-2.exr")).unwrap(), b"mine");
}

#[test]
fn a_file_that_holds_more_is_told_of_once_until_it_grows() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("g.exr");
    let mut run = SharedFile::new(&path);
    put(&path, &[0..20]);
    let mut told = |samples: Range<u64>| {
        let saved = run.save(&film(&[samples]), &Description::new("r"), &same).unwrap();
        assert_eq!((&saved.path, saved.is_elsewhere), (&path, false));
        saved.note
    };
    let note = told(0..10).unwrap();
    assert!(note.contains("g.exr already holds all samples of this run, and also 10..20"), "{note}");
    assert_eq!(told(0..12), None);
    put(&path, &[0..24]);
    let note = told(0..14).unwrap();
    assert!(note.contains("and also 14..24"), "{note}");
    assert!(at(&path) == film(&[0..24]));
}

#[test]
fn another_picture_is_told_from_the_side_of_this_run() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("g.exr");
    let mut run = SharedFile::new(&path);
    checkpoint::save(&path, &film(&[0..4]), &Description::new("theirs")).unwrap();
    let compared = |first: &str, second: &str| Err(format!("it is {first} here, {second} there"));
    let saved = run.save(&film(&[0..2]), &Description::new("mine"), &compared).unwrap();
    let note = saved.note.unwrap();
    assert!(note.contains("a film of another picture: it is mine here, theirs there"), "{note}");
}
