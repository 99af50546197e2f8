//! Tests of what integer values mean, and of the files of other programs.

use super::*;
use crate::film::to_byte;
use proptest::prelude::*;

/// Reads a PPM whose only row has these bytes.
fn of_bytes(bytes: &[u8], encoding: Encoding) -> ReadPicture {
    let header = format!("P6 {} 1 255 ", bytes.len() / 3);
    let file = [header.as_bytes(), bytes].concat();
    decode_picture(io::Cursor::new(&file), file.len() as u64, encoding).unwrap()
}

#[test]
fn whole_numbers_end_where_the_last_of_them_begins() {
    let srgb = ((254.5 / 255.0_f64 + 0.055) / 1.055).powf(2.4);
    for (encoding, limit) in [
        (Encoding::Book(Transfer::Linear), 255.0 / 256.0),
        (Encoding::Book(Transfer::Gamma2), (255.0_f64 / 256.0).powi(2)),
        (Encoding::Srgb, srgb),
    ] {
        let read = of_bytes(&[254, 255, 0], encoding);
        assert!((read.limit - limit).abs() < 1e-12, "{encoding:?}: {}", read.limit);
        let [below, end, zero] = read.pixels[0];
        assert!(below < read.limit && end.is_nan() && zero < below, "{:?}", read.pixels);
    }
}

#[test]
fn where_rows_have_two_transfers_the_lower_limit_counts() {
    let file = b"P6 1 2 255 \x80\x80\x80\x80\x80\x80";
    let encoding = Encoding::Book(Transfer::LinearAboveGamma2);
    let read = decode_picture(io::Cursor::new(file), file.len() as u64, encoding).unwrap();
    assert!(read.pixels[0][0] > 0.5 && read.pixels[1][0] < 0.3, "{:?}", read.pixels);
    assert_eq!(read.limit, (255.0_f64 / 256.0).powi(2));
}

proptest! {
    #[test]
    fn a_byte_stands_for_the_values_that_become_it(x in 0.0..1.2_f64) {
        for transfer in [Transfer::Linear, Transfer::Gamma2] {
            let byte = to_byte(x, transfer, 0, 1);
            let [low, high] = Encoding::Book(transfer).interval(byte.into(), 256, 0, 1);
            if byte == 255 {
                prop_assert!(low.is_nan());
            } else {
                prop_assert!(low <= x && x < high, "{x}: {low} to {high}");
            }
        }
    }

    #[test]
    fn srgb_is_read_within_its_steps(x in 0.0..0.99_f64) {
        let v = if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 };
        let byte = (255.0 * v).round() as u16;
        if byte < 255 {
            let [low, high] = Encoding::Srgb.interval(byte, 256, 0, 1);
            prop_assert!(low - 1e-9 <= x && x <= high + 1e-9, "{x}: {low} to {high}");
        }
    }
}

#[test]
fn an_exr_that_deflates_well_is_no_short_file() {
    use exr::prelude::*;
    let (width, height) = (512, 512);
    let black = SpecificChannels::rgb(|_: Vec2<usize>| (0.0_f32, 0.0_f32, 0.0_f32));
    for compression in [Compression::ZIP1, Compression::ZIP16] {
        let encoding = Encoding { compression, ..Encoding::FAST_LOSSLESS };
        let layer = Layer::new((width, height), LayerAttributes::default(), encoding, black.clone());
        let mut file = io::Cursor::new(Vec::new());
        Image::from_layer(layer).write().to_buffered(&mut file).unwrap();
        let bytes = file.into_inner();
        assert!(compression == Compression::ZIP1 || bytes.len() * 300 < width * height * 12);
        let (found_width, found_height, pixels) =
            read_exr(io::Cursor::new(&bytes), bytes.len() as u64).unwrap();
        assert_eq!((found_width as usize, found_height as usize), (width, height));
        assert!(pixels.iter().flatten().all(|x| *x == 0.0), "{compression:?}");
    }
}

#[test]
fn sixteen_bits_have_as_many_levels() {
    let file = b"P6 1 1 65535 \xff\xff\x80\x00\x00\x00";
    let encoding = Encoding::Book(Transfer::Linear);
    let read = decode_picture(io::Cursor::new(file), file.len() as u64, encoding).unwrap();
    let [end, middle, zero] = read.pixels[0];
    assert!(end.is_nan());
    assert_eq!([middle, zero, read.limit], [32_768.5, 0.5, 65_535.0].map(|level| level / 65_536.0));
}

/// Checks that a picture of one row of gray pixels, in linear values, has these intervals.
fn assert_intervals(file: &[u8], intervals: &[[f64; 2]], limit: f64) {
    let encoding = Encoding::Book(Transfer::Linear);
    let read = decode_picture(io::Cursor::new(file), file.len() as u64, encoding).unwrap();
    let steps = read.steps.unwrap();
    assert_eq!(read.pixels.len(), intervals.len());
    for (index, [low, high]) in intervals.iter().enumerate() {
        let found = read.pixels[index].iter().zip(steps[index]);
        for [from, to] in found.map(|(middle, step)| [middle - step, middle + step]) {
            let is_near =
                |found: f64, end: f64| (found - end).abs() < 1e-12 || (found.is_nan() && end.is_nan());
            assert!(
                is_near(from, *low) && is_near(to, *high),
                "{index}: {from} to {to}, not {low} to {high}"
            );
        }
    }
    assert!((read.limit - limit).abs() < 1e-12, "{}", read.limit);
}

#[test]
fn a_pnm_has_as_many_levels_as_its_header_says() {
    let unknown = [f64::NAN; 2];
    let of_32 = [[0.0, 1.0 / 32.0], [15.5 / 31.0, 16.5 / 31.0], [30.0 / 32.0, 30.5 / 31.0], unknown];
    assert_intervals(b"P5 4 1 31 \x00\x10\x1e\x1f", &of_32, 31.0 / 32.0);
    assert_intervals(b"P3 4 1 31 0 0 0 16 16 16 30 30 30 31 31 31 ", &of_32, 31.0 / 32.0);
    let of_1024 = [[511.5 / 1023.0, 512.5 / 1023.0], unknown];
    assert_intervals(b"P5 2 1 1023 \x02\x00\x03\xff", &of_1024, 1023.0 / 1024.0);
    // In a bitmap, 1 is black.
    assert_intervals(b"P4 2 1 \x80", &[[0.0, 0.5], unknown], 0.5);
}

/// A PNG of one row, perhaps with a chunk that says how many bits are significant.
fn png_of(
    colour: ::png::ColorType,
    depth: ::png::BitDepth,
    width: u32,
    row: &[u8],
    significant: &[u8],
) -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = ::png::Encoder::new(&mut file, width, 1);
    encoder.set_color(colour);
    encoder.set_depth(depth);
    if colour == ::png::ColorType::Indexed {
        encoder.set_palette(vec![0x80; 3]);
    }
    let mut writer = encoder.write_header().unwrap();
    if !significant.is_empty() {
        writer.write_chunk(::png::chunk::sBIT, significant).unwrap();
    }
    writer.write_image_data(row).unwrap();
    writer.finish().unwrap();
    file
}

#[test]
fn a_png_has_as_many_levels_as_its_bits_and_its_palette_has_256() {
    use ::png::{BitDepth, ColorType};
    let unknown = [f64::NAN; 2];
    let gray = |depth, width, row: &[u8]| png_of(ColorType::Grayscale, depth, width, row, &[]);
    let of_16 = [[0.0, 1.0 / 16.0], [6.5 / 15.0, 0.5], unknown];
    assert_intervals(&gray(BitDepth::Four, 3, b"\x07\xf0"), &of_16, 15.0 / 16.0);
    assert_intervals(&gray(BitDepth::Two, 2, b"\x30"), &[[0.0, 0.25], unknown], 0.75);
    assert_intervals(&gray(BitDepth::One, 2, b"\x40"), &[[0.0, 0.5], unknown], 0.5);
    let of_256 = [[128.0 / 256.0, 129.0 / 256.0]];
    assert_intervals(&gray(BitDepth::Eight, 1, b"\x80"), &of_256, 255.0 / 256.0);
    let palette = png_of(ColorType::Indexed, BitDepth::One, 1, b"\x00", &[]);
    assert_intervals(&palette, &of_256, 255.0 / 256.0);
    // 5 of 8 bits, as programs write them that scale pictures up to 8 bits.
    let scaled = png_of(ColorType::Rgb, BitDepth::Eight, 2, b"\x84\x84\x84\xff\xff\xff", &[5, 5, 5]);
    assert_intervals(&scaled, &[[15.5 / 31.0, 16.5 / 31.0], unknown], 31.0 / 32.0);
}

#[test]
fn of_significant_bits_the_fewest_of_the_colours_count_and_those_of_alpha_do_not() {
    use ::png::{BitDepth, ColorType};
    let of_256 = [[128.0 / 256.0, 129.0 / 256.0]];
    let rgba = png_of(ColorType::Rgba, BitDepth::Eight, 1, b"\x80\x80\x80\x10", &[8, 8, 8, 2]);
    assert_intervals(&rgba, &of_256, 255.0 / 256.0);
    let grey = png_of(ColorType::GrayscaleAlpha, BitDepth::Eight, 1, b"\x80\x10", &[8, 3]);
    assert_intervals(&grey, &of_256, 255.0 / 256.0);
    let of_32 = [[15.5 / 31.0, 16.5 / 31.0], [f64::NAN; 2]];
    for significant in [[5, 6, 8], [8, 5, 6], [6, 8, 5]] {
        let row = b"\x84\x84\x84\xff\xff\xff";
        let scaled = png_of(ColorType::Rgb, BitDepth::Eight, 2, row, &significant);
        assert_intervals(&scaled, &of_32, 31.0 / 32.0);
    }
    let deep = png_of(ColorType::Grayscale, BitDepth::Sixteen, 2, b"\x80\x00\xff\xff", &[]);
    let of_65536 = [[32_768.0 / 65_536.0, 32_769.0 / 65_536.0], [f64::NAN; 2]];
    assert_intervals(&deep, &of_65536, 65_535.0 / 65_536.0);
}

/// A byte of a bitmap has eight pixels, so no PNM is shorter than an eighth of what becomes of it.
#[test]
fn a_pnm_that_is_too_short_for_its_size_is_refused_before_memory_is_allocated() {
    let told = |length: u64| {
        let header = io::Cursor::new(b"P6 160 100 255 ");
        decode_picture(header, length, Encoding::Srgb).unwrap_err().to_string()
    };
    assert_eq!(told(5999), "it has 5999 bytes, but 160x100 pixels need at least 6000");
    assert!(!told(6000).contains("need at least"), "{}", told(6000));
}
