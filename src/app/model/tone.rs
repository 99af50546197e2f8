//! How bright the picture is shown. Files are saved without it.

use crate::progressive::View;
use eframe::egui::Key;
use serde::{Deserialize, Serialize};

/// The exposure of the picture, and the range of the luminance view.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tone {
    /// Radiance is multiplied by two to the power of this many stops.
    pub exposure: f64,
    /// The only channel that is shown, as grey.
    pub channel: Option<Channel>,
    /// The darkest and the brightest luminance of the luminance view, as powers of two.
    pub range: [f64; 2],
}

/// A channel of the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Channel {
    Red,
    Green,
    Blue,
}

impl Channel {
    pub const ALL: [Channel; 3] = [Channel::Red, Channel::Green, Channel::Blue];

    pub fn name(self) -> &'static str {
        match self {
            Channel::Red => "Only red",
            Channel::Green => "Only green",
            Channel::Blue => "Only blue",
        }
    }

    pub fn key(self) -> Key {
        match self {
            Channel::Red => Key::R,
            Channel::Green => Key::G,
            Channel::Blue => Key::B,
        }
    }
}

impl Default for Tone {
    fn default() -> Self {
        Tone { exposure: 0.0, channel: None, range: [-8.0, 4.0] }
    }
}

impl Tone {
    /// Stops that a key changes the exposure by.
    pub const STEP: f64 = 0.5;

    /// The largest exposure and the smallest, in stops.
    pub const EXPOSURES: std::ops::RangeInclusive<f64> = -12.0..=12.0;

    /// Makes the picture brighter by this many stops, as far as the limits allow.
    pub fn expose(&mut self, stops: f64) {
        self.exposure = (self.exposure + stops).clamp(*Self::EXPOSURES.start(), *Self::EXPOSURES.end());
    }

    /// Shows this channel alone, or all again.
    pub fn toggle(&mut self, channel: Channel) {
        self.channel = if self.channel == Some(channel) { None } else { Some(channel) };
    }

    /// The radiance that is shown as white.
    pub fn white(&self) -> f64 {
        (-self.exposure).exp2()
    }

    /// The view of the picture.
    pub fn of_picture(&self) -> View {
        match self.channel {
            None if self.exposure == 0.0 => View::Picture,
            channel => View::Exposed(self.exposure, channel.map(|channel| channel as usize)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exposure_stays_within_its_limits() {
        let mut tone = Tone::default();
        assert_eq!((tone.white(), tone.of_picture()), (1.0, View::Picture));
        tone.expose(1.5);
        assert_eq!((tone.exposure, tone.of_picture()), (1.5, View::Exposed(1.5, None)));
        tone.expose(-3.5);
        assert_eq!(tone.white(), 4.0);
        tone.expose(-1e3);
        assert_eq!(tone.exposure, -12.0);
    }
}
