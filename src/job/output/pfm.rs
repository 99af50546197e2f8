//! PFM: linear float RGB or grey, bottom row first, as other renderers write it.
//!
//! Source: Paul Debevec, "PFM Portable FloatMap Image Format".

use super::limits::{check_memory, invalid, pixel_count};
use std::io::{self, BufRead, Read};

/// Longest word of the header, bytes.
const WORD_LIMIT: usize = 32;

/// Reads width, height and linear RGB, top row first, from a file of `length` bytes. Grey becomes three equal channels.
pub(super) fn read(mut reader: impl BufRead, length: u64) -> io::Result<(u32, u32, Vec<[f32; 3]>)> {
    let channels = match word(&mut reader)?.as_str() {
        "PF" => 3,
        "Pf" => 1,
        other => return Err(invalid(format!("it begins with {other:?}; a PFM begins with PF or Pf"))),
    };
    let mut side = |what: &str| -> io::Result<u32> {
        let text = word(&mut reader)?;
        text.parse().map_err(|_| invalid(format!("its {what} is {text:?}")))
    };
    let (width, height) = (side("width")?, side("height")?);
    let text = word(&mut reader)?;
    let scale: f32 = text.parse().map_err(|_| invalid(format!("its scale is {text:?}")))?;
    let count = pixel_count(width, height)? * channels;
    if length < 4 * count as u64 {
        return Err(invalid(format!("it has {length} bytes, but its pixels alone need {}", 4 * count)));
    }
    check_memory(width, height)?;
    let mut bytes = Vec::new();
    bytes.try_reserve_exact(4 * count)?;
    reader.take(4 * count as u64).read_to_end(&mut bytes)?;
    if bytes.len() != 4 * count {
        return Err(invalid(format!("its pixels end after {} of {} bytes", bytes.len(), 4 * count)));
    }
    let (words, _) = bytes.as_chunks::<4>();
    // The scale's sign tells the byte order. Its magnitude is a unit that renderers leave at 1; it is ignored.
    let value =
        |word: &[u8; 4]| if scale < 0.0 { f32::from_le_bytes(*word) } else { f32::from_be_bytes(*word) };
    let rows = words.chunks_exact(width as usize * channels).rev();
    let pixels = rows
        .flat_map(|row| row.chunks_exact(channels))
        .map(|pixel| [0, 1, 2].map(|channel: usize| value(&pixel[channel.min(channels - 1)])))
        .collect();
    Ok((width, height, pixels))
}

/// Reads the next word of the header and one whitespace character after it.
fn word(reader: &mut impl BufRead) -> io::Result<String> {
    let mut text = String::new();
    loop {
        let mut byte = [0];
        reader.read_exact(&mut byte)?;
        match byte[0] {
            space if space.is_ascii_whitespace() && text.is_empty() => {}
            space if space.is_ascii_whitespace() => return Ok(text),
            other if text.len() < WORD_LIMIT && other.is_ascii_graphic() => text.push(char::from(other)),
            _ => return Err(invalid("it has no PFM header".to_owned())),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(header: &str, values: &[f32], little: bool) -> Vec<u8> {
        let bytes = values.iter().flat_map(|x| if little { x.to_le_bytes() } else { x.to_be_bytes() });
        header.bytes().chain(bytes).collect()
    }

    fn read(bytes: &[u8]) -> io::Result<(u32, u32, Vec<[f32; 3]>)> {
        super::read(bytes, bytes.len() as u64)
    }

    #[test]
    fn rows_are_flipped_and_both_byte_orders_read() {
        let values: Vec<f32> = (0..12).map(|i| i as f32).collect();
        let expected = vec![[6.0, 7.0, 8.0], [9.0, 10.0, 11.0], [0.0, 1.0, 2.0], [3.0, 4.0, 5.0]];
        for (header, little) in [("PF\n2 2\n-1.0\n", true), ("PF 2 2 1\n", false)] {
            let found = read(&file(header, &values, little)).unwrap();
            assert_eq!(found, (2, 2, expected.clone()));
        }
        let grey = read(&file("Pf\n1 2\n-1\n", &[0.25, 0.5], true)).unwrap();
        assert_eq!(grey, (1, 2, vec![[0.5; 3], [0.25; 3]]));
    }

    #[test]
    fn invalid_pfm_is_refused_with_a_reason() {
        let cases: [(&[u8], &str); 6] = [
            (b"P6\n1 1\n255\n", "\"P6\""),
            (b"PF\nx 1\n-1\n", "width"),
            (b"PF\n0 1\n-1\n", "0x1"),
            (b"PF\n99999 99999\n-1\n", "99999x99999"),
            (b"PF\n9999 9999\n-1\n1234", "it has 20 bytes, but its pixels alone need 1199760012"),
            (b"PF\n2 1\n-1\n12345678901234567890", "20 of 24 bytes"),
        ];
        for (bytes, part) in cases {
            let message = read(bytes).unwrap_err().to_string();
            assert!(message.contains(part), "{message}");
        }
    }
}
