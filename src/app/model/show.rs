//! The views of a film, and how bright the picture is shown. Files are saved without that.

use crate::backends::layers::Layer;
use crate::numbers::heat::HeatScale;
use crate::progressive::View;
use crate::stages::Means;
use serde::{Deserialize, Serialize};

/// A view of the film.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Show {
    /// The rendered picture.
    #[default]
    Picture,
    /// Normals at the first hit.
    Normals,
    /// Albedo of the materials at the first hit.
    Albedo,
    /// Rays per path.
    Bounces,
    /// Standard error of each pixel.
    Error,
    /// Luminance in false colours.
    Luminance,
}

impl Show {
    /// All views.
    pub const ALL: [Show; 6] =
        [Show::Picture, Show::Normals, Show::Albedo, Show::Bounces, Show::Error, Show::Luminance];

    /// The view that a sight needs.
    pub fn of_means(means: Means) -> Show {
        match means {
            Means::Picture | Means::Wipe(_) => Show::Picture,
            Means::Albedo => Show::Albedo,
            Means::RaysPerPath => Show::Bounces,
            Means::StandardError => Show::Error,
            Means::Luminance(_) => Show::Luminance,
        }
    }

    /// Its name in menus, one sentence about it, and other words by which the palette finds it.
    pub fn words(self) -> [&'static str; 3] {
        match self {
            Show::Picture => ["Picture", "The picture as it will be saved", "view"],
            Show::Normals => {
                ["Normals", "Which way surfaces face: x is red, y green, z blue", "view direction"]
            }
            Show::Albedo => {
                ["Surface colours", "What surfaces reflect (albedo), without light", "view albedo"]
            }
            Show::Bounces => {
                ["Rays per path", "How many rays a path has: where the time goes", "view depth bounces"]
            }
            Show::Error => [
                "Error",
                "How uncertain each pixel still is (standard error)",
                "view grain quality spp samples",
            ],
            Show::Luminance => [
                "Brightness",
                "How bright each pixel is, in false colours with a scale",
                "view heat luminance",
            ],
        }
    }

    pub fn name(self) -> &'static str {
        self.words()[0]
    }

    /// The layer, if the view shows one.
    pub fn layer(self) -> Option<Layer> {
        match self {
            Show::Normals => Some(Layer::Normals),
            Show::Albedo => Some(Layer::Albedo),
            Show::Bounces => Some(Layer::RaysPerPath),
            Show::Picture | Show::Error | Show::Luminance => None,
        }
    }

    /// The view for resolving the film.
    pub fn of_film(self, tone: &Tone) -> View {
        match self {
            Show::Error => View::StandardError,
            Show::Luminance => View::Luminance(tone.range),
            Show::Picture | Show::Normals | Show::Albedo | Show::Bounces => tone.of_picture(),
        }
    }

    /// The scale, if the view is a heat map.
    pub fn scale(self, tone: &Tone) -> Option<HeatScale> {
        match self {
            Show::Luminance => Some(HeatScale::luminance(tone.range)),
            Show::Bounces => Some(HeatScale::RAYS),
            Show::Error => Some(HeatScale::ERROR),
            Show::Picture | Show::Normals | Show::Albedo => None,
        }
    }
}

/// The exposure of the picture, and the range of the luminance view.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tone {
    /// Radiance is multiplied by two to the power of this many stops.
    pub exposure: f64,
    /// The darkest and the brightest luminance of the luminance view, as powers of two.
    pub range: [f64; 2],
}

impl Default for Tone {
    fn default() -> Self {
        Tone { exposure: 0.0, range: [-8.0, 4.0] }
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

    /// The view of the picture.
    pub fn of_picture(&self) -> View {
        if self.exposure == 0.0 { View::Picture } else { View::Exposed(self.exposure) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exposure_stays_within_its_limits() {
        let mut tone = Tone::default();
        assert_eq!(tone.of_picture(), View::Picture);
        tone.expose(1.5);
        assert_eq!((tone.exposure, tone.of_picture()), (1.5, View::Exposed(1.5)));
        tone.expose(-3.5);
        assert_eq!(tone.exposure, -2.0);
        tone.expose(-1e3);
        assert_eq!(tone.exposure, -12.0);
    }
}
