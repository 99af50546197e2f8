//! `report.csv`.

use super::data::{Data, Measured};
use std::fmt::Write;

/// All measurements, one line for each picture and number of samples.
pub fn csv(data: &Data) -> String {
    let mut text = String::from(
        "scene,backend,sampler,seed,samples,trace_seconds,wall_seconds,device_seconds,mse,rel_mse,flip,mse_estimate,rejected\n",
    );
    for run in &data.runs {
        for point in &run.points {
            let Measured { samples, trace_seconds, wall_seconds, mse, rel_mse, flip, rejected, .. } = point;
            let optional = |value: Option<f64>| value.map_or_else(String::new, |value| value.to_string());
            let (device, estimate) = (optional(point.device_seconds), optional(point.mse_estimate));
            let curve = &run.curve;
            // A scene's name may be any file name.
            let scene = curve.scene.replace([',', '"', '\n'], "_");
            let _ = writeln!(
                text,
                "{scene},{},{},{},{samples},{trace_seconds},{wall_seconds},{device},{mse},{rel_mse},{flip},{estimate},{rejected}",
                curve.backend, curve.sampler, run.seed
            );
        }
    }
    text
}
