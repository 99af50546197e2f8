//! Flags and values that are refused.

use super::common::{refused, run, temp, text};

#[test]
fn without_batch_it_names_the_flag() {
    refused(&[], &["--batch"]);
}

#[test]
fn values_out_of_range_are_refused_with_value_and_limit() {
    let cases: [(&[&str], &[&str]); 11] = [
        (&["--vfov", "20,5"], &["20,5", "write a point: 20.5"]),
        (&["--size", "0x10"], &["0x10", "16384"]),
        (&["--samples", "0"], &["0", "4294967296"]),
        (&["--depth", "10001"], &["10001", "10000"]),
        (&["--vfov", "180"], &["180", "179"]),
        (&["--look-from", "1,2"], &["1,2", "three numbers"]),
        (&["--look-from", "1e200,0,0"], &["look_from.x is 1e200,", "1e18"]),
        (&["--noise-target", "1e-9"], &["1e-9", "above 3e-8"]),
        (&["--noise-target", "0.1", "--estimate-error", "off"], &["--noise-target", "--estimate-error on"]),
        (&["--sample-range", "0..8", "--samples", "9"], &["--sample-range", "--samples"]),
        (&["--checkpoint", "x.exr", "--every", "5 weeks"], &["5 weeks", "30d", "--every"]),
    ];
    for (arguments, parts) in cases {
        refused(&[&["--batch"], arguments].concat(), parts);
    }
}

#[test]
fn names_that_do_not_exist_are_refused() {
    refused(&["--batch", "--scene", "three-spheeres"], &["three-spheeres", "three-spheres"]);
    refused(&["--batch", "--stage", "glass-schlik"], &["glass-schlik", "glass-schlick"]);
    refused(&["--batch", "--device", "tpu"], &["tpu", "cpu"]);
    refused(&["--batch", "--adapter", "no-such-adapter"], &["adapter"]);
    refused(&["--batch", "--device", "cpu", "--adapter", "any"], &["--adapter", "--device cpu"]);
    refused(&["--batch", "--isa", "mmx"], &["mmx", "avx2"]);
    refused(&["--batch", "--no-such-flag"], &["--no-such-flag"]);
}

#[test]
fn missing_cpu_level_is_refused_with_those_available() {
    let foreign = if cfg!(target_arch = "x86_64") { "neon" } else { "avx2" };
    refused(&["--batch", "--isa", foreign], &[foreign, "portable"]);
    refused(&["--batch", "--isa", "portable", "--simd", "16"], &["16 lanes", "portable"]);
}

#[test]
fn outside_text_cannot_control_a_terminal() {
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
        let message = text(&output.stdout) + &text(&output.stderr);
        assert!(message.contains("a\\u{1b}[2Jb\\u{9b}c"), "{message}");
    }
    for arguments in
        [&["--batch", "--scene", "a\x1b[31mb"][..], &["--batch", "--out", "a\x1b]0;title\x07.png/"]]
    {
        let output = run(directory.path(), arguments);
        assert_eq!(output.status.code(), Some(2));
        assert!(!steers(&output.stderr) && output.stdout.is_empty(), "{output:?}");
        assert!(text(&output.stderr).starts_with("error"), "{output:?}");
    }
}
