//! The stages in the book's order. Section numbers and scene values are those of v4.0.2.

use super::{DielectricLaws, Diffuse, Rules, Setup, Shading, Stage, SurfaceRule, Transfer, sights};
use crate::scene::Camera;
use crate::scene::builtin::{
    BOOK_CAMERA, LeftSphere, book, empty, matte_on_ground, metals, one_sphere, three_spheres,
    touching_spheres,
};
use glam::DVec3;

const OUTPUT_AN_IMAGE: &str = "Output an Image";
const RAYS: &str = "Rays, a Simple Camera, and Background";
const ADDING_A_SPHERE: &str = "Adding a Sphere";
const SURFACE_NORMALS: &str = "Surface Normals and Multiple Objects";
const ANTIALIASING: &str = "Antialiasing";
const DIFFUSE_MATERIALS: &str = "Diffuse Materials";
const METAL: &str = "Metal";
const DIELECTRICS: &str = "Dielectrics";
const POSITIONABLE_CAMERA: &str = "Positionable Camera";
const DEFOCUS_BLUR: &str = "Defocus Blur";
const WHERE_NEXT: &str = "Where Next?";

const LINEAR: Rules = Rules { transfer: Transfer::Linear, ..Rules::FINISHED };
const NORMALS: Rules = Rules { shading: Shading::Normals, ..LINEAR };
const HEMISPHERE: Rules = Rules { diffuse: Diffuse::Hemisphere, ..LINEAR };

/// One ray through each pixel's centre, which ends at its first hit.
const ONE_RAY: Setup = Setup {
    scene: empty,
    camera: Camera::BOOK,
    rules: Rules { antialiasing: false, ..LINEAR },
    width: 480,
    height: 270,
    samples_per_pixel: 1,
    max_depth: 1,
};

/// Paths with as many rays as the book allows. The number of samples is a power of two, at which Sobol points are most
/// evenly distributed.
const PATHS: Setup = Setup {
    scene: matte_on_ground,
    camera: Camera::BOOK,
    rules: Rules::FINISHED,
    width: 480,
    height: 270,
    samples_per_pixel: 128,
    max_depth: 50,
};

const IMAGE_GRADIENT: Rules = Rules { shading: Shading::ImageGradient, antialiasing: false, ..LINEAR };

const HALF_ENERGY_LIMITED: Setup = Setup { rules: HEMISPHERE, max_depth: 5, ..PATHS };

const HOLLOW_GLASS: Setup = Setup { scene: || three_spheres(LeftSphere::HollowGlass), ..PATHS };

/// A view of the three spheres from above and from the left.
const SIDE_VIEW: Camera = Camera { look_from: DVec3::new(-2.0, 2.0, 1.0), ..Camera::BOOK };

const CLOSE_SIDE_VIEW: Camera = Camera { vfov_degrees: 20.0, ..SIDE_VIEW };

pub(super) const STAGES: &[Stage] = &[
    Stage {
        id: "ppm-tiny",
        section: "2.1",
        section_title: "The PPM Image Format",
        chapter_title: OUTPUT_AN_IMAGE,
        title: "A picture small enough to read",
        what_is_new: "A file of 16 by 9 pixels: a short header, then three numbers per pixel.",
        why: "Before any light is simulated, the way from a number to a coloured dot must be trusted. \
              At this size every value can be checked by eye.",
        look_for: "Rows come from the top, pixels from the left: red grows to the right, green grows downwards, \
                   and the first pixel is black.",
        sight: sights::PPM_TINY,
        pair: None,
        setup: Setup { rules: IMAGE_GRADIENT, width: 16, height: 9, ..ONE_RAY },
    },
    Stage {
        id: "ppm-gradient",
        section: "2.2",
        section_title: "Creating an Image File",
        chapter_title: OUTPUT_AN_IMAGE,
        title: "The same picture at full size",
        what_is_new: "The gradient in the size that all further pictures have.",
        why: "A picture that is known in advance shows at once if rows are swapped, channels mixed up or the \
              last column is missing.",
        look_for: "The corners: black and red above, green and yellow below. Between them is no seam and no border.",
        sight: sights::PPM_GRADIENT,
        pair: None,
        setup: Setup { rules: IMAGE_GRADIENT, ..ONE_RAY },
    },
    Stage {
        id: "sky",
        section: "4.2",
        section_title: "Sending Rays Into the Scene",
        chapter_title: RAYS,
        title: "The first rays",
        what_is_new: "A camera sends one ray through the middle of each pixel. What a ray brings back depends \
                      only on how steeply it climbs.",
        why: "The gradient is the light of every later scene: it has no lamps, only this sky all around.",
        look_for: "White below, blue above. The bands of equal colour bend slightly, since what counts is the \
                   height of a unit direction and not the row.",
        sight: sights::SKY,
        pair: None,
        setup: ONE_RAY,
    },
    Stage {
        id: "red-sphere",
        section: "5.2",
        section_title: "Creating Our First Raytraced Image",
        chapter_title: ADDING_A_SPHERE,
        title: "Something to hit",
        what_is_new: "Each ray asks whether it meets a sphere: a quadratic equation that has real solutions or \
                      has none.",
        why: "The sign of the discriminant alone separates inside from outside. Everything else in a ray tracer \
              is built on this question.",
        look_for: "A flat red disk. Nothing in it tells a ball from a coin, because no ray reports where it hit.",
        sight: sights::RED_SPHERE,
        pair: None,
        setup: Setup {
            scene: one_sphere,
            rules: Rules { shading: Shading::FirstHitRed, ..ONE_RAY.rules },
            ..ONE_RAY
        },
    },
    Stage {
        id: "normals",
        section: "6.1",
        section_title: "Shading with Surface Normals",
        chapter_title: SURFACE_NORMALS,
        title: "Which way the surface faces",
        what_is_new: "The hit point gives a normal, and its three components are shown as red, green and blue.",
        why: "A normal decides where light goes next, so a wrong one spoils every later stage. Painted as a \
              colour it cannot hide.",
        look_for: "Red to the right, green on top, blue where the surface looks at the camera.",
        sight: sights::NORMALS,
        pair: None,
        setup: Setup { scene: one_sphere, rules: Rules { antialiasing: false, ..NORMALS }, ..ONE_RAY },
    },
    Stage {
        id: "normals-world",
        section: "6.5",
        section_title: "A List of Hittable Objects",
        chapter_title: SURFACE_NORMALS,
        title: "More than one sphere",
        what_is_new: "A list of spheres, of which a ray takes the nearest in front of it. The ground is just a \
                      very large ball.",
        why: "With two things in a scene one can stand before the other, and only the distance along the ray \
              says which.",
        look_for: "The ball covers the ground behind it, and the ground is nearly uniform: its normal hardly \
                   turns from straight up.",
        sight: sights::NORMALS_WORLD,
        pair: None,
        setup: Setup { scene: matte_on_ground, rules: Rules { antialiasing: false, ..NORMALS }, ..ONE_RAY },
    },
    Stage {
        id: "aliased",
        section: "8.2",
        section_title: "Generating Pixels with Multiple Samples",
        chapter_title: ANTIALIASING,
        title: "Edges made of steps",
        what_is_new: "Nothing yet: one ray per pixel, the starting point of the comparison.",
        why: "A pixel is an area, but one ray asks about a single point of it. A yes-or-no answer cannot say \
              that the edge runs through the middle.",
        look_for: "The outline of the ball and the horizon are staircases. Zoom in on where they are almost \
                   level.",
        sight: sights::ALIASED,
        pair: Some("antialiased"),
        setup: Setup { scene: matte_on_ground, rules: Rules { antialiasing: false, ..NORMALS }, ..ONE_RAY },
    },
    Stage {
        id: "antialiased",
        section: "8.2",
        section_title: "Generating Pixels with Multiple Samples",
        chapter_title: ANTIALIASING,
        title: "Averages over a pixel",
        what_is_new: "Many rays per pixel, each through a different point of it, and their mean.",
        why: "The mean estimates how much of the pixel each surface covers. The same averaging will later \
              gather light, lens and blur for nothing extra.",
        look_for: "Edge pixels take shades between the two sides, and the steps are gone without the inside \
                   becoming soft.",
        sight: sights::ANTIALIASED,
        pair: Some("aliased"),
        setup: Setup { rules: NORMALS, samples_per_pixel: 64, max_depth: 1, ..PATHS },
    },
    Stage {
        id: "diffuse",
        section: "9.1",
        section_title: "A Simple Diffuse Material",
        chapter_title: DIFFUSE_MATERIALS,
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
    },
    Stage {
        id: "diffuse-limited",
        section: "9.2",
        section_title: "Limiting the Number of Child Rays",
        chapter_title: DIFFUSE_MATERIALS,
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
    },
    Stage {
        id: "shadow-acne",
        section: "9.3",
        section_title: "Fixing Shadow Acne",
        chapter_title: DIFFUSE_MATERIALS,
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
    },
    Stage {
        id: "lambertian-linear",
        section: "9.4",
        section_title: "True Lambertian Reflection",
        chapter_title: DIFFUSE_MATERIALS,
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
    },
    Stage {
        id: "lambertian-gamma",
        section: "9.5",
        section_title: "Using Gamma Correction for Accurate Color Intensity",
        chapter_title: DIFFUSE_MATERIALS,
        title: "Numbers for a display",
        what_is_new: "The square root is taken of each channel when the picture is made.",
        why: "Displays expect encoded values and raise them to a power of about two. Light is still added up \
              linearly; only the last step changes.",
        look_for: "Not a single ray differs from the stage before, yet the ball is now the middle grey that \
                   was asked for.",
        sight: sights::LAMBERTIAN_GAMMA,
        pair: Some("lambertian-linear"),
        setup: PATHS,
    },
    Stage {
        id: "gamut",
        section: "9.5",
        section_title: "Using Gamma Correction for Accurate Color Intensity",
        chapter_title: DIFFUSE_MATERIALS,
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
            rules: Rules {
                reflectance_strips: true,
                transfer: Transfer::LinearAboveGamma2,
                ..Rules::FINISHED
            },
            ..PATHS
        },
    },
    Stage {
        id: "metal",
        section: "10.5",
        section_title: "A Scene with Metal Spheres",
        chapter_title: METAL,
        title: "Mirrors",
        what_is_new: "Materials: each decides how a ray goes on and what colour it takes. Metal reflects about \
                      the normal.",
        why: "A mirror needs no chance at all, so its reflection is exactly as sharp as the scene that it shows.",
        look_for: "The blue ball in both metals, the ground bent around them, and the right one's golden tint \
                   on all that it reflects.",
        sight: sights::METAL,
        pair: Some("metal-fuzzy"),
        setup: Setup { scene: || metals(0.0, 0.0), ..PATHS },
    },
    Stage {
        id: "metal-fuzzy",
        section: "10.6",
        section_title: "Fuzzy Reflection",
        chapter_title: METAL,
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
    },
    Stage {
        id: "glass-refract",
        section: "11.2",
        section_title: "Snell's Law",
        chapter_title: DIELECTRICS,
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
    },
    Stage {
        id: "glass-tir",
        section: "11.3",
        section_title: "Total Internal Reflection",
        chapter_title: DIELECTRICS,
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
    },
    Stage {
        id: "glass-schlick",
        section: "11.4",
        section_title: "Schlick Approximation",
        chapter_title: DIELECTRICS,
        title: "Windows at a slant",
        what_is_new: "Glass reflects a share of the light that grows towards grazing angles, by Schlick's \
                      formula; a random number decides between the two ways.",
        why: "A window seen from the side is a mirror. Without that share, glass looks like a hole with a \
              distorted view in it.",
        look_for: "Against refraction alone, the rim of the left ball now carries a pale reflection of the sky.",
        sight: sights::GLASS_SCHLICK,
        pair: Some("glass-refract"),
        setup: Setup { scene: || three_spheres(LeftSphere::Glass(1.5)), ..PATHS },
    },
    Stage {
        id: "hollow-glass",
        section: "11.5",
        section_title: "Modeling a Hollow Glass Sphere",
        chapter_title: DIELECTRICS,
        title: "A shell of glass",
        what_is_new: "A ball of air inside the ball of glass: an inner sphere of index 1/1.5.",
        why: "An index is relative to what surrounds it, so the inner surface needs no rule of its own, only the \
              inverse number.",
        look_for: "Through the middle the scene is upright and almost straight, as through a soap bubble. Only \
                   the thick rim still bends.",
        sight: sights::HOLLOW_GLASS,
        pair: None,
        setup: HOLLOW_GLASS,
    },
    Stage {
        id: "three-spheres",
        section: "11.5",
        section_title: "Modeling a Hollow Glass Sphere",
        chapter_title: DIELECTRICS,
        title: "The measured scene",
        what_is_new: "The same scene, larger and with more samples: what the finished renderer shows unless it is \
                      asked for something else.",
        why: "It has every material and a path of every kind in four small balls and a ground, so it is the \
              picture that speed and error are measured on.",
        look_for: "The remaining noise: in the bright caustic under the glass, and least in the sky, where no \
                   path depends on chance.",
        sight: sights::THREE_SPHERES,
        pair: None,
        setup: Setup { width: 800, height: 450, samples_per_pixel: 200, max_depth: 24, ..HOLLOW_GLASS },
    },
    Stage {
        id: "fov-wide",
        section: "12.1",
        section_title: "Camera Viewing Geometry",
        chapter_title: POSITIONABLE_CAMERA,
        title: "A wide view",
        what_is_new: "The vertical field of view is a setting: 90 degrees here.",
        why: "The two balls are placed so that they touch each other and the limits of a right angle, which \
              makes the angle easy to check.",
        look_for: "Towards the sides the balls are stretched to eggs. That is what a flat picture of a wide \
                   angle has to look like.",
        sight: sights::FOV_WIDE,
        pair: Some("fov-narrow"),
        setup: Setup { scene: touching_spheres, ..PATHS },
    },
    Stage {
        id: "fov-narrow",
        section: "12.1",
        section_title: "Camera Viewing Geometry",
        chapter_title: POSITIONABLE_CAMERA,
        title: "A narrow view",
        what_is_new: "The same scene from the same place, 30 degrees high.",
        why: "Only the angle changes: the rays of this picture are those from the middle of the wide one.",
        look_for: "The middle of the wide picture, enlarged. The perspective between the balls is unchanged, \
                   because the eye has not moved.",
        sight: sights::FOV_NARROW,
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
        chapter_title: POSITIONABLE_CAMERA,
        title: "Another place to stand",
        what_is_new: "The camera can stand anywhere and look anywhere; a third vector says what is up.",
        why: "Three directions at right angles (right, up, back) replace the axes. The tracer itself does not \
              notice.",
        look_for: "The three balls from above and from the left; the hollow one is now nearest.",
        sight: sights::VIEW_DISTANT,
        pair: None,
        setup: Setup { camera: SIDE_VIEW, ..HOLLOW_GLASS },
    },
    Stage {
        id: "view-close",
        section: "12.2",
        section_title: "Positioning and Orienting the Camera",
        chapter_title: POSITIONABLE_CAMERA,
        title: "Zoomed in",
        what_is_new: "The same place with a field of view of 20 degrees.",
        why: "Position and zoom are independent: this is a longer lens, not a step closer.",
        look_for: "Everything is sharp from front to back, as only a pinhole can show it.",
        sight: sights::VIEW_CLOSE,
        pair: Some("defocus"),
        setup: Setup { camera: CLOSE_SIDE_VIEW, ..HOLLOW_GLASS },
    },
    Stage {
        id: "defocus",
        section: "13.2",
        section_title: "Generating Sample Rays",
        chapter_title: DEFOCUS_BLUR,
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
            ..HOLLOW_GLASS
        },
    },
    Stage {
        id: "book",
        section: "14.1",
        section_title: "A Final Render",
        chapter_title: WHERE_NEXT,
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
    },
];
