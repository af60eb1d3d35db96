//! Patches of furniture: rectangles of whole pixels, so that what lies under something opaque is not drawn, and the inside of what is opaque
//! is drawn without blending.

use std::f32::consts::FRAC_1_SQRT_2;

/// A rectangle of whole pixels of a tile; never empty.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Patch {
    /// Left, top.
    pub low: [i32; 2],
    /// Right, bottom; exclusive.
    pub high: [i32; 2],
}

impl Patch {
    fn new(low: [i32; 2], high: [i32; 2]) -> Option<Self> {
        (low[0] < high[0] && low[1] < high[1]).then_some(Self { low, high })
    }

    /// All pixels that a rectangle touches.
    pub fn around(low: [f32; 2], high: [f32; 2]) -> Option<Self> {
        Self::new(low.map(|v| v.floor() as i32), high.map(|v| v.ceil() as i32))
    }

    /// The pixels whose centres lie so far inside of a rectangle with round corners that nothing of its border's fade is seen there: `panel`
    /// of `pass/furniture.wgsl` is one there. At the corners less of it than there is.
    pub fn inside(low: [f32; 2], high: [f32; 2], radius_px: f32, softness_px: f32) -> Option<Self> {
        let radius = radius_px.min(0.5 * (high[0] - low[0])).min(0.5 * (high[1] - low[1]));
        let fade = 0.5 * softness_px;
        let inset = fade.max(radius - (radius - fade) * FRAC_1_SQRT_2);
        let first = |v: f32| (v + inset - 0.5).ceil() as i32;
        let end = |v: f32| (v - inset + 0.5).floor() as i32;
        Self::new(low.map(first), high.map(end))
    }

    /// What two have in common.
    pub fn common(self, other: Self) -> Option<Self> {
        let low = [self.low[0].max(other.low[0]), self.low[1].max(other.low[1])];
        let high = [self.high[0].min(other.high[0]), self.high[1].min(other.high[1])];
        Self::new(low, high)
    }

    /// What of this is not in the other: above, left, right, below.
    pub fn without(self, other: Self) -> impl Iterator<Item = Self> {
        let Some(hole) = self.common(other) else { return [Some(self), None, None, None].into_iter().flatten() };
        let parts = [
            Self::new(self.low, [self.high[0], hole.low[1]]),
            Self::new([self.low[0], hole.low[1]], [hole.low[0], hole.high[1]]),
            Self::new([hole.high[0], hole.low[1]], [self.high[0], hole.high[1]]),
            Self::new([self.low[0], hole.high[1]], self.high),
        ];
        parts.into_iter().flatten()
    }

    /// How many pixels it has.
    pub fn area(self) -> i64 {
        i64::from(self.high[0] - self.low[0]) * i64::from(self.high[1] - self.low[1])
    }

    /// Its corners, as the GPU takes them.
    pub fn corners(self) -> [f32; 4] {
        [self.low[0], self.low[1], self.high[0], self.high[1]].map(|v| v as f32)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn any_patch() -> impl Strategy<Value = Patch> {
        (-9..9, -9..9, 1..12, 1..12).prop_map(|(x, y, w, h)| Patch { low: [x, y], high: [x + w, y + h] })
    }

    fn has(part: Patch, x: i32, y: i32) -> bool {
        (part.low[0]..part.high[0]).contains(&x) && (part.low[1]..part.high[1]).contains(&y)
    }

    proptest! {
        #![proptest_config(crate::seeds::config())]

        #[test]
        fn every_pixel_is_in_one_part(a in any_patch(), b in any_patch()) {
            let parts: Vec<Patch> = a.without(b).chain(a.common(b)).collect();
            for (x, y) in (-10..22).flat_map(|x| (-10..22).map(move |y| (x, y))) {
                let times = parts.iter().filter(|part| has(**part, x, y)).count();
                prop_assert_eq!(times, usize::from(has(a, x, y)));
            }
            prop_assert_eq!(parts.iter().map(|p| p.area()).sum::<i64>(), a.area());
        }

        #[test]
        fn inside_nothing_fades(
            low in prop::array::uniform2(-5.0_f32..5.0), size in prop::array::uniform2(1.0_f32..40.0),
            radius in 0.0_f32..30.0, softness in 1.0_f32..20.0,
        ) {
            let high = [low[0] + size[0], low[1] + size[1]];
            let Some(part) = Patch::inside(low, high, radius, softness) else { return Ok(()) };
            for y in part.low[1]..part.high[1] {
                for x in part.low[0]..part.high[0] {
                    let share = panel([x as f32 + 0.5, y as f32 + 0.5], low, high, radius, softness);
                    prop_assert!(share > 1.0 - 1e-5, "{x} {y}: {share}");
                }
            }
        }
    }

    /// The twin of `panel` of `pass/furniture.wgsl`, without the shape of its fade.
    fn panel(at: [f32; 2], low: [f32; 2], high: [f32; 2], radius: f32, softness: f32) -> f32 {
        let half = [0.5 * (high[0] - low[0]), 0.5 * (high[1] - low[1])];
        let corner = radius.min(half[0].min(half[1]));
        let beyond: [f32; 2] = std::array::from_fn(|i| (at[i] - 0.5 * (low[i] + high[i])).abs() - half[i] + corner);
        let outside = beyond[0].max(0.0).hypot(beyond[1].max(0.0));
        let distance = outside + beyond[0].max(beyond[1]).min(0.0) - corner;
        (0.5 - distance / softness).clamp(0.0, 1.0)
    }

    #[test]
    fn a_panel_on_whole_pixels_is_all_inside() {
        let part = Patch { low: [3, 4], high: [10, 6] };
        assert_eq!(Patch::inside([3.0, 4.0], [10.0, 6.0], 0.0, 1.0), Some(part));
        assert_eq!(Patch::around([3.0, 4.0], [10.0, 6.0]), Some(part));
        assert_eq!(Patch::inside([3.0, 4.0], [10.0, 6.0], 0.0, 3.0), None);
    }
}
