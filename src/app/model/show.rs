//! The views of a picture.

use crate::heat::HeatScale;
use crate::layers::Layer;

/// What the picture shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Show {
    /// The picture.
    #[default]
    Picture,
    /// Normals of what is seen first.
    Normals,
    /// The materials' own colours.
    Albedo,
    /// Rays per path.
    Bounces,
    /// Standard error of each pixel.
    Error,
    /// How full packets were.
    Occupancy,
    /// Difference from a loaded film.
    Difference,
}

impl Show {
    /// All of them.
    pub const ALL: [Show; 7] = [
        Show::Picture,
        Show::Normals,
        Show::Albedo,
        Show::Bounces,
        Show::Error,
        Show::Occupancy,
        Show::Difference,
    ];

    /// Its name, after "Show".
    pub fn name(self) -> &'static str {
        match self {
            Show::Picture => "picture",
            Show::Normals => "normals",
            Show::Albedo => "albedo",
            Show::Bounces => "bounces per path",
            Show::Error => "standard error",
            Show::Occupancy => "lane occupancy",
            Show::Difference => "difference to reference",
        }
    }

    /// What it is.
    pub fn help(self) -> &'static str {
        match self {
            Show::Picture => "The film, as it will be saved",
            Show::Normals => "Which way surfaces face: x red, y green, z blue",
            Show::Albedo => {
                "What surfaces reflect, without light and shadow; glass takes nothing and is white"
            }
            Show::Bounces => "How many rays a path takes, the camera's included: where the time goes",
            Show::Error => "Standard error of each pixel's mean, linear radiance: where the noise is",
            Show::Occupancy => {
                "How full the packets were, tile by tile: a lane whose tile has no more work waits until the \
                 last one there is done"
            }
            Show::Difference => "Distance from a loaded film, linear radiance",
        }
    }

    /// The layer that it is, if it is one.
    pub fn layer(self) -> Option<Layer> {
        match self {
            Show::Normals => Some(Layer::Normals),
            Show::Albedo => Some(Layer::Albedo),
            Show::Bounces => Some(Layer::RaysPerPath),
            Show::Picture | Show::Error | Show::Occupancy | Show::Difference => None,
        }
    }

    /// What its colours mean, if it is a heat map.
    pub fn scale(self) -> Option<HeatScale> {
        match self {
            Show::Bounces => Some(HeatScale::RAYS),
            Show::Error | Show::Difference => Some(HeatScale::ERROR),
            Show::Occupancy => Some(HeatScale::OCCUPANCY),
            Show::Picture | Show::Normals | Show::Albedo => None,
        }
    }
}
