//! Chapters 12 to 14: the positionable camera, its lens, and the final picture.

use super::setups::{PATHS, THREE_BALLS};
use crate::scene::Camera;
use crate::scene::builtin::{BOOK_CAMERA, book, touching_spheres};
use crate::stages::{Means, Rules, Setup, Sight, Stage};
use glam::DVec3;

const CHAPTER_12: &str = "Positionable Camera";
const CHAPTER_13: &str = "Defocus Blur";
const CHAPTER_14: &str = "Where Next?";

/// The three spheres from above and from the left.
const SIDE_VIEW: Camera = Camera { look_from: DVec3::new(-2.0, 2.0, 1.0), ..Camera::BOOK };

const CLOSE_SIDE_VIEW: Camera = Camera { vfov_degrees: 20.0, ..SIDE_VIEW };

pub(super) const STAGES: &[Stage] = &[
    Stage {
        id: "fov-wide",
        section: "12.1",
        section_title: "Camera Viewing Geometry",
        chapter_title: CHAPTER_12,
        title: "A wide view",
        what_is_new: "The vertical field of view is a setting: 90 degrees here.",
        why: "The two balls are placed so that they touch each other and the limits of a right angle, \
              which makes the angle easy to check.",
        look_for: "Towards the sides the balls are stretched into egg shapes. That is what a flat picture \
                   of a wide angle has to look like.",
        sight: Sight {
            means: Means::Albedo,
            part: None,
            caption: "Without light and shadow: two eggs, wider than high, that the frame cuts.",
        },
        alt: "A blue and a red ball side by side that touch in the middle of the picture; both are \
              stretched sideways.",
        pair: Some("fov-narrow"),
        setup: Setup { scene: touching_spheres, ..PATHS },
    },
    Stage {
        id: "fov-narrow",
        section: "12.1",
        section_title: "Camera Viewing Geometry",
        chapter_title: CHAPTER_12,
        title: "A narrow view",
        what_is_new: "The same scene from the same place, with a vertical field of view of 30 degrees.",
        why: "Only the angle changes: the rays of this picture are those from the middle of the wide one.",
        look_for: "The middle of the wide picture, enlarged. The perspective between the balls is \
                   unchanged, because the eye has not moved.",
        sight: Sight {
            means: Means::Wipe(0.5),
            part: None,
            caption: "Left, the wide view with its own camera. Right, its middle, enlarged.",
        },
        alt: "The place where the blue and the red ball touch, so close that the balls fill the picture.",
        pair: Some("fov-wide"),
        setup: Setup {
            scene: touching_spheres,
            camera: Camera { vfov_degrees: 30.0, ..Camera::BOOK },
            ..PATHS
        },
    },
    Stage {
        id: "view-distant",
        section: "12.2",
        section_title: "Positioning and Orienting the Camera",
        chapter_title: CHAPTER_12,
        title: "Another place to stand",
        what_is_new: "The camera can stand anywhere and look anywhere; a third vector says what is up.",
        why: "Three directions at right angles (right, up, back) replace the axes. The tracer itself does \
              not notice.",
        look_for: "The three balls from above and from the left; the hollow one is now nearest.",
        sight: Sight {
            means: Means::Picture,
            part: Some([0.36, 0.35, 0.62, 0.68]),
            caption: "From front to back: hollow glass, the blue ball, the metal.",
        },
        alt: "The three balls from above and from the left, small in the middle of wide yellow-green \
              ground.",
        pair: None,
        setup: Setup { camera: SIDE_VIEW, ..THREE_BALLS },
    },
    Stage {
        id: "view-close",
        section: "12.2",
        section_title: "Positioning and Orienting the Camera",
        chapter_title: CHAPTER_12,
        title: "Zoomed in",
        what_is_new: "The same place with a field of view of 20 degrees.",
        why: "Position and zoom are independent: this is a longer lens, not a step closer.",
        look_for: "Everything is sharp from front to back, as only a pinhole camera manages.",
        sight: Sight {
            means: Means::Wipe(0.5),
            part: None,
            caption: "Right, a pinhole: the glass in front is sharp. Left, a lens: the metal behind is \
                      not.",
        },
        alt: "The three balls from the same place, enlarged to fill the picture; all of them are sharp.",
        pair: Some("defocus"),
        setup: Setup { camera: CLOSE_SIDE_VIEW, ..THREE_BALLS },
    },
    Stage {
        id: "defocus",
        section: "13.2",
        section_title: "Generating Sample Rays",
        chapter_title: CHAPTER_13,
        title: "A lens instead of a pinhole",
        what_is_new: "Rays start all over a disk and meet again in a plane at the focus distance.",
        why: "A real camera needs a wide opening to gather light, and pays with blur in front of that \
              plane and behind it.",
        look_for: "The middle ball is sharp, about 3.4 away. The glass in front of it and the metal behind \
                   it dissolve, the more the farther they are from the plane.",
        sight: Sight {
            means: Means::Wipe(0.16),
            part: None,
            caption: "Left, a pinhole. Right, a lens: the blue ball stays sharp, glass and metal dissolve.",
        },
        alt: "The same view; the middle ball is sharp, the glass ball in front and the metal ball behind are blurred.",
        pair: Some("view-close"),
        setup: Setup {
            camera: Camera { defocus_angle_degrees: 10.0, focus_distance: Some(3.4), ..CLOSE_SIDE_VIEW },
            samples_per_pixel: 256,
            ..THREE_BALLS
        },
    },
    Stage {
        id: "book",
        section: "14.1",
        section_title: "A Final Render",
        chapter_title: CHAPTER_14,
        title: "The final render",
        what_is_new: "Nothing but scale: 485 spheres, every material, a lens, and 500 samples per pixel.",
        why: "All the rules together, each as it was shown alone. It is also the first scene where it pays \
              not to test every sphere.",
        look_for: "The glass ball inverts the crowd behind it, the metal ball mirrors the crowd upright, \
                   and the small balls in front of the plane in focus are gently blurred.",
        sight: Sight {
            means: Means::Picture,
            part: Some([0.36, 0.04, 0.86, 0.7]),
            caption: "Behind, glass turns the crowd upside down. In front, metal mirrors it upright.",
        },
        alt: "Hundreds of small balls of all materials and colours on grey ground around three large ones: \
              glass, matte brown and polished metal.",
        pair: None,
        setup: Setup {
            scene: book,
            camera: BOOK_CAMERA,
            rules: Rules::FINISHED,
            width: 1200,
            height: 675,
            samples_per_pixel: 500,
            max_depth: 50,
        },
    },
];
