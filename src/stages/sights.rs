//! How the thing to look for in each stage is shown. The table of stages names these.

use super::{Means, Sight};

pub(super) const PPM_TINY: Sight = Sight::new(
    Means::Picture,
    Some([0.0, 0.0, 0.3125, 0.334]),
    "The first pixel is black. Its red grows to the right, its green downwards.",
);

pub(super) const PPM_GRADIENT: Sight = Sight::new(
    Means::Luminance([-4.0, 0.0]),
    None,
    "Luminance in false colours: smooth from corner to corner, without a seam or a border.",
);

pub(super) const SKY: Sight = Sight::new(
    Means::Luminance([-0.75, 0.25]),
    None,
    "Luminance in false colours: the band at the height of the eye is level, the others bend away from it.",
);

pub(super) const RED_SPHERE: Sight = Sight::new(
    Means::Wipe(0.5),
    Some([0.3, 0.16, 0.7, 0.84]),
    "Left, one red for every hit. Right, the next stages know where each ray has hit.",
);

pub(super) const NORMALS: Sight = Sight::new(
    Means::Picture,
    Some([0.31, 0.17, 0.69, 0.83]),
    "Red grows to the right, green upwards, and blue towards you.",
);

pub(super) const NORMALS_WORLD: Sight = Sight::new(
    Means::Picture,
    Some([0.56, 0.42, 0.78, 0.68]),
    "The ball hides the horizon, and the ground is one green.",
);

/// The bottom of the ball, where its outline is almost level.
const BOTTOM_OF_THE_BALL: Option<[f64; 4]> = Some([0.46, 0.765, 0.54, 0.81]);

pub(super) const ALIASED: Sight = Sight::new(
    Means::Picture,
    BOTTOM_OF_THE_BALL,
    "The bottom of the ball: a pixel is either ball or ground, so the outline goes in steps.",
);

pub(super) const ANTIALIASED: Sight = Sight::new(
    Means::Wipe(0.5),
    BOTTOM_OF_THE_BALL,
    "Left, one ray per pixel. Right, edge pixels have shades between ball and ground.",
);

pub(super) const DIFFUSE: Sight = Sight::new(
    Means::Picture,
    Some([0.25, 0.5, 0.75, 1.0]),
    "The shadow has no edge: the nearer to the ball, the less sky the ground sees.",
);

pub(super) const DIFFUSE_LIMITED: Sight = Sight::new(
    Means::RaysPerPath,
    Some([0.32, 0.5, 0.68, 0.95]),
    "Rays per path: only in the crevice do many paths come near the limit of five.",
);

pub(super) const SHADOW_ACNE: Sight = Sight::new(
    Means::Wipe(0.47),
    Some([0.38, 0.66, 0.62, 0.99]),
    "Left, without acne. Right, speckles on the ball and lines on the ground.",
);

pub(super) const LAMBERTIAN_LINEAR: Sight = Sight::new(
    Means::Wipe(0.5),
    None,
    "The same light twice: left as plain numbers, right as a display expects it.",
);

pub(super) const LAMBERTIAN_GAMMA: Sight = Sight::new(
    Means::Wipe(0.5),
    Some([0.3, 0.16, 0.7, 0.84]),
    "Left, the stage before. Right, the same rays: half the light now looks like middle grey.",
);

pub(super) const GAMUT: Sight = Sight::new(
    Means::Picture,
    Some([0.3, 0.3, 0.7, 0.7]),
    "The same three greys: dark and close together above, in even steps below.",
);

pub(super) const METAL: Sight = Sight::new(
    Means::Picture,
    Some([0.27, 0.24, 0.8, 0.76]),
    "The blue ball is seen three times: in the left metal, itself, and in gold at the right.",
);

pub(super) const METAL_FUZZY: Sight = Sight::new(
    Means::Wipe(0.29),
    Some([0.12, 0.24, 0.42, 0.76]),
    "Left, a mirror. Right, fuzz 0.3: the horizon blurs more than the ball that is close.",
);

/// The glass ball, which the left edge of the picture cuts.
const GLASS_BALL: Option<[f64; 4]> = Some([0.0, 0.17, 0.4, 0.83]);

/// Its upper right, with the rim.
const GLASS_RIM: Option<[f64; 4]> = Some([0.08, 0.17, 0.39, 0.6]);

pub(super) const GLASS_REFRACT: Sight = Sight::new(
    Means::Wipe(0.25),
    GLASS_RIM,
    "Left, refraction alone. Right, the complete rule: the rim mirrors the sky.",
);

pub(super) const GLASS_TIR: Sight =
    Sight::new(Means::Picture, GLASS_BALL, "The rim mirrors sky and ground; the middle is a window.");

pub(super) const GLASS_SCHLICK: Sight = Sight::new(
    Means::Wipe(0.25),
    GLASS_RIM,
    "Left, refraction alone. Right, the reflected sky makes the rim pale.",
);

pub(super) const HOLLOW_GLASS: Sight = Sight::new(
    Means::Picture,
    GLASS_BALL,
    "Sky above and ground below, as without the ball. Only the rim is bent.",
);

pub(super) const THREE_SPHERES: Sight = Sight::new(
    Means::StandardError,
    None,
    "Standard error: bright under the glass and on the ground, dark in the sky.",
);

pub(super) const FOV_WIDE: Sight = Sight::new(
    Means::Albedo,
    None,
    "Without light and shadow: two eggs, wider than high, that the frame cuts.",
);

pub(super) const FOV_NARROW: Sight = Sight::new(
    Means::Wipe(0.5),
    None,
    "Left, the wide view with its own camera. Right, its middle, enlarged.",
);

pub(super) const VIEW_DISTANT: Sight = Sight::new(
    Means::Picture,
    Some([0.36, 0.35, 0.62, 0.68]),
    "From the front: hollow glass, the blue ball, the metal.",
);

pub(super) const VIEW_CLOSE: Sight = Sight::new(
    Means::Wipe(0.5),
    None,
    "Left, a pinhole: the glass in front is sharp. Right, a lens: the metal behind is not.",
);

pub(super) const DEFOCUS: Sight = Sight::new(
    Means::Wipe(0.16),
    None,
    "Left, a pinhole. Right, a lens: the blue ball stays sharp, glass and metal dissolve.",
);

pub(super) const BOOK: Sight = Sight::new(
    Means::Picture,
    Some([0.36, 0.04, 0.86, 0.7]),
    "Behind, glass turns the crowd upside down. In front, metal mirrors it upright.",
);
