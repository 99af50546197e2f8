//! The frames of a plan: which of them are there, and the animated PNG of all.

use super::{check, parts, watch, wrote};
use crate::cli::MergeOptions;
use crate::console;
use crate::describe::{SOFTWARE, describe_animation};
use crate::failure::{FAILED, Failure};
use crate::files::{ShownPath, Stamp};
use crate::interrupt::Interrupt;
use crate::output::{OutputFormat, write_animation};
use crate::plan::{Frames, Plan};
use crate::saved::FrameState;
use crate::terminal::print;
use anyhow::anyhow;
use std::process::ExitCode;
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Reads all frames, and says what is missing.
///
/// # Errors
/// [`Failure::Run`] if standard output cannot be written.
pub(super) fn check(plan: &Plan<Frames>, program: &str) -> Result<ExitCode, Failure> {
    let lacking = lacking(plan);
    let mut lines: Vec<String> = lacking.iter().map(|frame| frame.line(plan)).collect();
    lines.push(words(plan, lacking.len()));
    if !lacking.is_empty() {
        lines.push(parts::remedy(plan, &parts_of(&lacking), program));
    }
    check::tell(&lines, lacking.is_empty())
}

/// Makes the animated PNG if all frames are whole; otherwise says what is missing.
///
/// # Errors
/// [`Failure::Input`] if it cannot be such a file; [`Failure::Run`] if it cannot be written.
pub(super) fn merge(plan: &Plan<Frames>, options: &MergeOptions) -> Result<ExitCode, Failure> {
    check_names(options)?;
    let lacking = lacking(plan);
    if lacking.is_empty() {
        return assemble(plan, options);
    }
    for frame in &lacking {
        console::note(&frame.line(plan));
    }
    console::note(&words(plan, lacking.len()));
    parts::note_remedy(plan, &parts_of(&lacking), &options.program);
    Ok(ExitCode::from(FAILED))
}

/// Waits until all frames are whole, or until a signal, and tells how many are there; then makes the animated PNG.
///
/// # Errors
/// As [`merge`].
pub(super) fn watch(
    plan: &Plan<Frames>,
    options: &MergeOptions,
    every: Duration,
) -> Result<ExitCode, Failure> {
    check_names(options)?;
    let interrupt = Interrupt::install().map_err(Failure::Run)?;
    let mut awaited: Vec<(Frame, Option<Stamp>)> = lacking(plan)
        .into_iter()
        .map(|frame| {
            let seen = watch::stamp(&plan.names().path(frame.number));
            (frame, seen)
        })
        .collect();
    let (mut told, mut last) = (None, Instant::now());
    while !awaited.is_empty() && !interrupt.is_set() {
        if is_to_tell(told, awaited.len(), last.elapsed(), every) {
            console::note(&words(plan, awaited.len()));
            (told, last) = (Some(awaited.len()), Instant::now());
        }
        let begin = Instant::now();
        while begin.elapsed() < watch::LOOK && !interrupt.is_set() {
            sleep(watch::SIGNAL);
        }
        awaited.retain_mut(|(frame, seen)| {
            let now = watch::stamp(&plan.names().path(frame.number));
            if now.is_none() || now == *seen {
                return true;
            }
            (*seen, frame.state) = (now, state(plan, frame.number));
            if let FrameState::Wrong(_) = frame.state {
                console::note(&format!("warning: {}", frame.line(plan)));
            }
            frame.state != FrameState::Whole
        });
    }
    if awaited.is_empty() {
        let _writing = interrupt.while_writing("the animation");
        return assemble(plan, options);
    }
    let lacking: Vec<Frame> = awaited.into_iter().map(|(frame, _)| frame).collect();
    console::note(&words(plan, lacking.len()));
    console::note("interrupted; the same command goes on");
    parts::note_remedy(plan, &parts_of(&lacking), &options.program);
    Ok(interrupt.exit_code())
}

/// Whether to tell that so many frames are awaited: at first, and when it is another number than was `told`, but not
/// before `every` has passed `since` then.
fn is_to_tell(told: Option<usize>, awaited: usize, since: Duration, every: Duration) -> bool {
    told.is_none_or(|told| told != awaited && since >= every)
}

/// A frame that is not whole.
struct Frame {
    /// The part that renders it.
    part: usize,
    number: u32,
    state: FrameState,
}

impl Frame {
    fn line(&self, plan: &Plan<Frames>) -> String {
        let Frame { part, number, state } = self;
        match state {
            FrameState::Wrong(words) => format!("part {part}: {words}"),
            FrameState::Missing | FrameState::Whole => {
                let path = plan.names().path(*number);
                let name = path.file_name().unwrap_or_default().shown();
                format!("part {part}: {name} is missing")
            }
        }
    }
}

fn state(plan: &Plan<Frames>, number: u32) -> FrameState {
    let recipe = plan.recipe.at_frame(&plan.camera_path(), number);
    FrameState::of(&plan.names().path(number), &recipe, SOFTWARE)
}

/// The frames that are not whole, in order.
fn lacking(plan: &Plan<Frames>) -> Vec<Frame> {
    let frames = plan.manifest.work.parts.iter().enumerate();
    let frames = frames.flat_map(|(part, frames)| frames.range().map(move |number| (part, number)));
    let frames = frames.map(|(part, number)| Frame { part, number, state: state(plan, number) });
    frames.filter(|frame| frame.state != FrameState::Whole).collect()
}

/// The parts that render these frames.
fn parts_of(frames: &[Frame]) -> Vec<usize> {
    let mut parts: Vec<usize> = frames.iter().map(|frame| frame.part).collect();
    parts.dedup();
    parts
}

fn words(plan: &Plan<Frames>, lacking: usize) -> String {
    let count = plan.manifest.work.range().len();
    format!("{} of {count} frames are whole", count - lacking)
}

/// Returns an error if the result is not to be an animated PNG.
fn check_names(options: &MergeOptions) -> Result<(), Failure> {
    let is_png = |out: &&std::path::PathBuf| matches!(OutputFormat::from_path(out), Ok(OutputFormat::Png));
    match options.out.iter().find(|out| !is_png(out)) {
        Some(out) => Err(Failure::Input(anyhow!(
            "--out is {}, but the frames of an animation make an animated PNG; let the name end in .png",
            out.shown()
        ))),
        None => Ok(()),
    }
}

fn assemble(plan: &Plan<Frames>, options: &MergeOptions) -> Result<ExitCode, Failure> {
    let (work, settings, names) = (&plan.manifest.work, plan.job.settings(), plan.names());
    let description = describe_animation(&plan.recipe, &plan.manifest.command);
    let first = work.frames[0];
    for out in &options.out {
        let files = (0..work.range().len()).map(|index| names.path(first + index as u32));
        write_animation(out, [settings.width, settings.height], work.rate, files, &description)
            .map_err(Failure::run)?;
    }
    print(&format!("{}\n{}", words(plan, 0), wrote(&options.out))).map_err(Failure::Run)?;
    Ok(ExitCode::SUCCESS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::animation::Turn;
    use crate::cli::MergeSource;
    use crate::film::{Description, Film, fixed_point, key};
    use crate::output::{FrameRate, write_image};
    use crate::plan::Manifest;
    use crate::recipe::{Recipe, file};
    use crate::stages::Transfer;
    use std::io::BufReader;
    use std::path::{Path, PathBuf};

    #[test]
    fn a_number_is_told_at_first_and_then_when_it_has_changed_but_not_too_often() {
        let every = Duration::from_secs(5);
        let is_told = |told, millis| is_to_tell(told, 3, Duration::from_millis(millis), every);
        assert!(is_told(None, 0));
        assert!(is_told(Some(4), 5000) && is_told(Some(2), 9000));
        assert!(!is_told(Some(4), 4999) && !is_told(Some(3), 4999) && !is_told(Some(3), 9000));
    }

    const SIZE: [u32; 2] = [4, 3];

    /// A plan of the frames 5 to 8 in two parts, whose files are whole and of a grey of their own.
    fn planned(directory: &Path) -> Plan<Frames> {
        let rate = FrameRate { frames: 12, seconds: 1 };
        let work = Frames::new(&(5..9), Some(Turn::FramesPerTurn(20)), rate, 2).unwrap();
        let mut recipe = Recipe::find("three-spheres").unwrap();
        ([recipe.settings.width, recipe.settings.height], recipe.samples_per_pixel) = (SIZE, 1);
        let plan = Plan::write(directory, &recipe, &recipe.job().unwrap(), Manifest::new(work)).unwrap();
        for number in 5..9 {
            let recipe = plan.recipe.at_frame(&plan.camera_path(), number);
            let mut film = Film::new(SIZE[0], SIZE[1], 1);
            let grey = fixed_point([f64::from(number) / 10.0; 3]).unwrap();
            film.halves_mut()[0].iter_mut().for_each(|sum| sum.add(grey));
            film.record(0..1, 0).unwrap();
            let mut description = Description::new(&file::to_picture_toml(&recipe));
            description.set(key::SOFTWARE, SOFTWARE);
            description.set(key::SAMPLES, 1);
            write_image(&plan.names().path(number), &film, Transfer::Linear, &description).unwrap();
        }
        plan
    }

    fn into(plan: &Plan<Frames>, out: &[PathBuf]) -> MergeOptions {
        MergeOptions {
            source: MergeSource::Plan(plan.path.clone()),
            out: out.to_vec(),
            watch: None,
            check: false,
            program: "weekender".to_owned(),
        }
    }

    /// The first byte of each frame of an animated PNG, and the delay of the first.
    fn greys(path: &Path) -> (Vec<u8>, [u16; 2]) {
        let file = BufReader::new(std::fs::File::open(path).unwrap());
        let mut reader = png::Decoder::new(file).read_info().unwrap();
        let control = *reader.info().frame_control().unwrap();
        let frames = reader.info().animation_control().unwrap().num_frames;
        let mut first_byte = || {
            let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
            reader.next_frame(&mut pixels).unwrap();
            pixels[0]
        };
        ((0..frames).map(|_| first_byte()).collect(), [control.delay_num, control.delay_den])
    }

    #[test]
    fn frames_that_do_not_begin_at_0_are_merged_in_their_order() {
        let directory = tempfile::tempdir().unwrap();
        let plan = planned(directory.path());
        let out = ["a.png", "b.png"].map(|name| directory.path().join(name));
        assert_eq!(lacking(&plan).len(), 0);
        assert_eq!(merge(&plan, &into(&plan, &out)).unwrap(), ExitCode::SUCCESS);
        // Frame number 5 has the radiance 5/10, of which 256 levels show level 128, and so on.
        for out in &out {
            assert_eq!(greys(out), (vec![128, 153, 179, 204], [1, 12]));
        }
        assert_eq!(words(&plan, 0), "4 of 4 frames are whole");
    }

    #[test]
    fn a_frame_that_is_missing_is_of_the_part_that_has_its_number() {
        let directory = tempfile::tempdir().unwrap();
        let plan = planned(directory.path());
        for number in [6, 8] {
            std::fs::remove_file(plan.names().path(number)).unwrap();
        }
        std::fs::copy(plan.names().path(5), plan.names().path(7)).unwrap();
        let lacking = lacking(&plan);
        let lines: Vec<String> = lacking.iter().map(|frame| frame.line(&plan)).collect();
        assert_eq!(
            [&lines[0], &lines[2]],
            ["part 0: frame-0006.png is missing", "part 1: frame-0008.png is missing"]
        );
        assert!(lines[1].starts_with("part 1: ") && lines[1].contains("is of another picture"), "{lines:?}");
        assert_eq!((lines.len(), parts_of(&lacking)), (3, vec![0, 1]));
        assert_eq!(words(&plan, lacking.len()), "1 of 4 frames are whole");
        let out = [directory.path().join("a.png")];
        assert_eq!(merge(&plan, &into(&plan, &out)).unwrap(), ExitCode::from(FAILED));
        assert!(!out[0].exists());
    }

    #[test]
    fn parts_are_named_once() {
        let frame = |(part, number)| Frame { part, number, state: FrameState::Missing };
        let frames: Vec<Frame> = [(0, 1), (0, 2), (2, 7), (3, 8), (3, 9)].map(frame).into();
        assert_eq!(parts_of(&frames), [0, 2, 3]);
    }
}
