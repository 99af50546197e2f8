//! Flags and values that are refused.

use super::common::{refused, refused_in, run, temp, text};
use weekender::cli::{Request, parse};

#[test]
fn without_batch_it_names_the_flag() {
    refused(&[], &["--batch"]);
}

#[test]
fn values_out_of_range_are_refused_with_value_and_limit() {
    let cases: [(&[&str], &[&str]); 32] = [
        (&["--size", "0x10"], &["0x10", "16384"]),
        (&["--size", "100000x100000"], &["100000x100000", "16384"]),
        (&["--size", "800"], &["800", "WIDTHxHEIGHT"]),
        (&["--samples", "0"], &["0", "4294967296"]),
        (&["--samples", "-3"], &["-3"]),
        (&["--samples", "many"], &["many", "a whole number from 1 to 4294967296"]),
        (&["--samples", "1e3"], &["1e3", "a whole number from 1 to 4294967296, such as"]),
        (&["--depth", "0"], &["0", "10000"]),
        (&["--depth", "10001"], &["10001", "10000"]),
        (&["--vfov", "0"], &["vfov", "0.01", "179"]),
        (&["--vfov", "180"], &["180", "179"]),
        (&["--vfov", "nan"], &["nan", "within 0.01 and 179"]),
        (&["--vfov", "1e400"], &["1e400", "within 0.01 and 179"]),
        (&["--vfov", "wide"], &["wide", "number"]),
        (&["--defocus-angle", "180"], &["180", "179"]),
        (&["--defocus-angle", "-1"], &["-1", "179"]),
        (&["--focus-distance", "0"], &["focus_distance is 0"]),
        (&["--focus-distance", "inf"], &["inf", "within 1e-18 and 1e19"]),
        (&["--look-from", "1,2,3", "--look-at", "1,2,3"], &["[1, 2, 3]", "direction"]),
        (&["--look-from", "1,2"], &["1,2", "three numbers"]),
        (&["--look-from", "nan,0,0"], &["nan,0,0", "within -1e18 and 1e18"]),
        (&["--look-from", "1e200,0,0"], &["look_from.x is 1e200,", "1e18"]),
        (&["--time-limit", "0"], &["0", "seconds"]),
        (&["--time-limit", "inf"], &["inf", "1e9"]),
        (&["--noise-target", "-0.1"], &["-0.1", "above 3e-8"]),
        (&["--noise-target", "1e-9"], &["1e-9", "above 3e-8"]),
        (&["--noise-target", "0.1", "--estimate-error", "off"], &["--noise-target", "--estimate-error on"]),
        (&["--sample-range", "8..8"], &["8..8", "A below B"]),
        (&["--sample-range", "0..8", "--samples", "9"], &["--sample-range", "--samples"]),
        (&["--threads", "0"], &["0", "1024"]),
        (&["--threads", "100000"], &["100000", "1024"]),
        (&["--seed", "-1"], &["-1", "4294967295"]),
    ];
    for (arguments, parts) in cases {
        refused(&[&["--batch"], arguments].concat(), parts);
    }
}

#[test]
fn help_promises_every_stage_only_where_it_can_be_rendered() {
    let help = |command: &[&str]| {
        let said = text(&run(temp().path(), &[command, &["--help"]].concat()).stdout);
        said.split_whitespace().collect::<Vec<_>>().join(" ")
    };
    for command in ["plan", "diff", "compare"] {
        let said = help(&[command]);
        assert!(said.contains("--stage <ID>") && !said.contains("\"all\""), "{command}: {said}");
        assert!(!said.contains("--stage all"), "{command}: {said}");
    }
    assert!(help(&[]).contains("--stage all"));
    let check = help(&["check"]);
    assert!(check.contains("16 x 9") && check.contains("4 million"), "{check}");
}

#[test]
fn names_that_do_not_exist_are_refused() {
    refused(&["--batch", "--scene", "three-spheeres"], &["three-spheeres", "three-spheres"]);
    refused(&["--batch", "--scene", "field:0"], &["0"]);
    refused(&["--batch", "--stage", "glass-schlik"], &["glass-schlik", "glass-schlick"]);
    refused(&["--batch", "--scene", "book", "--stage", "book"], &["--scene", "--stage"]);
    refused(&["--batch", "--device", "tpu"], &["tpu", "cpu"]);
    refused(&["--batch", "--adapter", "no-such-adapter"], &["adapter"]);
    refused(&["--batch", "--device", "cpu", "--adapter", "any"], &["--adapter", "--device cpu"]);
    refused(&["--batch", "--simd", "3"], &["3", "16"]);
    refused(&["--batch", "--isa", "mmx"], &["mmx", "avx2"]);
    refused(&["--batch", "--device", "reference", "--simd", "8"], &["--simd", "reference"]);
    refused(&["--batch", "--no-such-flag"], &["--no-such-flag"]);
}

#[test]
fn what_the_processor_lacks_is_refused_with_what_it_has() {
    let foreign = if cfg!(target_arch = "x86_64") { "neon" } else { "avx2" };
    refused(&["--batch", "--isa", foreign], &[foreign, "portable"]);
    refused(&["--batch", "--isa", "portable", "--simd", "16"], &["16 lanes", "portable"]);
}

#[test]
fn nothing_from_outside_steers_or_floods_a_terminal() {
    let directory = temp();
    let steers = |bytes: &[u8]| text(bytes).chars().any(|c| c.is_control() && c != '\n');
    let scene = "[camera]\nlook_from = [0.0, 0.0, 3.0]\nlook_at = [0.0, 0.0, 0.0]\nvfov_degrees = 40.0\n\
                 [materials.\"a\\u001b[2Jb\\u009bc\"]\nkind = \"lambertian\"\nalbedo = [0.5, 0.5, 0.5]\n\
                 [[spheres]]\ncenter = [0.0, 0.0, 0.0]\nradius = 1.0\nmaterial = \"a\\u001b[2Jb\\u009bc\"\n";
    std::fs::write(directory.path().join("s.toml"), scene).unwrap();
    for more in [&[][..], &["--json", "-"]] {
        let path =
            ["diff", "--scene", "s.toml", "--size", "9x9", "--pixel", "4,4", "--sides", "cpu,reference"];
        let output = run(directory.path(), &[&path[..], more].concat());
        assert!(!steers(&output.stdout) && !steers(&output.stderr), "{output:?}");
        let told = text(&output.stdout) + &text(&output.stderr);
        assert!(told.contains("a\\u{1b}[2Jb\\u{9b}c"), "{told}");
    }
    let long = "x".repeat(100_000);
    for arguments in [
        &["--batch", "--scene", "a\x1b[31mb"][..],
        &["--batch", "--out", "a\x1b]0;title\x07.png/"],
        &["--batch", "--stage", &long],
        &["--batch", "--scene", &long],
        &["--batch", "--size", &long],
        &["--batch", "--out", &long],
        &[&long],
    ] {
        let output = run(directory.path(), arguments);
        assert_eq!(output.status.code(), Some(2));
        assert!(!steers(&output.stderr) && output.stdout.is_empty(), "{output:?}");
        assert!(output.stderr.len() < 10_000, "{} bytes", output.stderr.len());
        assert!(text(&output.stderr).starts_with("error"), "{output:?}");
    }
}

#[test]
fn how_often_a_film_is_kept_is_a_time() {
    refused(&["--batch", "--checkpoint", "x.exr", "--every", "5 weeks"], &["5 weeks", "30d", "--every"]);
    refused(&["--batch", "--checkpoint", "x.exr", "--every", "-1s"], &["-1s", "0.1s"]);
    refused(&["--batch", "--every", "5m"], &["--every", "--checkpoint"]);
}

#[test]
fn scene_files_are_refused_with_their_reason() {
    let directory = temp();
    let write = |content: &str| std::fs::write(directory.path().join("s.toml"), content).unwrap();
    let camera = "[camera]\nlook_from = [0.0, 0.0, 1.0]\nlook_at = [0.0, 0.0, 0.0]\nvfov_degrees = 90.0\n";
    let sphere = |radius: &str, material: &str| {
        format!("{camera}[[spheres]]\ncenter = [0.0, 0.0, 0.0]\nradius = {radius}\nmaterial = {material}\n")
    };
    let grey = "{ kind = \"lambertian\", albedo = [0.5, 0.5, 0.5] }";
    let cases: [(String, &[&str]); 11] = [
        ("camera = ".to_owned(), &["s.toml"]),
        (format!("{camera}zoom = 3\n"), &["zoom", "5"]),
        (sphere("0.0", grey), &["radius", "0"]),
        (sphere("-1.0", grey), &["radius", "-1"]),
        (sphere("nan", grey), &["radius", "NaN"]),
        (sphere("inf", grey), &["radius", "inf"]),
        (sphere("1.0", "\"nothing\""), &["nothing"]),
        (sphere("1.0", "{ kind = \"metal\", albedo = [1.0, 1.0, 1.0], fuzz = -1.0 }"), &["fuzz", "-1"]),
        (sphere("1.0", "{ kind = \"lambertian\", albedo = [2.0, 0.0, 0.0] }"), &["albedo", "2"]),
        (camera.replace("90.0", "180.0"), &["vfov", "180", "179"]),
        (camera.replace("1.0]", "0.0]"), &["look_from", "look_at"]),
    ];
    for (content, parts) in cases {
        write(&content);
        refused_in(&directory, &["--batch", "--scene", "s.toml"], parts);
    }
    std::fs::write(directory.path().join("s.toml"), [0xff, 0xfe, 0]).unwrap();
    refused_in(&directory, &["--batch", "--scene", "s.toml"], &["s.toml"]);
    refused_in(&directory, &["--batch", "--scene", "missing.toml"], &["missing.toml"]);
    refused_in(&directory, &["--batch", "--scene", "."], &["."]);
}

/// The window prefers a device that the command line chooses to the one that it remembers.
#[test]
fn every_flag_of_a_backend_chooses_a_device() {
    let is_given = |flags: &[&str]| {
        let words = ["weekender"].iter().chain(flags).map(Into::into);
        let Ok(Request::Window(options)) = parse(words) else { panic!("{flags:?}") };
        options.is_device_given
    };
    assert!(!is_given(&[]) && !is_given(&["--samples", "4", "--seed", "7"]));
    for flag in ["--device=cpu", "--threads=1", "--adapter=x", "--simd=off", "--isa=portable"] {
        assert!(is_given(&[flag]), "{flag}");
    }
}

#[test]
fn a_report_has_each_target_once_and_the_chosen_one_first() {
    let targets = |flags: &[&str]| {
        let words = ["weekender", "report", "--out", "found", "--backends", "cpu"];
        let Ok(Request::Report(options)) = parse(words.iter().chain(flags).map(Into::into)) else {
            panic!("{flags:?}")
        };
        options.targets()
    };
    assert_eq!(targets(&[]), [0.01, 0.001]);
    assert_eq!(targets(&["--target", "0.02"]), [0.02, 0.01, 0.001]);
    assert_eq!(targets(&["--target", "0.001"]), [0.001, 0.01]);
}

/// Without a number of samples, a time limit or a noise target is the only end.
#[test]
fn what_ends_a_render_is_what_was_asked_for() {
    let samples = |flags: &[&str]| {
        let words = ["weekender", "--batch", "--scene", "three-spheres"].iter().chain(flags).map(Into::into);
        let Ok(Request::Batch(options)) = parse(words) else { panic!("{flags:?}") };
        options.renders[0].plan.stop.samples
    };
    assert!(samples(&[]).is_some());
    assert_eq!(samples(&["--samples", "7", "--noise-target", "0.01"]), Some(7));
    for flags in [["--noise-target", "0.01"], ["--time-limit", "5"]] {
        assert_eq!(samples(&flags), None, "{flags:?}");
    }
}

#[test]
fn a_range_may_end_with_the_last_sample_that_there_is() {
    let range = |text: &str| {
        let words = ["weekender", "--batch", "--scene", "three-spheres", "--sample-range", text];
        let Ok(Request::Batch(options)) = parse(words.iter().map(Into::into)) else { return None };
        Some(options.renders[0].plan.range())
    };
    assert_eq!(range("4294967295..4294967296"), Some(4_294_967_295..4_294_967_296));
    assert_eq!(range("4294967295..4294967297"), None);
}
