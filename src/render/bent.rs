//! Lenses that bend rays as the GPU reads them, and where in the picture they are.

use glam::DVec2;

use crate::{
    lens::{
        ray::{FisheyeProjection, RayMethod, RayOutline, SAMPLED_KNOTS},
        ray_path::{ImageBend, RayPaths, Rim},
        share_field::ShareField,
    },
    render::{eye::PictureTile, layout, palette, screen_bound::ScreenBound},
    shader::MOST_RAY_LENSES,
    view::View,
};

/// Pixels around a rim: samples lie up to half a pixel beside the pixels' centres.
const MARGIN_PX: f64 = 1.0;

/// Lines of a grid from the middle of a lens to its rim, where it bends nothing.
const GRID_LINES: f64 = 8.0;
/// As `lib/view.wgsl` has it.
const FAR_AWAY: f32 = 1e30;

/// The part of a tile in which a rim lies.
pub(super) fn part_of(rim: &Rim, view: &View, tile: PictureTile) -> Option<ScreenBound> {
    let size = DVec2::new(view.size[0].into(), view.size[1].into());
    let half = view.half_extent();
    let center = DVec2::new(0.5 + 0.5 * rim.center.x / half.x, 0.5 - 0.5 * rim.center.y / half.y) * size;
    let radius = rim.radius / (2.0 * half.y) * size.y + MARGIN_PX;
    let diagonal = match rim.outline {
        RayOutline::Circle => std::f64::consts::SQRT_2 * radius,
        RayOutline::Square => 2.0 * radius,
    };
    let reach = [radius, radius, diagonal, diagonal];
    let middle = [center.x, center.y, center.x + center.y, center.x - center.y];
    let ends = |sign: f64| std::array::from_fn(|i| middle[i] + sign * reach[i]);
    ScreenBound::around(ends(-1.0), ends(1.0)).within(tile)
}

/// The part of a tile in which rays may be bent.
pub(super) fn bound(paths: &RayPaths, view: &View, tile: PictureTile) -> Option<ScreenBound> {
    paths.rims().filter_map(|rim| part_of(rim, view, tile)).reduce(ScreenBound::with)
}

/// The parts of a tile, pixels from its first, in which rays may be bent by lenses of these methods; no two have a pixel in common.
pub(super) fn parts(
    paths: &RayPaths,
    view: &View,
    tile: PictureTile,
    is_wanted: impl Fn(RayMethod) -> bool,
) -> Vec<PictureTile> {
    let rims = paths.rims().filter(|rim| is_wanted(rim.method));
    PictureTile::apart(rims.filter_map(|rim| part_of(rim, view, tile)).map(|part| part.rectangle()))
}

/// All of them as the shaders read them.
pub(super) fn uniform(paths: &RayPaths) -> layout::RayLenses {
    let mut made: layout::RayLenses = bytemuck::Zeroable::zeroed();
    let images = paths.images.len().min(MOST_RAY_LENSES);
    let planes = paths.planes.len().min(MOST_RAY_LENSES - images);
    (made.images, made.planes) = (images as u32, planes as u32);
    let mut knots = 0;
    for (lens, own) in made.lenses.iter_mut().zip(&paths.images) {
        *lens = of_rim(&own.rim);
        match &own.bend {
            ImageBend::Sampled(radius) => {
                lens.kind = layout::RAY_SAMPLED;
                (lens.first_knot, lens.knots) = (knots as u32, radius.knots.len() as u32);
                for (knot, [at, shown, slope]) in made.knots[knots..].iter_mut().zip(&radius.knots) {
                    *knot = [*at as f32, *shown as f32, *slope as f32, 0.0];
                }
                knots += SAMPLED_KNOTS;
            }
            ImageBend::Round(angle, projection) => {
                lens.angle = (0.5 * angle) as f32;
                lens.kind = match projection {
                    FisheyeProjection::Angular => layout::RAY_ANGULAR,
                    FisheyeProjection::Hemispherical => layout::RAY_HEMISPHERICAL,
                };
            }
            ImageBend::Own(own) => {
                lens.kind = layout::RAY_OWN;
                (lens.first_knot, lens.knots) = (knots as u32, own.handler);
                for (knot, four) in made.knots[knots..].iter_mut().zip(own.parameters.chunks(4)) {
                    knot.iter_mut().zip(four).for_each(|(slot, number)| *slot = *number);
                }
                knots += own.parameters.len().div_ceil(4).min(SAMPLED_KNOTS);
            }
        }
    }
    let mut fields = 0;
    for (lens, own) in made.lenses[images..].iter_mut().zip(&paths.planes) {
        *lens = layout::RayLens {
            border: own.border as f32,
            distance: own.distance as f32,
            until: own.until as f32,
            power: own.power as f32,
            kind: layout::RAY_PLANE,
            ..of_rim(&own.rim)
        };
        if own.rim.field.is_some() {
            (lens.outline, lens.first_knot) = (layout::OUTLINE_FIELD, fields);
            fields += 1;
        }
    }
    let of_method = |method: RayMethod| {
        let rims = paths.rims().take(MOST_RAY_LENSES).enumerate();
        rims.filter(|(_, rim)| rim.method == method).map(|(bit, _)| 1_u32 << bit).sum::<u32>()
    };
    (made.followed, made.warped) = (of_method(RayMethod::Rays), of_method(RayMethod::Image));
    made.moved = of_method(RayMethod::Vertices);
    let chosen = made.chosen.as_flattened_mut().iter_mut();
    chosen.zip(paths.rims()).for_each(|(slot, rim)| *slot = rim.only.as_ref().map_or(0, |only| only.first + 1));
    made.stretch = paths.stretch().map_or(FAR_AWAY, |stretch| stretch as f32);
    let events = paths.events();
    made.events = events.len().min(made.along.len()) as u32;
    for (slot, event) in made.along.iter_mut().zip(&events) {
        let lens = (images + event.plane) as u32;
        *slot = layout::RayEvent { distance: event.distance as f32, lens, ends: u32::from(event.ends), reserved: 0 };
    }
    made
}

fn of_rim(rim: &Rim) -> layout::RayLens {
    layout::RayLens {
        center: rim.center.as_vec2().to_array(),
        radius: rim.radius as f32,
        outline: u32::from(rim.outline == RayOutline::Square),
        grid: if rim.grid.is_some() { (rim.radius / GRID_LINES) as f32 } else { 0.0 },
        color: rim.grid.map_or([0.0; 3], palette::linear),
        ..bytemuck::Zeroable::zeroed()
    }
}

/// The fields of lenses that have some, one below the other: texels of a picture of [`SIDE`](crate::lens::share_field::SIDE) across.
pub(super) fn fields(paths: &RayPaths) -> Vec<&ShareField> {
    paths.planes.iter().filter_map(|lens| lens.rim.field.as_deref()).collect()
}
