//! What objects cover of the ground, as effects read it that fade at its rim.
//!
//! Of each footprint a grid of square cells; each lists the edges of the outline that may be near a place in it. Near means at most
//! the *core*: the area of the connected part that the edge goes around, divided by the length of its outline. No part is so narrow that
//! none of it is that deep inside, unless courtyards take up much of it: as one goes inwards outlines grow shorter, so that the area is at
//! most depth times length. Of a strip it is all of the depth, of a square or a circle half of it.
//!
//! Words of a table: the first object, how many there are, then of each where its footprint begins, counted from the table's begin, or 0.
//! Of a footprint: a corner of the grid (x, y, whole metres as i32), the side of a cell (f32, metres), columns and rows (16 bits each),
//! then of each cell where its edges begin, counted from the footprint's begin, and where the last ones end. Of an edge: both ends
//! (f32, metres from the corner) and the core (f32, metres). Edges are right to 2⁻²⁴ of the size of the footprint and 0.5 mm.

use std::sync::{Arc, OnceLock};

use glam::DVec2;

use crate::{
    city::{
        CityModel,
        derived::{Footprint, footprints},
    },
    geom::Aabb,
    lens::{Lens, solids::ShownCity},
    render::{
        content_cities::SceneContents, contents::ContentCity, placed_region::Leaf, standing::Placement,
        volume::LensVolume,
    },
    scene::Scene,
    shader::{PerObject, effect::find},
};

/// Cells of a grid along one axis, at most.
const MOST_CELLS: f64 = 32.0;
/// Words of an edge.
const EDGE: usize = 5;
/// Numbers that f32 holds exactly: effects know where a table begins by one.
const MOST_WORDS: usize = 1 << 24;

/// The footprints of a city's objects.
#[derive(Debug)]
pub struct Footprints {
    list: Vec<Footprint>,
    /// By object, which one.
    of_object: Vec<Option<u32>>,
    words: Vec<OnceLock<Arc<[u32]>>>,
}

impl Footprints {
    /// Of what is shown of a city; of each object by itself where `parts` says so.
    pub fn new(model: &CityModel, shown: &[u32], parts: bool) -> Self {
        let list = footprints(model, shown, parts);
        let mut of_object = vec![None; model.objects.len()];
        for (footprint, i) in list.iter().zip(0..) {
            footprint.objects.iter().for_each(|&object| of_object[object as usize] = Some(i));
        }
        let words = list.iter().map(|_| OnceLock::new()).collect();
        Self { list, of_object, words }
    }

    fn words_of(&self, i: usize, placement: &Placement) -> Arc<[u32]> {
        let made = || words(&self.list[i], placement).into();
        if placement.is_none() { self.words[i].get_or_init(made).clone() } else { made() }
    }

    /// The table of those that `is_wanted`, by object; their numbers are counted from `first`.
    fn table(&self, first: u32, placement: &Placement, is_wanted: impl Fn(u32) -> bool) -> Vec<u32> {
        let count = self.of_object.len();
        let mut table = vec![0; 2 + count];
        (table[0], table[1]) = (first, count as u32);
        let mut begins = vec![0; self.list.len()];
        for object in 0..count {
            let Some(i) = self.of_object[object].filter(|_| is_wanted(object as u32)) else { continue };
            let i = i as usize;
            if begins[i] == 0 {
                let words = self.words_of(i, placement);
                if table.len() + words.len() > MOST_WORDS {
                    continue;
                }
                begins[i] = table.len() as u32;
                table.extend_from_slice(&words);
            }
            table[2 + object] = begins[i];
        }
        table
    }
}

/// A footprint where it stands, as [`self`] says.
fn words(footprint: &Footprint, placement: &Placement) -> Vec<u32> {
    let level = placement.from.z;
    let placed = |p: &DVec2| placement.point(p.extend(level)).truncate();
    // Edges, each with the core of its part.
    let mut edges: Vec<([DVec2; 2], f64)> = Vec::new();
    for part in &footprint.parts {
        let first = edges.len();
        for ring in part {
            let next = ring.iter().cycle().skip(1);
            edges.extend(ring.iter().zip(next).map(|(a, b)| ([placed(a), placed(b)], 0.0)));
        }
        let of_part = &mut edges[first..];
        let origin = of_part.first().map_or(DVec2::ZERO, |([a, _], _)| *a);
        let area: f64 = of_part.iter().map(|([a, b], _)| 0.5 * (*a - origin).perp_dot(*b - origin)).sum();
        let length: f64 = of_part.iter().map(|([a, b], _)| a.distance(*b)).sum();
        of_part.iter_mut().for_each(|(_, core)| *core = area.abs() / length.max(1e-3));
    }
    let bounds = Aabb::from_points(edges.iter().flat_map(|(ends, _)| ends.map(|p| p.extend(0.0))));
    let core = edges.iter().map(|(_, core)| *core).fold(0.0, f64::max);
    let origin = bounds.min.truncate().floor();
    let size = bounds.max.truncate() - origin;
    let cell = (size.max_element() / MOST_CELLS).max(core).max(1.0) as f32;
    let side = f64::from(cell);
    let [columns, rows] = (size / side).to_array().map(|cells| cells.floor() as u32 + 1);
    let mut cells: Vec<Vec<usize>> = vec![Vec::new(); (columns * rows) as usize];
    // Rounding of places and of edges is far less.
    let reach = core + 0.05;
    for (i, ([a, b], _)) in edges.iter().enumerate() {
        let at = |p: DVec2| ((p - origin) / side).floor();
        let last = DVec2::new(f64::from(columns - 1), f64::from(rows - 1));
        let (low, high) =
            (at(a.min(*b) - reach).clamp(DVec2::ZERO, last), at(a.max(*b) + reach).clamp(DVec2::ZERO, last));
        for row in low.y as u32..=high.y as u32 {
            for column in low.x as u32..=high.x as u32 {
                let middle = origin + side * DVec2::new(f64::from(column) + 0.5, f64::from(row) + 0.5);
                // No place of the cell is farther from its middle than half its diagonal.
                if distance_to_edge(middle, [*a, *b]) <= reach + side * std::f64::consts::FRAC_1_SQRT_2 {
                    cells[(row * columns + column) as usize].push(i);
                }
            }
        }
    }
    let corner = origin.to_array().map(|x| x as i32 as u32);
    let mut words = vec![corner[0], corner[1], cell.to_bits(), columns | rows << 16];
    let mut begin = (words.len() + cells.len() + 1) as u32;
    for edges_of_cell in &cells {
        words.push(begin);
        begin += (EDGE * edges_of_cell.len()) as u32;
    }
    words.push(begin);
    for &i in cells.iter().flatten() {
        let ([a, b], core) = edges[i];
        let [a, b] = [a - origin, b - origin];
        words.extend([a.x, a.y, b.x, b.y, core].map(|x| (x as f32).to_bits()));
    }
    words
}

fn distance_to_edge(p: DVec2, [a, b]: [DVec2; 2]) -> f64 {
    let along = b - a;
    let share = ((p - a).dot(along) / along.length_squared().max(1e-12)).clamp(0.0, 1.0);
    p.distance(a + share * along)
}

/// What is made once for the scene's own city.
pub(super) type OwnFootprints = OnceLock<Footprints>;

/// Of each lens of a scene the table of what objects cover that it may act on; none, an empty one, of lenses that have no such effect.
pub(super) fn tables(
    scene: &Scene,
    city: ShownCity,
    own: &OwnFootprints,
    contents: &SceneContents,
    volumes: &[LensVolume],
) -> Vec<Vec<u32>> {
    let asks = |lens: &Lens| {
        let is_of_it = |name: &str| find(name).is_some_and(|e| e.objects == Some(PerObject::Footprints));
        lens.enabled && lens.uses().any(|used| is_of_it(&used.effect))
    };
    let of_lens = |(lens, number): (&Lens, u32)| {
        let volumes: Vec<&LensVolume> = volumes.iter().filter(|v| v.lens == number).collect();
        if !asks(lens) || volumes.is_empty() {
            return vec![0, 0];
        }
        let content = contents.of_lens(number);
        let (first, placement) = content.map_or((0, Placement::NONE), |c| (c.first_object, c.placement));
        let made = match content.and_then(|content| content.city.as_ref()) {
            Some(shown) => shown.footprints.get_or_init(|| of_content(shown)),
            None => own.get_or_init(|| Footprints::new(city.model, city.geometries, false)),
        };
        // Of members these alone; what only some place decides may be any.
        let is_member = |object: u32| {
            volumes.iter().any(|volume| {
                volume.region.leaves().any(|leaf| match &leaf.leaf {
                    Leaf::Members(members) => members.has(object),
                    Leaf::Volume(_) | Leaf::Sprite(_) | Leaf::Own(_) => true,
                })
            })
        };
        made.table(first, &placement, |object| first > 0 || is_member(object))
    };
    scene.lenses.iter().zip(0..).map(of_lens).collect()
}

fn of_content(city: &ContentCity) -> Footprints {
    let (made_of, parts) = &city.made_of;
    if city.is_derived() {
        Footprints::new(&city.source, made_of, *parts)
    } else {
        Footprints::new(&city.model, &city.geometries, false)
    }
}

#[cfg(test)]
mod tests {
    use glam::{DQuat, DVec3, Vec2};
    use proptest::prelude::*;

    use super::*;

    /// What the effect reads of a table: how deep inside a place is, metres, and the core there; `None` where that is more than the core.
    fn depth(table: &[u32], object: u32, place: DVec2) -> Option<[f32; 2]> {
        let of = &table[table[2 + (object - table[0]) as usize] as usize..];
        let number = |at: usize| f32::from_bits(of[at]);
        let at = (place - DVec2::new(f64::from(of[0] as i32), f64::from(of[1] as i32))).as_vec2();
        let (columns, rows) = (of[3] & 0xffff, of[3] >> 16);
        let cell = [at.x, at.y].map(|x| (x / number(2)).max(0.0) as u32);
        let cell = (cell[1].min(rows - 1) * columns + cell[0].min(columns - 1)) as usize;
        let mut nearest: Option<[f32; 2]> = None;
        for edge in (of[4 + cell] as usize..of[5 + cell] as usize).step_by(EDGE) {
            let [a, b] = [edge, edge + 2].map(|at| Vec2::new(number(at), number(at + 1)));
            let along = b - a;
            let share = ((at - a).dot(along) / along.length_squared().max(1e-12)).clamp(0.0, 1.0);
            let distance = at.distance(a + share * along);
            if nearest.is_none_or(|[known, _]| distance < known) {
                nearest = Some([distance, number(edge + 4)]);
            }
        }
        nearest.filter(|[distance, core]| distance < core)
    }

    /// The same from all edges.
    fn brute(footprint: &Footprint, place: DVec2) -> f64 {
        let rings = footprint.parts.iter().flatten();
        let edges = rings.flat_map(|ring| ring.iter().zip(ring.iter().cycle().skip(1)));
        edges.map(|(a, b)| distance_to_edge(place, [*a, *b])).fold(f64::INFINITY, f64::min)
    }

    fn of_rings(parts: &[&[&[[f64; 2]]]]) -> Footprints {
        let ring = |ring: &&[[f64; 2]]| ring.iter().map(|p| DVec2::from(*p)).collect();
        let parts = parts.iter().map(|part| part.iter().map(ring).collect()).collect();
        let list = vec![Footprint { objects: vec![0], parts, is_hull: false }];
        Footprints { list, of_object: vec![Some(0)], words: vec![OnceLock::new()] }
    }

    const FAR: [f64; 2] = [84_000.25, 447_000.5];

    fn rectangle([x, y]: [f64; 2], [w, h]: [f64; 2]) -> [[f64; 2]; 4] {
        let [x, y] = [x + FAR[0], y + FAR[1]];
        [[x, y], [x + w, y], [x + w, y + h], [x, y + h]]
    }

    #[test]
    fn a_rectangle_is_as_deep_as_its_sides_are_far_away() {
        let footprints = of_rings(&[&[&rectangle([0.0, 0.0], [40.0, 10.0])]]);
        let table = footprints.table(7, &Placement::NONE, |_| true);
        let at = |x, y| depth(&table, 7, DVec2::new(FAR[0] + x, FAR[1] + y));
        // Area by length: 400 by 100.
        let near = |found: Option<[f32; 2]>, wanted: f32| {
            let [distance, core] = found.expect("a depth");
            assert!((distance - wanted).abs() < 1e-4 && (core - 4.0).abs() < 1e-5, "{distance} {core}, not {wanted}");
        };
        near(at(20.0, 1.0), 1.0);
        near(at(2.5, 5.0), 2.5);
        near(at(39.5, 9.75), 0.25);
        assert_eq!((at(20.0, 5.0), at(10.0, 4.5)), (None, None), "the core");
        let none = footprints.table(0, &Placement::NONE, |_| false);
        assert_eq!(none, [0, 1, 0]);
    }

    #[test]
    fn each_part_has_a_core_of_its_own_and_stands_where_it_is_put() {
        let (house, shed) = (rectangle([0.0, 0.0], [40.0, 40.0]), rectangle([41.0, 0.0], [4.0, 4.0]));
        let footprints = of_rings(&[&[&house], &[&shed]]);
        let table = footprints.table(0, &Placement::NONE, |_| true);
        let at = |x, y| depth(&table, 0, DVec2::new(FAR[0] + x, FAR[1] + y));
        assert_eq!(at(43.0, 2.0), None, "the middle of the shed is wholly there, however near the house is");
        assert_eq!(at(41.5, 2.0).map(|found| found[1]), Some(1.0));
        assert_eq!(at(30.5, 2.0).map(|found| found[1]), Some(10.0));
        let to = DVec3::new(100.0, 200.0, 5.0);
        let from = DVec3::new(FAR[0], FAR[1], 0.0);
        let rotation = DQuat::from_rotation_z(std::f64::consts::FRAC_PI_2);
        let turned = footprints.table(0, &Placement { from, to, rotation, scale: 0.5 }, |_| true);
        let [distance, core] = depth(&turned, 0, DVec2::new(99.0, 210.0)).expect("a depth");
        assert!((distance - 1.0).abs() < 1e-4 && (core - 5.0).abs() < 1e-4, "{distance} {core}");
    }

    proptest! {
        #![proptest_config(crate::seeds::config())]

        /// Cells leave out no edge that is as near as the core, of outlines with corners anywhere.
        #[test]
        fn cells_leave_out_nothing_near(
            radii in prop::collection::vec(2.0..60.0f64, 3..40),
            places in prop::collection::vec((-60.0..60.0f64, -60.0..60.0f64), 50),
        ) {
            let n = radii.len() as f64;
            let middle = DVec2::from(FAR);
            let corner = |(i, r): (usize, &f64)| (middle + *r * DVec2::from_angle(i as f64 / n * std::f64::consts::TAU)).to_array();
            let ring: Vec<[f64; 2]> = radii.iter().enumerate().map(corner).collect();
            let footprints = of_rings(&[&[&ring]]);
            let table = footprints.table(0, &Placement::NONE, |_| true);
            let edges = ring.iter().zip(ring.iter().cycle().skip(1)).map(|(a, b)| (DVec2::from(*a), DVec2::from(*b)));
            let (area, length) = edges.fold((0.0, 0.0), |(area, length), (a, b)| {
                (area + 0.5 * (a - middle).perp_dot(b - middle), length + a.distance(b))
            });
            let core = area / length;
            for (x, y) in places {
                let place = middle + DVec2::new(x, y);
                let inside = ring.iter().zip(ring.iter().cycle().skip(1)).filter(|(a, b)| {
                    let (a, b) = (DVec2::from(**a), DVec2::from(**b));
                    (a.y > place.y) != (b.y > place.y) && place.x < a.x + (place.y - a.y) / (b.y - a.y) * (b.x - a.x)
                }).count() % 2 == 1;
                if !inside {
                    continue;
                }
                let exact = brute(&footprints.list[0], place);
                match depth(&table, 0, place) {
                    None => prop_assert!(exact > core - 1e-3, "{exact} of {core}"),
                    Some([distance, of]) => {
                        prop_assert!((f64::from(distance) - exact).abs() < 1e-4 && (f64::from(of) - core).abs() < 1e-4);
                    }
                }
            }
        }
    }
}
