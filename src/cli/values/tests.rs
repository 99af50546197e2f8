//! Values of flags, accepted and refused.

use super::*;

#[test]
fn values_are_read_up_to_their_limits() {
    assert_eq!(parse_size("800x450"), Ok((800, 450)));
    assert_eq!([parse_size("16384x1"), parse_size("1x16384")], [Ok((16384, 1)), Ok((1, 16384))]);
    assert_eq!(parse_vector("-2, 2,1e3"), Ok(DVec3::new(-2.0, 2.0, 1000.0)));
    assert_eq!(range(128_u64, "")("64 .. 128"), Ok(64..128));
    assert_eq!(number(.., "")("-2.5"), Ok(-2.5));
    let lanes = ["auto", "off", "1", "4", "8", "16"].map(parse_simd);
    assert_eq!(lanes, [None, Some(1), Some(1), Some(4), Some(8), Some(16)].map(Ok));
    assert_eq!([parse_isa("auto"), parse_isa("portable")], [Ok(None), Ok(Some(Isa::Portable))]);
    assert_eq!([parse_levels("auto"), parse_levels("all")], [None, Some(Isa::available())].map(Ok));
    assert_eq!(parse_levels("portable, portable"), Ok(Some(vec![Isa::Portable])));
    assert_eq!(["0", "1"].map(number(0.0..=1.0, "")), [Ok(0.0), Ok(1.0)]);
    assert_eq!([parse_seconds("1e9"), parse_noise_target("3.1e-8")], [Ok(1e9), Ok(3.1e-8)]);
}

#[test]
fn times_have_units() {
    let seconds = |text| parse_duration(text).map(|time| time.as_secs_f64());
    for (text, time) in [
        ("60s", 60.0),
        ("5m", 300.0),
        ("1.5h", 5400.0),
        ("2 min", 120.0),
        ("250ms", 0.25),
        ("90", 90.0),
        ("30d", 2_592_000.0),
        ("0.1s", 0.1),
    ] {
        assert_eq!(seconds(text), Ok(time), "{text}");
    }
    for text in ["", "s", "-5s", "0", "31d", "1e300h", "nan", "5 weeks", "1h30m", "99ms"] {
        assert!(parse_duration(text).unwrap_err().contains("30d"), "{text}");
    }
}

#[test]
fn refusals_name_what_is_allowed() {
    type Refusal = fn(&str) -> Option<String>;
    let cases: [(Refusal, &[&str], &str); 6] = [
        (|text| parse_size(text).err(), &["", "800", "800x", "0x450", "800x16385", "-8x4"], "16384"),
        (|text| parse_vector(text).err(), &["", "1,2", "1,2,3,4", "a,b,c", "1,nan,2"], "three numbers"),
        (|text| range(128_u64, "")(text).err(), &["", "5", "5..5", "6..5", "0..129", "-1..5"], "at most 128"),
        (|text| parse_seconds(text).err(), &["0", "-1", "nan", "inf", "x", ""], ""),
        (|text| parse_levels(text).err(), &["", "auto,avx2", "avx2,", "mmx"], "sse4.2"),
        (|text| parse_noise_target(text).err(), &["", "0", "1e-9", "101", "nan"], "above 3e-8"),
    ];
    for (refusal, texts, part) in cases {
        for text in texts {
            assert!(refusal(text).is_some_and(|message| message.contains(part)), "{text}");
        }
    }
    assert!(parse_simd("3").is_err() && parse_isa("mmx").is_err());
    assert!(number(0.0..=1.0, "")("1.001").is_err() && number(.., "")("inf").is_err());
}
