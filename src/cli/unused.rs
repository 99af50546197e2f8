//! Flags of the picture that have no effect on it.

use super::raw::{RawAnimation, RawPicture};
use crate::render::RenderJob;
use crate::stages::Stage;

/// Warnings that name the flags without effect on the pictures of `job`, one for each reason. `samples` is the number that
/// was asked for.
pub(super) fn notes(
    job: &RenderJob,
    stage: Option<&Stage>,
    picture: &RawPicture,
    animation: &RawAnimation,
    samples: Option<u64>,
) -> Vec<String> {
    let (rules, scene) = (job.rules(), job.scene());
    let has_lens = job.camera().defocus_angle_degrees > 0.0;
    let has_bounces = rules.has_bounces() && !scene.spheres.is_empty();
    let is_random =
        rules.has_rays() && (rules.antialiasing || has_lens || has_bounces && job.settings().max_depth > 1);
    let what = stage.map_or_else(|| "the scene".to_owned(), |stage| format!("the stage {}", stage.id));
    let depth = ("--depth", picture.depth.is_some());
    let mut notes = Vec::new();
    let mut add = |flags: &[(&'static str, bool)], reason: String| notes.extend(note(flags, &reason));
    if !rules.has_rays() {
        let frames =
            [("--frames", animation.frames.is_some()), ("--turntable", animation.turntable.is_some())];
        add(&[&picture.camera_flags()[..], &[depth], &frames].concat(), format!("{what} traces no rays"));
    } else {
        if !rules.has_bounces() {
            add(&[depth], format!("the rays of {what} end where they first hit"));
        } else if !has_bounces {
            add(&[depth], format!("{what} has no spheres, so no ray goes on after the camera's"));
        }
        if !has_lens {
            let reason = "the lens is a pinhole; add --defocus-angle".to_owned();
            add(&[("--focus-distance", picture.focus_distance.is_some())], reason);
        }
    }
    if !is_random {
        let flags = [
            ("--samples above 1", samples.is_some_and(|samples| samples > 1)),
            ("--sampler", picture.sampler.is_some()),
            ("--seed", picture.seed.is_some()),
        ];
        add(&flags, "all samples of a pixel are the same".to_owned());
    }
    notes
}

/// A warning that names those of the flags that are given.
fn note(flags: &[(&'static str, bool)], reason: &str) -> Option<String> {
    let given: Vec<&str> = flags.iter().filter(|(_, is_given)| *is_given).map(|(flag, _)| *flag).collect();
    match given.as_slice() {
        [] => None,
        [only] => Some(format!("{only} has no effect: {reason}")),
        [first @ .., last] => Some(format!("{} and {last} have no effect: {reason}", first.join(", "))),
    }
}

#[cfg(test)]
mod tests {
    use crate::cli::{Request, parse};

    /// The warnings for a command line, whatever renders its pictures.
    fn notes(line: &str) -> Vec<String> {
        let words = ["weekender"].into_iter().chain(line.split(' '));
        match parse(words.map(Into::into)).unwrap() {
            Request::Batch(options) => options.renders.into_iter().flat_map(|render| render.notes).collect(),
            Request::Frames(options) => options.notes,
            Request::Plan(options) => options.notes,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn flags_without_effect_are_named_with_the_reason() {
        let same = "all samples of a pixel are the same";
        for (line, expected) in [
            (
                "--batch --stage ppm-tiny --size 9x9 --samples 7 --depth 3 --look-from 1,2,3",
                vec![
                    "--look-from and --depth have no effect: the stage ppm-tiny traces no rays".to_owned(),
                    format!("--samples above 1 has no effect: {same}"),
                ],
            ),
            (
                "--batch --stage ppm-gradient --turntable=2 --vfov 30 --focus-distance 2 --out d",
                vec![
                    "--vfov, --focus-distance and --turntable have no effect: the stage ppm-gradient traces no rays"
                        .to_owned(),
                ],
            ),
            (
                "plan --parts 2 --out d --stage normals --samples 8 --depth 3 --seed 4 --sampler sobol",
                vec![
                    "--depth has no effect: the rays of the stage normals end where they first hit".to_owned(),
                    format!("--samples above 1, --sampler and --seed have no effect: {same}"),
                ],
            ),
            (
                "--batch --stage sky --depth 9",
                vec![
                    "--depth has no effect: the stage sky has no spheres, so no ray goes on after the camera's"
                        .to_owned(),
                ],
            ),
            (
                "--batch --scene three-spheres --focus-distance 2",
                vec!["--focus-distance has no effect: the lens is a pinhole; add --defocus-angle".to_owned()],
            ),
        ] {
            assert_eq!(notes(line), expected, "{line}");
        }
    }

    #[test]
    fn flags_with_an_effect_are_not() {
        for line in [
            "--batch --stage ppm-tiny --size 9x9 --samples 1",
            "--batch --stage sky --look-from 1,2,3 --vfov 30 --defocus-angle 2 --focus-distance 3 --samples 9",
            "--batch --stage antialiased --samples 9 --seed 3 --sampler independent",
            "--batch --stage metal --depth 3 --samples 9 --turntable=3 --out d",
            "--batch --stage all --depth 3 --samples 9 --out d",
            "plan --parts 2 --out d --scene metals --depth 3 --samples 9",
        ] {
            assert_eq!(notes(line), Vec::<String>::new(), "{line}");
        }
    }
}
