//! Soft borders of lenses: the degree of interest.

use crate::view::View;

/// How a lens ends: over a width around its border, half of it inside and half outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Border {
    /// δ, ≥ 0; 0 ends at once.
    pub width: f64,
    /// What the width is measured in.
    pub unit: BorderUnit,
    /// How what cannot be had by halves ends: what hides.
    pub discrete: Discrete,
}

/// What the width of a border is measured in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BorderUnit {
    /// Metres.
    #[default]
    Metres,
    /// Pixels at the distance of what is shown: the width in metres grows with it.
    Pixels,
    /// Metres along the ray: a lens is all there within half the width of where the ray enters and leaves it, and nowhere else.
    Ray,
}

/// How effects end that are there or not.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Discrete {
    /// At once, where the degree of interest is ½: at the border itself.
    #[default]
    Threshold,
    /// Pixel by pixel, more of them the higher the degree of interest; the mean of many samples is smooth.
    Dither,
}

impl Border {
    /// How far outside of the volumes a lens acts, metres, for what an eye sees of something no further away than `distance_m`
    /// along its axis.
    pub fn reach_m(&self, view: &View, distance_m: f64) -> f64 {
        let half = 0.5 * self.width;
        match self.unit {
            BorderUnit::Metres | BorderUnit::Ray => half,
            BorderUnit::Pixels if view.is_orthographic() => half * metres_per_pixel(view, 1.0),
            BorderUnit::Pixels => {
                // What is shown lies at most its own share of its distance behind the volume.
                let share = half * metres_per_pixel(view, 1.0);
                if share < 0.5 { share / (1.0 - share) * distance_m.max(0.0) } else { f64::INFINITY }
            }
        }
    }

    /// δ in metres at a distance along the view axis, metres.
    pub fn width_m(&self, view: &View, distance_m: f64) -> f64 {
        match self.unit {
            BorderUnit::Metres | BorderUnit::Ray => self.width,
            BorderUnit::Pixels => self.width * metres_per_pixel(view, distance_m),
        }
    }
}

/// Height of a pixel at a distance along the view axis, metres.
fn metres_per_pixel(view: &View, distance_m: f64) -> f64 {
    let per_distance = 2.0 * view.half_extent().y / f64::from(view.size[1]);
    if view.is_orthographic() { per_distance } else { per_distance * distance_m }
}

/// The degree of interest at a signed distance from a lens, outside +, of a border `width` wide: 1 inside, 0 outside,
/// smooth between. Both in the same unit.
pub fn degree_of_interest(distance: f64, width: f64) -> f64 {
    if width <= 0.0 {
        return f64::from(u8::from(distance <= 0.0));
    }
    let t = (0.5 - distance / width).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn it_is_one_half_at_the_border_and_ends_half_a_width_from_it() {
        for (distance, wanted) in [(-9.0, 1.0), (-2.0, 1.0), (-1.0, 0.843_75), (0.0, 0.5), (1.0, 0.156_25), (2.0, 0.0)]
        {
            assert_eq!(degree_of_interest(distance, 4.0), wanted, "{distance}");
        }
        assert_eq!([-1e-9, 0.0, 1e-9].map(|d| degree_of_interest(d, 0.0)), [1.0, 1.0, 0.0]);
    }

    proptest! {
        #![proptest_config(crate::seeds::config())]

        #[test]
        fn both_sides_share_what_there_is(distance in -50.0..50.0_f64, width in 0.01..60.0_f64) {
            let both = degree_of_interest(distance, width) + degree_of_interest(-distance, width);
            prop_assert!((both - 1.0).abs() < 1e-12);
        }
    }
}
