//! Statistics of noisy pictures: tests of equality, fits. Pure functions of numbers.

pub mod blocks;
pub mod fit;
pub mod normal;

/// The median, the mean of the two middle values if their number is even; `None` without values. NaN sorts last.
pub fn median(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let mut sorted: Vec<f64> = values.into_iter().collect();
    sorted.sort_by(f64::total_cmp);
    let lower = sorted.len().checked_sub(1)? / 2;
    Some(0.5 * (sorted[lower] + sorted[sorted.len() / 2]))
}

#[cfg(test)]
mod tests {
    use super::median;

    #[test]
    fn medians() {
        assert_eq!(median([3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median([4.0, 1.0, 2.0, 3.0]), Some(2.5));
        assert_eq!(median([]), None);
        assert_eq!(median([f64::NAN, 5.0, -2.0]), Some(5.0), "NaN sorts last");
    }
}
