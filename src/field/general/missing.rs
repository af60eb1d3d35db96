//! Numbers that stand for a missing one: headers of the general array importer have no way to say so, but tables have them.

use crate::field::general::data::Column;

/// How much farther than the others lie apart such a number lies from them.
const FAR: f64 = 10.0;

/// The number that stands for a missing one, if there is any: the least of all, -99, -100, -999, -1000 and so on, far from all others.
pub fn stands_for_none(columns: &[Column<'_>], components: usize) -> Option<f64> {
    let [mut least, mut second, mut greatest] = [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY];
    for column in columns {
        for i in 0..column.count {
            for c in 0..components {
                let value = column.numbers.at_byte(column.start + i * column.stride + c * column.component_stride);
                if value < least {
                    (least, second) = (value, least);
                } else if value > least && value < second {
                    second = value;
                }
                if value > greatest {
                    greatest = value;
                }
            }
        }
    }
    let is_far = second.is_finite() && greatest > second && second - least > FAR * (greatest - second);
    (is_far && is_usual(least)).then_some(least)
}

/// Whether it is -100, -1000, ... or -99, -999, ...
fn is_usual(number: f64) -> bool {
    let mut power = 100.0;
    while power < 1e31 {
        if number == -power || number == 1.0 - power {
            return true;
        }
        power *= 10.0;
    }
    false
}
