//! Flights of the camera: to another camera, or from bookmark to bookmark as an animation goes from keyframe to keyframe.

use super::model::remembered::Bookmark;
use crate::animation::{CameraPath, Keyframe};
use crate::scene::Camera;
use eframe::egui::emath::easing;
use glam::{DMat3, DQuat, DVec3};

/// How long the flight to another camera takes.
const SECONDS: f64 = 0.6;

/// Legs of the flight to another camera. The animation room's curve through their ends goes around what is looked at.
const LEGS: u32 = 12;

/// Steps of a leg.
const STEPS: u32 = 1000;

/// Frames from one bookmark to the next: two seconds at the usual rate.
pub const FRAMES_PER_BOOKMARK: u32 = 60;

/// Frames a second of an animated PNG, unless another rate is given.
const FRAMES_PER_SECOND: u32 = 30;

/// Steps between two frames, so that the flight is smooth on any screen. A power of two scales the path without rounding.
const STEPS_PER_FRAME: u32 = 64;

/// A camera that moves by itself.
pub struct Flight {
    path: CameraPath,
    /// The last frame of the path.
    last: u32,
    seconds: f64,
    is_eased: bool,
    /// When it began, seconds of the window's clock.
    begin: f64,
    /// The camera that it has led to.
    camera: Camera,
}

impl Flight {
    /// A flight from a camera to another one, which begins and ends slowly.
    pub fn between(from: &Camera, to: &Camera, now: f64) -> Flight {
        let keyframes = (0..=LEGS).map(|leg| Keyframe { frame: leg * STEPS, camera: between(from, to, leg) });
        let path = CameraPath::Keyframes { still: *to, keyframes: keyframes.collect() };
        Flight { path, last: LEGS * STEPS, seconds: SECONDS, is_eased: true, begin: now, camera: *from }
    }

    /// A flight along keyframes, as the animation is rendered. `camera` is the present one.
    pub fn along(keyframes: &[Keyframe], camera: &Camera, now: f64) -> Flight {
        let fine = |keyframe: &Keyframe| Keyframe { frame: keyframe.frame * STEPS_PER_FRAME, ..*keyframe };
        let last = keyframes.last().map_or(0, |keyframe| keyframe.frame);
        let path = CameraPath::Keyframes { still: *camera, keyframes: keyframes.iter().map(fine).collect() };
        let seconds = f64::from(last) / f64::from(FRAMES_PER_SECOND);
        Flight { path, last: last * STEPS_PER_FRAME, seconds, is_eased: false, begin: now, camera: *camera }
    }

    /// The camera that the flight has led to.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// Goes on to the camera of this time. Returns whether the flight is over. A camera that is not valid is left out.
    pub fn go_on(&mut self, now: f64) -> bool {
        let share =
            if self.seconds > 0.0 { ((now - self.begin) / self.seconds).clamp(0.0, 1.0) } else { 1.0 };
        let eased = if self.is_eased { f64::from(easing::cubic_in_out(share as f32)) } else { share };
        let camera = self.path.camera((eased * f64::from(self.last)).round() as u32);
        if camera.validate().is_ok() {
            self.camera = camera;
        }
        share >= 1.0
    }
}

/// The bookmarks as keyframes of an animation.
pub fn keyframes(bookmarks: &[Bookmark]) -> Vec<Keyframe> {
    let frames = (0..).map(|place| place * FRAMES_PER_BOOKMARK);
    frames.zip(bookmarks).map(|(frame, bookmark)| Keyframe { frame, camera: bookmark.camera() }).collect()
}

/// The first frame whose camera is not valid, and why.
pub fn first_fault(keyframes: &[Keyframe]) -> Option<(u32, String)> {
    let last = keyframes.last()?;
    let path = CameraPath::Keyframes { still: last.camera, keyframes: keyframes.to_vec() };
    (0..=last.frame)
        .find_map(|frame| path.camera(frame).validate().err().map(|error| (frame, error.to_string())))
}

/// The camera after so many legs of the way from one camera to another. What it looks at and its lens change as in an
/// animation with two keyframes. The eye goes around that point instead of straight on, which could lead through it.
fn between(from: &Camera, to: &Camera, leg: u32) -> Camera {
    match leg {
        0 => return *from,
        LEGS => return *to,
        _ => {}
    }
    let ends = [(0, from), (LEGS, to)].map(|(frame, camera)| Keyframe { frame, camera: *camera });
    let straight = CameraPath::Keyframes { still: *to, keyframes: ends.to_vec() }.camera(leg);
    let share = f64::from(leg) / f64::from(LEGS);
    let [near, far] = [from, to].map(|camera| camera.look_from.distance(camera.look_at));
    let distance = near * (far / near).powf(share);
    let (away, vup) = direction_between(from, to, share);
    Camera { look_from: straight.look_at + distance * away, vup, ..straight }
}

/// The direction from what is looked at to the eye, and an up vector, part of the way from one camera to another.
fn direction_between(from: &Camera, to: &Camera, share: f64) -> (DVec3, DVec3) {
    let [a, b] = [from, to].map(Camera::basis);
    let [up, other] = [from, to].map(|camera| camera.vup.normalize_or_zero());
    if up.distance(other) < 1e-9 {
        // The horizon stays level.
        let height = |w: DVec3| up.dot(w).clamp(-1.0, 1.0).asin();
        let level = |w: DVec3| (w - up * up.dot(w)).normalize_or_zero();
        let (start, end) = (level(a.w), level(b.w));
        let turn = up.dot(start.cross(end)).atan2(start.dot(end));
        let along = DQuat::from_axis_angle(up, share * turn) * start;
        let (sine, cosine) = (height(a.w) + share * (height(b.w) - height(a.w))).sin_cos();
        return (cosine * along + sine * up, from.vup);
    }
    let [a, b] = [a, b].map(|basis| DQuat::from_mat3(&DMat3::from_cols(basis.u, basis.v, basis.w)));
    let between = a.slerp(b, share);
    (between * DVec3::Z, between * DVec3::Y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::viewpoint::Viewpoint;

    const CAMERA: Camera =
        Camera { look_from: DVec3::new(0.0, 1.0, 5.0), look_at: DVec3::new(0.0, 0.0, -1.0), ..Camera::BOOK };

    /// The cameras of a flight, 100 a second.
    fn flown(mut flight: Flight) -> Vec<Camera> {
        let mut cameras = vec![*flight.camera()];
        for step in 1..10_000 {
            let is_over = flight.go_on(7.0 + 0.01 * f64::from(step));
            cameras.push(*flight.camera());
            if is_over {
                break;
            }
        }
        cameras
    }

    #[test]
    fn a_flight_ends_at_its_camera_to_the_bit_and_never_jumps() {
        let mut targets: Vec<Camera> =
            Viewpoint::ALL.iter().map(|side| side.camera(&CAMERA, DVec3::Y)).collect();
        targets.push(Camera {
            look_from: DVec3::new(-30.0, 4.0, 2.0),
            look_at: DVec3::new(4.0, 1.0, 0.1),
            vfov_degrees: 20.0,
            focus_distance: Some(10.0),
            ..CAMERA
        });
        for from in &targets {
            for to in &targets {
                let cameras = flown(Flight::between(from, to, 7.0));
                assert_eq!(cameras.first(), Some(from));
                assert_eq!(cameras.last(), Some(to));
                assert!((58..=62).contains(&cameras.len()), "{}", cameras.len());
                for pair in cameras.windows(2) {
                    let [old, new] = [pair[0].basis(), pair[1].basis()];
                    let turn = old.w.angle_between(new.w).max(old.v.angle_between(new.v));
                    assert!(turn < 0.2, "{from:?} to {to:?}: a jump by {turn}");
                }
                let least = |cameras: &[Camera]| {
                    let distances = cameras.iter().map(|camera| camera.look_from.distance(camera.look_at));
                    distances.fold(f64::INFINITY, f64::min)
                };
                let ends = least(&[*from, *to]);
                assert!(least(&cameras) > 0.9 * ends, "{from:?} to {to:?}: through what it looks at");
            }
        }
    }

    #[test]
    fn a_flight_is_at_the_nearest_of_its_steps() {
        let to = Camera { look_from: DVec3::new(-3.0, 4.0, -6.0), ..CAMERA };
        let keyframes = [(0, CAMERA), (1, to)].map(|(frame, camera)| Keyframe { frame, camera });
        let after = |steps: f64| {
            let mut flight = Flight::along(&keyframes, &CAMERA, 7.0);
            flight.go_on(7.0 + steps / f64::from(STEPS_PER_FRAME * FRAMES_PER_SECOND));
            *flight.camera()
        };
        assert_eq!(after(0.4), CAMERA);
        assert_ne!(after(0.6), CAMERA);
        assert_eq!(after(0.6), after(1.4));
        assert_ne!(after(1.4), after(1.6));
    }

    #[test]
    fn a_flight_between_level_cameras_stays_level() {
        let to = Camera { look_from: DVec3::new(-3.0, 4.0, -6.0), ..CAMERA };
        for camera in flown(Flight::between(&CAMERA, &to, 7.0)) {
            assert!(camera.basis().u.y.abs() < 1e-9);
        }
    }

    #[test]
    fn bookmarks_are_flown_as_their_keyframes_are_rendered() {
        let eyes = [DVec3::new(0.0, 1.0, 5.0), DVec3::new(4.0, 2.0, 3.0), DVec3::new(5.0, 1.0, -2.0)];
        let cameras = eyes.map(|look_from| Camera { look_from, ..CAMERA });
        let bookmarks = cameras.map(|camera| Bookmark::new("a".to_owned(), &camera));
        let keyframes = keyframes(&bookmarks);
        assert_eq!(keyframes.iter().map(|keyframe| keyframe.frame).collect::<Vec<_>>(), [0, 60, 120]);
        assert_eq!(first_fault(&keyframes), None);
        let path = CameraPath::Keyframes { still: CAMERA, keyframes: keyframes.clone() };
        let mut flight = Flight::along(&keyframes, &CAMERA, 0.0);
        for frame in 0..=120 {
            assert_eq!(flight.go_on(f64::from(frame) / 30.0), frame == 120);
            let off = flight.camera().look_from.distance(path.camera(frame).look_from);
            assert!(off < 1e-12, "frame {frame}: off by {off}");
        }
    }

    #[test]
    fn a_path_with_a_camera_that_is_not_valid_says_so() {
        let opposite = Camera { look_from: CAMERA.look_at * 2.0 - CAMERA.look_from, ..CAMERA };
        let bookmarks = [CAMERA, opposite].map(|camera| Bookmark::new("a".to_owned(), &camera));
        let (frame, reason) = first_fault(&keyframes(&bookmarks)).unwrap();
        assert_eq!(frame, 30);
        assert!(reason.contains("look_from and look_at are both"), "{reason}");
    }

    #[test]
    fn half_way_the_eye_is_half_way_around() {
        // Distance, degrees around and degrees up, seen from what is looked at.
        let eye = |distance: f64, around: f64, up: f64| {
            let ((sine, cosine), (rise, level)) = (around.to_radians().sin_cos(), up.to_radians().sin_cos());
            distance * DVec3::new(level * sine, rise, level * cosine)
        };
        for (from, to, middle) in [
            // The distance grows by a factor of two on each half of the way.
            (eye(4.0, 0.0, 0.0), eye(16.0, 90.0, 60.0), eye(8.0, 45.0, 30.0)),
            (eye(5.0, 150.0, -20.0), eye(5.0, 210.0, 40.0), eye(5.0, 180.0, 10.0)),
        ] {
            let [from, to] = [from, to].map(|look_from| Camera { look_from, look_at: DVec3::ZERO, ..CAMERA });
            let mut flight = Flight::between(&from, &to, 2.0);
            assert!(!flight.go_on(2.0 + 0.5 * SECONDS));
            let found = *flight.camera();
            assert!(found.look_from.distance(middle) < 1e-6, "{}, not {middle}", found.look_from);
            assert_eq!((found.look_at, found.vup), (DVec3::ZERO, CAMERA.vup));
        }
    }

    #[test]
    fn a_flight_to_a_camera_begins_and_ends_slowly() {
        let [from, to] = [4.0, 16.0].map(|distance| Camera {
            look_from: DVec3::Z * distance,
            look_at: DVec3::ZERO,
            ..CAMERA
        });
        let mut flight = Flight::between(&from, &to, 0.0);
        // After a quarter of the time, a sixteenth of the way: the distance is 4^(1/16) times as long.
        for (share, expected) in [(0.25, 4.0 * 1.0905), (0.75, 16.0 / 1.0905)] {
            assert!(!flight.go_on(share * SECONDS));
            let distance = flight.camera().look_from.length();
            assert!((distance / expected - 1.0).abs() < 0.01, "{distance}, not {expected}");
        }
        assert!(flight.go_on(SECONDS));
        assert_eq!(*flight.camera(), to);
    }

    #[test]
    fn a_flight_leaves_out_cameras_that_are_not_valid() {
        let opposite = Camera { look_from: CAMERA.look_at * 2.0 - CAMERA.look_from, ..CAMERA };
        let keyframes = [(0, CAMERA), (60, opposite)].map(|(frame, camera)| Keyframe { frame, camera });
        let mut flight = Flight::along(&keyframes, &CAMERA, 3.0);
        // In the middle, the eye is at what it looks at.
        assert!(!flight.go_on(4.0));
        assert_eq!(*flight.camera(), CAMERA);
        assert!(flight.go_on(5.0));
        assert_eq!(*flight.camera(), opposite);
    }

    #[test]
    fn a_flight_along_one_bookmark_is_over_at_once() {
        let other = Camera { vfov_degrees: 33.0, ..CAMERA };
        let keyframes = keyframes(&[Bookmark::new("a".to_owned(), &other)]);
        let mut flight = Flight::along(&keyframes, &CAMERA, 3.0);
        assert!(flight.go_on(3.0));
        assert_eq!((*flight.camera(), first_fault(&keyframes), first_fault(&[])), (other, None, None));
    }
}
