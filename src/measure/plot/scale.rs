//! From a figure to a place along an axis, and the ticks beside it.

/// An axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Scale {
    kind: Kind,
    /// Where the axis begins and ends in the drawing, pixels.
    span: [f64; 2],
    /// Values with a tick, and what stands there.
    pub ticks: Vec<(f64, String)>,
}

#[derive(Clone, Debug, PartialEq)]
enum Kind {
    Linear {
        low: f64,
        high: f64,
    },
    /// Logarithmic; `zero_at`: the share of the axis before it that belongs to 0.
    Log {
        low: f64,
        high: f64,
        zero_at: f64,
    },
    /// Values side by side, whatever lies between them.
    Ordinal(Vec<f64>),
}

/// Errors over so many times the smallest are drawn logarithmically.
const LOG_FROM: f64 = 12.0;
/// Share of a logarithmic axis that a 0 takes.
const ZERO_SHARE: f64 = 0.12;

impl Scale {
    /// For figures from 0 up: from 0 on, or logarithmic where they differ much; 0 then has a place of its own.
    pub fn of_errors(values: &[f64], span: [f64; 2]) -> Self {
        let values: Vec<f64> = values.iter().copied().filter(|v| v.is_finite() && *v >= 0.0).collect();
        let positive = || values.iter().copied().filter(|v| *v > 0.0);
        let (least, most) = (positive().fold(f64::INFINITY, f64::min), positive().fold(0.0, f64::max));
        if most == 0.0 {
            return Self::linear(0.0, 1.0, span);
        }
        if most < LOG_FROM * least {
            return Self::linear(0.0, most * 1.08, span);
        }
        let zero_at = if values.contains(&0.0) { ZERO_SHARE } else { 0.0 };
        Self::log(least / 1.5, most * 1.5, zero_at, span)
    }

    /// For ratios, with 1 in view: around them, or logarithmic where they differ much.
    pub fn of_ratios(values: &[f64], span: [f64; 2]) -> Self {
        let values = || values.iter().copied().filter(|v| v.is_finite() && *v > 0.0).chain([1.0]);
        let (least, most) = (values().fold(f64::INFINITY, f64::min), values().fold(0.0, f64::max));
        if most > 6.0 * least {
            return Self::log(least / 1.25, most * 1.25, 0.0, span);
        }
        let margin = (0.12 * (most - least)).max(0.02);
        Self::linear((least - margin).max(0.0), most + margin, span)
    }

    /// One place for each value.
    pub fn ordinal(values: &[f64], span: [f64; 2]) -> Self {
        let mut sorted: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
        sorted.sort_by(f64::total_cmp);
        sorted.dedup();
        let ticks = sorted.iter().map(|v| (*v, v.to_string())).collect();
        Self { kind: Kind::Ordinal(sorted), span, ticks }
    }

    fn linear(low: f64, high: f64, span: [f64; 2]) -> Self {
        // Four to ten steps of 1, 2 or 5 times a power of ten.
        let most = (high - low) / 4.0;
        let power = 10_f64.powf(most.log10().floor());
        let step = [5.0, 2.0, 1.0].map(|k| k * power).into_iter().find(|s| *s <= most).unwrap_or(power);
        let digits = (-step.log10().floor()).max(0.0) as usize;
        let first = (low / step - 1e-9).ceil() as i64;
        let last = (high / step + 1e-9).floor() as i64;
        let ticks = (first..=last).map(|i| i as f64 * step).map(|v| (v, format!("{v:.digits$}"))).collect();
        Self { kind: Kind::Linear { low, high }, span, ticks }
    }

    fn log(low: f64, high: f64, zero_at: f64, span: [f64; 2]) -> Self {
        let (from, to) = (low.log10().floor() as i32, high.log10().ceil() as i32);
        let decades = high.log10() - low.log10();
        let steps: &[f64] = if decades > 3.0 { &[1.0] } else { &[1.0, 2.0, 5.0] };
        let mut ticks = if zero_at > 0.0 { vec![(0.0, "0".to_owned())] } else { Vec::new() };
        for power in from..=to {
            for step in steps {
                let value = step * 10_f64.powi(power);
                if (low..=high).contains(&value) {
                    let digits = (-power).max(0) as usize;
                    let text = if digits > 4 { format!("{value:e}") } else { format!("{value:.digits$}") };
                    ticks.push((value, text));
                }
            }
        }
        Self { kind: Kind::Log { low, high, zero_at }, span, ticks }
    }

    /// Where a value stands, pixels; `None` for what has no place.
    pub fn at(&self, value: f64) -> Option<f64> {
        let share = match &self.kind {
            _ if !value.is_finite() => return None,
            Kind::Linear { low, high } => (value - low) / (high - low),
            Kind::Log { zero_at, .. } if value == 0.0 && *zero_at > 0.0 => 0.4 * zero_at,
            Kind::Log { .. } if value <= 0.0 => return None,
            Kind::Log { low, high, zero_at } => {
                zero_at + (1.0 - zero_at) * (value.log10() - low.log10()) / (high.log10() - low.log10())
            }
            Kind::Ordinal(values) => {
                let i = values.iter().position(|v| *v == value)?;
                (i as f64 + 0.5) / values.len() as f64
            }
        };
        let share = share.clamp(0.0, 1.0);
        Some(self.span[0] + share * (self.span[1] - self.span[0]))
    }

    /// Where the place of 0 ends and the logarithm begins, pixels; `None` where there is no such break.
    pub fn break_at(&self) -> Option<f64> {
        match self.kind {
            Kind::Log { zero_at, .. } if zero_at > 0.0 => {
                Some(self.span[0] + 0.8 * zero_at * (self.span[1] - self.span[0]))
            }
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(scale: &Scale) -> Vec<&str> {
        scale.ticks.iter().map(|t| t.1.as_str()).collect()
    }

    #[test]
    fn values_stand_where_they_should() {
        let linear = Scale::of_errors(&[0.0, 1.0, 2.0], [100.0, 316.0]);
        assert_eq!((linear.at(0.0), linear.at(1.0), linear.break_at()), (Some(100.0), Some(200.0), None));
        assert_eq!(texts(&linear), ["0.0", "0.5", "1.0", "1.5", "2.0"]);
        let log = Scale::of_errors(&[0.01, 1.0], [0.0, 100.0]);
        assert!((log.at(0.1).unwrap() - 50.0).abs() < 1e-9);
        assert_eq!(log.at(0.0), None, "a logarithm has no zero of its own");
        let zero = Scale::of_errors(&[0.0, 0.01, 1.0], [0.0, 100.0]);
        assert!(zero.at(0.0).unwrap() < zero.break_at().unwrap());
        assert!(zero.at(0.01).unwrap() > zero.break_at().unwrap());
        let ordinal = Scale::ordinal(&[4.0, 0.0, 1.0, 4.0], [0.0, 30.0]);
        assert_eq!([0.0, 1.0, 4.0].map(|v| ordinal.at(v)), [Some(5.0), Some(15.0), Some(25.0)]);
        assert_eq!(ordinal.at(2.0), None);
        // Upwards, as y goes in a drawing.
        let up = Scale::of_ratios(&[0.5, 1.5], [300.0, 0.0]);
        assert!(up.at(1.5) < up.at(1.0) && up.at(1.0) < up.at(0.5));
    }

    #[test]
    fn nothing_and_odd_numbers_make_an_axis_too() {
        for values in [vec![], vec![0.0], vec![f64::NAN, f64::INFINITY], vec![3.0], vec![1e-300, 1e300]] {
            for scale in [Scale::of_errors(&values, [0.0, 1.0]), Scale::of_ratios(&values, [0.0, 1.0])] {
                assert!((1..=700).contains(&scale.ticks.len()), "{values:?}: {:?}", texts(&scale));
                assert!(scale.ticks.iter().all(|t| scale.at(t.0).is_some_and(|p| (0.0..=1.0).contains(&p))));
                assert_eq!(scale.at(f64::NAN), None);
            }
        }
    }
}
