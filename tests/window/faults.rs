//! Faults in the tracer while the window shows its picture.

use crate::harness::{has_samples, open, save, until};
use crate::questions::Ask as _;
use weekender::app::Command;
use weekender::film::{Film, checkpoint};
use weekender::job::output::OutputFormat;

const PICTURE: &str = "--stage defocus --size 48x27 --device cpu --samples 40";

/// The film that the window saves when the picture is finished.
fn film_of(flags: &str, message: Option<&str>) -> Film {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("film.exr");
    let mut harness = open(&format!("{PICTURE} {flags}"));
    if let Some(message) = message {
        until(&mut harness, message, |window| window.messages().iter().any(|said| said.contains(message)));
    }
    until(&mut harness, "the end", |window| has_samples(40)(window) && window.status().phase.is_over());
    save(&mut harness, Command::SaveAs(OutputFormat::Exr), &path);
    checkpoint::load(&path).unwrap().film
}

#[test]
fn another_backend_finishes_after_a_panic() {
    let whole = film_of("", None);
    for tiles in [0, 9] {
        let film = film_of(&format!("--simulate-panic {tiles}"), Some("panicked"));
        assert_eq!((film.samples(), film.rejected()), (whole.samples(), 0), "{tiles} tiles before the panic");
        // The backend that takes over may round differently, which sends a few paths in thousands another way.
        let mean = |film: &Film| (0..48 * 27).map(|pixel| film.mean(pixel)[0]).sum::<f64>() / (48.0 * 27.0);
        let (found, expected) = (mean(&film), mean(&whole));
        assert!((found - expected).abs() < 2e-4 * expected, "{tiles}: {found}, not {expected}");
    }
}
