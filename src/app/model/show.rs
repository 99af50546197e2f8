//! The views of a film.

use super::Tone;
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
    /// Share of lanes in use.
    Occupancy,
    /// Luminance in false colours.
    Luminance,
}

impl Show {
    /// All views.
    pub const ALL: [Show; 7] = [
        Show::Picture,
        Show::Normals,
        Show::Albedo,
        Show::Bounces,
        Show::Error,
        Show::Occupancy,
        Show::Luminance,
    ];

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
                "Noise",
                "How uncertain each pixel still is (standard error)",
                "view grain quality spp samples",
            ],
            Show::Occupancy => {
                ["Lanes at work", "How full the lanes of the processor were", "view simd avx packet"]
            }
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
            Show::Picture | Show::Error | Show::Occupancy | Show::Luminance => None,
        }
    }

    /// The view for resolving the film.
    pub fn of_film(self, tone: &Tone) -> View {
        match self {
            Show::Error => View::StandardError,
            Show::Occupancy => View::Occupancy,
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
            Show::Occupancy => Some(HeatScale::OCCUPANCY),
            Show::Picture | Show::Normals | Show::Albedo => None,
        }
    }
}
