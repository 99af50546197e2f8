//! The figures in the book's order. The ids never change, because pages and command lines contain them.

use super::panels::{
    ALIASED, ANTIALIASED, BOOK, DEFOCUS, DIFFUSE, DIFFUSE_LIMITED, FOV_NARROW, FOV_WIDE, GAMUT,
    GLASS_REFRACT, GLASS_SCHLICK, GLASS_TIR, HOLLOW_GLASS, LAMBERTIAN_GAMMA, LAMBERTIAN_LINEAR, METAL,
    METAL_FUZZY, NORMALS, NORMALS_WORLD, PPM_GRADIENT, PPM_TINY, RED_SPHERE, SHADOW_ACNE, SKY, THREE_SPHERES,
    VIEW_CLOSE, VIEW_DISTANT,
};
use super::{Figure, Panel};

pub(super) const FIGURES: &[Figure] = &[
    Figure {
        id: "ppm-tiny",
        title: "A picture small enough to read",
        caption: "144 pixels, enlarged. Red grows to the right and green grows downwards, so a swapped row, column or \
                  channel shows at once.",
        panels: &[PPM_TINY],
    },
    Figure {
        id: "ppm-gradient",
        title: "The gradient at full size",
        caption: "The same two ramps over the whole picture: no seam, no border, no missing column.",
        panels: &[PPM_GRADIENT],
    },
    Figure {
        id: "sky",
        title: "The sky",
        caption: "One ray through the middle of each pixel. Its colour depends only on how steeply the ray climbs.",
        panels: &[SKY],
    },
    Figure {
        id: "red-sphere",
        title: "The first sphere",
        caption: "Rays that hit the sphere are red. Nothing tells the ball from a disk yet, because no ray reports \
                  where it hit.",
        panels: &[RED_SPHERE],
    },
    Figure {
        id: "normals",
        title: "Normals as colours",
        caption: "The x, y and z of the unit normal, moved from -1..1 to 0..1, are the red, green and blue of each \
                  hit.",
        panels: &[NORMALS],
    },
    Figure {
        id: "normals-world",
        title: "Two spheres",
        caption: "A ray takes the nearest hit in front of it. The ground is a sphere of radius 100, so its normals \
                  hardly turn.",
        panels: &[NORMALS_WORLD],
    },
    Figure {
        id: "antialiasing",
        title: "One sample against 64",
        caption: "With one ray per pixel, edges are staircases. The mean of many rays, each through another point of \
                  the pixel, gives edge pixels a shade in between.",
        panels: &[ALIASED, ANTIALIASED],
    },
    Figure {
        id: "diffuse",
        title: "The first light",
        caption: "Every bounce takes a random direction of the hemisphere and keeps half of the light. No lamp was \
                  placed: the sky lights the ball, and the ground hides a part of the sky.",
        panels: &[DIFFUSE],
    },
    Figure {
        id: "bounce-limit",
        title: "A limit on bounces",
        caption: "A path that is cut off brings no light. Each bounce halves the light, so little is left after four: \
                  the crevice under the ball gets darker by a step or two of 255, and all else stays as it was.",
        panels: &[Panel { label: "At most 49 bounces", ..DIFFUSE }, DIFFUSE_LIMITED],
    },
    Figure {
        id: "shadow-acne",
        title: "Shadow acne",
        caption: "Rounding puts a hit point slightly above or below its surface. From below, the next ray finds the \
                  same surface again, is scattered into the ball, and usually brings no light at all.",
        panels: &[SHADOW_ACNE, Panel { label: "Without acne", ..DIFFUSE_LIMITED }],
    },
    Figure {
        id: "lambertian",
        title: "Uniform against Lambertian",
        caption: "Lambertian directions gather around the normal. The top of the ball sees more of the sky and is \
                  brighter; the shadow under it is heavier, because the ball blocks the directions that count most.",
        panels: &[DIFFUSE, Panel { label: "Lambertian", ..LAMBERTIAN_LINEAR }],
    },
    Figure {
        id: "gamma",
        title: "Linear against gamma",
        caption: "The same light twice. On the right, the square root was taken before the numbers were written, \
                  which is close to what displays expect.",
        panels: &[
            Panel { label: "Linear", ..LAMBERTIAN_LINEAR },
            Panel { label: "With gamma", ..LAMBERTIAN_GAMMA },
        ],
    },
    Figure {
        id: "gamut",
        title: "Five greys, twice",
        caption: "Surfaces that reflect 10, 30, 50, 70 and 90 % of the light. The upper half is linear and the lower \
                  half has gamma, where the steps look even.",
        panels: &[GAMUT],
    },
    Figure {
        id: "metal",
        title: "Metal",
        caption: "Metal reflects about the normal and tints what it reflects. No chance is involved, so the \
                  reflection is as sharp as the scene.",
        panels: &[METAL],
    },
    Figure {
        id: "fuzz",
        title: "Polished against fuzzy",
        caption: "The end of each reflected ray is moved by a random vector of length fuzz: 0.3 on the left ball, 1 on \
                  the right one.",
        panels: &[METAL, METAL_FUZZY],
    },
    Figure {
        id: "glass-rules",
        title: "Three rules of glass",
        caption: "Snell's law alone; reflection where Snell's law has no solution, on a bubble of air in water; and \
                  Schlick's reflectance, which grows towards grazing angles.",
        panels: &[GLASS_REFRACT, GLASS_TIR, GLASS_SCHLICK],
    },
    Figure {
        id: "hollow-glass",
        title: "Solid against hollow glass",
        caption: "A sphere of air inside the sphere of glass turns the lens into a window: the scene behind it is \
                  upright again.",
        panels: &[Panel { label: "Solid", ..GLASS_SCHLICK }, HOLLOW_GLASS],
    },
    Figure {
        id: "three-spheres",
        title: "The measured scene",
        caption: "Every material in five spheres. Speed and error are measured on this picture.",
        panels: &[THREE_SPHERES],
    },
    Figure {
        id: "fov",
        title: "Field of view",
        caption: "The eye stays where it is; only the vertical angle changes. The narrow picture is the middle of the \
                  wide one.",
        panels: &[FOV_WIDE, FOV_NARROW],
    },
    Figure {
        id: "view",
        title: "Distant and close",
        caption: "The same place, from above and from the left, with a wide and with a narrow field of view.",
        panels: &[VIEW_DISTANT, VIEW_CLOSE],
    },
    Figure {
        id: "defocus",
        title: "Pinhole against lens",
        caption: "With a lens, rays start all over a disk and meet again at the focus distance of 3.4. Only what is \
                  there stays sharp.",
        panels: &[Panel { label: "Pinhole", ..VIEW_CLOSE }, DEFOCUS],
    },
    Figure {
        id: "book",
        title: "The final picture",
        caption: "485 spheres with every material and a lens: nothing new but scale.",
        panels: &[BOOK],
    },
];
