//! The normal distribution, and the conversion of Student's distribution to it.

use statrs::distribution::{ContinuousCDF, StudentsT};
use statrs::function::erf::{erfc, erfc_inv};

/// The probability of a normal number below `z`.
pub fn distribution(z: f64) -> f64 {
    0.5 * erfc(-z / std::f64::consts::SQRT_2)
}

/// The `z >= 0` that a normal number exceeds, on either side of 0, with the probability `chance`: 0 for 1 and above, and
/// a number that is never exceeded for 0.
fn two_sided_quantile(chance: f64) -> f64 {
    (std::f64::consts::SQRT_2 * erfc_inv(chance)).clamp(0.0, 40.0)
}

/// The limit that the largest absolute value of `count` independent normal numbers exceeds with the probability
/// `chance`.
///
/// Source: Sidak, "Rectangular Confidence Regions for the Means of Multivariate Normal Distributions", 1967.
pub fn largest_of(count: usize, chance: f64) -> f64 {
    let each = -((-chance).ln_1p() / count.max(1) as f64).exp_m1();
    two_sided_quantile(each)
}

/// With this many degrees of freedom or more, Student's distribution equals the normal one to within a millionth.
const ENDLESS_FREEDOM: f64 = 1e7;

/// The normal number as unlikely as the value `t` of Student's distribution with `freedom > 0` degrees of freedom. NaN
/// stays NaN.
pub fn from_student(t: f64, freedom: f64) -> f64 {
    if t.is_nan() || freedom >= ENDLESS_FREEDOM {
        return t;
    }
    let student = StudentsT::new(0.0, 1.0, freedom);
    student.map_or(t, |student| two_sided_quantile(2.0 * student.sf(t.abs())).copysign(t))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_quantiles() {
        for (chance, z) in
            [(0.05, 1.959_964), (0.01, 2.575_829), (6.334e-5, 4.0), (5.733e-7, 5.0), (1.0, 0.0)]
        {
            assert!(
                (two_sided_quantile(chance) - z).abs() < 2e-5,
                "{chance}: {}",
                two_sided_quantile(chance)
            );
        }
    }

    #[test]
    fn the_largest_of_many_is_larger() {
        assert!((largest_of(1, 0.01) - 2.575_829).abs() < 1e-5);
        // 240 blocks have a tail of 4.2e-5.
        assert!((largest_of(240, 0.01) - 4.096).abs() < 1e-3, "{}", largest_of(240, 0.01));
        assert_eq!(largest_of(0, 0.01), largest_of(1, 0.01));
    }

    #[test]
    fn student_quantiles_become_normal() {
        // Two-sided quantiles of Student's distribution for probabilities of 5 % and 0.1 %.
        for (freedom, five_percent, per_mille) in
            [(5.0, 2.5706, 6.8688), (20.0, 2.0860, 3.8495), (63.0, 1.9983, 3.4515)]
        {
            for (t, z) in [(five_percent, 1.960), (per_mille, 3.2905)] {
                let found = from_student(t, freedom);
                assert!((found - z).abs() < 5e-4, "{freedom}, {t}: {found}");
                assert_eq!(from_student(-t, freedom), -found);
            }
        }
        assert_eq!(from_student(4.0, 1e9), 4.0);
        assert!((from_student(4.0, 9e6) - 4.0).abs() < 1e-5);
        assert!(from_student(f64::NAN, 5.0).is_nan() && from_student(1e300, 5.0) > 30.0);
    }
}
