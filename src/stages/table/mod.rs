//! The stages in the book's order. Section numbers and scene values follow v4.0.2.

mod setups;

use super::{DielectricLaws, Diffuse, Means, Rules, Setup, Shading, Sight, Stage, SurfaceRule, Transfer};
use crate::scene::Camera;
use crate::scene::builtin::{
    BOOK_CAMERA, LeftSphere, SIDE_VIEW, WIDE_LENS, book, matte_on_ground, metals, one_sphere, three_spheres,
    touching_spheres,
};
use glam::DVec3;
use setups::{LINEAR, ONE_RAY, PATHS, THREE_BALLS};

const NORMAL_COLOURS: Rules = Rules { shading: Shading::Normals, ..LINEAR };
const IMAGE_GRADIENT: Rules = Rules { shading: Shading::ImageGradient, antialiasing: false, ..LINEAR };

/// The bottom of the ball, where its outline is almost level.
const BOTTOM_OF_THE_BALL: Option<[f64; 4]> = Some([0.46, 0.765, 0.54, 0.81]);

const HEMISPHERE: Rules = Rules { diffuse: Diffuse::Hemisphere, ..LINEAR };
const HALF_ENERGY_LIMITED: Setup = Setup { rules: HEMISPHERE, max_depth: 5, ..PATHS };

/// Raises the ground above the middle of the picture across its width, while the ball still stands out.
const FROM_A_LITTLE_HIGHER: Camera = Camera {
    look_from: DVec3::new(0.0, 0.6, 0.4),
    look_at: DVec3::new(0.0, -0.2, -1.0),
    vfov_degrees: 60.0,
    ..Camera::BOOK
};

/// The glass ball, cut by the left edge of the picture.
const GLASS_BALL: Option<[f64; 4]> = Some([0.0, 0.17, 0.4, 0.83]);

/// Its upper right, with the rim.
const GLASS_RIM: Option<[f64; 4]> = Some([0.08, 0.17, 0.39, 0.6]);

const CLOSE_SIDE_VIEW: Camera = Camera { vfov_degrees: 20.0, ..SIDE_VIEW };

pub(super) const STAGES: &[Stage] = &[
    // Chapters 2 to 8: pictures, rays, spheres and their normals, antialiasing.
    Stage {
        id: "ppm-tiny",
        section: "2.1",
        title: "A picture small enough to read",
        what_is_new: "A file of 16 by 9 pixels: a short header, then three numbers per pixel.",
        why: "Before any light is simulated, you must be able to trust the way from a number to a coloured \
              dot. At this size every value can be checked by eye.",
        look_for: "Rows come from the top, pixels from the left: red grows to the right, green grows \
                   downwards, and the first pixel is black.",
        sight: Sight {
            means: Means::Picture,
            part: Some([0.0, 0.0, 0.3125, 0.334]),
            caption: "The first pixel is black. From there, red grows to the right and green downwards.",
        },
        alt: "A gradient of 16 by 9 large pixels: black at the top left, red at the top right, green at \
              the bottom left, yellow at the bottom right.",
        pair: None,
        setup: Setup { rules: IMAGE_GRADIENT, width: 16, height: 9, is_about_pixels: true, ..ONE_RAY },
    },
    Stage {
        id: "ppm-gradient",
        section: "2.2",
        title: "The same picture at full size",
        what_is_new: "The same gradient in the size of most later pictures, 480 by 270 pixels.",
        why: "A picture that is known in advance shows at once if rows are swapped, channels mixed up or \
              the last column is missing.",
        look_for: "The corners: black and red above, green and yellow below. There is no seam and no \
                   border between them.",
        sight: Sight {
            means: Means::Luminance([-4.0, 0.0]),
            part: None,
            caption: "Luminance in false colours: smooth from corner to corner, without a seam or a \
                      border.",
        },
        alt: "A smooth gradient: black at the top left, red at the top right, green at the bottom left, \
              yellow at the bottom right.",
        pair: None,
        setup: Setup { rules: IMAGE_GRADIENT, ..ONE_RAY },
    },
    Stage {
        id: "sky",
        section: "4.2",
        title: "The first rays",
        what_is_new: "A camera sends one ray through the middle of each pixel. What a ray brings back \
                      depends only on how steeply it climbs.",
        why: "The gradient is the light of every later scene: there are no lamps, only this sky all \
              around.",
        look_for: "White below, blue above. The bands of equal colour bend slightly, since what counts is \
                   the height of a unit direction and not the row.",
        sight: Sight {
            means: Means::Luminance([-0.75, 0.25]),
            part: None,
            caption: "Luminance in false colours: the band at the height of the eye is level, the others \
                      bend away from it.",
        },
        alt: "A gradient from light blue at the top to white at the bottom.",
        pair: None,
        setup: ONE_RAY,
    },
    Stage {
        id: "red-sphere",
        section: "5.2",
        title: "Something to hit",
        what_is_new: "Each ray asks whether it meets a sphere: a quadratic equation that has real \
                      solutions or has none.",
        why: "The sign of the discriminant alone separates inside from outside. Everything else in a ray \
              tracer is built on this question.",
        look_for: "A flat red disk. Nothing in it tells a ball from a coin, because no ray reports where \
                   it hit.",
        sight: Sight {
            means: Means::Wipe(0.5),
            part: Some([0.3, 0.16, 0.7, 0.84]),
            caption: "Right, one red for every hit. Left, the next stage knows where each ray has hit.",
        },
        alt: "A flat red disk in front of the blue and white sky.",
        pair: Some("normals"),
        setup: Setup {
            scene: one_sphere,
            rules: Rules { shading: Shading::FirstHitRed, ..ONE_RAY.rules },
            ..ONE_RAY
        },
    },
    Stage {
        id: "normals",
        section: "6.1",
        title: "Which way the surface faces",
        what_is_new: "The hit point gives a normal, and its three components are shown as red, green and \
                      blue.",
        why: "A normal decides where light goes next, so a wrong one spoils every later stage. Painted as \
              a colour it cannot hide.",
        look_for: "Red to the right, green on top, blue where the surface looks at the camera.",
        sight: Sight {
            means: Means::Picture,
            part: Some([0.31, 0.17, 0.69, 0.83]),
            caption: "Red grows to the right, green upwards, and blue towards you.",
        },
        alt: "A ball in the colours of its normals: turquoise at the top, pink on the right, blue in the \
              middle, violet at the bottom.",
        pair: Some("red-sphere"),
        setup: Setup { scene: one_sphere, rules: Rules { antialiasing: false, ..NORMAL_COLOURS }, ..ONE_RAY },
    },
    Stage {
        id: "normals-world",
        section: "6.5",
        title: "More than one sphere",
        what_is_new: "A list of spheres, of which a ray takes the nearest in front of it. The ground is \
                      just a very large ball.",
        why: "With two things in a scene one can stand before the other, and only the distance along the \
              ray says which.",
        look_for: "The ball covers the ground behind it, and the ground is nearly uniform: its normal \
                   hardly turns from straight up.",
        sight: Sight {
            means: Means::Picture,
            part: Some([0.56, 0.42, 0.78, 0.68]),
            caption: "The ball hides the horizon, and the ground is one green.",
        },
        alt: "The ball in the colours of its normals, on ground that is light green all over.",
        pair: None,
        setup: Setup {
            scene: matte_on_ground,
            rules: Rules { antialiasing: false, ..NORMAL_COLOURS },
            ..ONE_RAY
        },
    },
    Stage {
        id: "aliased",
        section: "8.2",
        title: "Edges made of steps",
        what_is_new: "Nothing yet: one ray per pixel, the starting point of the comparison.",
        why: "A pixel is an area, but one ray asks about a single point of it. A yes-or-no answer cannot \
              say that the edge runs through the middle.",
        look_for: "The outline of the ball and the horizon are staircases. Zoom in on where they are \
                   almost level.",
        sight: Sight {
            means: Means::Picture,
            part: BOTTOM_OF_THE_BALL,
            caption: "The bottom of the ball: a pixel is either ball or ground, so the outline goes in \
                      steps.",
        },
        alt: "The ball in the colours of its normals; its outline and the horizon are made of small steps.",
        pair: Some("antialiased"),
        setup: Setup {
            scene: matte_on_ground,
            rules: Rules { antialiasing: false, ..NORMAL_COLOURS },
            is_about_pixels: true,
            ..ONE_RAY
        },
    },
    Stage {
        id: "antialiased",
        section: "8.2",
        title: "Averages over a pixel",
        what_is_new: "Many rays per pixel, each through a different point of it, and their mean.",
        why: "The mean estimates how much of the pixel each surface covers. The same averaging will later \
              also cover light paths and the lens, at no extra cost.",
        look_for: "Edge pixels take shades between the two sides, and the steps are gone without the \
                   inside becoming soft.",
        sight: Sight {
            means: Means::Wipe(0.5),
            part: BOTTOM_OF_THE_BALL,
            caption: "Left, one ray per pixel. Right, edge pixels have shades between ball and ground.",
        },
        alt: "The same ball with a smooth outline and a smooth horizon.",
        pair: Some("aliased"),
        setup: Setup {
            rules: NORMAL_COLOURS,
            samples_per_pixel: 64,
            max_depth: 1,
            is_about_pixels: true,
            ..PATHS
        },
    },
    // Chapter 9: diffuse surfaces, and pictures for a display.
    Stage {
        id: "diffuse",
        section: "9.1",
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
    // Chapters 10 and 11: metal and glass.
    Stage {
        id: "metal",
        section: "10.5",
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
        setup: Setup {
            width: 800,
            height: 450,
            samples_per_pixel: 200,
            max_depth: 24,
            is_in_book: false,
            ..THREE_BALLS
        },
    },
    // Chapters 12 to 14: the positionable camera, its lens, and the final picture.
    Stage {
        id: "fov-wide",
        section: "12.1",
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
        setup: Setup { camera: WIDE_LENS, samples_per_pixel: 256, ..THREE_BALLS },
    },
    Stage {
        id: "book",
        section: "14.1",
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
            width: 1200,
            height: 675,
            samples_per_pixel: 500,
            has_random_spheres: true,
            ..PATHS
        },
    },
];
