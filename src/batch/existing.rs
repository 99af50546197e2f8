//! Looks at the films that a render would replace, before it begins.

use super::files::Places;
use crate::cli::RenderOptions;
use crate::failure::Failure;
use crate::files::{FileIdentity, ShownPath};
use crate::film::{Film, SampleRanges};
use crate::recipe::file;
use crate::saved::Replaced;
use anyhow::anyhow;
use std::ops::Range;

/// Checks what is in the `places` of a render that goes on with `resumed`. Returns warnings for the user.
///
/// # Errors
/// [`Failure::Input`] if `--checkpoint` is a file that the render does not go on with.
pub(super) fn check(
    render: &RenderOptions,
    places: &Places,
    resumed: Option<&Film>,
) -> Result<Vec<String>, Failure> {
    let mut warnings: Vec<String> = resumed.and_then(|film| too_many(render, film)).into_iter().collect();
    let own = render.resume.as_deref().and_then(FileIdentity::of);
    for (flag, path, place) in places.films(render) {
        let identity = FileIdentity::of(path);
        if own.as_ref().zip(identity.as_ref()).is_some_and(|(own, it)| own.is_same_as(it)) {
            continue;
        }
        let found = Replaced::at(path, &file::to_picture_toml(&render.recipe));
        if flag == "--checkpoint" {
            if let Some(reason) = found.refusal(path) {
                return Err(Failure::Input(anyhow!(reason)));
            }
            continue;
        }
        let is_kept = |samples: &SampleRanges| {
            samples.iter().all(|range| is_covered(&range, &render.plan.range(), resumed))
        };
        warnings.extend(found.warning(path, is_kept));
        if let Replaced::Same(samples) = &found
            && is_kept(samples)
        {
            // A render that is stopped early must not replace it either.
            place.lock().holds(samples);
        }
    }
    Ok(warnings)
}

/// Whether all samples of `range` are in the `planned` ones or in the film that the render goes on with.
fn is_covered(range: &Range<u64>, planned: &Range<u64>, resumed: Option<&Film>) -> bool {
    let before = range.start..range.end.min(planned.start);
    let after = range.start.max(planned.end)..range.end;
    let is_held = |part: Range<u64>| {
        part.is_empty() || resumed.is_some_and(|film| film.samples().first_gap(part, u64::MAX).is_none())
    };
    is_held(before) && is_held(after)
}

/// A warning if the film to go on with has samples beyond those that `--samples` asks for.
fn too_many(render: &RenderOptions, film: &Film) -> Option<String> {
    let asked = render.asked_samples?;
    let path = render.resume.as_deref()?.shown();
    let samples = film.samples();
    (samples.end() > asked).then(|| {
        format!(
            "{path} already holds the samples {samples} of each pixel, and none can be removed, so the result has more \
             than --samples {asked}"
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::batch::files::write;
    use crate::batch::tests::options;
    use crate::film::{Description, checkpoint};
    use crate::progressive::Status;
    use std::path::Path;

    /// Writes the film of `render` with these samples, with the seed `seed`.
    fn put(path: &Path, render: &RenderOptions, samples: Range<u64>, seed: u32) -> Film {
        let mut recipe = render.recipe.clone();
        recipe.settings.seed = seed;
        let mut film = render.job.new_film();
        film.record(samples, 0).unwrap();
        checkpoint::save(path, &film, &Description::new(&file::to_picture_toml(&recipe))).unwrap();
        film
    }

    #[test]
    fn only_what_the_plan_or_the_film_has_is_covered() {
        let mut film = Film::new(1, 1, 1);
        film.record(0..4, 0).unwrap();
        film.record(16..20, 0).unwrap();
        for (range, planned, alone, with_film) in [
            (0..4, 0..8, true, true),
            (0..8, 0..8, true, true),
            (0..9, 0..8, false, false),
            (0..8, 4..8, false, true),
            (4..20, 4..16, false, true),
            (4..21, 4..16, false, false),
            (17..19, 4..8, false, true),
            (3..5, 8..9, false, false),
        ] {
            assert_eq!(is_covered(&range, &planned, None), alone, "{range:?} in {planned:?}");
            assert_eq!(is_covered(&range, &planned, Some(&film)), with_film, "{range:?} in {planned:?}");
        }
    }

    #[test]
    fn a_checkpoint_never_replaces_a_film_that_the_render_does_not_go_on_with() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("k.exr");
        let name = path.to_str().unwrap();
        for samples in ["8", "3000", "4000"] {
            let render = options(&["--checkpoint", name, "--samples", samples]);
            let film = put(&path, &render, 0..3000, 0);
            let told = check(&render, &Places::of(&render).unwrap(), None).unwrap_err().to_string();
            assert!(told.contains("3000 samples") && told.contains("--continue"), "{told}");
            std::fs::remove_file(&path).unwrap();
            assert!(check(&render, &Places::of(&render).unwrap(), None).unwrap().is_empty());
            put(&path, &render, 0..3000, 0);
            let going_on = options(&["--checkpoint", name, "--samples", "4000", "--continue"]);
            assert!(check(&going_on, &Places::of(&going_on).unwrap(), Some(&film)).unwrap().is_empty());
            put(&path, &render, 0..3000, 1);
            let told = check(&render, &Places::of(&render).unwrap(), None).unwrap_err().to_string();
            assert!(told.contains("another picture (seed is 0 here, 1 there)"), "{told}");
            std::fs::remove_file(&path).unwrap();
        }
    }

    #[test]
    fn an_output_replaces_a_film_with_a_warning_if_samples_are_lost() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("k.exr");
        let warned = |flags: &[&str]| {
            let render = options(&[&["--out", path.to_str().unwrap()][..], flags].concat());
            check(&render, &Places::of(&render).unwrap(), None).unwrap().join("; ")
        };
        put(&path, &options(&[]), 0..32, 0);
        let told = warned(&["--samples", "8"]);
        assert!(told.contains("k.exr, which holds 32 samples per pixel of this picture"), "{told}");
        assert!(!warned(&["--sample-range", "32..64"]).is_empty());
        assert!(warned(&["--samples", "8", "--seed", "1"]).contains("another picture"));
        for all in [["--samples", "32"], ["--samples", "64"], ["--time-limit", "1"]] {
            assert_eq!(warned(&all), "", "{all:?}");
        }
    }

    #[test]
    fn a_render_that_ends_early_leaves_the_longer_film() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("k.exr");
        let render = options(&["--out", path.to_str().unwrap(), "--samples", "64"]);
        let longer = put(&path, &render, 0..32, 0);
        let places = Places::of(&render).unwrap();
        assert!(check(&render, &places, None).unwrap().is_empty());
        for (end, held) in [(8, 32), (40, 40)] {
            let mut film = render.job.new_film();
            film.record(0..end, 0).unwrap();
            let written = write(&render, &places, &film, &Status::default(), None, |_| {});
            assert!(written.failure.is_none(), "{written:?}");
            assert_eq!(written.notes.len(), usize::from(held == longer.sample_count()), "{written:?}");
            assert_eq!(checkpoint::load(&path).unwrap().film.sample_count(), held);
        }
    }

    #[test]
    fn fewer_samples_than_the_film_has_are_warned_of() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("film.exr");
        let name = path.to_str().unwrap();
        let film = put(&path, &options(&[]), 0..32, 0);
        let out = directory.path().join("f.png");
        let warned = |flags: &[&str]| {
            let render = options(&[&["--out", out.to_str().unwrap()][..], flags].concat());
            check(&render, &Places::of(&render).unwrap(), Some(&film)).unwrap().join("; ")
        };
        for flags in [["--resume", name].as_slice(), &["--checkpoint", name, "--continue"]] {
            let told = warned(&[flags, &["--samples", "8"]].concat());
            assert!(told.contains("film.exr already holds the samples 0..32"), "{told}");
            assert!(told.ends_with("--samples 8"), "{told}");
            for more in [&["--samples", "32"][..], &["--samples", "40"], &["--sample-range", "4..8"], &[]] {
                assert_eq!(warned(&[flags, more].concat()), "", "{more:?}");
            }
        }
    }
}
