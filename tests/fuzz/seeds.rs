//! Seed inputs: files that the program and its libraries write.

use exr::prelude::{
    Compression, Encoding as ExrEncoding, Image, ImageAttributes, Layer, LayerAttributes, SpecificChannels,
    WritableImage,
};
use image::{DynamicImage, ImageFormat};
use std::io::Cursor;
use std::path::Path;
use weekender::film::{Description, Film, checkpoint, fixed_point, key};
use weekender::job::output::write_image;
use weekender::job::recipe::Recipe;
use weekender::job::recipe::file::{to_picture_toml, to_toml};
use weekender::scene::builtin::BuiltinScene;
use weekender::stages::{Stage, Transfer};

/// The files of a directory.
pub fn kept(name: &str) -> Vec<Vec<u8>> {
    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join(name);
    let files = std::fs::read_dir(directory).into_iter().flatten().map(|entry| entry.unwrap().path());
    let mut files: Vec<_> = files.filter(|path| path.is_file()).collect();
    files.sort();
    files.iter().map(|path| std::fs::read(path).unwrap()).collect()
}

pub fn scenes() -> Vec<Vec<u8>> {
    let builtin = BuiltinScene::ALL.iter().filter_map(|scene| Recipe::builtin(scene.name));
    let small = builtin.filter(|recipe| recipe.scene.spheres.len() < 100);
    let stages = Stage::ALL.iter().map(Stage::recipe);
    let mut scenes: Vec<Vec<u8>> = small.chain(stages).map(|recipe| to_toml(&recipe).into_bytes()).collect();
    scenes.retain(|text| text.len() < 4000);
    let field = Recipe::builtin("field:20000").unwrap();
    scenes.push(to_picture_toml(&field).replace("20000", "200").into_bytes());
    scenes.extend(kept("assets/scenes").into_iter().filter(|text| text.len() < 8000));
    scenes
}

fn film(width: u32, height: u32) -> Film {
    let mut film = Film::new(width, height);
    for half in film.halves_mut() {
        for (index, sum) in half.iter_mut().enumerate() {
            *sum = fixed_point([0.3, 0.7, 0.02 * index as f64]).unwrap();
        }
    }
    film.record(0..2, 0).unwrap();
    film.record(100..101, 1).unwrap();
    film.record(200..300, 0).unwrap();
    film
}

fn description() -> Description {
    let mut description = Description::new(&to_toml(&Recipe::builtin("two-spheres").unwrap()));
    description.set(key::SCENE, "two-spheres");
    description.set(key::SAMPLES, 12);
    description
}

/// The file that the program writes with this extension.
fn written(ending: &str, film: &Film) -> Vec<u8> {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join(format!("a.{ending}"));
    write_image(&path, film, Transfer::Gamma2, &description()).unwrap();
    std::fs::read(path).unwrap()
}

pub fn films() -> Vec<Vec<u8>> {
    // A short text leaves more mutations for the rest of the file.
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("a.exr");
    checkpoint::save(&path, &film(3, 2), &Description::new("x")).unwrap();
    vec![written("exr", &film(5, 4)), written("exr", &film(1, 1)), std::fs::read(path).unwrap()]
}

pub fn exrs() -> Vec<Vec<u8>> {
    let pixel =
        |at: exr::prelude::Vec2<usize>| (0.1_f32 * at.x() as f32, 0.5_f32, 1.0_f32 / (1 + at.y()) as f32);
    let mut files = films();
    for compression in [
        Compression::Uncompressed,
        Compression::RLE,
        Compression::ZIP1,
        Compression::ZIP16,
        Compression::PIZ,
        Compression::PXR24,
        Compression::B44,
        Compression::B44A,
    ] {
        for mut encoding in [ExrEncoding::UNCOMPRESSED, ExrEncoding::SMALL_FAST_LOSSLESS] {
            encoding.compression = compression;
            let layer =
                Layer::new((9, 7), LayerAttributes::named("a"), encoding, SpecificChannels::rgb(pixel));
            let image = Image::empty(ImageAttributes::with_size((9, 7))).with_layer(layer);
            let mut file = Cursor::new(Vec::new());
            if image.write().non_parallel().to_buffered(&mut file).is_ok() {
                files.push(file.into_inner());
            }
        }
    }
    files
}

fn encoded(image: &DynamicImage, format: ImageFormat) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    image.write_to(&mut file, format).unwrap();
    file.into_inner()
}

pub fn pngs() -> Vec<Vec<u8>> {
    let image =
        DynamicImage::ImageRgb8(image::RgbImage::from_fn(7, 5, |x, y| image::Rgb([x as u8, y as u8, 255])));
    let kinds = [
        image.clone(),
        image.to_rgba8().into(),
        image.to_luma8().into(),
        image.to_luma_alpha8().into(),
        image.to_rgb16().into(),
        image.to_luma16().into(),
    ];
    let mut files = vec![written("png", &film(5, 4))];
    files.extend(kinds.iter().map(|image| encoded(image, ImageFormat::Png)));
    for (colour, depth) in
        [(png::ColorType::Grayscale, png::BitDepth::One), (png::ColorType::Indexed, png::BitDepth::Two)]
    {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, 8, 4);
        encoder.set_color(colour);
        encoder.set_depth(depth);
        encoder.set_palette(&[0_u8, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11][..]);
        let length = if depth == png::BitDepth::One { 4 } else { 8 };
        encoder.write_header().unwrap().write_image_data(&vec![0x5a; length]).unwrap();
        files.push(bytes);
    }
    files
}

pub fn ppms() -> Vec<Vec<u8>> {
    let image = DynamicImage::ImageRgb8(image::RgbImage::new(3, 2));
    vec![
        written("ppm", &film(5, 4)),
        encoded(&image, ImageFormat::Pnm),
        encoded(&image.to_luma8().into(), ImageFormat::Pnm),
        b"P2\n# grey\n2 2\n15\n0 1 2 15\n".to_vec(),
        b"P3 2 1 255 0 1 2 3 4 5\n".to_vec(),
        b"P4\n9 2\n\x55\x80\xaa\x00".to_vec(),
        b"P5 2 2 65535\n\x00\x01\x02\x03\x04\x05\x06\x07".to_vec(),
        b"P6 1 1 65535\n\x00\x01\x02\x03\x04\x05".to_vec(),
        b"P1 3 2 1 0 1 0 1 0".to_vec(),
    ]
}

pub fn pfms() -> Vec<Vec<u8>> {
    let pixels = |count: usize| (0..count).flat_map(|i| (i as f32).to_le_bytes()).collect::<Vec<u8>>();
    vec![
        [&b"PF\n3 2\n-1.0\n"[..], &pixels(18)].concat(),
        [&b"Pf 2 2 1\n"[..], &pixels(4)].concat(),
        [&b"PF\n1 1\n-1\n"[..], &[0xff; 12]].concat(),
    ]
}

pub fn descriptions() -> Vec<Vec<u8>> {
    ["exr", "png", "ppm"].into_iter().map(|ending| written(ending, &film(2, 2))).collect()
}

pub fn flags() -> Vec<Vec<u8>> {
    let lines = [
        "--batch --scene three-spheres --size 80x45 --samples 3 --out a.png --checkpoint a.exr --json -",
        "--batch --stage 9.2 --depth 50 --sampler independent --seed 7 --time-limit 1.5 --noise-target 0.01",
        "--scene field:100 --look-from 13,2,3 --look-at 0,0,0 --vup 0,1,0 --vfov 20 --defocus-angle 0.6 --focus-distance 10",
        "--batch --stage metal --out a.ppm --progress off --simd 8 --isa avx2 --threads 2 --device cpu",
        "--batch --sample-range 4..8 --device reference --out a.ppm",
        "--save-scene a.toml --scene metals",
        "--resume a.exr --batch --samples 12",
        "merge a.exr b.exr --out c.exr",
        "compare a.exr b.png --encoding srgb --json c.json",
        "bench --scene book --spp 8 --isa all",
        "report --scenes two-spheres,close-up --size 64x36 --seeds 2 --out report",
        "--list",
        "--help",
    ];
    lines.into_iter().map(|line| line.replace(' ', "\n").into_bytes()).collect()
}
