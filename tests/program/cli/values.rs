//! Flags and values that are refused.

use super::common::{refused, temp};
use crate::common::program::{outcome, weekender};

#[test]
fn bad_values_are_refused_with_value_and_limit() {
    refused(&[], &["--batch"]);
    let foreign = if cfg!(target_arch = "x86_64") { "neon" } else { "avx2" };
    let cases: [(&[&str], &[&str]); 20] = [
        (&["--vfov", "20,5"], &["20,5", "write a point: 20.5"]),
        (&["--size", "0x10"], &["0x10", "16384"]),
        (&["--samples", "0"], &["0", "4294967296"]),
        (&["--samples", "1e3"], &["1e3", "4294967296"]),
        (&["--depth", "10001"], &["10001", "10000"]),
        (&["--vfov", "180"], &["180", "179"]),
        (&["--look-from", "1,2"], &["1,2", "three numbers"]),
        (&["--look-from", "1e200,0,0"], &["look_from.x is 1e200,", "1e18"]),
        (&["--noise-target", "1e-9"], &["1e-9", "above 3e-8"]),
        (&["--sample-range", "0..8", "--samples", "9"], &["--sample-range", "--samples"]),
        (&["--checkpoint", "x.exr", "--every", "5 weeks"], &["5 weeks", "30d", "--every"]),
        (&["--scene", "three-spheeres"], &["three-spheeres", "three-spheres"]),
        (&["--stage", "glass-schlik"], &["glass-schlik", "glass-schlick"]),
        (&["--device", "tpu"], &["tpu", "cpu"]),
        (&["--adapter", "no-such-adapter"], &["adapter"]),
        (&["--device", "cpu", "--adapter", "any"], &["--adapter", "--device cpu"]),
        (&["--isa", "mmx"], &["mmx", "avx2"]),
        (&["--isa", foreign], &[foreign, "portable"]),
        (&["--isa", "portable", "--simd", "16"], &["16 lanes", "portable"]),
        (&["--no-such-flag"], &["--no-such-flag"]),
    ];
    for (arguments, parts) in cases {
        refused(&[&["--batch"], arguments].concat(), parts);
    }
}

#[test]
fn outside_text_cannot_control_a_terminal() {
    let directory = temp();
    let run = |arguments: &[&str]| {
        let (code, out, message) = outcome(&weekender(directory.path(), arguments).output().unwrap());
        let all = out + &message;
        assert!(!all.chars().any(|c| c.is_control() && c != '\n'), "{all:?}");
        (code, all)
    };
    for arguments in [["--scene", "a\x1b[31mb"], ["--out", "a\x1b]0;title\x07.png/"]] {
        let (code, all) = run(&[&["--batch"], &arguments[..]].concat());
        assert!(code == Some(2) && all.starts_with("error"), "{all}");
    }
}
