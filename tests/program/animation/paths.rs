//! Camera paths as functions of the frame's number.

use glam::DVec3;
use std::f64::consts::TAU;
use weekender::batch::FrameNames;
use weekender::scene::Camera;
use weekender::scene::animation::{CameraPath, Keyframe};

fn camera() -> Camera {
    Camera {
        look_from: DVec3::new(3.0, 2.0, 4.0),
        look_at: DVec3::new(1.0, 0.5, -1.0),
        vup: DVec3::new(0.0, 2.0, 0.1),
        vfov_degrees: 30.0,
        defocus_angle_degrees: 1.0,
        focus_distance: Some(5.0),
    }
}

fn turntable(frames: u32) -> CameraPath {
    CameraPath::Turntable { start: camera(), frames }
}

fn keyframed(keyframes: Vec<Keyframe>) -> CameraPath {
    CameraPath::Keyframes(keyframes)
}

/// Over or under `look_at`, the picture turns by 180 degrees; the frames are named once, with the remedy.
#[test]
fn a_path_over_its_target_is_warned_about() {
    use super::common::{ends, temp};
    let scene = |middle: &str, more: &str| {
        let ends = |frame: u32, z: f64| {
            format!("[[keyframes]]\nframe = {frame}\nlook_from = [0.0, 0.5, {z:?}]\n{more}\n")
        };
        format!(
            "scene = \"three-spheres\"\n[camera]\nlook_from = [0.0, 1.0, 3.0]\nlook_at = [0.0, 0.0, -1.0]\nvfov_degrees = 60.0\n{}\
             [[keyframes]]\nframe = 20\nlook_from = {middle}\n{more}\n{}",
            ends(0, 4.0),
            ends(40, -6.0)
        )
    };
    for (middle, more, is_warned) in [
        ("[0.01, 5.0, -1.01]", "", true),
        ("[0.01, -5.0, -1.01]", "", true),
        ("[0.01, 5.0, -1.01]", "vup = [1.0, 0.0, 0.0]", false),
        ("[5.0, 0.5, -1.0]", "", false),
    ] {
        let directory = temp();
        std::fs::write(directory.path().join("s.toml"), scene(middle, more)).unwrap();
        let flags = [
            "--batch",
            "--scene",
            "s.toml",
            "--size",
            "8x8",
            "--samples",
            "1",
            "--frames",
            "18..23",
            "--out",
            "d",
        ];
        let (_, message) = ends(directory.path(), 0, &flags);
        assert_eq!(
            message.matches("turns over between the frames 19 and 21").count(),
            usize::from(is_warned),
            "{message}"
        );
    }
}

#[test]
fn a_turntable_closes_to_the_bit() {
    for length in [7, 120] {
        let path = turntable(length);
        assert_eq!(path.camera(0), camera());
        assert_eq!(path.camera(length), camera(), "{length}");
        for frame in 1..length {
            assert_ne!(path.camera(frame), camera(), "{length}, {frame}");
        }
        assert_eq!(path.camera(5 * length + 3), path.camera(3));
    }
}

#[test]
fn a_turntable_circles_about_the_up_direction() {
    let (start, axis) = (camera(), camera().vup.normalize());
    let arm = start.look_from - start.look_at;
    let path = turntable(90);
    for frame in 0..90 {
        let turned = path.camera(frame);
        let now = turned.look_from - turned.look_at;
        assert!((now.length() - arm.length()).abs() < 1e-12);
        assert!((now.dot(axis) - arm.dot(axis)).abs() < 1e-12);
        assert_eq!(Camera { look_from: start.look_from, ..turned }, start);
        // Counterclockwise from above, by the same angle in each frame.
        let flat = |arm: DVec3| (arm - axis * axis.dot(arm)).normalize();
        let angle = flat(arm).cross(flat(now)).dot(axis).atan2(flat(arm).dot(flat(now)));
        let expected = TAU * f64::from(frame) / 90.0;
        assert!((((angle - expected) / TAU + 0.5).rem_euclid(1.0) - 0.5).abs() < 1e-12, "{frame}: {angle}");
    }
}

/// A path of uneven steps with every parameter in motion, on a grid `fine` times as fine as its frames.
fn keyframes(fine: u32) -> Vec<Keyframe> {
    [(3, 0.0), (10, 1.0), (12, 3.0), (40, 2.0)]
        .map(|(frame, x)| Keyframe {
            frame: fine * frame,
            camera: Camera {
                look_from: DVec3::new(x, 2.0 + x * x, 5.0 - x),
                look_at: DVec3::new(0.1 * x, -0.3 * x, 0.0),
                vup: DVec3::new(0.1 * x, 3.0, 0.0),
                vfov_degrees: 20.0 + 30.0 * x,
                defocus_angle_degrees: x,
                focus_distance: (x > 0.5).then_some(1.0 + x),
            },
        })
        .to_vec()
}

#[test]
fn path_meets_its_keyframes_and_rests_beyond_them() {
    let (keys, path) = (keyframes(1), keyframed(keyframes(1)));
    for Keyframe { frame, camera } in &keys {
        assert_eq!(path.camera(*frame), *camera);
    }
    assert_eq!((path.camera(0), path.camera(99_999)), (keys[0].camera, keys[3].camera));
}

/// All numbers of a camera that are interpolated.
fn numbers(camera: &Camera) -> [f64; 12] {
    let Camera { look_from: f, look_at: a, vup, .. } = camera;
    let up = vup.normalize();
    let (view, lens) = (camera.vfov_degrees, camera.defocus_angle_degrees);
    [f.x, f.y, f.z, a.x, a.y, a.z, up.x, up.y, up.z, view, lens, camera.effective_focus_distance()]
}

#[test]
fn a_path_has_neither_jumps_nor_corners() {
    // Steps, and changes of steps, shrink with the grid: a jump would keep the first and a corner the second.
    let worst = |fine: u32| {
        let path = keyframed(keyframes(fine));
        let cameras: Vec<_> = (3 * fine..=40 * fine).map(|frame| numbers(&path.camera(frame))).collect();
        let step = cameras.windows(2).flat_map(|pair| (0..12).map(|i| (pair[1][i] - pair[0][i]).abs()));
        let bend = cameras
            .windows(3)
            .flat_map(|three| (0..12).map(|i| (three[2][i] - 2.0 * three[1][i] + three[0][i]).abs()));
        [step.fold(0.0, f64::max), bend.fold(0.0, f64::max)]
    };
    let ([step, bend], [fine_step, fine_bend]) = (worst(64), worst(256));
    assert!(fine_step < 0.26 * step, "{step} {fine_step}");
    assert!(fine_bend < 0.08 * bend, "{bend} {fine_bend}");
}

#[test]
fn lens_and_view_never_leave_the_range_of_two_keyframes() {
    let path = keyframed(keyframes(32));
    for pair in keyframes(32).windows(2) {
        let ends = [pair[0].camera, pair[1].camera].map(|camera| numbers(&camera));
        for frame in pair[0].frame..=pair[1].frame {
            let now = numbers(&path.camera(frame));
            for number in 9..12 {
                let (low, high) =
                    (ends[0][number].min(ends[1][number]), ends[0][number].max(ends[1][number]));
                assert!((low - 1e-9..=high + 1e-9).contains(&now[number]), "{frame}: {now:?}");
            }
        }
    }
}

/// The slope at a keyframe is that of the parabola through it and its neighbours, however uneven the steps are.
#[test]
fn a_parabola_stays_one_between_inner_keyframes() {
    let at = |frame: u32| {
        let t = f64::from(frame);
        Keyframe { frame, camera: Camera { look_from: DVec3::new(t, 0.1 * t * t, 9.0), ..camera() } }
    };
    let path = keyframed([0, 2, 10, 13, 20].map(at).to_vec());
    for frame in 2..=13 {
        let (found, expected) = (path.camera(frame).look_from, at(frame).camera.look_from);
        assert!(found.distance(expected) < 1e-12, "{frame}: {found}, expected {expected}");
    }
}

#[test]
fn names_have_at_least_the_digits_of_the_pattern() {
    let names = FrameNames::of_pattern("shots/turn-##.png".as_ref()).unwrap();
    let shown = [0, 7, 123].map(|frame| names.path(frame).display().to_string());
    assert_eq!(shown, ["shots/turn-00.png", "shots/turn-07.png", "shots/turn-123.png"]);
    for pattern in ["turn.png", "turn-#-#.png", "#/turn.png"] {
        assert_eq!(FrameNames::of_pattern(pattern.as_ref()), None, "{pattern}");
    }
}
