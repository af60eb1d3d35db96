//! Room for overlays: what of a picture they leave free, and the layout that covers least of the city.
//!
//! ```text
//!   objects of context lines ─> points over the rectangle around each: no overlay covers them where that can be
//!   sight lines of a grid    ─> cells that show buildings, and cells that show sky or ground
//!   layouts                  ─> as asked for; keeping to empty cells; along one side each ─> the one that covers least of the buildings
//! ```

use glam::DVec2;

use crate::{
    figure::overlays::places::Shown,
    overlay::{Align, Arrangement, Fact, Placed, Rect, Request, place, placed::Seat},
    render::picture::Studio,
    scene::{Poi, PoiPlace, Scene, overlay::Along},
    view::View,
};

/// Cells of a picture, across and down.
const CELLS: [u32; 2] = [64, 36];
/// Of objects that take more than this part of the picture so much of their middle is left free.
const LARGEST: f64 = 0.25;
/// Parts of the objects' rectangles that are left free, the first for which there is room.
const PARTS: [f64; 3] = [1.0, 0.4, 0.1];
/// Points on each side of an object's rectangle at most.
const MOST_ACROSS: f64 = 12.0;
/// Steps by which shares of overlays over buildings are told apart: less is no reason for another place.
const STEPS: f64 = 20.0;

/// Points over the objects that the overlays of `shown` are of, pixels, by how much of each they lie over ([`PARTS`]); `apart`: no farther from
/// each other than an overlay is wide or high.
pub(super) fn over_objects(
    studio: &Studio,
    scene: &Scene,
    view: &View,
    shown: &[&Shown],
    apart: f64,
) -> [Vec<DVec2>; PARTS.len()] {
    let named = shown.iter().flat_map(|one| &one.best_view.pois);
    let mut ids: Vec<&str> =
        named.filter_map(|name| object_of(scene.pois.iter().find(|poi| poi.name == *name)?)).collect();
    ids.sort_unstable();
    ids.dedup();
    let rectangles: Vec<[DVec2; 2]> = ids.into_iter().filter_map(|id| rectangle(studio, view, id)).collect();
    PARTS.map(|part| rectangles.iter().flat_map(|rect| points(*rect, part, view.size, apart)).collect())
}

fn object_of(poi: &Poi) -> Option<&str> {
    if let PoiPlace::Object(id) = &poi.place { Some(id) } else { None }
}

/// The rectangle around what is in the picture of an object: its lower and its higher corner, pixels. `None`: nothing is, or some of it is
/// not before the eye.
fn rectangle(studio: &Studio, view: &View, id: &str) -> Option<[DVec2; 2]> {
    let bulk = studio.bulk(id).ok()?;
    let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for corner in &bulk.corners {
        let pixel = view.pixel(*corner).filter(|p| p.z > view.camera.near_m)?.truncate();
        (low, high) = (low.min(pixel), high.max(pixel));
    }
    let [w, h] = view.size.map(f64::from);
    (low, high) = (low.max(DVec2::ZERO), high.min(DVec2::new(w, h)));
    low.cmplt(high).all().then_some([low, high])
}

/// A grid over the middle of a rectangle, with its sides; so much of it, but no more than [`LARGEST`] of the picture.
fn points([mut low, mut high]: [DVec2; 2], part: f64, picture: [u32; 2], apart: f64) -> Vec<DVec2> {
    let [w, h] = picture.map(f64::from);
    let most = LARGEST * w * h / (high - low).element_product();
    let (middle, less) = (0.5 * (low + high), part.min(most).sqrt());
    (low, high) = (middle + less * (low - middle), middle + less * (high - middle));
    let count = ((high - low) / apart.max(1.0)).ceil().clamp(DVec2::ONE, DVec2::splat(MOST_ACROSS));
    let at = |i: u32, j: u32| low + (high - low) * DVec2::new(f64::from(i), f64::from(j)) / count;
    (0..=count.y as u32).flat_map(|j| (0..=count.x as u32).map(move |i| at(i, j))).collect()
}

/// The middles of the cells of a picture that show anything of the city but ground, pixels.
pub(super) fn busy(studio: &Studio, view: &View) -> Vec<DVec2> {
    let places = studio.places();
    cells(view.size).filter(|at| places.shows_building(&view.ray(*at))).collect()
}

/// The middles of the cells of a picture, pixels.
fn cells(picture: [u32; 2]) -> impl Iterator<Item = DVec2> {
    let side = [0, 1].map(|i| f64::from(picture[i]) / f64::from(CELLS[i]));
    let middle = move |x: u32, y: u32| (DVec2::new(x.into(), y.into()) + 0.5) * DVec2::from(side);
    (0..CELLS[1]).flat_map(move |y| (0..CELLS[0]).map(move |x| middle(x, y)))
}

/// Places overlays where `asked` has them, but that they leave free what they are of (`over_objects`), as far as that makes them no smaller by more
/// than a step; and that where the scene leaves the side to the program it is the one on which they cover least of the buildings, and they keep to the
/// sky and the ground where that costs nothing else. With a frame before they stay as they are.
pub(super) fn placed(
    asked: &Request,
    over_objects: [Vec<DVec2>; PARTS.len()],
    along: Along,
    busy: &[DVec2],
    before: Option<&Placed>,
) -> Placed {
    let arranged = |arrangement: Arrangement| {
        let mut other = asked.clone();
        other.layout.arrangement = arrangement;
        other
    };
    if let Some(before) = before {
        let stays = if along == Along::Border { before.request.layout.arrangement } else { asked.layout.arrangement };
        let is_as_good = |placed: &Placed| placed.step <= before.step && placed.folded.len() <= before.folded.len();
        let as_it_was = leaving_free(&arranged(stays), &over_objects, Some(before));
        return match is_as_good(&as_it_was) {
            true => as_it_was,
            // There may be more room on all sides.
            false => leaving_free(asked, &over_objects, Some(before)),
        };
    }
    let others: &[Arrangement] = match along {
        Along::Border => &[
            Arrangement::Horizontal(Align::First),
            Arrangement::Vertical(Align::Last),
            Arrangement::Vertical(Align::First),
            Arrangement::Vertical(Align::Both),
            Arrangement::Horizontal(Align::Last),
        ],
        _ => &[],
    };
    let first = leaving_free(asked, &over_objects, None);
    // Of the points that what is placed now leaves free; what is asked of a frame after this one has none of buildings.
    let avoid = first.request.avoid.clone();
    let is_asked = |point: usize| point < avoid.len();
    let place_as = |request: Request| place(&Request { avoid: avoid.clone(), ..request }, None);
    let mut avoiding = Request { avoid: avoid.clone(), ..asked.clone() };
    avoiding.avoid.extend(busy);
    let cost = |placed: &Placed| cost(placed, busy, is_asked);
    let as_asked = cost(&first).0;
    let all = std::iter::once(place(&avoiding, None)).chain(others.iter().map(|other| place_as(arranged(*other))));
    let better = all.map(|other| (cost(&other), other)).filter(|((cost, _), _)| *cost < as_asked);
    let mut least = better.min_by_key(|(cost, _)| *cost).map_or(first, |(_, other)| other);
    least.request.avoid = avoid;
    least
}

/// Places overlays so that they leave free as much of the objects that they are of as makes them no smaller by more than a step than if they
/// left nothing free, and folds none.
fn leaving_free(asked: &Request, over_objects: &[Vec<DVec2>; PARTS.len()], before: Option<&Placed>) -> Placed {
    if over_objects[0].is_empty() {
        return place(asked, before);
    }
    let plain = place(asked, None);
    let over = |points: &Vec<DVec2>| {
        let avoid = asked.avoid.iter().chain(points).copied().collect();
        place(&Request { avoid, ..asked.clone() }, before)
    };
    let is_good = |placed: &Placed| placed.step <= plain.step + 1 && placed.folded.len() <= plain.folded.len();
    let mut all = over_objects.iter().map(over);
    let last = all.next_back();
    all.find(is_good).or(last).unwrap_or(plain)
}

/// What is worse about places, the most important first: overlays without one, points that are covered, how much all are shrunk, overlays that
/// stand further inward, lines that cross, twentieths of their area over buildings; and, of what is alike in these, the hundredths of a picture's width and height that lines are long.
fn cost(placed: &Placed, busy: &[DVec2], is_asked: impl Fn(usize) -> bool) -> ([usize; 6], u32) {
    let covered = placed.facts.iter().map(|fact| match fact {
        Fact::Covers { points, .. } => points.iter().filter(|point| is_asked(**point)).count(),
        _ => 0,
    });
    let rects: Vec<Rect> = placed.placements.iter().map(|placement| placement.rect).collect();
    let [w, h] = placed.request.picture.map(f64::from);
    let is_under = |at: &DVec2| rects.iter().any(|rect| rect.covers(*at, 0.0));
    let under = cells(placed.request.picture).filter(is_under).count();
    let over = busy.iter().filter(|at| is_under(at)).count();
    let share = over as f64 / under.max(1) as f64;
    let inward = placed.placements.iter().filter(|placement| matches!(placement.seat, Seat::Inward(_))).count();
    let length = placed.lines.iter().flat_map(|line| line.points.windows(2)).map(|ends| ends[0].distance(ends[1]));
    let twentieths = (STEPS * share).round() as usize;
    let hundredths = (100.0 * length.sum::<f64>() / (w + h)).round() as u32;
    let crossings = placed.crossings.sum() as usize;
    ([placed.folded.len(), covered.sum(), placed.step as usize, inward, crossings, twentieths], hundredths)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::overlay::{self, Focus, LineKind, SizeRule};

    fn one(id: u32, size: [f64; 2], at: [f64; 2]) -> overlay::Overlay {
        let size = DVec2::from(size);
        overlay::Overlay {
            id,
            priority: 0.0,
            min: 0.5 * size,
            preferred: size,
            max: size,
            anchors: vec![Focus::Point(at.into())],
            lines: LineKind::Straight,
            weight: 0.5,
            distance: 10.0,
        }
    }

    fn request(overlays: Vec<overlay::Overlay>, avoid: Vec<DVec2>) -> Request {
        Request {
            picture: [960, 540],
            overlays,
            avoid,
            clearance: 6.0,
            blocked: Vec::new(),
            layout: overlay::Layout {
                arrangement: Arrangement::Border,
                along: overlay::Along::Even,
                size: SizeRule::Preferred,
                margin: 12,
                gap: 9,
                ..overlay::Layout::default()
            },
        }
    }

    /// The middles of the cells of rows, 15 pixels each.
    fn rows(rows: std::ops::Range<u32>) -> Vec<DVec2> {
        let middle = |x: u32, y: u32| DVec2::new(f64::from(x) * 15.0 + 7.5, f64::from(y) * 15.0 + 7.5);
        rows.flat_map(|y| (0..64).map(move |x| middle(x, y))).collect()
    }

    /// No objects.
    const NOTHING: [Vec<DVec2>; PARTS.len()] = [const { Vec::new() }; PARTS.len()];

    #[test]
    fn overlays_keep_to_the_sky() {
        // Houses from the thirteenth row of cells on; the place that the overlay is of is near the lower border.
        let asked = request(vec![one(0, [210.0, 140.0], [480.0, 500.0])], Vec::new());
        let plain = place(&asked, None).placements[0].rect;
        assert!(plain.max[1] > 300, "without knowing better it stands below: {plain:?}");
        let found = placed(&asked, NOTHING, Along::Border, &rows(12..36), None);
        let rect = found.placements[0].rect;
        assert!(rect.max[1] <= 200, "{rect:?}");
        // In the frame after it stays there, and where the scene says the side it is that one.
        let next = placed(&asked, NOTHING, Along::Border, &[], Some(&found));
        assert_eq!(next.placements[0].rect, rect);
        let mut below = asked;
        below.layout.arrangement = Arrangement::Horizontal(Align::Last);
        let rect = placed(&below, NOTHING, Along::Bottom, &rows(12..36), None).placements[0].rect;
        assert!(rect.max[1] > 500, "{rect:?}");
    }

    #[test]
    fn no_place_is_left_for_less_than_it_costs() {
        // All of the picture shows houses: it is as if nobody had looked.
        let asked = request(vec![one(0, [210.0, 140.0], [480.0, 500.0])], Vec::new());
        let found = placed(&asked, NOTHING, Along::Border, &rows(0..36), None);
        assert_eq!(found.placements, place(&asked, None).placements);
    }

    #[test]
    fn an_object_is_not_covered_by_an_overlay_of_any_size() {
        for (rect, size) in [
            ([[300.0, 0.0], [700.0, 540.0]], [200.0, 130.0]),
            ([[0.0, 300.0], [960.0, 420.0]], [150.0, 100.0]),
            ([[0.0, 0.0], [420.0, 200.0]], [240.0, 160.0]),
        ] {
            let rect = rect.map(DVec2::from);
            let middle = 0.5 * (rect[0] + rect[1]);
            let over = PARTS.map(|part| points(rect, part, [960, 540], 0.5 * size[1]));
            let asked = request(vec![one(0, size, middle.into())], Vec::new());
            let found = placed(&asked, over, Along::Border, &[], None);
            let stands = found.placements[0].rect;
            // Of an object that is larger than a quarter of the picture the middle is left free.
            let share = ((rect[1] - rect[0]).element_product() / (960.0 * 540.0) / LARGEST).max(1.0).sqrt();
            let free = [rect[0], rect[1]].map(|corner| middle + (corner - middle) / share);
            let apart = |i: usize| {
                f64::from(stands.max[i]) <= free[0][i] + 1e-9 || f64::from(stands.min[i]) >= free[1][i] - 1e-9
            };
            assert!(apart(0) || apart(1), "{rect:?}: {stands:?}");
        }
    }
}
