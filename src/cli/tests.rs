//! Command lines and the requests that they make. `tests/golden/flags.rs` has most flags; these are the others.

use super::*;
use crate::animation::Turn;
use crate::backends::BackendChoice;
use crate::output::FrameRate;
use crate::render_cpu::{CpuOptions, Isa};
use crate::render_gpu::GpuOptions;
use std::time::Duration;

fn request(line: &str) -> Result<Request, Failure> {
    parse(format!("weekender {line}").split(' ').map(Into::into))
}

fn refused(line: &str) -> String {
    request(line).unwrap_err().to_string()
}

fn some_gpu() -> GpuOptions {
    GpuOptions::of_adapter(Some("some"))
}

#[test]
fn commands_call_the_program_in_any_directory_as_it_was_called_in_this_one() {
    let whole = std::env::current_exe().unwrap().to_str().unwrap().to_owned();
    for (name, expected) in [
        ("weekender", "weekender"),
        ("./weekender", whole.as_str()),
        ("../release/weekender", whole.as_str()),
        ("target/release/weekender", whole.as_str()),
        ("/usr/bin/weekender", whole.as_str()),
    ] {
        let parsed = |words: &[&str]| parse([&[name], words].concat().into_iter().map(Into::into)).unwrap();
        let planned = |more: &[&str]| match parsed(
            &[&["plan", "--samples", "4", "--parts", "2", "--out", "no-such-plan"], more].concat(),
        ) {
            Request::Plan(options) => options.program,
            other => panic!("{other:?}"),
        };
        assert_eq!(planned(&[]), expected, "{name}");
        assert_eq!(planned(&["--program", "./another"]), "./another", "{name}");
        match parsed(&["merge", "no-such-a.exr", "no-such-b.exr", "--out", "no-such-c.exr"]) {
            Request::Merge(options) => assert_eq!(options.program, expected, "{name}"),
            other => panic!("{other:?}"),
        }
    }
    assert_eq!(called(None), "weekender");
}

#[cfg(unix)]
#[test]
fn words_that_are_not_utf_8_are_named() {
    use std::os::unix::ffi::OsStringExt;
    let words = [&b"weekender"[..], b"--batch", b"--out", b"a\xff.png", b"--scene", b"b\xfe.toml"];
    let told = parse(words.map(|word| OsString::from_vec(word.to_vec()))).unwrap_err().to_string();
    assert!(told.starts_with("error: the command line has words that are not UTF-8, "), "{told}");
    assert!(told.contains(r#": "a\xFF.png", "b\xFE.toml"; rename the file"#), "{told}");
}

#[test]
fn a_merge_is_of_films_or_of_a_plan_which_can_be_watched_and_checked() {
    let directory = tempfile::tempdir().unwrap();
    let plan = directory.path().to_str().unwrap();
    let merged = |line: &str| match request(&format!("merge {line}")) {
        Ok(Request::Merge(options)) => *options,
        other => panic!("{other:?}"),
    };
    for (flags, seconds) in [
        ("", None),
        (" --watch", Some(60)),
        (" --watch --every 5s", Some(5)),
        (" --every 2m --watch", Some(120)),
    ] {
        let options = merged(&format!("{plan} --out no-such.png{flags}"));
        assert!(
            matches!(&options.source, MergeSource::Plan(found) if found == directory.path()),
            "{options:?}"
        );
        assert_eq!((options.watch, options.check), (seconds.map(Duration::from_secs), false), "{flags}");
        assert_eq!(options.out, [Path::new("no-such.png")]);
    }
    let checked = merged(&format!("{plan} --check"));
    assert!(checked.check && checked.out.is_empty() && checked.watch.is_none(), "{checked:?}");
    let films = merged("no-such-a.exr no-such-b.exr --out no-such.exr --out no-such.png");
    let names = ["no-such-a.exr", "no-such-b.exr"].map(Path::new);
    assert!(matches!(&films.source, MergeSource::Films(found) if *found == names), "{films:?}");
    assert_eq!(films.out, ["no-such.exr", "no-such.png"].map(Path::new));
    for (line, part) in [
        ("no-such-a.exr --out no-such.exr --watch", "--watch needs a plan: "),
        ("no-such-a.exr no-such/plan.json --out no-such.exr", "a plan cannot be used with other files: "),
        ("no-such-a.exr --out no-such.jpg", "no-such.jpg"),
        ("no-such-a.exr --out no-such.exr --every 5s", "--watch"),
        ("no-such-a.exr --out no-such.exr --check", "--check"),
    ] {
        let told = refused(&format!("merge {line}"));
        assert!(told.contains(part), "{line}: {told}");
    }
}

#[test]
fn a_plan_has_its_format_its_frames_and_its_rate() {
    let planned = |flags: &str| match request(&format!("plan --out no-such-plan --parts 2 {flags}")) {
        Ok(Request::Plan(options)) => *options,
        other => panic!("{other:?}"),
    };
    for (name, format) in [
        ("text", PlanFormat::Text),
        ("json", PlanFormat::Json),
        ("slurm", PlanFormat::Slurm),
        ("parallel", PlanFormat::Parallel),
        ("make", PlanFormat::Make),
    ] {
        assert_eq!(planned(&format!("--samples 4 --format {name}")).format, format);
    }
    for (flags, frames, turn, rate) in [
        ("--turntable", 0..120, Turn::FramesPerTurn(120), [30, 1]),
        ("--turntable=7 --fps 30000/1001", 0..7, Turn::FramesPerTurn(7), [30_000, 1001]),
        ("--frames 2..9 --turntable=90", 2..9, Turn::FramesPerTurn(90), [30, 1]),
        ("--frames 3..5 --turntable=-2deg --fps 24", 3..5, Turn::DegreesPerFrame(-2.0), [24, 1]),
    ] {
        let rate = FrameRate { frames: rate[0], seconds: rate[1] };
        let work = PlannedWork::Frames { frames, turntable: Some(turn), rate };
        assert_eq!(planned(flags).work, work, "{flags}");
    }
    assert!(refused("plan --out no-such-plan --parts 2 --turntable=2deg").contains("--frames"));
}

#[test]
fn frames_are_those_that_are_named_or_one_turn() {
    for (flags, frames, samples, animation) in [
        ("--turntable=4 --samples 3 --out no-such", 0..4, 3, None),
        ("--frames 3..5 --turntable=90 --samples 2 --out no-such.png", 3..5, 2, Some([30, 1])),
        ("--turntable=5 --fps 25/2 --samples 1 --out no-such.APNG", 0..5, 1, Some([25, 2])),
    ] {
        let Ok(Request::Frames(options)) = request(&format!("--batch --device cpu {flags}")) else {
            panic!("no frames: {flags}")
        };
        assert_eq!((options.frames, options.recipe.samples_per_pixel), (frames, samples), "{flags}");
        let rate = options.animation.map(|(_, rate)| [rate.frames, rate.seconds]);
        assert_eq!(rate, animation, "{flags}");
    }
    for (out, part) in [
        ("no-such-##.jpg", "let the pattern end in .png"),
        ("no-such.exr", "an animation has no film"),
        ("no-such.gif", "a directory of PNG files"),
    ] {
        let told = refused(&format!("--batch --turntable --out {out}"));
        assert!(told.contains(&format!("--out is {out}, but ")) && told.contains(part), "{told}");
    }
}

#[test]
fn a_path_is_compared_by_the_sides_and_at_the_place_that_are_named() {
    let compared = |flags: &str| match request(&format!("diff {flags}")) {
        Ok(Request::Diff(options)) => *options,
        other => panic!("{other:?}"),
    };
    let cpu = |isa| BackendChoice::Cpu(CpuOptions { isa, ..CpuOptions::default() });
    let portable = || cpu(Some(Isa::Portable));
    for (flags, sides) in [
        ("--pixel 0,0", [cpu(None), BackendChoice::Gpu(GpuOptions::default())]),
        ("--pixel 0,0 --sides gpu,portable --adapter some", [BackendChoice::Gpu(some_gpu()), portable()]),
        (
            "--pixel 0,0 --sides reference,cpu --isa portable",
            [BackendChoice::Reference { threads: None }, portable()],
        ),
    ] {
        assert_eq!(compared(flags).sides, sides, "{flags}");
    }
    let given = |x, y, sample| PathChoice::Given { pixel: [x, y], sample };
    for (flags, size, path) in [
        ("--pixel 2,3", [800, 450], given(2, 3, 0)),
        ("--pixel 19,9 --sample 7 --size 20x10", [20, 10], given(19, 9, 7)),
        ("--find", [200, 113], PathChoice::Find { samples: 4 }),
        ("--find=9 --size 300x10", [300, 10], PathChoice::Find { samples: 9 }),
    ] {
        let DiffOptions { job, path: found, .. } = compared(&format!("--sides portable,reference {flags}"));
        assert_eq!(([job.settings().width, job.settings().height], found), (size, path), "{flags}");
    }
    for (flags, told) in [
        (
            "--pixel 20,9 --size 20x10",
            "--pixel is 20,9, but the picture has 20x10 pixels: the last one is 19,9",
        ),
        (
            "--pixel 3,10 --size 20x10",
            "--pixel is 3,10, but the picture has 20x10 pixels: the last one is 19,9",
        ),
        ("--pixel 0,0 --adapter some", "--adapter needs the side gpu in --sides"),
        ("--pixel 0,0 --isa portable", "--isa needs the side cpu in --sides"),
    ] {
        let error = refused(&format!("diff --sides portable,reference {flags}"));
        assert!(error.starts_with(&format!("error: {told}")), "{error}");
    }
}

#[test]
fn backends_are_those_that_are_named() {
    let backend = |line: &str| match request(line) {
        Ok(Request::Gallery(options)) => options.backend,
        Ok(Request::Part(options)) => options.backend,
        other => panic!("{other:?}"),
    };
    let cpu = BackendChoice::Cpu(CpuOptions { threads: Some(3), ..CpuOptions::default() });
    for command in ["gallery --out no-such", "render-part no-such --part 1"] {
        for (flags, expected) in [
            ("--device reference --threads 3", BackendChoice::Reference { threads: Some(3) }),
            ("--device gpu --adapter some", BackendChoice::Gpu(some_gpu())),
            ("--adapter some", BackendChoice::Gpu(some_gpu())),
            ("--device cpu --threads 3", cpu.clone()),
        ] {
            assert_eq!(backend(&format!("{command} {flags}")), expected, "{command} {flags}");
        }
        let told = refused(&format!("{command} --device cpu --adapter some"));
        assert!(told.starts_with("error: --adapter cannot be used with --device cpu: "), "{told}");
    }
    let Ok(Request::Compare(options)) = request("compare gpu reference --adapter some") else {
        panic!("no comparison")
    };
    let side = |name: &str, choice| CompareSide::Backend { name: name.to_owned(), choice };
    let reference = BackendChoice::Reference { threads: None };
    assert_eq!(options.sides, [side("gpu", BackendChoice::Gpu(some_gpu())), side("reference", reference)]);
}

#[test]
fn a_search_has_its_seed_and_a_report_its_reference() {
    for (flags, search, seed) in [
        ("--search 3 --seed 4", Some(Duration::from_secs(3)), 4),
        ("--search .5", Some(Duration::from_millis(500)), 0),
        ("--filter copies", None, 0),
    ] {
        let Ok(Request::Stress(options)) = request(&format!("stress --isa portable {flags}")) else {
            panic!("no search: {flags}")
        };
        assert_eq!((options.search, options.seed), (search, seed), "{flags}");
    }
    let line = "report --out no-such --backends portable --scenes metals --reference no-such.exr";
    let Ok(Request::Report(options)) = request(line) else { panic!("no report") };
    assert_eq!(options.reference, ReferenceChoice::File(PathBuf::from("no-such.exr")));
}
