//! Chapters 12 to 14: the positionable camera, its lens, and the final picture.

use super::setups::{PATHS, THREE_BALLS};
use crate::scene::Camera;
use crate::scene::builtin::{BOOK_CAMERA, book, touching_spheres};
use crate::stages::{Rules, Setup, Stage, sights};
use glam::DVec3;

const CHAPTER_12: &str = "Positionable Camera";
const CHAPTER_13: &str = "Defocus Blur";
const CHAPTER_14: &str = "Where Next?";

/// A view of the three spheres from above and from the left.
const SIDE_VIEW: Camera = Camera { look_from: DVec3::new(-2.0, 2.0, 1.0), ..Camera::BOOK };

const CLOSE_SIDE_VIEW: Camera = Camera { vfov_degrees: 20.0, ..SIDE_VIEW };

pub(super) const FOV_WIDE: Stage = Stage {
    id: "fov-wide",
    section: "12.1",
    section_title: "Camera Viewing Geometry",
    chapter_title: CHAPTER_12,
    title: "A wide view",
    what_is_new: "The vertical field of view is a setting: 90 degrees here.",
    why: "The two balls are placed so that they touch each other and the limits of a right angle, which \
          makes the angle easy to check.",
    look_for: "Towards the sides the balls are stretched to eggs. That is what a flat picture of a wide \
               angle has to look like.",
    sight: sights::FOV_WIDE,
    pair: Some("fov-narrow"),
    setup: Setup { scene: touching_spheres, ..PATHS },
};

pub(super) const FOV_NARROW: Stage = Stage {
    id: "fov-narrow",
    section: "12.1",
    section_title: "Camera Viewing Geometry",
    chapter_title: CHAPTER_12,
    title: "A narrow view",
    what_is_new: "The same scene from the same place, 30 degrees high.",
    why: "Only the angle changes: the rays of this picture are those from the middle of the wide one.",
    look_for: "The middle of the wide picture, enlarged. The perspective between the balls is unchanged, \
               because the eye has not moved.",
    sight: sights::FOV_NARROW,
    pair: Some("fov-wide"),
    setup: Setup { scene: touching_spheres, camera: Camera { vfov_degrees: 30.0, ..Camera::BOOK }, ..PATHS },
};

pub(super) const VIEW_DISTANT: Stage = Stage {
    id: "view-distant",
    section: "12.2",
    section_title: "Positioning and Orienting the Camera",
    chapter_title: CHAPTER_12,
    title: "Another place to stand",
    what_is_new: "The camera can stand anywhere and look anywhere; a third vector says what is up.",
    why: "Three directions at right angles (right, up, back) replace the axes. The tracer itself does not \
          notice.",
    look_for: "The three balls from above and from the left; the hollow one is now nearest.",
    sight: sights::VIEW_DISTANT,
    pair: None,
    setup: Setup { camera: SIDE_VIEW, ..THREE_BALLS },
};

pub(super) const VIEW_CLOSE: Stage = Stage {
    id: "view-close",
    section: "12.2",
    section_title: "Positioning and Orienting the Camera",
    chapter_title: CHAPTER_12,
    title: "Zoomed in",
    what_is_new: "The same place with a field of view of 20 degrees.",
    why: "Position and zoom are independent: this is a longer lens, not a step closer.",
    look_for: "Everything is sharp from front to back, as only a pinhole can show it.",
    sight: sights::VIEW_CLOSE,
    pair: Some("defocus"),
    setup: Setup { camera: CLOSE_SIDE_VIEW, ..THREE_BALLS },
};

pub(super) const DEFOCUS: Stage = Stage {
    id: "defocus",
    section: "13.2",
    section_title: "Generating Sample Rays",
    chapter_title: CHAPTER_13,
    title: "A lens instead of a pinhole",
    what_is_new: "Rays start all over a disk and meet again in a plane at the focus distance.",
    why: "A real camera needs a wide opening to gather light, and pays with blur in front of that plane and \
          behind it.",
    look_for: "The middle ball is sharp, about 3.4 away. The near glass and the far ground dissolve, the \
               more the further they are from the plane.",
    sight: sights::DEFOCUS,
    pair: Some("view-close"),
    setup: Setup {
        camera: Camera { defocus_angle_degrees: 10.0, focus_distance: Some(3.4), ..CLOSE_SIDE_VIEW },
        samples_per_pixel: 256,
        ..THREE_BALLS
    },
};

pub(super) const BOOK: Stage = Stage {
    id: "book",
    section: "14.1",
    section_title: "A Final Render",
    chapter_title: CHAPTER_14,
    title: "The final render",
    what_is_new: "Nothing but scale: 485 spheres, every material, a lens, and 500 samples per pixel.",
    why: "All the rules together, each as it was shown alone. It is also the first scene where it pays not \
          to test every sphere.",
    look_for: "The glass ball inverts the crowd behind it, the golden one mirrors it, and the small balls \
               in front of the focus blur gently.",
    sight: sights::BOOK,
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
};
