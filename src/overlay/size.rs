//! Sizes of overlays: as they prefer, by distance or by interest, and shrunk where there is no room.

use glam::DVec2;

use crate::overlay::request::{Overlay, SizeRule};

/// Steps from the size that an overlay should have down to the smallest: eighths.
pub const SHRINK_STEPS: u32 = 8;

/// The limits of an overlay, whole pixels: smallest, wanted, each 1 and up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sizes {
    /// Smallest width and height.
    pub min: [i32; 2],
    /// Width and height by the rule.
    pub wanted: [i32; 2],
}

impl Sizes {
    /// The size after `step` of [`SHRINK_STEPS`] steps of shrinking, pixels.
    pub fn shrunk(&self, step: u32) -> [i32; 2] {
        let left = i64::from(SHRINK_STEPS - step.min(SHRINK_STEPS));
        [0, 1].map(|i| {
            let (min, wanted) = (i64::from(self.min[i]), i64::from(self.wanted[i]));
            (min + (wanted - min) * left / i64::from(SHRINK_STEPS)) as i32
        })
    }
}

/// The sizes of `overlays` by a rule, in their order, none larger than `room` (pixels) if its smallest size allows it.
pub fn sizes_of(overlays: &[&Overlay], rule: SizeRule, room: [i32; 2]) -> Vec<Sizes> {
    let nearest =
        overlays.iter().map(|o| o.distance).filter(|d| *d > 0.0 && d.is_finite()).fold(f64::INFINITY, f64::min);
    let share = |overlay: &Overlay| match rule {
        SizeRule::Preferred => None,
        SizeRule::ByInterest => Some(if overlay.weight.is_nan() { 0.0 } else { overlay.weight.clamp(0.0, 1.0) }),
        SizeRule::ByDistance if overlay.distance > 0.0 && overlay.distance.is_finite() => {
            Some((nearest / overlay.distance).clamp(0.0, 1.0))
        }
        SizeRule::ByDistance => Some(0.0),
    };
    let sizes = |overlay: &&Overlay| {
        let min = whole(overlay.min);
        let preferred = at_least(whole(overlay.preferred), min);
        let max = at_least(whole(overlay.max), preferred);
        let wanted = match share(overlay) {
            None => preferred,
            Some(t) => [0, 1].map(|i| (f64::from(min[i]) + f64::from(max[i] - min[i]) * t).round() as i32),
        };
        Sizes { min, wanted: at_least([wanted[0].min(room[0]), wanted[1].min(room[1])], min) }
    };
    overlays.iter().map(sizes).collect()
}

/// A size on whole pixels, 1..2²⁰.
fn whole(size: DVec2) -> [i32; 2] {
    size.to_array().map(|s| if s.is_finite() { s.round().clamp(1.0, f64::from(1 << 20)) as i32 } else { 1 })
}

fn at_least(size: [i32; 2], least: [i32; 2]) -> [i32; 2] {
    [size[0].max(least[0]), size[1].max(least[1])]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::overlay::request::LineKind;

    fn overlay(distance: f64, weight: f64) -> Overlay {
        let [min, preferred, max] = [DVec2::new(40.0, 20.0), DVec2::new(100.0, 80.0), DVec2::new(200.0, 100.0)];
        Overlay {
            id: 0,
            priority: 0.0,
            min,
            preferred,
            max,
            anchors: vec![],
            lines: LineKind::Straight,
            weight,
            distance,
        }
    }

    fn wanted(overlays: &[Overlay], rule: SizeRule) -> Vec<[i32; 2]> {
        sizes_of(&overlays.iter().collect::<Vec<_>>(), rule, [1000, 1000]).iter().map(|s| s.wanted).collect()
    }

    #[test]
    fn sizes_follow_their_rule() {
        let some = [overlay(50.0, 0.0), overlay(100.0, 0.5), overlay(200.0, 1.0), overlay(f64::NAN, f64::NAN)];
        assert_eq!(wanted(&some, SizeRule::Preferred), [[100, 80]; 4]);
        assert_eq!(wanted(&some, SizeRule::ByDistance), [[200, 100], [120, 60], [80, 40], [40, 20]]);
        assert_eq!(wanted(&some, SizeRule::ByInterest), [[40, 20], [120, 60], [200, 100], [40, 20]]);
    }

    #[test]
    fn sizes_shrink_down_to_the_smallest_and_fit_the_room() {
        let overlays = [overlay(1.0, 0.0)];
        let sizes = sizes_of(&[&overlays[0]], SizeRule::Preferred, [90, 1000])[0];
        assert_eq!(sizes, Sizes { min: [40, 20], wanted: [90, 80] });
        assert_eq!([0, 4, 8, 99].map(|step| sizes.shrunk(step)), [[90, 80], [65, 50], [40, 20], [40, 20]]);
    }

    #[test]
    fn sizes_that_are_no_sizes_are_one_pixel() {
        let mut odd = overlay(1.0, 0.0);
        (odd.min, odd.preferred, odd.max) = (DVec2::splat(f64::NAN), DVec2::new(-5.0, f64::INFINITY), DVec2::ZERO);
        assert_eq!(wanted(&[odd], SizeRule::Preferred), [[1, 1]]);
    }
}
