//! Where the silhouettes of lenses pass, as far as that is known in closed form: elsewhere their outlines draw nothing, whatever their
//! bounds are.

use glam::{DVec2, DVec3};

use crate::{
    geom::{
        Ray,
        shape::{Sphere, Volume, VolumeForm},
    },
    lens::LensBody,
    render::{eye::PictureTile, volume::LensVolume},
    shader::LensTest,
    view::View,
};

/// Of a lens: the balls whose silhouettes its outline follows; none where it may be anywhere.
#[derive(Clone, Debug, Default)]
pub struct Silhouette(Option<Vec<(DVec3, f64)>>);

impl Silhouette {
    /// Of the volumes of a lens that are in view.
    pub fn of<'a>(volumes: impl Iterator<Item = &'a LensVolume>) -> Self {
        let ball = |volume: &LensVolume| match volume.region.volume() {
            Some(Volume::Sphere(Sphere { center, radius }))
                if volume.drawn == LensBody::Outline && volume.test(false) == LensTest::volume(VolumeForm::Sphere) =>
            {
                Some((*center, *radius))
            }
            _ => None,
        };
        Self(volumes.map(ball).collect())
    }

    /// Whether a line along it may be seen by some rays.
    ///
    /// A ray passes the middle of a ball at `m`; |m − r| is at most the distance of the middle times the angle from the ray to the silhouette.
    pub fn may_be_seen_by(&self, rays: &Rays) -> bool {
        let Some(balls) = &self.0 else { return true };
        let Rays { middle: Ray { origin, direction }, turn, are_parallel } = *rays;
        balls.iter().any(|(center, radius)| {
            let to_center = *center - origin;
            let away = to_center.length();
            let along = to_center.dot(direction) / direction.length_squared();
            let miss = (to_center - along * direction).length();
            // And what is lost to rounding.
            (miss - radius).abs() <= if are_parallel { turn } else { turn * away } + 1e-6 * away
        })
    }
}

/// The rays of a rectangle of the picture.
#[derive(Clone, Copy, Debug)]
pub struct Rays {
    middle: Ray,
    /// No ray of it turns from that of its middle by more: the half diagonal at distance 1; parallel ones are no more than this aside, metres.
    turn: f64,
    are_parallel: bool,
}

impl Rays {
    /// Of a rectangle that is so many pixels larger on all sides.
    pub fn of(view: &View, PictureTile { origin, size }: PictureTile, margin_px: f64) -> Self {
        let [origin, size] = [origin, size].map(|[x, y]| DVec2::new(x.into(), y.into()));
        let turn = (0.5 * size + margin_px).length() * view.pixel_m(1.0);
        Self { middle: view.ray(origin + 0.5 * size), turn, are_parallel: view.is_orthographic() }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::{geom::Aabb, view::Camera};

    proptest! {
        #![proptest_config(crate::seeds::config())]

        #[test]
        fn where_no_silhouette_is_all_rays_meet_the_ball_or_none(
            eye in prop::array::uniform3(-30.0..30.0_f64),
            radius in 0.5..28.0_f64,
            fov in prop_oneof![1e-3..0.1_f64, 0.1..3.1_f64],
            height in prop_oneof![Just(None), (0.1..90.0_f64).prop_map(Some)],
            at in prop::array::uniform2(0_u32..9),
        ) {
            let size = [288, 288];
            let eye = DVec3::from(eye);
            prop_assume!(eye.length() > 0.1);
            let camera = Camera::looking(eye, DVec3::new(0.3, radius * 0.9, 0.2), fov);
            let camera = match height {
                Some(height_m) => Camera { projection: crate::view::Projection::Orthographic { height_m }, ..camera },
                None => camera,
            };
            let Ok(view) = View::new(camera, size, &Aabb::EMPTY) else { return Ok(()) };
            let tile = PictureTile { origin: at.map(|i| 32 * i), size: [32; 2] };
            let ball = Silhouette(Some(vec![(DVec3::ZERO, radius)]));
            let volume = Volume::Sphere(Sphere { center: DVec3::ZERO, radius });
            let margin = 4;
            let meets = |x: i32, y: i32| {
                let [x, y] = [x + tile.origin[0] as i32, y + tile.origin[1] as i32].map(|i| f64::from(i) + 0.5);
                volume.entry_exit(&view.ray(DVec2::new(x, y))).is_some()
            };
            let all = (-margin..32 + margin).flat_map(|y| (-margin..32 + margin).map(move |x| (x, y)));
            let found: Vec<bool> = all.map(|(x, y)| meets(x, y)).collect();
            let is_mixed = found.contains(&true) && found.contains(&false);
            prop_assert!(!is_mixed || ball.may_be_seen_by(&Rays::of(&view, tile, f64::from(margin))));
        }
    }

    #[test]
    fn lines_touch_few_tiles() {
        let camera = Camera::looking(DVec3::new(0.0, -40.0, 0.0), DVec3::ZERO, 0.8);
        let view = View::new(camera, [960, 960], &Aabb::EMPTY).expect("a view");
        let ball = Silhouette(Some(vec![(DVec3::ZERO, 10.0)]));
        let tiles = (0..30).flat_map(|y| (0..30).map(move |x| PictureTile { origin: [32 * x, 32 * y], size: [32; 2] }));
        let touched = tiles.filter(|tile| ball.may_be_seen_by(&Rays::of(&view, *tile, 4.0))).count();
        // A ring of 290 pixels' radius goes through 72 of them, and beside as many in reach of the diagonal.
        assert!((72..250).contains(&touched), "{touched} of 900");
        let corner = Rays::of(&view, PictureTile { origin: [0; 2], size: [32; 2] }, 4.0);
        assert!(Silhouette::default().may_be_seen_by(&corner));
    }
}
