//! Chapters 9 to 11: diffuse surfaces, metal and glass.

use super::setups::{LINEAR, PATHS, THREE_BALLS};
use crate::scene::builtin::{LeftSphere, metals, three_spheres};
use crate::stages::{DielectricLaws, Diffuse, Rules, Setup, Stage, SurfaceRule, Transfer, sights};

const CHAPTER_9: &str = "Diffuse Materials";
const CHAPTER_10: &str = "Metal";
const CHAPTER_11: &str = "Dielectrics";

const HEMISPHERE: Rules = Rules { diffuse: Diffuse::Hemisphere, ..LINEAR };
const HALF_ENERGY_LIMITED: Setup = Setup { rules: HEMISPHERE, max_depth: 5, ..PATHS };

pub(super) const DIFFUSE: Stage = Stage {
    id: "diffuse",
    section: "9.1",
    section_title: "A Simple Diffuse Material",
    chapter_title: CHAPTER_9,
    title: "Light that bounces",
    what_is_new: "A ray that hits goes on in a random direction of the hemisphere above the surface, and \
                  brings half of what it finds there.",
    why: "This is the first light transport: a point is as bright as the surroundings that it can see, one \
          random direction at a time.",
    look_for: "The ball has shading and a soft shadow though nobody placed a lamp: the sky lights it, and \
               the ground hides part of the sky.",
    sight: sights::DIFFUSE,
    pair: None,
    setup: Setup { rules: HEMISPHERE, ..PATHS },
};

pub(super) const DIFFUSE_LIMITED: Stage = Stage {
    id: "diffuse-limited",
    section: "9.2",
    section_title: "Limiting the Number of Child Rays",
    chapter_title: CHAPTER_9,
    title: "An end to every path",
    what_is_new: "A path is cut off after four bounces and then brings nothing.",
    why: "A path between two surfaces could go on for ever. A limit bounds the work, and costs the light \
          of the longest paths.",
    look_for: "Almost nothing: each bounce halves the light, so little is left after four. Only the crevice where \
               the ball meets the ground gets darker, by a step or two of 255. With a limit of two rays the \
               underside of the ball loses half of its light.",
    sight: sights::DIFFUSE_LIMITED,
    pair: Some("shadow-acne"),
    setup: HALF_ENERGY_LIMITED,
};

pub(super) const SHADOW_ACNE: Stage = Stage {
    id: "shadow-acne",
    section: "9.3",
    section_title: "Fixing Shadow Acne",
    chapter_title: CHAPTER_9,
    title: "When rounding meets geometry",
    what_is_new: "One step back: a bounced ray may find the surface that it has just left, as in a tracer \
                  that accepts every distance above 0.",
    why: "A computed hit point lies a hair above or below the true surface. From below, the ray meets the \
          same surface again at once. All the other stages know which sphere a ray starts on.",
    look_for: "Dark speckles and lines on both surfaces, which are real rounding and not added noise. Their \
               pattern follows the spacing of the numbers.",
    sight: sights::SHADOW_ACNE,
    pair: Some("diffuse-limited"),
    setup: Setup { rules: Rules { surface: SurfaceRule::Acne, ..HEMISPHERE }, ..HALF_ENERGY_LIMITED },
};

pub(super) const LAMBERTIAN_LINEAR: Stage = Stage {
    id: "lambertian-linear",
    section: "9.4",
    section_title: "True Lambertian Reflection",
    chapter_title: CHAPTER_9,
    title: "Matte as matte surfaces are",
    what_is_new: "The direction is the normal plus a random unit vector, so steep directions are more \
                  likely than grazing ones, in proportion to the cosine.",
    why: "Paper and chalk look equally bright from every side. That is Lambert's law, and sampling by it \
          spares the weight that the hemisphere would need.",
    look_for: "Shadows are heavier: where the ball covers the sky overhead, it blocks the directions that now \
               count most. The top of the ball is brighter, its underside darker. Yet all of it is too dark: a \
               grey of 50 % is shown without regard to how a display works.",
    sight: sights::LAMBERTIAN_LINEAR,
    pair: Some("lambertian-gamma"),
    setup: Setup { rules: LINEAR, ..PATHS },
};

pub(super) const LAMBERTIAN_GAMMA: Stage = Stage {
    id: "lambertian-gamma",
    section: "9.5",
    section_title: "Using Gamma Correction for Accurate Color Intensity",
    chapter_title: CHAPTER_9,
    title: "Numbers for a display",
    what_is_new: "The square root is taken of each channel when the picture is made.",
    why: "Displays expect encoded values and raise them to a power of about two. Light is still added up \
          linearly; only the last step changes.",
    look_for: "Not a single ray differs from the stage before, yet the ball is now the middle grey that \
               was asked for.",
    sight: sights::LAMBERTIAN_GAMMA,
    pair: Some("lambertian-linear"),
    setup: PATHS,
};

pub(super) const GAMUT: Stage = Stage {
    id: "gamut",
    section: "9.5",
    section_title: "Using Gamma Correction for Accurate Color Intensity",
    chapter_title: CHAPTER_9,
    title: "Five greys, twice",
    what_is_new: "Five strips in which every surface reflects 10, 30, 50, 70 and 90 %; the upper half is \
                  shown linear, the lower half with gamma.",
    why: "Reflectances at equal distances should look like equal steps. The picture shows which encoding \
          achieves that.",
    look_for: "In the upper half the dark strips run together and the last step is huge. In the lower half \
               the strips climb evenly.",
    sight: sights::GAMUT,
    pair: None,
    setup: Setup {
        rules: Rules { reflectance_strips: true, transfer: Transfer::LinearAboveGamma2, ..Rules::FINISHED },
        ..PATHS
    },
};

pub(super) const METAL: Stage = Stage {
    id: "metal",
    section: "10.5",
    section_title: "A Scene with Metal Spheres",
    chapter_title: CHAPTER_10,
    title: "Mirrors",
    what_is_new: "Materials: each decides how a ray goes on and what colour it takes. Metal reflects about \
                  the normal.",
    why: "A mirror needs no chance at all, so its reflection is exactly as sharp as the scene that it shows.",
    look_for: "The blue ball in both metals, the ground bent around them, and the right one's golden tint \
               on all that it reflects.",
    sight: sights::METAL,
    pair: Some("metal-fuzzy"),
    setup: Setup { scene: || metals(0.0, 0.0), ..PATHS },
};

pub(super) const METAL_FUZZY: Stage = Stage {
    id: "metal-fuzzy",
    section: "10.6",
    section_title: "Fuzzy Reflection",
    chapter_title: CHAPTER_10,
    title: "Brushed metal",
    what_is_new: "The end of the reflected ray is moved to a random point of a small sphere around it, of radius \
                  0.3 on the left and 1 on the right.",
    why: "Real metal is rough at a small scale and scatters about the mirror direction. The sphere's radius \
          is a plain dial for how much.",
    look_for: "Reflections blur with distance: what nearly touches the metal stays clear. At fuzz 1 little \
               but the colour is left.",
    sight: sights::METAL_FUZZY,
    pair: Some("metal"),
    setup: Setup { scene: || metals(0.3, 1.0), ..PATHS },
};

pub(super) const GLASS_REFRACT: Stage = Stage {
    id: "glass-refract",
    section: "11.2",
    section_title: "Snell's Law",
    chapter_title: CHAPTER_11,
    title: "Glass that only refracts",
    what_is_new: "A ray that enters or leaves glass is bent by Snell's law. It is never reflected.",
    why: "One law at a time shows what each contributes. This one alone is not glass yet.",
    look_for: "The left ball turns the scene behind it upside down, which is right. Its rim is wrong: there, \
               real glass would mirror its surroundings.",
    sight: sights::GLASS_REFRACT,
    pair: Some("glass-schlick"),
    setup: Setup {
        scene: || three_spheres(LeftSphere::Glass(1.5)),
        rules: Rules { dielectric: DielectricLaws::RefractOnly, ..Rules::FINISHED },
        ..PATHS
    },
};

pub(super) const GLASS_TIR: Stage = Stage {
    id: "glass-tir",
    section: "11.3",
    section_title: "Total Internal Reflection",
    chapter_title: CHAPTER_11,
    title: "Where refraction has no answer",
    what_is_new: "If Snell's law asks for a sine above 1, the ray is reflected. The ball is a bubble of air \
                  in water, index 1/1.33, where this happens from outside.",
    why: "Towards a thinner medium there is an angle beyond which no light gets through. Glass fibres rely \
          on this.",
    look_for: "A bright ring: the bubble's rim mirrors the sky and the ground, while its middle can be seen \
               through.",
    sight: sights::GLASS_TIR,
    pair: None,
    setup: Setup {
        scene: || three_spheres(LeftSphere::Glass(1.0 / 1.33)),
        rules: Rules { dielectric: DielectricLaws::TotalReflection, ..Rules::FINISHED },
        ..PATHS
    },
};

pub(super) const GLASS_SCHLICK: Stage = Stage {
    id: "glass-schlick",
    section: "11.4",
    section_title: "Schlick Approximation",
    chapter_title: CHAPTER_11,
    title: "Windows at a slant",
    what_is_new: "Glass reflects a share of the light that grows towards grazing angles, by Schlick's \
                  formula; a random number decides between the two ways.",
    why: "A window seen from the side is a mirror. Without that share, glass looks like a hole with a \
          distorted view in it.",
    look_for: "Against refraction alone, the rim of the left ball now carries a pale reflection of the sky.",
    sight: sights::GLASS_SCHLICK,
    pair: Some("glass-refract"),
    setup: Setup { scene: || three_spheres(LeftSphere::Glass(1.5)), ..PATHS },
};

pub(super) const HOLLOW_GLASS: Stage = Stage {
    id: "hollow-glass",
    section: "11.5",
    section_title: "Modeling a Hollow Glass Sphere",
    chapter_title: CHAPTER_11,
    title: "A shell of glass",
    what_is_new: "A ball of air inside the ball of glass: an inner sphere of index 1/1.5.",
    why: "An index is relative to what surrounds it, so the inner surface needs no rule of its own, only the \
          inverse number.",
    look_for: "Through the middle the scene is upright and almost straight, as through a soap bubble. Only \
               the thick rim still bends.",
    sight: sights::HOLLOW_GLASS,
    pair: None,
    setup: THREE_BALLS,
};

pub(super) const THREE_SPHERES: Stage = Stage {
    id: "three-spheres",
    section: "11.5",
    section_title: "Modeling a Hollow Glass Sphere",
    chapter_title: CHAPTER_11,
    title: "The measured scene",
    what_is_new: "The same scene, larger and with more samples: what the finished renderer shows unless it is \
                  asked for something else.",
    why: "It has every material and a path of every kind in four small balls and a ground, so it is the \
          picture that speed and error are measured on.",
    look_for: "The remaining noise: in the bright caustic under the glass, and least in the sky, where no \
               path depends on chance.",
    sight: sights::THREE_SPHERES,
    pair: None,
    setup: Setup { width: 800, height: 450, samples_per_pixel: 200, max_depth: 24, ..THREE_BALLS },
};
