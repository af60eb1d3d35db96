//! A bounding volume hierarchy over boxes: built by `obvhs`, walked here.
//!
//! Boxes are kept as f32 around an origin of the hierarchy's own, rounded outwards; all tests are in f64 and pad by
//! what the change of origin can lose: a query may visit too much, never too little. What is in a leaf is the caller's.

use glam::{DVec3, Vec3A};
use obvhs::{
    BvhBuildParams,
    bvh2::{Bvh2, builder::build_bvh2, node::Bvh2Node},
};
use rustc_hash::FxHashMap;

use crate::geom::{aabb::Aabb, ray::Ray};

/// `normal · p + offset ≥ 0`: one side of a plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfSpace {
    /// Points into the half-space; any length but zero.
    pub normal: DVec3,
    /// Metres, times the length of `normal`.
    pub offset: f64,
}

impl HalfSpace {
    /// The half-space in front of a plane through `point`.
    pub fn through(point: DVec3, normal: DVec3) -> Self {
        Self { normal, offset: -normal.dot(point) }
    }

    /// The signed distance of a point, times the length of the normal.
    pub fn distance(&self, point: DVec3) -> f64 {
        self.normal.dot(point) + self.offset
    }
}

/// Boxes that can be asked by box, by convex region and along rays. Items are numbered as the boxes were given.
#[derive(Clone)]
pub struct Bvh {
    tree: Bvh2,
    /// Middle of all boxes: f32 is finest around it.
    origin: DVec3,
    /// Largest absolute coordinate of the origin, metres.
    origin_size: f64,
}

impl std::fmt::Debug for Bvh {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Bvh").field("nodes", &self.tree.nodes.len()).field("origin", &self.origin).finish()
    }
}

/// Error of a sum or product of f64, with room for a few of them.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

impl Bvh {
    /// Builds the hierarchy, in parallel; empty boxes are kept but never found.
    pub fn build(boxes: &[Aabb]) -> Self {
        let all = boxes.iter().filter(|b| !b.is_empty()).fold(Aabb::EMPTY, |all, b| all.union(*b));
        let origin = if all.is_empty() { DVec3::ZERO } else { all.center() };
        let numbered = boxes.iter().zip(0_u32..).filter(|(b, _)| !b.is_empty());
        let (rounded, numbers): (Vec<_>, Vec<_>) = numbered.map(|(b, i)| (round_outwards(*b, origin), i)).unzip();
        let (rounded, numbers) = heaped(rounded, numbers);
        let mut tree = if rounded.is_empty() {
            Bvh2::default()
        } else {
            build_bvh2(&rounded, BvhBuildParams::fast_build(), &mut std::time::Duration::default())
        };
        let mut items = Vec::with_capacity(boxes.len());
        for leaf in tree.nodes.iter_mut().filter(|node| node.is_leaf()) {
            let (first, count) = (leaf.first_index as usize, leaf.prim_count as usize);
            leaf.first_index = items.len() as u32;
            let own = &tree.primitive_indices[first..first + count];
            own.iter().for_each(|index| items.extend_from_slice(&numbers[*index as usize]));
            leaf.prim_count = items.len() as u32 - leaf.first_index;
        }
        tree.primitive_indices = items;
        Self { tree, origin, origin_size: origin.abs().max_element() }
    }

    /// Visits all items whose boxes meet `region`, in no particular order.
    pub fn in_box(&self, region: &Aabb, mut visit: impl FnMut(u32)) {
        let region = self.local(region);
        self.walk(|node| bounds(node).meets(&region).then_some(()), |item, ()| visit(item));
    }

    /// Of the items whose boxes meet `region` those that `holds` is true of, or some of them and `false`: at most `most`, and of so many
    /// times as many tried, which bounds what a search takes where all items lie in one place.
    pub fn some_in_box(
        &self,
        region: &Aabb,
        most: usize,
        times: usize,
        holds: impl Fn(u32) -> bool,
    ) -> (Vec<u32>, bool) {
        let region = self.local(region);
        let (mut found, mut tried) = (Vec::new(), 0);
        let mut stack: Vec<&Bvh2Node> = self.tree.nodes.first().into_iter().collect();
        while let Some(node) = stack.pop() {
            if !bounds(node).meets(&region) {
                continue;
            }
            if !node.is_leaf() {
                stack.extend(self.children(node));
                continue;
            }
            for &item in self.items(node) {
                tried += 1;
                if holds(item) {
                    found.push(item);
                }
                if found.len() == most || tried == most.saturating_mul(times) {
                    return (found, false);
                }
            }
        }
        (found, true)
    }

    /// A box in the coordinates of the hierarchy, and a little larger.
    fn local(&self, region: &Aabb) -> Aabb {
        let pad = ROUNDING * (self.origin_size + region.min.abs().max(region.max.abs()).max_element());
        Aabb { min: region.min - self.origin - pad, max: region.max - self.origin + pad }
    }

    /// Visits all items whose boxes may meet the intersection of half-spaces; `true`: the box lies wholly in it.
    ///
    /// Boxes near an edge of the region may be visited although they lie outside: each plane is tested alone.
    pub fn in_half_spaces(&self, planes: &[HalfSpace], mut visit: impl FnMut(u32, bool)) {
        let local: Vec<(DVec3, f64, f64)> = planes
            .iter()
            .map(|plane| {
                let offset = plane.distance(self.origin);
                let size = plane.normal.abs().element_sum() * self.origin_size + plane.offset.abs();
                (plane.normal, offset, ROUNDING * size)
            })
            .collect();
        let test = |node: &Bvh2Node| {
            let bounds = bounds(node);
            let (center, half) = (bounds.center(), 0.5 * bounds.size());
            let mut inside = true;
            for &(normal, offset, pad) in &local {
                let reach = normal.abs().dot(half) * (1.0 + ROUNDING) + pad;
                let distance = normal.dot(center) + offset;
                if distance < -reach {
                    return None;
                }
                inside &= distance >= reach;
            }
            Some(inside)
        };
        self.walk(test, &mut visit);
    }

    /// Visits all items whose boxes may meet a region; `true`: the box lies wholly in it. `coverage` says of a box in world
    /// metres `None` where it is outside and whether all of it is inside where it is not; below a box that is, it is not
    /// asked again. The box that it is asked for may be smaller than the items' own by what f64 loses in a change of origin.
    pub fn in_region(&self, coverage: impl Fn(&Aabb) -> Option<bool>, mut visit: impl FnMut(u32, bool)) {
        let mut stack: Vec<(&Bvh2Node, bool)> = self.tree.nodes.first().map(|root| (root, false)).into_iter().collect();
        while let Some((node, is_inside)) = stack.pop() {
            let bounds = bounds(node);
            let in_world = Aabb { min: bounds.min + self.origin, max: bounds.max + self.origin };
            let covered = if is_inside { Some(true) } else { coverage(&in_world) };
            let Some(is_inside) = covered else { continue };
            if node.is_leaf() {
                self.items(node).iter().for_each(|&item| visit(item, is_inside));
            } else {
                stack.extend(self.children(node).map(|child| (child, is_inside)));
            }
        }
    }

    /// Follows items that moved: the tree stays, its boxes are made anew from `boxes`, numbered as they were built. Queries
    /// stay right however far they move, and are fast as long as neighbours stay neighbours. Built again where a box that
    /// was empty no longer is, or the other way round.
    pub fn refit(&mut self, boxes: &[Aabb]) {
        let is_kept = |item: &u32| boxes.get(*item as usize).is_some_and(|b| !b.is_empty());
        let same_items = self.tree.primitive_indices.iter().all(is_kept)
            && self.tree.primitive_indices.len() == boxes.iter().filter(|b| !b.is_empty()).count();
        if !same_items {
            *self = Self::build(boxes);
            return;
        }
        // Parents before their children, so from the back every node finds its children done.
        let mut order: Vec<usize> = if self.tree.nodes.is_empty() { Vec::new() } else { vec![0] };
        let mut next = 0;
        while next < order.len() {
            let node = &self.tree.nodes[order[next]];
            if !node.is_leaf() {
                order.extend([node.first_index as usize, node.first_index as usize + 1]);
            }
            next += 1;
        }
        for &i in order.iter().rev() {
            let node = self.tree.nodes[i];
            let around = if node.is_leaf() {
                let all = self.items(&node).iter().fold(Aabb::EMPTY, |all, &item| all.union(boxes[item as usize]));
                round_outwards(all, self.origin)
            } else {
                let [left, right] = self.children(&node);
                left.aabb().union(right.aabb())
            };
            self.tree.nodes[i].set_aabb(around);
        }
    }

    /// Visits the items whose boxes a ray meets before `t_max`, roughly from near to far. `visit` gets the item and the
    /// current end of the ray and returns the new one (the same, or a nearer hit).
    pub fn along_ray(&self, ray: &Ray, t_max: f64, mut visit: impl FnMut(u32, f64) -> f64) {
        let Some(root) = self.tree.nodes.first() else { return };
        let slabs = Slabs::new(self, ray);
        let mut end = t_max;
        let mut stack: Vec<(f64, &Bvh2Node)> = Vec::with_capacity(64);
        stack.extend(slabs.entry(root, end).map(|t| (t, root)));
        while let Some((entry, node)) = stack.pop() {
            if entry > end {
                continue;
            }
            if node.is_leaf() {
                for &item in self.items(node) {
                    end = visit(item, end);
                }
                continue;
            }
            let children = self.children(node);
            let mut entries = children.map(|child| slabs.entry(child, end).map(|t| (t, child)));
            // The nearer child is pushed last.
            if let [Some((left, _)), Some((right, _))] = entries
                && left < right
            {
                entries.swap(0, 1);
            }
            stack.extend(entries.into_iter().flatten());
        }
    }

    /// Visits the items of all leaves that `test` lets pass, with what it said of the leaf.
    fn walk<T: Copy>(&self, test: impl Fn(&Bvh2Node) -> Option<T>, mut visit: impl FnMut(u32, T)) {
        let mut stack: Vec<&Bvh2Node> = self.tree.nodes.first().into_iter().collect();
        while let Some(node) = stack.pop() {
            let Some(answer) = test(node) else { continue };
            if node.is_leaf() {
                self.items(node).iter().for_each(|&item| visit(item, answer));
            } else {
                stack.extend(self.children(node));
            }
        }
    }

    /// The hierarchy as plain data, the root first, and the items of its leaves in their order; no more than `most_depth` boxes lie in each
    /// other, for a walk whose stack is that long. `boxes`: those that it was built from.
    pub fn flat(&self, most_depth: usize, boxes: &[Aabb]) -> (Vec<FlatNode>, Vec<u32>) {
        let mut deepest = 0;
        let mut stack: Vec<(&Bvh2Node, usize)> = self.tree.nodes.first().map(|root| (root, 1)).into_iter().collect();
        while let Some((node, depth)) = stack.pop() {
            deepest = deepest.max(depth);
            if !node.is_leaf() {
                stack.extend(self.children(node).map(|child| (child, depth + 1)));
            }
        }
        if deepest > most_depth {
            return halved(self.tree.primitive_indices.clone(), boxes);
        }
        let flat = |node: &Bvh2Node| {
            let own = bounds(node);
            let moved = Aabb { min: own.min + self.origin, max: own.max + self.origin };
            let count = if node.is_leaf() { node.prim_count } else { 0 };
            FlatNode::new(&moved, node.first_index, count)
        };
        (self.tree.nodes.iter().map(flat).collect(), self.tree.primitive_indices.clone())
    }

    fn items(&self, leaf: &Bvh2Node) -> &[u32] {
        let first = leaf.first_index as usize;
        &self.tree.primitive_indices[first..first + leaf.prim_count as usize]
    }

    fn children(&self, node: &Bvh2Node) -> [&Bvh2Node; 2] {
        let first = node.first_index as usize;
        [&self.tree.nodes[first], &self.tree.nodes[first + 1]]
    }
}

/// A box of a hierarchy as plain data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlatNode {
    /// Its corners, rounded outwards.
    pub min: [f32; 3],
    /// The same.
    pub max: [f32; 3],
    /// Of an inner one: the first of its two boxes; of a leaf: its first item.
    pub first: u32,
    /// Items of a leaf; 0: an inner one.
    pub count: u32,
}

impl FlatNode {
    fn new(bounds: &Aabb, first: u32, count: u32) -> Self {
        let rounded = round_outwards(*bounds, DVec3::ZERO);
        Self { min: rounded.min.to_array(), max: rounded.max.to_array(), first, count }
    }
}

/// Items of a leaf of a halved hierarchy.
const HALVED_LEAF: usize = 4;

/// A hierarchy that halves items at the middle of their longest side: never deeper than their number asks for.
fn halved(mut items: Vec<u32>, boxes: &[Aabb]) -> (Vec<FlatNode>, Vec<u32>) {
    let mut nodes = vec![FlatNode { min: [0.0; 3], max: [0.0; 3], first: 0, count: 0 }];
    let mut open = vec![(0, 0, items.len())];
    while let Some((node, from, to)) = open.pop() {
        let own = &mut items[from..to];
        let all = own.iter().fold(Aabb::EMPTY, |all, &item| all.union(boxes[item as usize]));
        if own.len() <= HALVED_LEAF {
            nodes[node] = FlatNode::new(&all, from as u32, own.len() as u32);
            continue;
        }
        let size = all.size();
        let axis = if size.x >= size.y && size.x >= size.z { 0 } else { 1 + usize::from(size.z > size.y) };
        let middle = own.len() / 2;
        own.select_nth_unstable_by(middle, |a, b| {
            let at = |item: &u32| boxes[*item as usize].center()[axis];
            at(a).total_cmp(&at(b))
        });
        let first = nodes.len();
        nodes[node] = FlatNode::new(&all, first as u32, 0);
        nodes.extend([nodes[node]; 2]);
        open.extend([(first, from, from + middle), (first + 1, from + middle, to)]);
    }
    (nodes, items)
}

/// Equal boxes from so many on are one to the builder.
const HEAP: usize = 16;

/// Boxes with the items of each: of many equal ones one that has all of their items. The builder joins boxes that are each other's nearest; of
/// equal ones only the first two are, and it would go over all the others once for each.
fn heaped(boxes: Vec<obvhs::aabb::Aabb>, numbers: Vec<u32>) -> (Vec<obvhs::aabb::Aabb>, Vec<Vec<u32>>) {
    let bits = |own: &obvhs::aabb::Aabb| [own.min.to_array(), own.max.to_array()].map(|p| p.map(f32::to_bits));
    let mut counts: FxHashMap<[[u32; 3]; 2], usize> = FxHashMap::default();
    boxes.iter().for_each(|own| *counts.entry(bits(own)).or_default() += 1);
    let mut heaps: FxHashMap<[[u32; 3]; 2], usize> = FxHashMap::default();
    let (mut kept, mut items): (Vec<_>, Vec<Vec<u32>>) = (Vec::with_capacity(boxes.len()), Vec::new());
    for (own, number) in boxes.into_iter().zip(numbers) {
        let is_heap = counts.get(&bits(&own)).is_some_and(|count| *count >= HEAP);
        match heaps.get(&bits(&own)).filter(|_| is_heap) {
            Some(heap) => items[*heap].push(number),
            None => {
                if is_heap {
                    heaps.insert(bits(&own), kept.len());
                }
                kept.push(own);
                items.push(vec![number]);
            }
        }
    }
    (kept, items)
}

/// A ray made ready for the boxes of one hierarchy.
struct Slabs {
    origin: DVec3,
    direction: DVec3,
    /// The distance by which the change of origin may have moved the ray, metres.
    pad: f64,
}

impl Slabs {
    fn new(bvh: &Bvh, ray: &Ray) -> Self {
        let pad = ROUNDING * (bvh.origin_size + ray.origin.abs().max_element());
        Self { origin: ray.origin - bvh.origin, direction: ray.direction, pad }
    }

    /// Where the ray enters the node's box, if it does before `end`. Divides only where there is a direction: a ray
    /// within a slab's plane is in it (hard case 10).
    fn entry(&self, node: &Bvh2Node, end: f64) -> Option<f64> {
        let bounds = bounds(node);
        let (mut near, mut far) = (0.0_f64, end);
        for axis in 0..3 {
            let low = bounds.min[axis] - self.pad - self.origin[axis];
            let high = bounds.max[axis] + self.pad - self.origin[axis];
            let along = self.direction[axis];
            if along == 0.0 {
                if low > 0.0 || high < 0.0 {
                    return None;
                }
                continue;
            }
            let (t0, t1) = if along > 0.0 { (low / along, high / along) } else { (high / along, low / along) };
            near = near.max(t0 - ROUNDING * t0.abs());
            far = far.min(t1 + ROUNDING * t1.abs());
        }
        (near <= far).then_some(near)
    }
}

fn bounds(node: &Bvh2Node) -> Aabb {
    let bounds = node.aabb();
    Aabb { min: bounds.min.as_dvec3(), max: bounds.max.as_dvec3() }
}

/// The box around `origin` in f32, no smaller on any side.
fn round_outwards(bounds: Aabb, origin: DVec3) -> obvhs::aabb::Aabb {
    let down = |x: f64| if f64::from(x as f32) > x { (x as f32).next_down() } else { x as f32 };
    let up = |x: f64| if f64::from(x as f32) < x { (x as f32).next_up() } else { x as f32 };
    let (min, max) = (bounds.min - origin, bounds.max - origin);
    obvhs::aabb::Aabb {
        min: Vec3A::new(down(min.x), down(min.y), down(min.z)),
        max: Vec3A::new(up(max.x), up(max.y), up(max.z)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn boxes(count: u32) -> Vec<Aabb> {
        // Far from the origin of the world, as cities are.
        let at = |seed: u32| f64::from(seed.wrapping_mul(2_654_435_761) >> 16) / 65536.0;
        (0..count)
            .map(|i| {
                let min = DVec3::new(85_000.0 + 900.0 * at(i), 447_000.0 + 900.0 * at(i + 7), 40.0 * at(i + 13));
                Aabb { min, max: min + 9.0 * DVec3::new(at(i + 1), at(i + 2), if i % 5 == 0 { 0.0 } else { 1.0 }) }
            })
            .collect()
    }

    #[test]
    fn nothing_and_one_box_work() {
        let none = Bvh::build(&[]);
        none.in_box(&Aabb { min: DVec3::MIN, max: DVec3::MAX }, |_| panic!("nothing is there"));
        let ray = Ray { origin: DVec3::ZERO, direction: DVec3::X };
        none.along_ray(&ray, f64::INFINITY, |_, _| panic!("nothing is there"));
        let unit = Aabb { min: DVec3::ZERO, max: DVec3::ONE };
        let one = Bvh::build(&[Aabb::EMPTY, unit]);
        let mut found = Vec::new();
        one.along_ray(&ray, f64::INFINITY, |item, end| {
            found.push(item);
            end
        });
        assert_eq!(found, [1]);
    }

    #[test]
    fn box_queries_find_what_brute_force_finds() {
        let boxes = boxes(1000);
        let bvh = Bvh::build(&boxes);
        for i in 0..50 {
            let center = boxes[i * 17].center();
            let region = Aabb { min: center - 40.0, max: center + 40.0 };
            let mut found = Vec::new();
            bvh.in_box(&region, |item| found.push(item));
            found.sort_unstable();
            // Leaves hold several boxes: all that meet the region are there, and not everything else.
            let expected = (0..1000_u32).filter(|&b| boxes[b as usize].meets(&region));
            assert!(expected.clone().all(|b| found.binary_search(&b).is_ok()));
            assert!(found.len() < expected.count() + 100);
        }
    }

    #[test]
    fn convex_queries_never_lose_a_box_and_only_call_inside_what_is() {
        let boxes = boxes(1000);
        let bvh = Bvh::build(&boxes);
        let eye = DVec3::new(85_450.0, 447_450.0, 30.0);
        let planes = [
            HalfSpace::through(eye, DVec3::new(1.0, 0.5, 0.0)),
            HalfSpace::through(eye, DVec3::new(1.0, -0.5, 0.1)),
            HalfSpace::through(eye + DVec3::new(0.0, 0.0, 3.0), DVec3::new(0.0, 0.0, -2.0)),
        ];
        let mut found = vec![None; 1000];
        bvh.in_half_spaces(&planes, |item, inside| found[item as usize] = Some(inside));
        for (bounds, found) in boxes.iter().zip(&found) {
            let corners = bounds.corners();
            let meets = planes.iter().all(|p| corners.iter().any(|&c| p.distance(c) >= 0.0));
            let inside = corners.iter().all(|&c| planes.iter().all(|p| p.distance(c) >= -1e-6));
            assert!(!meets || found.is_some(), "a box that meets every half-space is found");
            assert!(*found != Some(true) || inside, "a box called inside is inside");
        }
        assert!(found.contains(&Some(true)) && found.iter().any(Option::is_none));
    }

    #[test]
    fn boxes_that_moved_are_found_where_they_are() {
        let before = boxes(1000);
        let mut bvh = Bvh::build(&before);
        // Each goes its own way, the last one far away.
        let moved: Vec<Aabb> = before
            .iter()
            .enumerate()
            .map(|(i, b)| {
                let way =
                    if i == 999 { DVec3::splat(1e6) } else { DVec3::new((i % 37) as f64, -((i % 11) as f64), 5.0) };
                Aabb { min: b.min + way, max: b.max + way }
            })
            .collect();
        bvh.refit(&moved);
        for center in moved.iter().step_by(9).map(Aabb::center) {
            let region = Aabb { min: center - 15.0, max: center + 15.0 };
            let mut found = Vec::new();
            bvh.in_box(&region, |item| found.push(item));
            found.sort_unstable();
            let expected: Vec<u32> = (0..1000_u32).filter(|&b| moved[b as usize].meets(&region)).collect();
            assert!(expected.iter().all(|b| found.binary_search(b).is_ok()), "{center}");
            assert!(found.len() < expected.len() + 100);
        }
        // Empty ones come and go.
        let mut other = moved;
        other[3] = Aabb::EMPTY;
        bvh.refit(&other);
        other[3] = before[3];
        bvh.refit(&other);
        let mut found = Vec::new();
        bvh.in_box(&before[3], |item| found.push(item));
        assert!(found.contains(&3));
        Bvh::build(&[]).refit(&[]);
    }

    #[test]
    fn axis_parallel_rays_through_flat_boxes_and_along_their_faces_miss_none() {
        let flat = |z: f64| Aabb { min: DVec3::new(0.1, 0.1, z), max: DVec3::new(1.1, 1.1, z) };
        let boxes: Vec<_> = (0..100).map(|i| flat(f64::from(i) * 0.1)).collect();
        let bvh = Bvh::build(&boxes);
        let count = |origin: [f64; 3], direction: [f64; 3]| {
            let mut hits = std::collections::BTreeSet::new();
            let ray = Ray { origin: origin.into(), direction: direction.into() };
            bvh.along_ray(&ray, f64::INFINITY, |item, end| {
                hits.insert(item);
                end
            });
            hits
        };
        assert_eq!(count([0.5, 0.5, -1.0], [0.0, 0.0, 1.0]).len(), 100);
        assert_eq!(count([0.1, 1.1, -1.0], [0.0, 0.0, 1e-300]).len(), 100, "along the corners");
        for i in 0..100 {
            let z = f64::from(i) * 0.1;
            assert!(count([-5.0, 0.5, z], [1.0, 0.0, 0.0]).contains(&(i as u32)), "in the plane of box {i}");
            assert!(count([-5.0, 0.1, z], [1.0, -0.0, 0.0]).contains(&(i as u32)), "along an edge of box {i}");
        }
        assert_eq!(count([1.2, 0.5, -1.0], [0.0, 0.0, 1.0]).len(), 0);
    }

    #[test]
    fn equal_boxes_are_all_found() {
        let one = |x: f64| Aabb { min: DVec3::splat(x), max: DVec3::splat(x + 1.0) };
        let many: Vec<Aabb> = (0..5000).map(|i| one(f64::from(if i % 3 == 0 { i } else { i % 2 }))).collect();
        let bvh = Bvh::build(&many);
        for at in [0.5, 1.5, 300.5, 9000.0] {
            let region = Aabb { min: DVec3::splat(at), max: DVec3::splat(at) };
            let mut found = Vec::new();
            bvh.in_box(&region, |i| found.push(i));
            found.sort_unstable();
            let wanted: Vec<u32> = (0..5000).filter(|i| many[*i as usize].meets(&region)).collect();
            // Those of a leaf's other boxes are visited, too.
            assert!(found.windows(2).all(|pair| pair[0] < pair[1]), "{at}");
            found.retain(|i| many[*i as usize].meets(&region));
            assert_eq!(found, wanted, "{at}");
            let meets = |i: u32| i.is_multiple_of(2) && many[i as usize].meets(&region);
            let (mut some, is_all) = bvh.some_in_box(&region, 100, 4, meets);
            some.sort_unstable();
            let all: Vec<u32> = wanted.into_iter().filter(|i| meets(*i)).collect();
            assert!(some.len() <= 100 && some.iter().all(|i| all.contains(i)), "{at}");
            assert!(!is_all || some == all, "{at}");
            assert!(is_all || at < 2.0, "{at}: few are there");
        }
    }
}
