//! What a film file does not say about a kept picture.

use crate::app::model::device::Device;
use crate::app::model::kept::Kept;
use crate::app::model::session::Session;
use crate::app::model::view::ViewState;
use crate::job::render::BackendInfo;
use crate::progressive::{Contribution, Status};
use serde::{Deserialize, Serialize};
use std::time::Duration;

/// The document of a kept picture, and how its samples were traced. It never changes.
#[derive(Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct PictureNote {
    /// The document.
    pub session: Session,
    /// [`Kept::seconds_before`].
    pub seconds_before: Option<f64>,
    trace: Duration,
    backend: Option<Backend>,
    contributions: Vec<(Backend, u64)>,
}

/// A [`BackendInfo`] as text.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct Backend {
    name: String,
    device: String,
    lanes: usize,
    threads: usize,
}

impl Backend {
    fn of(info: &BackendInfo) -> Backend {
        let BackendInfo { name, device, lanes, threads } = info;
        Backend { name: (*name).to_owned(), device: device.clone(), lanes: *lanes, threads: *threads }
    }

    /// `None` for a backend that this version of the program does not have.
    fn info(&self) -> Option<BackendInfo> {
        let name = Device::ALL.map(Device::name).into_iter().find(|name| *name == self.name)?;
        Some(BackendInfo { name, device: self.device.clone(), lanes: self.lanes, threads: self.threads })
    }
}

impl PictureNote {
    /// The note of a kept picture. Takes up to a second for a scene of many spheres.
    pub fn of(kept: &Kept) -> Self {
        let Status { trace, backend, contributions, .. } = &*kept.status;
        PictureNote {
            session: Session::of(&kept.document, &ViewState::default(), false),
            seconds_before: kept.seconds_before,
            trace: *trace,
            backend: backend.as_ref().map(Backend::of),
            contributions: contributions
                .iter()
                .map(|part| (Backend::of(&part.backend), part.samples_per_pixel))
                .collect(),
        }
    }

    /// The status of a film of this many samples per pixel, as far as descriptions need it.
    pub fn status(&self, samples_per_pixel: u64) -> Status {
        let contribution = |(backend, samples_per_pixel): &(Backend, u64)| {
            Some(Contribution { backend: backend.info()?, samples_per_pixel: *samples_per_pixel })
        };
        Status {
            trace: self.trace,
            samples_per_pixel,
            backend: self.backend.as_ref().and_then(Backend::info),
            contributions: self.contributions.iter().filter_map(contribution).collect(),
            ..Status::default()
        }
    }
}
