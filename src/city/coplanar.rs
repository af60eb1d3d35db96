//! Triangles that lie in one plane and cover each other: party walls, doors in walls, floors on the ground.
//!
//! Depth cannot tell them apart, so a fixed order does: the same triangle wins in every frame, from every side (hard
//! case 3). Which planes are the same is known exactly from load ([`CityModel::planes`]).

use std::{
    cmp::Reverse,
    collections::BTreeSet,
    sync::atomic::{AtomicUsize, Ordering},
};

use glam::{DVec2, DVec3};
use rayon::prelude::*;
use rustc_hash::FxHashMap;

use crate::{
    city::model::{CityModel, NONE, ObjectClass, StringId},
    geom::{Aabb, bvh::Bvh},
};

/// Triangles that overlap on less than this do not cover each other, square metres.
const LEAST_AREA_M2: f64 = 1e-6;
/// Nor do those whose overlap is narrower than this, metres: the f32 positions of neighbours differ by some 10⁻⁵.
const LEAST_WIDTH_M: f64 = 5e-5;
/// Positions in different tiles differ by less than this where they are meant to be the same, metres.
const ROUNDING_M: f64 = 1e-3;
/// Planes of more triangles than this use a hierarchy, fewer are tried pair by pair.
const PAIRWISE: usize = 32;
/// Others that are looked for of each triangle in a hierarchy.
const MOST_OVER: usize = 256;
/// How many are tried for each of these.
const TRIES: usize = 16;
/// Triangles of one plane that overlap more, of which it is still found out which overlap each other; and layers, each of which is a draw.
const MOST_BROAD: usize = 2048;

/// A triangle that shares its place with another one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CoplanarTriangle {
    /// Its tile, by index.
    pub tile: u32,
    /// Index into [`CityModel::planes`].
    pub triangle: u32,
    /// Number of its plane: [`CityModel::plane_equations`] at `group - 1`.
    pub group: u32,
    /// Within the group, 0 and up, no two alike; of triangles at one place the highest is seen.
    pub priority: u32,
    /// The number of triangles that lie below it at most, one on the other: triangles of one layer do not overlap, and one that
    /// overlaps another has the higher layer if it has the higher priority.
    pub layer: u32,
}

/// All triangles of the geometries `shown` that another shown triangle covers, whatever side they face: by group, then
/// by priority.
///
/// The priority: what stands on the ground is above it; doors and windows are above roofs, roofs above walls, walls
/// above other surfaces, these above ground surfaces; then the object whose id comes first in byte order; then what was
/// read first.
pub fn coplanar_triangles(model: &CityModel, shown: &[u32]) -> Vec<CoplanarTriangle> {
    stacked_triangles(model, shown, &[])
}

/// The same, but of two triangles that cover each other that is above that was higher, in the middle of what they share.
/// `heights`: of each corner of each triangle of the model; empty: as [`coplanar_triangles`] has it.
pub fn stacked_triangles(model: &CityModel, shown: &[u32], heights: &[[f32; 3]]) -> Vec<CoplanarTriangle> {
    let mut members: Vec<CoplanarTriangle> = Vec::new();
    for geometry in shown.iter().filter_map(|&geometry| model.geometries.get(geometry as usize)) {
        for number in geometry.tiles.clone() {
            let indices = &model.tiles[number as usize].indices;
            for triangle in indices.start / 3..indices.end / 3 {
                let group = model.planes[triangle as usize];
                if group != 0 {
                    members.push(CoplanarTriangle { tile: number, triangle, group, priority: 0, layer: 0 });
                }
            }
        }
    }
    members.par_sort_unstable_by_key(|member| u64::from(member.group) << 32 | u64::from(member.triangle));
    let ranks: FxHashMap<StringId, u8> = surface_ranks(model);
    let groups: Vec<&[CoplanarTriangle]> =
        members.chunk_by(|a, b| a.group == b.group).filter(|group| group.len() > 1).collect();
    let crowded = AtomicUsize::new(0);
    let covered = groups.into_par_iter().flat_map_iter(|group| {
        let (members, own) = covered(model, group, &ranks, heights);
        crowded.fetch_add(own, Ordering::Relaxed);
        members
    });
    let all = covered.collect();
    let crowded = crowded.into_inner();
    if crowded > 0 {
        log::warn!(
            "{crowded} triangles lie in one plane and each over {MOST_OVER} others or more; which of them is seen is not sure"
        );
    }
    all
}

/// The members of one plane that cover another one, by priority; and how many lie over or under more others than are looked at.
fn covered(
    model: &CityModel,
    group: &[CoplanarTriangle],
    ranks: &FxHashMap<StringId, u8>,
    heights: &[[f32; 3]],
) -> (Vec<CoplanarTriangle>, usize) {
    let corners: Vec<[DVec3; 3]> = group.iter().map(|member| world_corners(model, member)).collect();
    let flat = flatten(&corners, model.plane_equations[group[0].group as usize - 1].normal);
    // Which others each one overlaps.
    let (others, crowded): (Vec<Vec<u32>>, usize) = if group.len() <= PAIRWISE {
        let of = |i: usize| -> Vec<u32> {
            (0..group.len()).filter(|&j| i != j && overlap(&flat[i], &flat[j])).map(|j| j as u32).collect()
        };
        ((0..group.len()).map(of).collect(), 0)
    } else {
        // Flat boxes of one plane may lie apart by the rounding of their tiles.
        let grown = |bounds: Aabb| Aabb { min: bounds.min - ROUNDING_M, max: bounds.max + ROUNDING_M };
        let boxes: Vec<Aabb> = corners.iter().map(|&corners| grown(Aabb::from_points(corners))).collect();
        mutual(&boxes, &|i, j| overlap(&flat[i], &flat[j]))
    };
    let mut order: Vec<usize> = (0..group.len()).filter(|&i| !others[i].is_empty()).collect();
    if heights.is_empty() {
        order.sort_by_cached_key(|&i| {
            let member = &group[i];
            let surface = model.surfaces[first_vertex_surface(model, member) as usize];
            let object = &model.objects[surface.object as usize];
            let rank = ranks.get(&surface.kind).copied().unwrap_or(OTHER_SURFACE);
            (class_rank(object.class), rank, Reverse(&object.id), Reverse(member.triangle))
        });
    } else {
        let base = corners[0][0];
        let raised = |(member, corners): (&CoplanarTriangle, &[DVec3; 3])| {
            let heights = heights[member.triangle as usize].map(f64::from);
            [0, 1, 2].map(|k| ((corners[k] - base).truncate(), heights[k]))
        };
        let raised: Vec<Raised> = group.iter().zip(&corners).map(raised).collect();
        order = stacked(order, &others, &raised);
    }
    // From the lowest up: one layer above the highest that it overlaps.
    let mut layers: Vec<Option<u32>> = vec![None; group.len()];
    let number = |(priority, i): (usize, usize)| {
        let below = others[i].iter().filter_map(|&j| layers[j as usize]).max();
        let layer = below.map_or(0, |layer| layer + 1).min(MOST_BROAD as u32 - 1);
        layers[i] = Some(layer);
        CoplanarTriangle { priority: priority as u32, layer, ..group[i] }
    };
    (order.into_iter().enumerate().map(number).collect(), crowded)
}

/// Of some triangles of a plane, by their boxes: which others each one overlaps, or `most` of them and `false`.
fn overlapping(
    some: &[usize],
    boxes: &[Aabb],
    most: usize,
    overlap: &(impl Fn(usize, usize) -> bool + Sync),
) -> Vec<(Vec<u32>, bool)> {
    let own: Vec<Aabb> = some.iter().map(|i| boxes[*i]).collect();
    let bvh = Bvh::build(&own);
    let of = |i: &usize| {
        let is_other = |j: u32| some[j as usize] != *i && overlap(*i, some[j as usize]);
        let (found, is_whole) = bvh.some_in_box(&boxes[*i], most, TRIES, is_other);
        (found.into_iter().map(|j| some[j as usize] as u32).collect(), is_whole)
    };
    some.par_iter().map(of).collect()
}

/// Which others each triangle of a plane overlaps. Where not all are looked for, one that many lie over is in the lists of these, and such broad
/// ones are looked for among each other. And of how many not even those are known.
fn mutual(boxes: &[Aabb], overlap: &(impl Fn(usize, usize) -> bool + Sync)) -> (Vec<Vec<u32>>, usize) {
    let all: Vec<usize> = (0..boxes.len()).collect();
    let (mut others, are_whole): (Vec<Vec<u32>>, Vec<bool>) =
        overlapping(&all, boxes, MOST_OVER, overlap).into_iter().unzip();
    let broad: Vec<usize> = all.into_iter().filter(|i| !are_whole[*i]).collect();
    if broad.is_empty() {
        return (others, 0);
    }
    let mut more: Vec<Vec<u32>> = vec![Vec::new(); others.len()];
    for (i, own) in others.iter().enumerate() {
        own.iter().filter(|j| !are_whole[**j as usize]).for_each(|j| more[*j as usize].push(i as u32));
    }
    let most = if broad.len() <= MOST_BROAD { MOST_BROAD } else { MOST_OVER };
    let mut unsure = 0;
    for (i, (among, is_whole)) in broad.iter().zip(overlapping(&broad, boxes, most, overlap)) {
        unsure += usize::from(!is_whole);
        others[*i].append(&mut more[*i]);
        others[*i].extend(among);
        others[*i].sort_unstable();
        others[*i].dedup();
    }
    (others, unsure)
}

/// A level triangle, and how high each corner was.
type Raised = [(DVec2, f64); 3];

/// Triangles from the lowest up: each after all that it covers and that were below it. Where some go round in a circle, that whose
/// highest corner is lowest is taken first.
fn stacked(members: Vec<usize>, others: &[Vec<u32>], raised: &[Raised]) -> Vec<usize> {
    let top = |i: usize| raised[i].iter().fold(0.0, |top: f64, (_, z)| top.max(*z));
    // Heights are not negative, so their bits are in their order.
    let key = |i: usize| (top(i).to_bits(), i);
    let mut above: Vec<Vec<usize>> = vec![Vec::new(); raised.len()];
    let mut below = vec![0_u32; raised.len()];
    for &i in &members {
        for j in others[i].iter().map(|&j| j as usize).filter(|&j| j > i) {
            let (low, high) = if is_above(&raised[i], &raised[j]).unwrap_or(key(i) > key(j)) { (j, i) } else { (i, j) };
            above[low].push(high);
            below[high] += 1;
        }
    }
    let mut left: BTreeSet<(u64, usize)> = members.iter().map(|&i| key(i)).collect();
    let mut free: BTreeSet<(u64, usize)> = left.iter().copied().filter(|&(_, i)| below[i] == 0).collect();
    let mut order = Vec::with_capacity(members.len());
    while let Some(next) = free.pop_first().or_else(|| left.first().copied()) {
        left.remove(&next);
        order.push(next.1);
        for &high in &above[next.1] {
            below[high] = below[high].saturating_sub(1);
            if below[high] == 0 && left.contains(&key(high)) {
                free.insert(key(high));
            }
        }
    }
    order
}

/// Whether the first is the higher one in the middle of what two share; `None` where they are as high there, to a millimetre.
fn is_above(a: &Raised, b: &Raised) -> Option<bool> {
    let turned = |t: &Raised| {
        let [p, q, r] = t.map(|(p, _)| p);
        if (q - p).perp_dot(r - p) < 0.0 { [p, r, q] } else { [p, q, r] }
    };
    let (polygon, count) = intersection(&turned(a), &turned(b));
    let middle = polygon[..count].iter().sum::<DVec2>() / count.max(1) as f64;
    let height = |[(p, z), (q, y), (r, x)]: &Raised| {
        let area = (*q - *p).perp_dot(*r - *p);
        let (u, v) = ((middle - *p).perp_dot(*r - *p) / area, (*q - *p).perp_dot(middle - *p) / area);
        z + u * (y - z) + v * (x - z)
    };
    let difference = height(a) - height(b);
    (difference.abs() > 1e-3).then_some(difference > 0.0)
}

/// The rank of a class: above the ground what stands on it; among the ground, what is laid on what.
fn class_rank(class: ObjectClass) -> u8 {
    match class {
        ObjectClass::Terrain => 0,
        ObjectClass::Land => 1,
        ObjectClass::Water => 2,
        ObjectClass::Road => 3,
        _ => 4,
    }
}

/// Rank of surfaces that are not in the table.
const OTHER_SURFACE: u8 = 2;

/// Semantic surface types (CityJSON, CityGML 2 and 3) by rank, as far as the model has them.
fn surface_ranks(model: &CityModel) -> FxHashMap<StringId, u8> {
    let table = [
        ("GroundSurface", 0),
        ("ClosureSurface", 1),
        ("InteriorWallSurface", 1),
        ("FloorSurface", 1),
        ("CeilingSurface", 1),
        ("WallSurface", 3),
        ("OuterFloorSurface", 3),
        ("OuterCeilingSurface", 3),
        ("RoofSurface", 4),
        ("Window", 5),
        ("WindowSurface", 5),
        ("Door", 6),
        ("DoorSurface", 6),
    ];
    let known = table.into_iter().filter_map(|(name, rank)| Some((model.strings.find(name)?, rank)));
    known.chain([(StringId(NONE), OTHER_SURFACE)]).collect()
}

fn first_vertex_surface(model: &CityModel, member: &CoplanarTriangle) -> u32 {
    let tile = &model.tiles[member.tile as usize];
    model.vertices[(tile.vertices.start + model.indices[3 * member.triangle as usize]) as usize].surface
}

fn world_corners(model: &CityModel, member: &CoplanarTriangle) -> [DVec3; 3] {
    let tile = &model.tiles[member.tile as usize];
    [0, 1, 2].map(|k| model.position(tile, tile.vertices.start + model.indices[3 * member.triangle as usize + k]))
}

/// Triangles in two coordinates of their plane (undistorted), counter-clockwise, around the first corner of all.
fn flatten(triangles: &[[DVec3; 3]], normal: DVec3) -> Vec<[DVec2; 3]> {
    let (u, v) = normal.any_orthonormal_pair();
    let base = triangles[0][0];
    triangles
        .iter()
        .map(|triangle| {
            let [a, b, c] = triangle.map(|corner| DVec2::new(u.dot(corner - base), v.dot(corner - base)));
            if (b - a).perp_dot(c - a) < 0.0 { [a, c, b] } else { [a, b, c] }
        })
        .collect()
}

/// Whether two counter-clockwise triangles share more than a border.
fn overlap(a: &[DVec2; 3], b: &[DVec2; 3]) -> bool {
    let low = |t: &[DVec2; 3]| t[0].min(t[1]).min(t[2]);
    let high = |t: &[DVec2; 3]| t[0].max(t[1]).max(t[2]);
    if (high(a).min(high(b)) - low(a).max(low(b))).min_element() <= 0.0 {
        return false;
    }
    let (area, border) = clipped(a, b);
    area > LEAST_AREA_M2 && 2.0 * area > LEAST_WIDTH_M * border
}

/// The intersection of two counter-clockwise triangles, and how many corners it has (Sutherland–Hodgman).
pub(super) fn intersection(a: &[DVec2; 3], b: &[DVec2; 3]) -> ([DVec2; 8], usize) {
    // A triangle cut by three lines has at most six corners.
    let mut polygon = [DVec2::ZERO; 8];
    polygon[..3].copy_from_slice(a);
    let mut count = 3;
    for i in 0..3 {
        let (from, to) = (b[i], b[(i + 1) % 3]);
        let side = |p: DVec2| (to - from).perp_dot(p - from);
        let mut next = [DVec2::ZERO; 8];
        let mut kept = 0;
        for k in 0..count {
            let (p, q) = (polygon[k], polygon[(k + 1) % count]);
            let (at_p, at_q) = (side(p), side(q));
            if at_p >= 0.0 && kept < 8 {
                next[kept] = p;
                kept += 1;
            }
            if (at_p > 0.0 && at_q < 0.0 || at_p < 0.0 && at_q > 0.0) && kept < 8 {
                next[kept] = p + (q - p) * (at_p / (at_p - at_q));
                kept += 1;
            }
        }
        (polygon, count) = (next, kept);
    }
    (polygon, count)
}

/// Area and perimeter of the intersection of two counter-clockwise triangles.
fn clipped(a: &[DVec2; 3], b: &[DVec2; 3]) -> (f64, f64) {
    let (polygon, count) = intersection(a, b);
    let base = polygon[0];
    let (mut area, mut border) = (0.0, 0.0);
    for k in 0..count {
        let (p, q) = (polygon[k], polygon[(k + 1) % count]);
        area += 0.5 * (p - base).perp_dot(q - base);
        border += p.distance(q);
    }
    (area, border)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::city::test_city::{add, add_box, builder, grid_of_cubes};

    fn all(model: &CityModel) -> Vec<u32> {
        (0..model.geometries.len() as u32).collect()
    }

    fn object_of(model: &CityModel, triangle: &CoplanarTriangle) -> String {
        let geometry = model.tiles[triangle.tile as usize].geometry;
        model.objects[model.geometries[geometry as usize].object as usize].id.to_string()
    }

    #[test]
    fn intersections_have_the_known_area() {
        let p = |x: f64, y: f64| DVec2::new(x, y);
        let a = [p(0.0, 0.0), p(4.0, 0.0), p(0.0, 4.0)];
        assert_eq!(clipped(&a, &a).0, 8.0);
        assert_eq!(clipped(&a, &[p(1.0, 1.0), p(2.0, 1.0), p(1.0, 2.0)]).0, 0.5);
        assert_eq!(clipped(&[p(1.0, 1.0), p(2.0, 1.0), p(1.0, 2.0)], &a).0, 0.5);
        assert_eq!(clipped(&a, &[p(0.0, 2.0), p(4.0, 2.0), p(4.0, 6.0)]).0, 1.0);
        assert!(!overlap(&a, &[p(4.0, 0.0), p(4.0, 4.0), p(0.0, 4.0)]), "neighbours");
        assert!(!overlap(&a, &[p(4.0 - 4e-6, 0.0), p(4.0, 4.0), p(-4e-6, 4.0)]), "neighbours, rounded");
    }

    #[test]
    fn covering_is_mutual() {
        let mut x = 1_u32;
        let mut next = |below: u32| {
            x = x.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from((x >> 8) % below)
        };
        let mut met = 0;
        for _ in 0..20_000 {
            let mut triangle = || {
                let [a, b, c] = [0; 3].map(|_| DVec2::new(3000.0 + next(5) * 0.75, next(4) * 1.1));
                if (b - a).perp_dot(c - a) < 0.0 { [a, c, b] } else { [a, b, c] }
            };
            let (a, b) = (triangle(), triangle());
            assert_eq!(overlap(&a, &b), overlap(&b, &a), "{a:?} {b:?}: {:?} {:?}", clipped(&a, &b), clipped(&b, &a));
            met += u32::from(overlap(&a, &b));
        }
        assert!(met > 1000);
    }

    #[test]
    fn party_walls_are_a_group_and_neighbouring_roofs_are_none() {
        let mut b = builder();
        add_box(&mut b, "west", [0, 0, 0], [10_000, 10_000, 9_000]);
        add_box(&mut b, "east", [10_000, 2_000, 0], [20_000, 10_000, 9_000]);
        let model = b.finish();
        let found = coplanar_triangles(&model, &all(&model));
        assert_eq!(found.len(), 4, "two triangles on either side: roofs, floors and backs are neighbours only");
        assert!(found.windows(2).all(|w| w[0].group == w[1].group));
        let owners: Vec<_> = found.iter().map(|t| object_of(&model, t)).collect();
        assert_eq!(owners, ["west", "west", "east", "east"], "the id that comes first wins");
        assert_eq!(found.iter().map(|t| t.priority).collect::<Vec<_>>(), [0, 1, 2, 3]);
        assert_eq!(found.iter().map(|t| t.layer).collect::<Vec<_>>(), [0, 0, 1, 1], "two walls, one on the other");
        let plane = model.plane_equations[found[0].group as usize - 1];
        assert_eq!((plane.normal, plane.offset), (DVec3::X, 85_010.0));
        assert!(coplanar_triangles(&model, &[0]).is_empty(), "nothing to cover when the neighbour is hidden");
    }

    /// Each type of surface against each, and each class of object: the later one wins, whatever their ids say.
    #[test]
    fn ranks_are_in_order_each_against_each() {
        let surfaces: [&[Option<&str>]; 7] = [
            &[Some("GroundSurface")],
            &[Some("ClosureSurface"), Some("InteriorWallSurface"), Some("FloorSurface"), Some("CeilingSurface")],
            &[None, Some("SomethingElse")],
            &[Some("WallSurface"), Some("OuterFloorSurface"), Some("OuterCeilingSurface")],
            &[Some("RoofSurface")],
            &[Some("Window"), Some("WindowSurface")],
            &[Some("Door"), Some("DoorSurface")],
        ];
        let classes =
            [ObjectClass::Terrain, ObjectClass::Land, ObjectClass::Water, ObjectClass::Road, ObjectClass::Building];
        let winner = |below: (ObjectClass, Option<&str>), above: (ObjectClass, Option<&str>), flip: bool| {
            let square = |size: i64| vec![[0, 0, 0], [size, 0, 0], [size, size, 0], [0, size, 0]];
            let face = [vec![0, 1, 2, 3]];
            // An id that comes first wins where ranks are equal.
            let ids = if flip { ["b", "a"] } else { ["a", "b"] };
            let mut b = builder();
            add(&mut b, ids[0], below.0, below.1, square(9_000), &face);
            add(&mut b, ids[1], above.0, above.1, square(5_000), &face);
            let model = b.finish();
            let found = coplanar_triangles(&model, &all(&model));
            let of_winner = object_of(&model, found.last().expect("they overlap"));
            of_winner == ids[1]
        };
        for (i, one) in surfaces.iter().enumerate() {
            for (j, other) in surfaces.iter().enumerate() {
                for (a, b) in one.iter().flat_map(|a| other.iter().map(move |b| (*a, *b))) {
                    for flip in [false, true].into_iter().filter(|_| i != j || a != b) {
                        let building = ObjectClass::Building;
                        let wins = winner((building, a), (building, b), flip);
                        let wanted = if i == j { flip } else { j > i };
                        assert_eq!(wins, wanted, "{b:?} over {a:?}");
                    }
                }
            }
        }
        for (i, &one) in classes.iter().enumerate() {
            for (j, &other) in classes.iter().enumerate().filter(|(j, _)| *j != i) {
                for flip in [false, true] {
                    assert_eq!(winner((one, None), (other, None), flip), j > i, "{other:?} over {one:?}");
                }
            }
        }
    }

    #[test]
    fn doors_win_over_walls_and_buildings_over_the_ground() {
        let rectangle = |x0, x1, z0, z1| vec![[x0, 0, z0], [x1, 0, z0], [x1, 0, z1], [x0, 0, z1]];
        let ground = |size: i64| vec![[-size, -size, 0], [size, -size, 0], [size, size, 0], [-size, size, 0]];
        let face = [vec![0, 1, 2, 3]];
        let mut b = builder();
        add(&mut b, "a terrain", ObjectClass::Terrain, None, ground(90_000), &face);
        add(&mut b, "b wall", ObjectClass::Building, Some("WallSurface"), rectangle(0, 9_000, 0, 9_000), &face);
        add(&mut b, "c door", ObjectClass::Building, Some("Door"), rectangle(1_000, 2_000, 0, 2_000), &face);
        add(&mut b, "d floor", ObjectClass::Building, Some("GroundSurface"), ground(4_000), &face);
        let model = b.finish();
        let found = coplanar_triangles(&model, &all(&model));
        let mut winners: FxHashMap<u32, String> = FxHashMap::default();
        for triangle in &found {
            winners.insert(triangle.group, object_of(&model, triangle));
        }
        let mut winners: Vec<_> = winners.into_values().collect();
        winners.sort();
        assert_eq!(winners, ["c door", "d floor"]);
    }

    #[test]
    fn party_walls_meet_although_their_tiles_round_differently() {
        // All in one plane, x = 10.123 m, which no f32 holds; every building has an origin of its own.
        let mut b = builder();
        for i in 0..40_i64 {
            let (y, z) = (i * 15_301, i * 377);
            add_box(&mut b, &format!("west {i}"), [i * 131 - 9_000, y, z], [10_123, y + 10_000, z + 9_000]);
            add_box(&mut b, &format!("east {i}"), [10_123, y, z + 1_000], [30_777 + i * 57, y + 9_000, z + 7_000]);
        }
        let model = b.finish();
        let found = coplanar_triangles(&model, &all(&model));
        assert_eq!(found.len(), 160);
        assert!(found.iter().all(|triangle| triangle.group == found[0].group));
    }

    #[test]
    fn many_neighbours_in_one_plane_cover_nothing() {
        let model = grid_of_cubes(60, 60);
        assert!(model.planes.iter().filter(|&&plane| plane == model.planes[0]).count() >= 7200);
        assert!(coplanar_triangles(&model, &all(&model)).is_empty());
    }

    #[test]
    fn large_planes_find_the_same_as_pair_by_pair() {
        // Strips that overlap their next but one neighbour only.
        let mut b = builder();
        for i in 0..100_i64 {
            let points = vec![[i * 1000, 0, 0], [i * 1000 + 1500, 0, 0], [i * 1000 + 1500, 500, 0], [i * 1000, 500, 0]];
            let shift = (i % 3) * 600;
            let points = points.into_iter().map(|[x, y, z]| [x, y + shift, z]).collect();
            add(&mut b, &i.to_string(), ObjectClass::Building, None, points, &[vec![0, 1, 2, 3]]);
        }
        let model = b.finish();
        let everything: Vec<_> = model
            .tiles
            .iter()
            .zip(0_u32..)
            .flat_map(|(tile, number)| {
                (tile.indices.start / 3..tile.indices.end / 3).map(move |triangle| (number, triangle))
            })
            .collect();
        let corners: Vec<[DVec3; 3]> = everything
            .iter()
            .map(|&(tile, triangle)| {
                world_corners(&model, &CoplanarTriangle { tile, triangle, group: 1, priority: 0, layer: 0 })
            })
            .collect();
        let flat = flatten(&corners, DVec3::Z);
        let mut expected: Vec<u32> = (0..flat.len())
            .filter(|&i| (0..flat.len()).any(|j| i != j && overlap(&flat[i], &flat[j])))
            .map(|i| everything[i].1)
            .collect();
        let mut found: Vec<u32> = coplanar_triangles(&model, &all(&model)).iter().map(|t| t.triangle).collect();
        expected.sort_unstable();
        found.sort_unstable();
        assert_eq!(found, expected);
    }

    /// A lawn under a thousand plots is under all of them, although it overlaps more than are looked for; thousands of faces in one place take
    /// no time, and no more layers than there may be.
    #[test]
    fn what_many_lie_over_is_under_all_of_them() {
        let mut b = builder();
        let mut square = |id: String, class, [x, y, size]: [i64; 3]| {
            let corners = vec![[x, y, 0], [x + size, y, 0], [x + size, y + size, 0], [x, y + size, 0]];
            add(&mut b, &id, class, None, corners, &[vec![0, 1, 2, 3]]);
        };
        square("lawn".into(), ObjectClass::Land, [0, 0, 400_000]);
        // It overlaps more than are looked for, too, and lies on the lawn.
        square("pond".into(), ObjectClass::Water, [0, 0, 390_000]);
        for i in 0..1000 {
            square(format!("plot {i}"), ObjectClass::Road, [10_000 * (i % 32), 10_000 * (i / 32), 9_000]);
        }
        for i in 0..3000 {
            square(format!("again {i}"), ObjectClass::Building, [500_000, 0, 9_000]);
        }
        let model = b.finish();
        let found = coplanar_triangles(&model, &all(&model));
        let layers = |of: &str| -> Vec<u32> {
            found.iter().filter(|t| object_of(&model, t).starts_with(of)).map(|t| t.layer).collect()
        };
        assert_eq!(layers("lawn"), [0, 0]);
        assert_eq!(layers("pond"), [1, 1]);
        assert!(layers("plot").len() == 2000 && layers("plot").iter().all(|layer| *layer == 2));
        let again = layers("again");
        assert!(again.len() == 6000 && again.iter().all(|layer| (*layer as usize) < MOST_BROAD));
    }
}
