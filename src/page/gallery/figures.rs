//! The figures in the book's order. Ids never change, because pages and command lines contain them.

use super::{Figure, Panel};

const fn panel(stage_id: &'static str, label: &'static str) -> Panel {
    Panel { stage_id, label }
}

pub(super) const FIGURES: &[Figure] = &[
    Figure {
        id: "ppm-tiny",
        title: "A picture small enough to read",
        caption: "144 pixels, enlarged. Red grows to the right and green grows downwards, so a swapped row, column or \
                  channel shows at once.",
        panels: &[panel("ppm-tiny", "16 by 9 pixels")],
    },
    Figure {
        id: "ppm-gradient",
        title: "The gradient at full size",
        caption: "The same two ramps over the whole picture: no seam, no border, no missing column.",
        panels: &[panel("ppm-gradient", "Full size")],
    },
    Figure {
        id: "sky",
        title: "The sky",
        caption: "One ray through the middle of each pixel. Its colour depends only on how steeply the ray climbs.",
        panels: &[panel("sky", "Sky")],
    },
    Figure {
        id: "red-sphere",
        title: "The first sphere",
        caption: "Rays that hit the sphere are red. Nothing tells the ball from a disk yet, because no ray reports \
                  where it hit.",
        panels: &[panel("red-sphere", "Hits in red")],
    },
    Figure {
        id: "normals",
        title: "Normals as colours",
        caption: "The x, y and z of the unit normal, moved from -1..1 to 0..1, are the red, green and blue of each \
                  hit.",
        panels: &[panel("normals", "Normals as colours")],
    },
    Figure {
        id: "normals-world",
        title: "Two spheres",
        caption: "A ray takes the nearest hit in front of it. The ground is a sphere of radius 100, so its normals \
                  hardly turn.",
        panels: &[panel("normals-world", "Two spheres")],
    },
    Figure {
        id: "antialiasing",
        title: "One sample against 64",
        caption: "With one ray per pixel, edges are staircases. The mean of many rays, each through another point of \
                  the pixel, gives edge pixels a shade in between.",
        panels: &[panel("aliased", "1 sample per pixel"), panel("antialiased", "64 samples per pixel")],
    },
    Figure {
        id: "diffuse",
        title: "The first light",
        caption: "Every bounce takes a random direction of the hemisphere and keeps half of the light. No lamp was \
                  placed: the sky is the light. The ball's shadow is where it hides a part of the sky from the ground.",
        panels: &[panel("diffuse", "Uniform over the hemisphere")],
    },
    Figure {
        id: "bounce-limit",
        title: "A limit on bounces",
        caption: "A path that is cut off brings no light. Each bounce halves the light, so little is left after four: \
                  the crevice under the ball gets darker by a step or two of 255, and all else stays as it was.",
        panels: &[panel("diffuse", "At most 49 bounces"), panel("diffuse-limited", "At most four bounces")],
    },
    Figure {
        id: "shadow-acne",
        title: "Shadow acne",
        caption: "Rounding puts a hit point slightly above or below its surface. From below, the next ray finds the \
                  same surface again, is scattered into the ball, and usually brings no light at all.",
        panels: &[
            panel("shadow-acne", "Every distance above 0 counts"),
            panel("diffuse-limited", "Without acne"),
        ],
    },
    Figure {
        id: "lambertian",
        title: "Uniform against Lambertian",
        caption: "Lambertian directions gather around the normal. The top of the ball sees more of the sky and is \
                  brighter; the shadow under it is heavier, because the ball blocks the directions that count most.",
        panels: &[panel("diffuse", "Uniform over the hemisphere"), panel("lambertian-linear", "Lambertian")],
    },
    Figure {
        id: "gamma",
        title: "Linear against gamma",
        caption: "The same light twice. On the right, the square root was taken before the numbers were written, \
                  which is close to what displays expect.",
        panels: &[panel("lambertian-linear", "Linear"), panel("lambertian-gamma", "With gamma")],
    },
    Figure {
        id: "gamut",
        title: "Five greys, twice",
        caption: "Surfaces that reflect 10, 30, 50, 70 and 90 % of the light. The upper half is linear, and a display \
                  shows its 50 % with 22 % of the light of white. The lower half has gamma, which makes it 47 %.",
        panels: &[panel("gamut", "10, 30, 50, 70 and 90 %")],
    },
    Figure {
        id: "metal",
        title: "Metal",
        caption: "Metal reflects about the normal and tints what it reflects. No chance is involved, so the \
                  reflection is as sharp as the scene.",
        panels: &[panel("metal", "Polished")],
    },
    Figure {
        id: "fuzz",
        title: "Polished against fuzzy",
        caption: "The end of each reflected ray is moved by a random vector of length fuzz: 0.3 on the left ball, 1 on \
                  the right one.",
        panels: &[panel("metal", "Polished"), panel("metal-fuzzy", "Fuzz 0.3 and 1")],
    },
    Figure {
        id: "glass-rules",
        title: "Three rules of glass",
        caption: "Snell's law alone; reflection where Snell's law has no solution, on a bubble of air in water; and \
                  Schlick's reflectance, which grows towards grazing angles.",
        panels: &[
            panel("glass-refract", "Refraction only"),
            panel("glass-tir", "Total reflection"),
            panel("glass-schlick", "Schlick's reflectance"),
        ],
    },
    Figure {
        id: "hollow-glass",
        title: "Solid against hollow glass",
        caption: "A sphere of air inside the sphere of glass turns the lens into a window: the scene behind it is \
                  upright again.",
        panels: &[panel("glass-schlick", "Solid"), panel("hollow-glass", "Hollow")],
    },
    Figure {
        id: "three-spheres",
        title: "The measured scene",
        caption: "Every material in five spheres. Speed and error are measured on this picture.",
        panels: &[panel("three-spheres", "All materials")],
    },
    Figure {
        id: "fov",
        title: "Field of view",
        caption: "The eye stays where it is; only the vertical angle changes. The narrow picture is the middle of the \
                  wide one.",
        panels: &[panel("fov-wide", "90 degrees"), panel("fov-narrow", "30 degrees")],
    },
    Figure {
        id: "view",
        title: "Distant and close",
        caption: "The three balls from above and from the left, with a wide and with a narrow field of view.",
        panels: &[panel("view-distant", "90 degrees"), panel("view-close", "20 degrees")],
    },
    Figure {
        id: "defocus",
        title: "Pinhole against lens",
        caption: "With a lens, rays start all over a disk and meet again at the focus distance of 3.4. Only what is \
                  there stays sharp.",
        panels: &[panel("view-close", "Pinhole"), panel("defocus", "With a lens")],
    },
    Figure {
        id: "book",
        title: "The final picture",
        caption: "485 spheres with every material and a lens: nothing new but scale.",
        panels: &[panel("book", "485 spheres")],
    },
];
