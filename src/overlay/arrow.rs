//! Arrows at the picture's border for what is outside of it, or behind the camera.

use glam::DVec2;

/// Where an arrow at the border points to something that is not in the picture, and whither.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BorderArrow {
    /// Its tip, pixels; `margin` inside the picture's border.
    pub tip: DVec2,
    /// The way that it points, unit length.
    pub direction: DVec2,
}

/// The arrow for a thing that lies in `direction` from the middle of the picture (x right, y down; of any length above 0).
///
/// Its tip is where the ray from the middle leaves the picture less `margin` pixels on each side; in a picture that is smaller than that
/// it is the middle. `None` for a direction that is none: zero, or not finite.
///
/// For a point behind the camera, the direction is that of its place in the camera's axes (x right, −y up), not that of its projection, which is mirrored.
pub fn border_arrow(picture: [u32; 2], margin: f64, direction: DVec2) -> Option<BorderArrow> {
    let largest = direction.abs().max_element();
    if !largest.is_finite() || direction.is_nan() {
        return None;
    }
    // Scaled first, so that neither tiny nor huge directions lose their length.
    let direction = (direction / largest).try_normalize()?;
    let middle = DVec2::new(f64::from(picture[0]), f64::from(picture[1])) * 0.5;
    let margin = if margin.is_finite() { margin.max(0.0) } else { 0.0 };
    let half = (middle - margin).max(DVec2::ZERO);
    let way = |i: usize| if direction[i] == 0.0 { f64::INFINITY } else { half[i] / direction[i].abs() };
    let tip = middle + direction * way(0).min(way(1));
    // The rounding of the product must not carry the tip over the margin.
    Some(BorderArrow { tip: tip.clamp(middle - half, middle + half), direction })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrows_stand_on_the_border() {
        let tip = |x, y| border_arrow([200, 100], 10.0, DVec2::new(x, y)).map(|a| a.tip);
        assert_eq!(tip(1.0, 0.0), Some(DVec2::new(190.0, 50.0)));
        assert_eq!(tip(0.0, -7.0), Some(DVec2::new(100.0, 10.0)));
        assert_eq!(tip(-90.0, 40.0), Some(DVec2::new(10.0, 90.0)), "into the corner");
        assert_eq!(tip(3.0, 3.0), Some(DVec2::new(140.0, 90.0)), "45°");
        assert_eq!(tip(1e300, 1e300), tip(1e-300, 1e-300));
    }

    #[test]
    fn a_direction_that_is_none_has_no_arrow() {
        for (x, y) in [(0.0, 0.0), (f64::NAN, 1.0), (1.0, f64::NAN), (f64::INFINITY, 1.0), (1.0, f64::NEG_INFINITY)] {
            assert_eq!(border_arrow([200, 100], 10.0, DVec2::new(x, y)), None, "{x} {y}");
        }
    }

    #[test]
    fn a_picture_smaller_than_its_margin_has_its_arrow_in_the_middle() {
        for margin in [10.0, f64::MAX] {
            let arrow = border_arrow([1, 1], margin, DVec2::X).unwrap();
            assert_eq!((arrow.tip, arrow.direction), (DVec2::splat(0.5), DVec2::X));
        }
        assert_eq!(border_arrow([0, 0], f64::NAN, DVec2::Y).unwrap().tip, DVec2::ZERO);
    }
}
