//! Formats, sizes and damages of pictures.

use super::*;

fn bytes(file: &str) -> Vec<[u8; 3]> {
    Mine::decode(file.as_bytes()).unwrap().bytes
}

fn reason(file: &[u8]) -> String {
    Mine::decode(file).unwrap_err()
}

#[test]
fn values_are_scaled_by_the_largest_one() {
    assert_eq!(bytes("P3 1 1 255 0 128 255"), [[0, 128, 255]]);
    assert_eq!(bytes("P3 1 1 1 0 1 1"), [[0, 255, 255]]);
    assert_eq!(bytes("P3 1 1 65535 0 32768 65535"), [[0, 127, 255]]);
    assert_eq!(bytes("P3 1 1 100 50 99 -7"), [[127, 252, 0]]);
    for most in ["0", "65536", "-1"] {
        let told = reason(format!("P3 1 1 {most} 0 0 0").as_bytes());
        assert!(told.contains(&format!("its largest value is {most};")), "{told}");
    }
    assert!(reason(b"P6 1 1 254 abc").contains("its largest value is 254"));
}

#[test]
fn a_size_is_refused_from_one_pixel_above_the_limit_on() {
    for (size, part) in [
        ("2000 2000", "need 12000000"),
        ("4000001 1", "more than 4000000"),
        ("1 4000001", "more than 4000000"),
        ("5 0", "header says 5 x 0"),
    ] {
        for kind in ["P3", "P6"] {
            let told = reason(format!("{kind} {size} 255\n1").as_bytes());
            assert!(told.contains(part), "{kind}: {told}");
        }
    }
    let told = reason(b"P3 2 3 255 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17");
    assert!(told.contains("need 18 numbers, but there are 17: 2 of 3 rows"), "{told}");
}

#[test]
fn comments_and_line_ends_do_not_matter() {
    let expected = [[1, 2, 3], [4, 5, 6]];
    for file in [
        "P3\n# a\n2 # b\n1\n# c 9 9\n255\n1 2 3 4 5 6",
        "P3\r2 1\r255\r1 2 3\r4 5 6",
        "P3\r\n2\t1 255\r\n1 2 3\r\n4 5 6\r\n",
    ] {
        let mine = Mine::decode(file.as_bytes()).unwrap();
        assert_eq!((&mine.bytes[..], mine.damages.len(), mine.format), (&expected[..], 0, "P3"), "{file:?}");
    }
    let mine = Mine::decode(b"P6 # a\n2\n#b\n# c\n1 255\n\x01\x02\x03\x04\x05\x06and more").unwrap();
    assert_eq!((&mine.bytes[..], mine.damages.len(), mine.format), (&expected[..], 0, "P6"));
    // White space after the header is one byte; more of it belongs to the pixels.
    let mine = Mine::decode(b"P6 1 1 255\n\n\r\n").unwrap();
    assert_eq!(mine.bytes, [[b'\n', b'\r', b'\n']]);
    assert!(reason(b"P6 2 # no end").contains("header is not complete"));
    assert!(reason(b"P6 2 -1 255").contains("header is not complete"));
}

#[test]
fn a_binary_file_that_was_written_as_text_is_repaired() {
    let mine = Mine::decode(b"P6\r\n1 1\r\n255\r\n\r\n\r\x07").unwrap();
    assert_eq!((mine.bytes, mine.damages.len()), (vec![[b'\n', b'\r', 7]], 1));
    // Without a byte too many there is nothing to repair.
    let mine = Mine::decode(b"P6\r\n1 1\r\n255\r\n\r\n\x07").unwrap();
    assert_eq!((mine.bytes, mine.damages.len()), (vec![[b'\r', b'\n', 7]], 0));
}

#[test]
fn damages_are_counted() {
    let file = "hello\nP3\n2 1\n255\nScanlines: 2\n1 2.5 3\nDone.\n\n300 -1 1e3 8 9";
    let mine = Mine::decode(file.as_bytes()).unwrap();
    let titles: Vec<&str> = mine.damages.iter().map(|damage| damage.title.as_str()).collect();
    assert_eq!(
        titles,
        [
            "there is other text before the header",
            "2 lines of the file are messages, not numbers",
            "2 values are not whole numbers",
            "there are 8 numbers, but 2 x 1 pixels need 6",
            "3 numbers are below 0 or above 255",
        ]
    );
    assert_eq!(mine.bytes, [[1, 2, 3], [255, 0, 255]]);
}

/// Writes pixels as a P3 of 16 x 9 and reads it.
fn read(value: impl Fn(usize) -> [u8; 3]) -> Result<Mine, ReadError> {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("mine.ppm");
    let pixels: String = (0..16 * 9).map(value).map(|[r, g, b]| format!("{r} {g} {b}\n")).collect();
    std::fs::write(&path, format!("P3\n16 9\n255\n{pixels}")).unwrap();
    Mine::read(&path)
}

#[test]
fn a_picture_of_one_value_is_refused_with_what_to_look_at() {
    for (value, part) in [([0; 3], "int(x) * 256"), ([255; 3], "number of samples"), ([9, 8, 7], "ray_color")]
    {
        let refused = read(|_| value).unwrap_err().to_string();
        let [r, g, b] = value;
        assert!(refused.contains(&format!("all its pixels are {r} {g} {b}, so")), "{refused}");
        assert!(refused.contains(part), "{refused}");
    }
    assert!(read(|pixel| if pixel == 100 { [1, 0, 0] } else { [0; 3] }).is_ok());
}

#[test]
fn transparent_pixels_are_counted() {
    let png = |alpha: fn(u32) -> u8, colour: u8| {
        let image =
            image::RgbaImage::from_fn(16, 9, |x, y| image::Rgba([colour, x as u8, y as u8, alpha(x)]));
        let mut file = Cursor::new(Vec::new());
        image.write_to(&mut file, image::ImageFormat::Png).unwrap();
        Mine::decode(file.get_ref()).unwrap()
    };
    assert!(png(|_| 255, 7).damages.is_empty());
    let some = png(|x| if x < 2 { 200 } else { 255 }, 7);
    assert_eq!(some.bytes[17], [7, 1, 1]);
    assert!(some.damages[0].title.starts_with("18 pixels are transparent"), "{:?}", some.damages);
    let all = png(|_| 0, 7);
    assert!(all.damages[0].title.starts_with("144 pixels are transparent"), "{:?}", all.damages);
    let nothing = Mine { bytes: vec![[0; 3]; 144], ..all };
    let refused = nothing.worth_checking().unwrap_err();
    assert!(refused.contains("144 pixels are transparent") && !refused.contains("int(x)"), "{refused}");
}
