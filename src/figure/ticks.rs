//! Round numbers along an axis, and how numbers are written in a figure.

/// Round values within `min..=max`, evenly spaced: about `wanted` of them, at most twice as many. Their distance is 1,
/// 2 or 5 times a power of ten; none where the range is empty or not finite.
pub fn ticks(min: f64, max: f64, wanted: usize) -> (Vec<f64>, f64) {
    let range = max - min;
    let step = round_step(range / wanted.max(1) as f64);
    if !(range.is_finite() && range > 0.0 && step.is_finite() && step > 0.0) {
        return (Vec::new(), 1.0);
    }
    // A value a rounding error outside counts as inside.
    let slack = range * 1e-9;
    let first = ((min - slack) / step).ceil();
    let values = (0..=2 * wanted.max(1)).map(|i| (first + i as f64) * step);
    (values.take_while(|v| *v <= max + slack).map(|v| v + 0.0).collect(), step)
}

/// The smallest of 1, 2, 5 times a power of ten that is not smaller.
fn round_step(least: f64) -> f64 {
    let power = 10_f64.powf(least.log10().floor());
    // A power of ten may come out a rounding error too large.
    [1.0, 2.0, 5.0, 10.0].map(|m| m * power).into_iter().find(|step| *step >= least * (1.0 - 1e-9)).unwrap_or(least)
}

/// A number as a figure shows it, with the decimals that tell values `step` apart: a true minus, thin spaces between
/// groups of three from five digits on, powers of ten for what is very large or small.
pub fn number_text(value: f64, step: f64) -> String {
    let size = value.abs().max(step.abs());
    if !value.is_finite() {
        return "?".to_owned();
    }
    if value != 0.0 && !(1e-4..1e9).contains(&size) {
        return in_powers(value, step);
    }
    let decimals = (-(step.abs().log10() + 1e-9).floor()).clamp(0.0, 9.0) as usize;
    let text = format!("{:.decimals$}", value.abs());
    let (whole, fraction) = text.split_once('.').map_or((text.as_str(), None), |(w, f)| (w, Some(f)));
    let mut out = String::new();
    if value < 0.0 && text.bytes().any(|b| (b'1'..=b'9').contains(&b)) {
        out.push('−');
    }
    for (i, digit) in whole.chars().enumerate() {
        if i > 0 && whole.len() > 4 && (whole.len() - i).is_multiple_of(3) {
            out.push('\u{2009}');
        }
        out.push(digit);
    }
    out.extend(fraction.iter().flat_map(|f| ['.'].into_iter().chain(f.chars())));
    out
}

/// `−1.5×10⁹`.
fn in_powers(value: f64, step: f64) -> String {
    let power = value.abs().log10().floor() as i32;
    let mantissa = value.abs() / 10_f64.powi(power);
    let decimals = (f64::from(power) - (step.abs().log10() + 1e-9).floor()).clamp(0.0, 3.0) as usize;
    let sign = if value < 0.0 { "−" } else { "" };
    let raised: String = power.to_string().chars().map(superscript).collect();
    format!("{sign}{mantissa:.decimals$}×10{raised}")
}

fn superscript(c: char) -> char {
    match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        c => c.to_digit(10).and_then(|d| char::from_u32(0x2070 + d)).unwrap_or(c),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        assert_eq!(ticks(0.0, 10.0, 5), (vec![0.0, 2.0, 4.0, 6.0, 8.0, 10.0], 2.0));
        assert_eq!(ticks(1653.0, 2019.0, 4), (vec![1700.0, 1800.0, 1900.0, 2000.0], 100.0));
        assert_eq!(ticks(-0.25, 0.26, 5), (vec![-0.2, 0.0, 0.2], 0.2));
        assert_eq!(ticks(0.3, 0.9, 3).0.len(), 3);
        // 0.30000000000000004: a rounding error above a tick, which is one; and 3 · 0.1 is as much above 0.3.
        assert_eq!(ticks(0.1 + 0.2, 0.8, 5).0.len(), 6);
        assert_eq!(ticks(-0.2, 0.3, 5).0.len(), 6);
        for (min, max) in [(1.0, 1.0), (2.0, 1.0), (f64::MIN, f64::MAX), (f64::NAN, 1.0), (0.0, f64::INFINITY)] {
            assert_eq!(ticks(min, max, 5).0, Vec::<f64>::new());
        }
        for (min, max) in [(0.0, 1e-300), (1e15, 1e15 + 1.0), (-1e300, 1e300), (-7.3, 1234.5), (0.1, 0.7)] {
            for wanted in 0..9 {
                let (values, step) = ticks(min, max, wanted);
                assert!(values.len() <= 2 * wanted.max(1) + 1, "{min} {max} {wanted}");
                let slack = (max - min) * 1e-6;
                assert!(values.iter().all(|v| (min - slack..=max + slack).contains(v)), "{values:?}");
                assert!(values.windows(2).all(|w| (w[1] - w[0] - step).abs() <= 1e-6 * step.max(w[1].abs() * 1e-9)));
            }
        }
    }

    #[test]
    fn numbers_are_written_for_people() {
        let cases = [
            (1950.0, 50.0, "1950"),
            (0.0, 0.5, "0.0"),
            (-0.0, 1.0, "0"),
            (-12.5, 0.5, "−12.5"),
            (-0.04, 1.0, "0"),
            (12_500.0, 500.0, "12\u{2009}500"),
            (1_234_567.0, 1.0, "1\u{2009}234\u{2009}567"),
            (0.3, 0.1, "0.3"),
            (0.001, 0.001, "0.001"),
            (2e9, 1e9, "2×10⁹"),
            (-1.5e12, 5e11, "−1.5×10¹²"),
            (2e-7, 1e-7, "2×10⁻⁷"),
            (f64::NAN, 1.0, "?"),
        ];
        for (value, step, expected) in cases {
            assert_eq!(number_text(value, step), expected, "{value} by {step}");
        }
    }
}
