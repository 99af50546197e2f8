//! How a render ended, as a failure or none.

use super::files::Written;
use crate::cli::RenderOptions;
use crate::failure::Failure;
use crate::files::ShownPath;
use crate::film::Film;
use crate::progressive::{Phase, Status};
use anyhow::anyhow;

/// The result of a render and of writing its files. `kept` is the number of samples per pixel in the checkpoint file.
pub(super) fn outcome(
    render: &RenderOptions,
    status: &Status,
    film: Option<&Film>,
    written: &Written,
    kept: Option<u64>,
) -> Result<(), Failure> {
    let failure = written.failure.as_ref();
    let Phase::Failed(reason) = &status.phase else {
        return failure.map_or(Ok(()), |failure| Err(Failure::Run(anyhow!("{failure}"))));
    };
    let held = film.map_or(0, Film::sample_count);
    Err(match (failure, kept, &render.checkpoint) {
        (Some(failure), ..) => Failure::Run(anyhow!("{reason}; {failure}")),
        (None, ..) if held > 0 => {
            let files: Vec<String> = written.files.iter().map(ShownPath::shown).collect();
            let files = files.join(", ");
            Failure::BrokeOff(anyhow!(
                "{reason}; the {held} samples per pixel rendered before are in {files}"
            ))
        }
        (None, Some(kept), Some(path)) => {
            let path = path.shown();
            Failure::BrokeOff(anyhow!("{reason}; {kept} samples per pixel are in {path}"))
        }
        _ => Failure::Run(anyhow!("{reason}")),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::batch::tests::options;
    use crate::progressive::EndReason;

    #[test]
    fn a_render_that_leaves_nothing_has_not_broken_off() {
        let options = options(&["--checkpoint", "a.exr"]);
        let status = Status { phase: Phase::Failed("it broke".to_owned()), ..Status::default() };
        let failure = |kept| outcome(&options, &status, None, &Written::default(), kept).unwrap_err();
        assert!(matches!(failure(None), Failure::Run(_)));
        assert!(
            matches!(failure(Some(4)), Failure::BrokeOff(error) if error.to_string().contains("4 samples"))
        );
    }

    #[test]
    fn a_failure_says_why_and_where_the_samples_are() {
        let options = options(&["--checkpoint", "k.exr"]);
        let mut film = options.job.new_film();
        film.record(0..6, 0).unwrap();
        let failed = Status { phase: Phase::Failed("it broke".to_owned()), ..Status::default() };
        let done = Status { phase: Phase::Done(EndReason::Samples), ..Status::default() };
        let ended = |status: &Status, film: Option<&Film>, failure: Option<&str>| {
            let failure = failure.map(|words| anyhow!("{words}"));
            let files = vec!["a.png".into(), "k.exr".into()];
            let written = Written { files, failure, ..Written::default() };
            match outcome(&options, status, film, &written, Some(4)) {
                Ok(()) => "success".to_owned(),
                Err(Failure::BrokeOff(error)) => format!("broke off: {error}"),
                Err(Failure::Run(error)) => format!("failed: {error}"),
                Err(other) => panic!("{other:?}"),
            }
        };
        let held = "broke off: it broke; the 6 samples per pixel rendered before are in a.png, k.exr";
        assert_eq!(ended(&failed, Some(&film), None), held);
        let kept = "broke off: it broke; 4 samples per pixel are in k.exr";
        assert_eq!(ended(&failed, Some(&options.job.new_film()), None), kept);
        assert_eq!(ended(&failed, Some(&film), Some("no space")), "failed: it broke; no space");
        assert_eq!(ended(&done, Some(&film), Some("no space")), "failed: no space");
        assert_eq!(ended(&done, Some(&film), None), "success");
    }
}
