//! Values of flags, accepted and refused.

use super::*;

const PORTABLE: Level = Level(Some(Isa::Portable));

#[test]
fn values_are_read() {
    assert_eq!(parse_size("800x450"), Ok((800, 450)));
    assert_eq!(parse_vector("-2, 2,1e3"), Ok(DVec3::new(-2.0, 2.0, 1000.0)));
    assert_eq!(parse_sample_range("64..128"), Ok(64..128));
    assert_eq!(parse_simd("off"), Ok(Simd(Some(1))));
    assert_eq!(parse_simd("16"), Ok(Simd(Some(16))));
    assert_eq!(parse_isa("sse4.2"), Ok(Level(Some(Isa::Sse42))));
    assert_eq!((parse_isa("portable"), parse_isa("baseline")), (Ok(PORTABLE), Ok(PORTABLE)));
    assert_eq!(parse_pixel("3, 4"), Ok([3, 4]));
    assert_eq!(parse_sides("portable,gpu"), Ok([RawSide::Portable, RawSide::Gpu]));
    assert_eq!(parse_levels("avx2, sse4.2,avx2"), Ok(Levels::Named(vec![Isa::Sse42, Isa::Avx2])));
    assert_eq!(parse_counts("1e3..2e4").as_deref(), Ok(&[1000, 3000, 10_000][..]));
    assert_eq!(parse_counts("7..7").as_deref(), Ok(&[7][..]));
    assert_eq!(parse_tolerance("0"), Ok(0.0));
    assert_eq!(whole(2..=u64::MAX, 7)("18446744073709551615"), Ok(u64::MAX));
    assert_eq!(parse_noise_target("3.1e-8"), Ok(3.1e-8));
}

#[test]
fn times_have_units() {
    let seconds = |text| parse_duration(text).map(|time| time.as_secs_f64());
    for (text, time) in [("60s", 60.0), ("5m", 300.0), ("1.5h", 5400.0), ("2 min", 120.0), ("250ms", 0.25)] {
        assert_eq!(seconds(text), Ok(time), "{text}");
    }
    assert_eq!((seconds("90"), seconds("30d"), seconds("0.1s")), (Ok(90.0), Ok(2_592_000.0), Ok(0.1)));
    for text in ["", "s", "-5s", "0", "0s", "31d", "1e300h", "nan", "inf s", "5 weeks", "1h30m", "99ms"] {
        assert!(parse_duration(text).unwrap_err().contains("30d"), "{text}");
    }
}

#[test]
fn nonsense_is_refused_with_what_is_allowed() {
    for text in ["", "800", "800x", "x", "0x450", "800x16385", "99999999999x1", "-8x4"] {
        assert!(parse_size(text).unwrap_err().contains("16384"), "{text}");
    }
    for text in ["", "1,2", "1,2,3,4", "a,b,c"] {
        assert!(parse_vector(text).is_err(), "{text}");
    }
    for text in ["", "5", "5..5", "6..5", "0..4294967297", "-1..5", "a..b"] {
        assert!(parse_sample_range(text).unwrap_err().contains("4294967296"), "{text}");
    }
    for text in ["0", "-1", "nan", "inf", "x", ""] {
        assert!(parse_seconds(text).is_err() && parse_rmse(text).is_err(), "{text}");
    }
    assert!(parse_simd("3").is_err() && parse_isa("mmx").is_err());
    for text in ["", "1", "1,", "-1,2", "1,2,3", "a,b"] {
        assert!(parse_pixel(text).is_err(), "{text}");
    }
    for text in ["", "cpu", "cpu,tpu", "cpu,gpu,reference"] {
        assert!(parse_sides(text).unwrap_err().contains("portable"), "{text}");
    }
    for text in ["", "auto,avx2", "avx2,", "mmx"] {
        assert!(parse_levels(text).unwrap_err().contains("sse4.2"), "{text}");
    }
    for text in ["", "5", "0..5", "10..9", "1e3..1e8", "nan..5", "1.5..3", "-1..5"] {
        assert!(parse_counts(text).unwrap_err().contains("10000000"), "{text}");
    }
    for text in ["", "-1", "nan", "2"] {
        assert!(parse_tolerance(text).is_err(), "{text}");
    }
    for text in ["", "1e3", "0", "11", "-1", "2.5", "99999999999999999999", "many"] {
        let expected = "must be a whole number from 1 to 10, such as 7";
        assert_eq!(whole(1..=10_u64, 7)(text), Err(expected.to_owned()), "{text}");
    }
    for text in ["", "0", "1e-9", "2.9e-8", "101", "nan", "1e400"] {
        assert!(
            parse_noise_target(text).unwrap_err().contains("above 3e-8, which rounding can cost"),
            "{text}"
        );
    }
    for text in ["1e400", "-1e400", "inf", "nan", "x", ""] {
        assert!(parse_vfov(text).unwrap_err().contains("within 0.01 and 179"), "{text}");
        assert!(parse_defocus_angle(text).unwrap_err().contains("from 0 to below 179"), "{text}");
        assert!(parse_focus_distance(text).unwrap_err().contains("within 1e-18 and 1e19"), "{text}");
        let vector = format!("1,{text},2");
        assert!(parse_vector(&vector).unwrap_err().contains("each within -1e18 and 1e18"), "{text}");
    }
}

#[test]
fn the_limits_themselves_are_accepted() {
    assert_eq!([parse_size("16384x1"), parse_size("1x16384")], [Ok((16384, 1)), Ok((1, 16384))]);
    assert_eq!([whole(1..=10, 7)("1"), whole(1..=10, 7)("10")], [Ok(1), Ok(10)]);
    assert_eq!(
        [parse_seconds("1e9"), parse_rmse("100"), parse_noise_target("100")],
        [Ok(1e9), Ok(1e2), Ok(1e2)]
    );
    assert!(parse_seconds("1.1e9").is_err() && parse_rmse("100.1").is_err());
    assert_eq!([parse_tolerance("0"), parse_tolerance("1")], [Ok(0.0), Ok(1.0)]);
    assert!(parse_tolerance("1.001").is_err() && parse_tolerance("-0.001").is_err());
    assert_eq!(parse_sample_range("4294967295 .. 4294967296"), Ok(4_294_967_295..4_294_967_296));
    assert_eq!(parse_frames("99999..100000"), Ok(99_999..100_000));
    assert_eq!(
        parse_counts("1..1e7").map(|counts| (counts.len(), counts.last().copied())),
        Ok((15, Some(10_000_000)))
    );
}

#[test]
fn spheres_are_counted_in_steps_of_about_three() {
    for (text, counts) in
        [("1..10", &[1, 3, 10][..]), ("20..600", &[20, 60, 200, 600]), ("20..599", &[20, 60, 200])]
    {
        assert_eq!(parse_counts(text).as_deref(), Ok(counts), "{text}");
    }
}

#[test]
fn lanes_levels_and_sides_have_names() {
    let lanes = ["auto", "off", "1", "4", "8", "16"].map(parse_simd);
    assert_eq!(lanes, [None, Some(1), Some(1), Some(4), Some(8), Some(16)].map(|lanes| Ok(Simd(lanes))));
    assert_eq!(parse_isa("auto"), Ok(Level(None)));
    for isa in Isa::ALL {
        assert_eq!(parse_isa(isa.name()), Ok(Level(Some(isa))));
        assert_eq!(parse_levels(isa.name()), Ok(Levels::Named(vec![isa])));
    }
    assert_eq!([parse_levels("auto"), parse_levels("all")], [Ok(Levels::Auto), Ok(Levels::All)]);
    assert_eq!(parse_sides("cpu, reference"), Ok([RawSide::Cpu, RawSide::Reference]));
    assert_eq!(parse_sides("reference,cpu"), Ok([RawSide::Reference, RawSide::Cpu]));
}

#[test]
fn turns_are_frames_or_degrees_and_rates_may_be_fractions() {
    for (text, turn) in [
        ("2", Turn::FramesPerTurn(2)),
        ("100000", Turn::FramesPerTurn(100_000)),
        ("180deg", Turn::DegreesPerFrame(180.0)),
        ("-180 deg", Turn::DegreesPerFrame(-180.0)),
        ("0.5deg", Turn::DegreesPerFrame(0.5)),
    ] {
        assert_eq!(parse_turn(text), Ok(turn), "{text}");
    }
    for text in ["1", "100001", "180.5deg", "-180.5deg", "0deg"] {
        assert!(parse_turn(text).is_err(), "{text}");
    }
    for (text, frames, seconds) in [("65535", 65535, 1), ("25/2", 25, 2), ("30000 / 1001", 30_000, 1001)] {
        assert_eq!(parse_rate(text), Ok(FrameRate { frames, seconds }), "{text}");
    }
    for text in ["65536", "0/1", "1/0", "1/65536", "-1"] {
        assert!(parse_rate(text).is_err(), "{text}");
    }
}
