//! Chapter 9: diffuse surfaces, and pictures for a display.

use super::setups::{LINEAR, PATHS};
use crate::scene::Camera;
use crate::stages::{Diffuse, Means, Rules, Setup, Sight, Stage, SurfaceRule, Transfer};
use glam::DVec3;

const CHAPTER_9: &str = "Diffuse Materials";

const HEMISPHERE: Rules = Rules { diffuse: Diffuse::Hemisphere, ..LINEAR };
const HALF_ENERGY_LIMITED: Setup = Setup { rules: HEMISPHERE, max_depth: 5, ..PATHS };

/// Raises the ground above the middle of the picture across its width, while the ball still stands out.
const FROM_A_LITTLE_HIGHER: Camera = Camera {
    look_from: DVec3::new(0.0, 0.6, 0.4),
    look_at: DVec3::new(0.0, -0.2, -1.0),
    vfov_degrees: 60.0,
    ..Camera::BOOK
};

pub(super) const STAGES: &[Stage] = &[
    Stage {
        id: "diffuse",
        section: "9.1",
        section_title: "A Simple Diffuse Material",
        chapter_title: CHAPTER_9,
        title: "Light that bounces",
        what_is_new: "A ray that hits goes on in a random direction of the hemisphere above the surface, \
                      and carries back half of the light it finds there.",
        why: "This is the first simulation of light transport: a point is lit by the surroundings that it \
              can see, one random direction at a time.",
        look_for: "Shading and a soft shadow, though nobody placed a lamp: the sky is the light. The \
                   ground hides part of it from the ball, and the ball hides part of it from the ground.",
        sight: Sight {
            means: Means::Picture,
            part: Some([0.25, 0.5, 0.75, 1.0]),
            caption: "The shadow has no edge: the nearer to the ball, the less sky the ground sees.",
        },
        alt: "A dark grey matte ball on grey ground, with a soft, nearly black shadow where they touch.",
        pair: Some("antialiased"),
        setup: Setup { rules: HEMISPHERE, ..PATHS },
    },
    Stage {
        id: "diffuse-limited",
        section: "9.2",
        section_title: "Limiting the Number of Child Rays",
        chapter_title: CHAPTER_9,
        title: "An end to every path",
        what_is_new: "A path is cut off after four bounces and then contributes nothing.",
        why: "A path between two surfaces could go on for ever. A limit bounds the work, and costs the \
              light of the longest paths.",
        look_for: "Almost nothing: each bounce halves the light, so little is left after four. Only the \
                   crevice where the ball meets the ground gets darker, by a step or two of 255. With a \
                   limit of two rays the underside of the ball loses half of its light.",
        sight: Sight {
            means: Means::RaysPerPath,
            part: Some([0.32, 0.5, 0.68, 0.95]),
            caption: "Rays per path: only in the crevice do many paths come near the limit of five.",
        },
        alt: "The dark grey matte ball on grey ground; the shadow beneath it is slightly darker.",
        pair: Some("shadow-acne"),
        setup: HALF_ENERGY_LIMITED,
    },
    Stage {
        id: "shadow-acne",
        section: "9.3",
        section_title: "Fixing Shadow Acne",
        chapter_title: CHAPTER_9,
        title: "When rounding meets geometry",
        what_is_new: "One step back: a bounced ray may find the surface that it has just left, as in a \
                      tracer that accepts every distance above 0.",
        why: "A computed hit point lies a hair above or below the true surface. From below, the ray meets \
              the same surface again at once. All the other stages know which sphere a ray starts on.",
        look_for: "The ball: it is half as bright as it should be, and speckled. On the ground there are \
                   lines. This is real rounding and not added noise; the pattern follows the spacing of \
                   the numbers.",
        sight: Sight {
            means: Means::Wipe(0.47),
            part: Some([0.38, 0.66, 0.62, 0.99]),
            caption: "Left, without acne. Right, speckles on the ball and lines on the ground.",
        },
        alt: "The matte ball, much darker than it should be, on ground that is a little too dark, with fine \
              vertical lines below the ball.",
        pair: Some("diffuse-limited"),
        setup: Setup { rules: Rules { surface: SurfaceRule::Acne, ..HEMISPHERE }, ..HALF_ENERGY_LIMITED },
    },
    Stage {
        id: "lambertian-linear",
        section: "9.4",
        section_title: "True Lambertian Reflection",
        chapter_title: CHAPTER_9,
        title: "Matte as matte surfaces are",
        what_is_new: "The direction is the normal plus a random unit vector, so steep directions are more \
                      likely than grazing ones, in proportion to the cosine.",
        why: "Paper and chalk look equally bright from every side. That is Lambert's law, and sampling by \
              it saves the weighting that the hemisphere needs.",
        look_for: "Shadows are heavier: where the ball covers the sky overhead, it blocks the directions \
                   that now count most. The top of the ball is brighter, its underside darker. Yet all of \
                   it is too dark: a grey of 50 % is shown without regard to how a display works.",
        sight: Sight {
            means: Means::Wipe(0.5),
            part: None,
            caption: "The same light twice: right as plain numbers, left as a display expects it.",
        },
        alt: "A dark grey matte ball on grey ground; its soft shadow is deeper than with uniform \
              directions.",
        pair: Some("lambertian-gamma"),
        setup: Setup { rules: LINEAR, ..PATHS },
    },
    Stage {
        id: "lambertian-gamma",
        section: "9.5",
        section_title: "Using Gamma Correction for Accurate Color Intensity",
        chapter_title: CHAPTER_9,
        title: "Numbers for a display",
        what_is_new: "The square root is taken of each channel when the picture is made.",
        why: "Displays expect encoded values and raise them to a power of about two. Light is still added \
              up linearly; only the last step changes.",
        look_for: "Not a single ray differs from the stage before, yet the grey of 50 % that was asked for \
                   is now shown as about half.",
        sight: Sight {
            means: Means::Wipe(0.5),
            part: Some([0.3, 0.16, 0.7, 0.84]),
            caption: "Left, the stage before. Right, the same rays: half the light is now shown as half.",
        },
        alt: "The same ball, ground and shadow in light grey.",
        pair: Some("lambertian-linear"),
        setup: PATHS,
    },
    Stage {
        id: "gamut",
        section: "9.5",
        section_title: "Using Gamma Correction for Accurate Color Intensity",
        chapter_title: CHAPTER_9,
        title: "Five greys, twice",
        what_is_new: "Five strips in which every surface reflects 10, 30, 50, 70 and 90 %, seen from a \
                      little higher up. The upper half is shown linear, the lower half with gamma.",
        why: "A display raises values to a power of about 2.2. It shows a plain 50 % with 22 % of the \
              light of white, but the square root of 50 % with 47 %: only then does half come out as half.",
        look_for: "The strip in the middle, whose surfaces reflect half of the light: far too dark above \
                   the line, about right below it. Above, the strip of 10 % is almost black.",
        sight: Sight {
            means: Means::Picture,
            part: Some([0.21, 0.25, 0.79, 0.75]),
            caption: "30, 50 and 70 % of the light: far too dark above the line, about right below it.",
        },
        alt: "Five vertical strips from dark to light, over a ball and the ground up to the horizon. Each \
              strip is much darker in the upper half than in the lower half, and the first is almost black \
              there.",
        pair: Some("lambertian-gamma"),
        setup: Setup {
            rules: Rules {
                reflectance_strips: true,
                transfer: Transfer::LinearAboveGamma2,
                ..Rules::FINISHED
            },
            camera: FROM_A_LITTLE_HIGHER,
            ..PATHS
        },
    },
];
