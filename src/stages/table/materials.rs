//! Chapters 10 and 11: metal and glass.

use super::setups::{PATHS, THREE_BALLS};
use crate::scene::builtin::{LeftSphere, metals, three_spheres};
use crate::stages::{DielectricLaws, Means, Rules, Setup, Sight, Stage};

const CHAPTER_10: &str = "Metal";
const CHAPTER_11: &str = "Dielectrics";

/// The glass ball, cut by the left edge of the picture.
const GLASS_BALL: Option<[f64; 4]> = Some([0.0, 0.17, 0.4, 0.83]);

/// Its upper right, with the rim.
const GLASS_RIM: Option<[f64; 4]> = Some([0.08, 0.17, 0.39, 0.6]);

pub(super) const STAGES: &[Stage] = &[
    Stage {
        id: "metal",
        section: "10.5",
        section_title: "A Scene with Metal Spheres",
        chapter_title: CHAPTER_10,
        title: "Mirrors",
        what_is_new: "Materials: each decides how a ray goes on and what colour it takes. Metal reflects \
                      about the normal.",
        why: "A mirror needs no chance at all, so its reflection is exactly as sharp as the scene that it \
              shows.",
        look_for: "The blue ball in both metals, the ground bent around them, and the right one's golden \
                   tint on all that it reflects.",
        sight: Sight {
            means: Means::Picture,
            part: Some([0.27, 0.24, 0.8, 0.76]),
            caption: "The blue ball is seen three times: in the left metal, itself, and in gold at the \
                      right.",
        },
        alt: "A matte blue ball between a silver and a golden ball, which mirror it, the yellow-green \
              ground and the sky sharply.",
        pair: Some("metal-fuzzy"),
        setup: Setup { scene: || metals(0.0, 0.0), ..PATHS },
    },
    Stage {
        id: "metal-fuzzy",
        section: "10.6",
        section_title: "Fuzzy Reflection",
        chapter_title: CHAPTER_10,
        title: "Brushed metal",
        what_is_new: "The end of the reflected ray is moved to a random point of a sphere around it, of \
                      radius 0.3 on the left and 1 on the right.",
        why: "Real metal is rough at a small scale and scatters about the mirror direction. The sphere's \
              radius is a plain dial for how much.",
        look_for: "Reflections blur with distance: what nearly touches the metal stays clear. At fuzz 1 \
                   little but the colour is left.",
        sight: Sight {
            means: Means::Wipe(0.29),
            part: Some([0.12, 0.24, 0.42, 0.76]),
            caption: "Left, a mirror. Right, fuzz 0.3: the horizon blurs more than the ball that is close.",
        },
        alt: "The same three balls; the silver one mirrors softly, and the golden one hardly shows a \
              reflection.",
        pair: Some("metal"),
        setup: Setup { scene: || metals(0.3, 1.0), ..PATHS },
    },
    Stage {
        id: "glass-refract",
        section: "11.2",
        section_title: "Snell's Law",
        chapter_title: CHAPTER_11,
        title: "Glass that only refracts",
        what_is_new: "A ray that enters or leaves glass is bent by Snell's law. It is never reflected.",
        why: "One law at a time shows what each contributes. This one alone is not glass yet.",
        look_for: "The left ball turns the scene behind it upside down, which is right. Its rim is wrong: \
                   there, real glass would mirror its surroundings.",
        sight: Sight {
            means: Means::Wipe(0.25),
            part: GLASS_RIM,
            caption: "Right, refraction alone. Left, the complete rule: the rim mirrors the sky.",
        },
        alt: "A glass ball on the left that shows the scene upside down up to its very edge: ground above, \
              sky below. A blue ball in the middle and a golden one on the right.",
        pair: Some("glass-schlick"),
        setup: Setup {
            scene: || three_spheres(LeftSphere::Glass(1.5)),
            rules: Rules { dielectric: DielectricLaws::RefractOnly, ..Rules::FINISHED },
            ..PATHS
        },
    },
    Stage {
        id: "glass-tir",
        section: "11.3",
        section_title: "Total Internal Reflection",
        chapter_title: CHAPTER_11,
        title: "Where refraction has no answer",
        what_is_new: "If Snell's law asks for a sine above 1, the ray is reflected. The ball is a bubble \
                      of air in water, index 1/1.33, where this happens from outside.",
        why: "Towards an optically thinner medium there is an angle beyond which no light gets through. \
              Glass fibres rely on this.",
        look_for: "The bubble's rim, which mirrors: a crescent of bluer sky at the top, and the blue ball \
                   a second time at the right. Through the middle you see the scene, not reversed.",
        sight: Sight {
            means: Means::Picture,
            part: GLASS_BALL,
            caption: "The rim mirrors: bluer sky above, the blue ball again at the right. The middle is a \
                      window.",
        },
        alt: "A bubble of air on the left: its middle can be seen through, and its rim mirrors the sky, \
              the ground and the blue ball.",
        pair: None,
        setup: Setup {
            scene: || three_spheres(LeftSphere::Glass(1.0 / 1.33)),
            rules: Rules { dielectric: DielectricLaws::TotalReflection, ..Rules::FINISHED },
            ..PATHS
        },
    },
    Stage {
        id: "glass-schlick",
        section: "11.4",
        section_title: "Schlick Approximation",
        chapter_title: CHAPTER_11,
        title: "Windows at a slant",
        what_is_new: "Glass reflects a share of the light that grows towards grazing angles, by Schlick's \
                      formula; a random number decides between the two ways.",
        why: "A window seen from the side is a mirror. Without that share, glass looks like a hole with a \
              distorted view in it.",
        look_for: "Against refraction alone, the rim of the left ball now carries a pale reflection of the \
                   sky.",
        sight: Sight {
            means: Means::Wipe(0.25),
            part: GLASS_RIM,
            caption: "Left, refraction alone. Right, the reflected sky makes the rim pale.",
        },
        alt: "A glass ball on the left that shows the scene upside down, with a pale reflection of the sky \
              along its rim.",
        pair: Some("glass-refract"),
        setup: Setup { scene: || three_spheres(LeftSphere::Glass(1.5)), ..PATHS },
    },
    Stage {
        id: "hollow-glass",
        section: "11.5",
        section_title: "Modeling a Hollow Glass Sphere",
        chapter_title: CHAPTER_11,
        title: "A shell of glass",
        what_is_new: "A ball of air inside the ball of glass: an inner sphere of index 1/1.5.",
        why: "An index is relative to what surrounds it, so the inner surface needs no rule of its own, \
              only the inverse number.",
        look_for: "Through the middle the scene is upright and almost straight, as through a soap bubble. \
                   Only the thick rim still bends.",
        sight: Sight {
            means: Means::Picture,
            part: GLASS_BALL,
            caption: "Sky above and ground below, as without the ball. Only the rim is bent.",
        },
        alt: "A thin shell of glass on the left: the scene behind it is upright, and only the rim bends \
              the light.",
        pair: None,
        setup: THREE_BALLS,
    },
    Stage {
        id: "three-spheres",
        section: "11.5",
        section_title: "Modeling a Hollow Glass Sphere",
        chapter_title: CHAPTER_11,
        title: "Four spheres, for measuring",
        what_is_new: "The same scene, larger and with more samples: what the finished renderer shows \
                      unless it is asked for something else.",
        why: "It has every material and a path of every kind in four small balls and a ground, so it is \
              the picture that speed and error are measured on.",
        look_for: "The remaining noise: most of it in the glass ball and on the ground below the metal, \
                   and least in the sky, where no path depends on chance.",
        sight: Sight {
            means: Means::StandardError,
            part: None,
            caption: "Standard error: bright in the glass and on the ground below the metal, dark in the \
                      sky.",
        },
        alt: "A hollow glass ball, a matte blue ball and a golden metal ball in a row on yellow-green \
              ground.",
        pair: None,
        setup: Setup { width: 800, height: 450, samples_per_pixel: 200, max_depth: 24, ..THREE_BALLS },
    },
];
