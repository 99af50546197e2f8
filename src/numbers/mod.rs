//! Statistics, charts and heat maps.

#[cfg(not(target_family = "wasm"))]
pub mod chart;
pub mod heat;
pub mod statistics;

/// A number rounded to `digits` decimal digits of `scale`.
pub fn rounded(n: f64, scale: f64, digits: i32) -> f64 {
    let exponent = digits - 1 - scale.log10().floor().clamp(-300.0, 300.0) as i32;
    // Multiplying by a power below 1 would add digits.
    let factor = 10.0_f64.powi(exponent.abs());
    let rounded = if exponent < 0 { (n / factor).round() * factor } else { (n * factor).round() / factor };
    if rounded.is_finite() { rounded } else { n }
}
