//! Which pictures are rendered again, and what stays after an interruption, a full disk or a refusal.

use super::quick;
use crate::work::{self, Outcome};
use crate::write;
use std::fs;
use std::path::Path;
use std::sync::atomic::Ordering;
use std::thread;
use std::time::Duration;
use weekender::system::failure::Failure;
use weekender::system::interrupt::Interrupt;

/// Renders these figures or stages.
fn render(out: &Path, only: &str) -> Result<Outcome, Failure> {
    write(&quick(out, &["--only", only]), &Interrupt::unheard())
}

/// How many are rendered and how many kept.
fn counts(out: &Path, only: &str) -> [usize; 2] {
    let Outcome { rendered, kept, missing } = render(out, only).unwrap();
    assert_eq!(missing, 0);
    [rendered, kept]
}

#[test]
fn only_outdated_stills_are_rendered() {
    let at = tempfile::tempdir().unwrap();
    let only = "sky,red-sphere,antialiasing";
    assert_eq!(counts(at.path(), only), [4, 0]);
    assert_eq!(counts(at.path(), only), [0, 4]);
    let file = |name: &str| at.path().join("figures").join(name);
    // A damaged byte and a deleted file; a newer file alone does not count as changed.
    let mut bytes = fs::read(file("red-sphere.png")).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    fs::write(file("red-sphere.png"), bytes).unwrap();
    fs::remove_file(file("antialiased.png")).unwrap();
    fs::write(file("sky.png"), fs::read(file("sky.png")).unwrap()).unwrap();
    assert_eq!(counts(at.path(), only), [2, 2]);
    // A picture with other settings.
    fs::copy(file("red-sphere.png"), file("aliased.png")).unwrap();
    assert_eq!(counts(at.path(), only), [1, 3]);
    assert!(!at.path().join("index.html").exists());
}

#[test]
fn an_interruption_keeps_page_and_pictures() {
    let at = tempfile::tempdir().unwrap();
    let (options, interrupt) = (quick(at.path(), &[]), Interrupt::unheard());
    let more = at.path().join("figures/more");
    thread::scope(|scope| {
        scope.spawn(|| {
            while !more.read_dir().is_ok_and(|mut files| files.next().is_some()) {
                thread::sleep(Duration::from_millis(1));
            }
            interrupt.flag().store(true, Ordering::Relaxed);
        });
        let outcome = write(&options, &interrupt).unwrap();
        assert!(outcome.missing > 20, "{outcome:?}");
    });
    assert!(at.path().join("index.html").exists() && !at.path().join("figures/book.png").exists());
}

#[test]
fn a_failure_keeps_finished_stills() {
    let at = tempfile::tempdir().unwrap();
    let (options, interrupt) = (quick(at.path(), &["--only", "ppm-tiny,sky"]), Interrupt::unheard());
    let blocked = at.path().join("figures/sky.png");
    let block = || fs::create_dir(&blocked).map_err(Failure::run);
    let failure = work::render(&options, &interrupt, options.stills(), block).unwrap_err();
    assert!(matches!(failure, Failure::BrokeOff(_)), "{failure}");
    for part in ["sky.png", "kept: 1 picture"] {
        assert!(failure.to_string().contains(part), "{failure}");
    }
    fs::remove_dir(&blocked).unwrap();
    assert_eq!(counts(at.path(), "ppm-tiny,sky"), [1, 1]);
}

#[test]
fn what_is_refused_leaves_nothing() {
    let at = tempfile::tempdir().unwrap();
    let out = at.path().join("out");
    let refused = write(&quick(&out, &["--adapter", "no such adapter"]), &Interrupt::unheard());
    assert!(matches!(refused, Err(Failure::Input(_))) && !out.exists(), "{refused:?}");
    fs::write(&out, "").unwrap();
    assert!(matches!(render(&out, "sky"), Err(Failure::Input(_))));
    let page = at.path().join("index.html");
    fs::write(&page, "<title>Me</title>").unwrap();
    let refused = write(&quick(at.path(), &[]), &Interrupt::unheard());
    assert!(matches!(refused, Err(Failure::Input(_))), "{refused:?}");
    assert_eq!(fs::read_to_string(&page).unwrap(), "<title>Me</title>");
    assert!(!at.path().join("figures").exists());
}
