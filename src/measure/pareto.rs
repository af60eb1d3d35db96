//! The Pareto front: what nothing else beats in both figures at once.

/// Whether each point is on the front; both figures are better when smaller.
///
/// A point is beaten by one that is no worse in both figures and better in one. Equal points do not beat each other:
/// they are on the front together or not at all. A point with a figure that is not a number is never on it, and beats
/// none.
pub fn front(points: &[[f64; 2]]) -> Vec<bool> {
    let is_number = |p: &[f64; 2]| p.iter().all(|v| !v.is_nan());
    let beats = |a: &[f64; 2], b: &[f64; 2]| a[0] <= b[0] && a[1] <= b[1] && a != b;
    points.iter().map(|p| is_number(p) && !points.iter().any(|other| beats(other, p))).collect()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn fronts_known_by_thought() {
        // More accurate and slower, step by step: everybody.
        assert_eq!(front(&[[3.0, 1.0], [2.0, 2.0], [1.0, 3.0]]), [true; 3]);
        // One is best in both.
        assert_eq!(front(&[[1.0, 1.0], [1.0, 2.0], [2.0, 1.0], [3.0, 3.0]]), [true, false, false, false]);
        // Inside the corner, above the line between its neighbours: still not beaten.
        assert_eq!(front(&[[0.0, 10.0], [9.0, 9.0], [10.0, 0.0]]), [true; 3]);
        assert_eq!(front(&[]), [false; 0]);
    }

    #[test]
    fn ties() {
        assert_eq!(front(&[[1.0, 1.0], [1.0, 1.0]]), [true, true], "equal points stand together");
        assert_eq!(front(&[[2.0, 2.0], [2.0, 2.0], [1.0, 1.0]]), [false, false, true], "and fall together");
        assert_eq!(front(&[[1.0, 5.0], [1.0, 4.0]]), [false, true], "equal in one figure: the other decides");
        assert_eq!(front(&[[0.0, 1.0], [-0.0, 1.0]]), [true, true], "both zeros are one number");
    }

    #[test]
    fn what_is_no_number_is_not_on_it() {
        assert_eq!(front(&[[f64::NAN, 0.0], [1.0, 1.0]]), [false, true]);
        assert_eq!(front(&[[1.0, f64::INFINITY], [2.0, 1.0]]), [true, true], "infinite is a number");
        assert_eq!(front(&[[f64::NAN; 2]]), [false]);
    }

    proptest! {
        #![proptest_config(crate::seeds::config())]

        /// By definition: sorted by one figure, the other falls along the front; and what is not on it is beaten by
        /// something that is.
        #[test]
        fn the_front_falls_and_beats_the_rest(points in prop::collection::vec([0_u8..8, 0_u8..8], 1..40)) {
            let points: Vec<[f64; 2]> = points.iter().map(|p| p.map(f64::from)).collect();
            let on = front(&points);
            let mut members: Vec<[f64; 2]> = points.iter().zip(&on).filter(|(_, on)| **on).map(|(p, _)| *p).collect();
            members.sort_by(|a, b| a[0].total_cmp(&b[0]));
            members.dedup();
            prop_assert!(!members.is_empty());
            prop_assert!(members.windows(2).all(|w| w[0][0] < w[1][0] && w[0][1] > w[1][1]));
            for (p, _) in points.iter().zip(&on).filter(|(_, on)| !**on) {
                prop_assert!(members.iter().any(|m| m[0] <= p[0] && m[1] <= p[1]));
            }
        }
    }
}
