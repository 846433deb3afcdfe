//! Against tables, textbooks and simulation.

use super::super::statistics::{Moments, Quantiles, holm};
use super::*;
use crate::strategy::area;

#[test]
fn half_widths_are_those_of_the_tables_of_student() {
    let quantiles = Quantiles::default();
    // Values −1 and 1 in turn have the mean 0 and a standard deviation near 1.
    for (count, t) in [(2, 12.7062), (3, 4.3027), (5, 2.7764), (10, 2.2622), (30, 2.0452), (101, 1.9840)] {
        let values: Vec<f64> = (0..count).map(|index| f64::from(index % 2) * 2.0 - 1.0).collect();
        let size = f64::from(count);
        let mean = if count % 2 == 0 { 0.0 } else { -1.0 / size };
        let deviation = ((size - size * mean * mean) / (size - 1.0)).sqrt();
        let found = quantiles.estimate(&Moments::of(values.into_iter()));
        close(found.mean, mean, 1e-12);
        close(found.high - mean, t * deviation / size.sqrt(), 6e-5 * deviation);
        close(mean - found.low, found.high - mean, 1e-12);
    }
}

/// "Student", The probable error of a mean, 1908: additional sleep under two drugs. The figures
/// are those that R prints for this test.
#[test]
fn the_paired_test_gives_the_textbook_s_figures() {
    let one = [0.7, -1.6, -0.2, -1.2, -0.1, 3.4, 3.7, 0.8, 0.0, 2.0];
    let other = [1.9, 0.8, 1.1, 0.1, -0.1, 4.4, 5.5, 1.6, 4.6, 3.4];
    let test = Quantiles::default().paired_test(one.iter().zip(other).map(|(one, other)| one - other));
    assert_eq!(test.difference.count, 10);
    close(test.difference.mean, -1.58, 1e-12);
    close(test.difference.low, -2.459_885_8, 5e-8);
    close(test.difference.high, -0.700_114_2, 5e-8);
    close(test.p_value, 0.002_833, 5e-7);
    close(test.effect_size * 10.0_f64.sqrt(), -4.0621, 5e-5);
}

#[test]
fn too_little_says_nothing_and_no_difference_is_one() {
    let quantiles = Quantiles::default();
    let none = quantiles.paired_test([].into_iter());
    assert!(none.difference.mean.is_nan() && none.p_value.is_nan());
    let single = quantiles.paired_test([f64::NAN, 0.5].into_iter());
    assert_eq!((single.difference.count, single.difference.mean), (1, 0.5));
    assert!(single.difference.low.is_nan() && single.p_value.is_nan() && single.effect_size.is_nan());
    let same = quantiles.paired_test([0.0; 3].into_iter());
    assert_eq!((same.p_value, same.difference.low, same.difference.high), (1.0, 0.0, 0.0));
    let always = quantiles.paired_test([0.5; 3].into_iter());
    assert_eq!((always.p_value, always.difference.low, always.difference.high), (0.0, 0.5, 0.5));
}

#[test]
fn intervals_hold_the_truth_and_tests_err_as_often_as_they_say() {
    let mut chance = ChaCha8Rng::seed_from_u64(1);
    let (quantiles, repeats) = (Quantiles::default(), 20_000);
    let (mut holds, mut errs) = (0, 0);
    for _ in 0..repeats {
        let values: Vec<f64> = (0..5).map(|_| 3.0 + 2.0 * normal(&mut chance)).collect();
        let found = quantiles.estimate(&Moments::of(values.iter().copied()));
        holds += i32::from(found.low <= 3.0 && 3.0 <= found.high);
        errs += i32::from(quantiles.paired_test(values.iter().map(|value| value - 3.0)).p_value < 0.05);
    }
    // Four standard errors of a share of 0.95.
    close(f64::from(holds) / f64::from(repeats), 0.95, 4.0 * (0.95 * 0.05 / f64::from(repeats)).sqrt());
    assert_eq!(holds + errs, repeats, "a test errs where the interval misses");
}

/// R: `p.adjust(c(0.01, 0.04, 0.03, 0.005), "holm")`.
#[test]
fn holm_corrects_as_r_does() {
    let corrected = holm(&[0.01, f64::NAN, 0.04, 0.03, 0.005, 0.9]);
    assert!(corrected[1].is_nan());
    let expected = [0.04, 0.09, 0.09, 0.025, 0.9];
    for (index, expected) in [0, 2, 3, 4, 5].into_iter().zip(expected) {
        close(corrected[index], expected, 1e-12);
    }
    let expected = [0.03, 0.06, 0.06, 0.02];
    holm(&[0.01, 0.04, 0.03, 0.005]).into_iter().zip(expected).for_each(|(a, b)| close(a, b, 1e-12));
    assert_eq!(holm(&[0.6, 0.7]), [1.0, 1.0]);
}

#[test]
fn the_area_is_that_of_trapezoids() {
    // 0 to 10 falling from 4 to 2: 30; 10 to 40 at 2: 60; of 40.
    close(area(&[0, 10, 40], &[4.0, 2.0, 2.0]), 90.0 / 40.0, 1e-12);
    // The first value holds from the start: 2 · 4, then 8 · 3 of 10.
    close(area(&[2, 10], &[4.0, 2.0]), 32.0 / 10.0, 1e-12);
    // Undefined until step 10: the mean over what follows.
    close(area(&[0, 10, 20], &[f64::NAN, 1.0, 2.0]), 1.5, 1e-12);
    // Undefined between: only the two ends count, 10 steps each.
    let gap = [1.0, 1.0, f64::NAN, 5.0, 5.0];
    close(area(&[0, 10, 20, 30, 40], &gap), 3.0, 1e-12);
    close(area(&[0, 10], &[f64::NAN, 3.0]), 3.0, 0.0);
    close(area(&[0], &[3.0]), 3.0, 0.0);
    assert!(area(&[0, 10], &[f64::NAN; 2]).is_nan() && area(&[], &[]).is_nan());
}
