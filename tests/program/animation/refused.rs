//! Animations that make no sense.

/// Exit code 2, a message with all of `parts`, and no new file.
fn refused(arguments: &[&str], parts: &[&str]) {
    crate::common::program::refused(super::common::temp().path(), arguments, parts);
}

#[test]
fn ranges_and_turns_have_limits() {
    for range in ["5..5", "6..5", "0..100001", "7", "a..b"] {
        refused(
            &["--batch", "--turntable", "--frames", range, "--out", "d"],
            &[range, "100000, such as 0..120"],
        );
    }
    for turn in ["0", "1", "-5", "100001", "3deg"] {
        refused(&["--batch", &format!("--turntable={turn}"), "--out", "d"], &[turn, "2 to 100000"]);
    }
}

#[test]
fn a_camera_must_move_and_be_valid() {
    refused(&["--batch", "--frames", "0..3", "--out", "d"], &["--turntable", "[[keyframes]]"]);
    let scene = ["--batch", "--scene", "scene.toml", "--frames", "0..6", "--out", "d"];
    refused(&[&scene[..], &["--vfov", "20"]].concat(), &["--vfov", "use --turntable"]);
    // On the diagonal, the camera is within the limits of positions; on its way to the axis, it leaves them.
    let far =
        ["--batch", "--turntable", "--look-from", "7.2e17,0,7.2e17", "--look-at", "0,0,0", "--out", "d"];
    refused(&far, &["frame 12: look_from.x is 1.0"]);
}

#[test]
fn an_animation_is_not_a_film() {
    let base = ["--batch", "--turntable", "--frames", "0..2"];
    let with = |more: &[&str], parts: &[&str]| refused(&[&base[..], more].concat(), parts);
    with(&[], &["--out"]);
    for out in ["a.exr", "a.mp4", "a.png", "a-##.gif", "a-#-#.png", "-"] {
        with(&["--out", out], &[out, "turn-####.png"]);
    }
    with(&["--out", "a-#.png", "--json", "a-1.png"], &["a-1.png"]);
    for (flag, value) in [
        ("--resume", "film.exr"),
        ("--checkpoint", "film.exr"),
        ("--sample-range", "0..4"),
        ("--save-scene", "other.toml"),
    ] {
        with(&["--out", "d", flag, value], &["cannot be used with", flag]);
    }
    refused(&["--frames", "0..2", "--turntable", "--out", "d"], &["--batch"]);
}
