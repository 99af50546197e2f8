//! Heat maps: dark to bright colours for numbers, and the scale that explains them.

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeatScale {
    /// Quantity and unit.
    pub title: &'static str,
    /// Values at the two ends of the scale, which is logarithmic.
    limits: [f64; 2],
    /// Parts between the labels of a legend.
    parts: u8,
}

/// Dark to bright, evenly spaced.
const COLOURS: [[f64; 3]; 7] = [
    [0.0, 0.0, 4.0],
    [40.0, 11.0, 84.0],
    [101.0, 21.0, 110.0],
    [159.0, 42.0, 99.0],
    [212.0, 72.0, 66.0],
    [245.0, 125.0, 21.0],
    [252.0, 255.0, 164.0],
];

impl HeatScale {
    /// Errors, linear radiance.
    pub const ERROR: HeatScale = HeatScale { title: "linear radiance", limits: [1e-4, 1.0], parts: 4 };

    /// Absolute differences of two pictures, linear radiance.
    pub const DIFFERENCE: HeatScale =
        HeatScale { title: "|difference|, linear radiance", ..HeatScale::ERROR };

    /// Differences of two pictures as they are displayed, from 0 to 1.
    pub const DISPLAYED: HeatScale = HeatScale { title: "|difference|, 0 to 1", ..HeatScale::ERROR };

    pub const RAYS: HeatScale = HeatScale { title: "rays per path", limits: [1.0, 32.0], parts: 5 };

    /// Luminance, from `2^low` to `2^high`.
    pub fn luminance([low, high]: [f64; 2]) -> HeatScale {
        HeatScale { title: "luminance, linear", limits: [low.exp2(), high.exp2()], parts: 4 }
    }

    /// Values with labels for a legend, evenly spaced from end to end.
    pub fn marks(&self) -> Vec<(f64, String)> {
        let [low, high] = self.limits;
        let value = |part: u8| low * (high / low).powf(f64::from(part) / f64::from(self.parts));
        (0..=self.parts).map(value).map(|value| (value, short(value))).collect()
    }

    /// Position of a value on the scale, `0..=1`.
    pub fn place(&self, value: f64) -> f64 {
        let [low, high] = self.limits;
        if value <= low { 0.0 } else { ((value / low).ln() / (high / low).ln()).min(1.0) }
    }

    pub fn colour(&self, value: f64) -> [u8; 3] {
        colour_at(self.place(value))
    }
}

/// Two significant digits.
fn short(value: f64) -> String {
    let decimals = (1.0 - value.abs().log10().floor()).clamp(0.0, 6.0) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// The colour at a position on any scale, `0..=1`.
pub fn colour_at(place: f64) -> [u8; 3] {
    let last = COLOURS.len() - 1;
    let along = place.clamp(0.0, 1.0) * last as f64;
    let from = (along as usize).min(last - 1);
    let share = along - from as f64;
    let channel = |i: usize| COLOURS[from][i] * (1.0 - share) + COLOURS[from + 1][i] * share;
    [0, 1, 2].map(|i| channel(i).round() as u8)
}
