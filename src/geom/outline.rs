//! Outlines of figures on an integer lattice: the union of triangles, convex hulls, smallest rectangles.
//!
//! ```text
//! triangles ─> edges without their opposites ─> one simple ring: exact, done
//!                                          └──> else: constrained triangulation of all edges, cut where they cross
//!                                                 ─> which of its faces are covered ─> loops around those
//! ```

use glam::{DVec2, DVec3};
use rustc_hash::FxHashMap;
use spade::{
    ConstrainedDelaunayTriangulation, Point2, Triangulation,
    handles::{DirectedEdgeHandle, FixedVertexHandle},
};

use crate::geom::{
    aabb::Aabb,
    bvh::Bvh,
    exact::{cross, dot, orient, segments_meet, twice_area},
    ray::Ray,
};

/// A point of the lattice.
pub type Point = [i64; 2];

/// A connected part of a figure: its outer ring counter-clockwise, then its holes clockwise.
pub type Part = Vec<Vec<Point>>;

/// Rings of more edges are not tried pair by pair.
const MOST_PAIRS: usize = 1000;
/// Triangles whose corners and crossings are more places than this have no outline: it would take seconds.
const MOST_PLACES: usize = 1 << 17;
/// Gaps and notches narrower than this are closed, lattice units: what rounding to the lattice opens between neighbours.
const GAP: f64 = 2.0;

/// The area that triangles cover together, whichever way they turn.
///
/// Where they neither overlap nor enclose a hole the outline is exact, with the very corners of the triangles. Elsewhere crossings of
/// edges are rounded to the lattice (by half a unit per axis at most) and gaps narrower than two units are closed; such triangles with
/// more than 131,072 corners and crossings have no outline.
pub fn union(triangles: &[[Point; 3]]) -> Vec<Part> {
    let turned: Vec<[Point; 3]> = triangles
        .iter()
        .filter_map(|&[a, b, c]| match orient(a, b, c).signum() {
            0 => None,
            1 => Some([a, b, c]),
            _ => Some([a, c, b]),
        })
        .collect();
    match border(&turned) {
        Some(ring) => vec![vec![ring]],
        None => overlaid(&turned),
    }
}

/// Edges of counter-clockwise triangles that have no opposite, where they are one ring that does not meet itself. The winding
/// number of the rest is how often triangles cover a place; inside such a ring it is 1.
fn border(triangles: &[[Point; 3]]) -> Option<Vec<Point>> {
    let edges = || triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let mut counts: FxHashMap<[Point; 2], i32> = FxHashMap::default();
    for [a, b] in edges() {
        let (key, step) = if a < b { ([a, b], 1) } else { ([b, a], -1) };
        *counts.entry(key).or_default() += step;
    }
    counts.retain(|_, count| *count != 0);
    if counts.is_empty() || counts.len() > MOST_PAIRS || counts.values().any(|count| count.abs() > 1) {
        return None;
    }
    let mut next: FxHashMap<Point, Point> = FxHashMap::default();
    for (&[a, b], &count) in &counts {
        let (from, to) = if count > 0 { (a, b) } else { (b, a) };
        if next.insert(from, to).is_some() {
            return None;
        }
    }
    let first = *next.keys().min()?;
    let mut ring = vec![first];
    while let Some(&to) = next.get(ring.last()?)
        && to != first
    {
        ring.push(to);
        if ring.len() > next.len() {
            return None;
        }
    }
    (ring.len() == next.len() && is_simple(&ring)).then(|| straightened(&ring))
}

/// Whether no two edges of a ring share more than the corner between neighbours.
fn is_simple(ring: &[Point]) -> bool {
    let n = ring.len();
    let edge = |i: usize| (ring[i], ring[(i + 1) % n]);
    (0..n).all(|i| {
        let (a, b) = edge(i);
        let (_, c) = edge((i + 1) % n);
        let turns_back = cross([b[0] - a[0], b[1] - a[1]], [c[0] - b[0], c[1] - b[1]]) == 0
            && dot([b[0] - a[0], b[1] - a[1]], [c[0] - b[0], c[1] - b[1]]) < 0;
        let mut others = (i + 2..n).filter(|&j| (j + 1) % n != i).map(edge);
        !turns_back && !others.any(|(c, d)| segments_meet(a, b, c, d))
    })
}

/// A ring without the corners that lie exactly on a straight line between their neighbours.
fn straightened(ring: &[Point]) -> Vec<Point> {
    let n = ring.len();
    let is_corner = |i: &usize| orient(ring[(i + n - 1) % n], ring[*i], ring[(i + 1) % n]) != 0;
    (0..n).filter(is_corner).map(|i| ring[i]).collect()
}

type Net = ConstrainedDelaunayTriangulation<Point2<f64>>;
type Edge<'a> = DirectedEdgeHandle<'a, Point2<f64>, (), spade::CdtEdge<()>, ()>;

/// The general way: all edges in one triangulation, and the loops around its covered faces.
fn overlaid(triangles: &[[Point; 3]]) -> Vec<Part> {
    let Some(&[origin, ..]) = triangles.first() else { return Vec::new() };
    let local = |p: Point| Point2::new((p[0] - origin[0]) as f64, (p[1] - origin[1]) as f64);
    let Some(net) = net_of(triangles, local) else { return Vec::new() };
    let near: Vec<[DVec2; 3]> = triangles.iter().map(|t| t.map(|p| DVec2::new(local(p).x, local(p).y))).collect();
    let boxes: Vec<Aabb> = near.iter().map(|t| Aabb::from_points(t.iter().map(|p| p.extend(0.0)))).collect();
    let tree = Bvh::build(&boxes);
    let is_in = |p: DVec2| {
        let mut is_found = false;
        // Straight up, from below to above the plane; the first that holds the place is enough.
        tree.along_ray(&Ray { origin: p.extend(-1.0), direction: DVec3::Z }, 2.0, |triangle, end| {
            let [a, b, c] = &near[triangle as usize];
            let left = |from: &DVec2, to: &DVec2| (*to - *from).perp_dot(p - *from) >= 0.0;
            is_found |= left(a, b) && left(b, c) && left(c, a);
            if is_found { f64::NEG_INFINITY } else { end }
        });
        is_found
    };
    let mut covered = vec![false; net.num_all_faces()];
    for face in net.inner_faces() {
        let middle = face.center();
        covered[face.fix().index()] = is_in(DVec2::new(middle.x, middle.y));
    }
    close_gaps(&net, &mut covered);
    let point = |p: Point2<f64>| [p.x.round() as i64 + origin[0], p.y.round() as i64 + origin[1]];
    loops(&net, &covered, point)
}

/// The triangulation of all edges; `None` where a number is beyond what it takes, or there are more places than an outline may have.
fn net_of(triangles: &[[Point; 3]], local: impl Fn(Point) -> Point2<f64>) -> Option<Net> {
    let mut sites: Vec<Point> = triangles.iter().flatten().copied().collect();
    sites.sort_unstable();
    sites.dedup();
    let mut edges: Vec<[Point; 2]> = triangles
        .iter()
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
        .map(|[a, b]| if a < b { [a, b] } else { [b, a] })
        .collect();
    edges.sort_unstable();
    edges.dedup();
    let mut net = Net::bulk_load_cdt(sites.iter().map(|&p| local(p)).collect(), Vec::new()).ok()?;
    let handles: FxHashMap<[u64; 2], FixedVertexHandle> =
        net.vertices().map(|v| ([v.position().x.to_bits(), v.position().y.to_bits()], v.fix())).collect();
    let handle = |p: Point| handles.get(&[local(p).x.to_bits(), local(p).y.to_bits()]).copied();
    // Snap rounding ends; this bounds what it may take.
    let mut most = 4 * MOST_PLACES;
    for [a, b] in edges {
        add_edge(&mut net, [handle(a)?, handle(b)?], &mut most)?;
    }
    Some(net)
}

/// Adds an edge and all that it crosses as pieces between places of the lattice: each crossing is rounded to one, and both edges go through that (snap
/// rounding, Hobby 1999). `most`: pieces that may still be looked at; `None` where these or the places are too many.
fn add_edge(net: &mut Net, edge: [FixedVertexHandle; 2], most: &mut usize) -> Option<()> {
    let mut open = vec![edge];
    while let Some([from, to]) = open.pop() {
        if from == to {
            continue;
        }
        *most = most.checked_sub(1)?;
        let crossed = net.get_conflicting_edges_between_vertices(from, to).next();
        let Some(crossed) = crossed else {
            net.add_constraint(from, to);
            continue;
        };
        let [c, d] = crossed.vertices().map(|vertex| vertex.fix());
        let at = |vertex: FixedVertexHandle| {
            let position = net.vertex(vertex).position();
            DVec2::new(position.x, position.y)
        };
        let (start, along, across) = (at(from), at(to) - at(from), at(d) - at(c));
        let share = ((at(c) - start).perp_dot(across) / along.perp_dot(across)).clamp(0.0, 1.0);
        let place = (start + share * along).round();
        let met = net.insert(Point2::new(place.x, place.y)).ok()?;
        if net.num_vertices() > MOST_PLACES {
            return None;
        }
        // Where the place lies on the other edge, that is in two pieces already.
        let whole = net.get_edge_from_neighbors(c, d).filter(|edge| edge.is_constraint_edge());
        if let Some(whole) = whole.map(|edge| edge.as_undirected().fix()).filter(|_| met != c && met != d) {
            net.remove_constraint_edge(whole);
            open.extend([[c, met], [met, d]]);
        }
        open.extend([[from, met], [met, to]]);
    }
    Some(())
}

/// Covers faces too narrow to be anything but rounding, where a long edge of them is beside a covered one.
fn close_gaps(net: &Net, covered: &mut [bool]) {
    let mut narrow = Vec::new();
    for face in net.inner_faces().filter(|face| !covered[face.fix().index()]) {
        let length = |edge: &Edge<'_>| edge.length_2().sqrt();
        let edges = face.adjacent_edges();
        let Some(longest) = edges.iter().copied().max_by(|a, b| length(a).total_cmp(&length(b))) else { continue };
        let is_beside =
            |edge: &Edge<'_>| 2.0 * length(edge) > length(&longest) && covered[edge.rev().face().fix().index()];
        if 2.0 * face.area() < GAP * length(&longest) && edges.iter().any(is_beside) {
            narrow.push(face.fix().index());
        }
    }
    narrow.into_iter().for_each(|face| covered[face] = true);
}

/// The rings around the covered faces of a triangulation, by connected part.
fn loops(net: &Net, covered: &[bool], point: impl Fn(Point2<f64>) -> Point) -> Vec<Part> {
    let part_of = connected(net, covered);
    let is_border = |edge: &Edge<'_>| covered[edge.face().fix().index()] && !covered[edge.rev().face().fix().index()];
    let mut parts: Vec<Part> = Vec::new();
    let mut done = vec![false; net.num_directed_edges()];
    for start in net.directed_edges().filter(|edge| is_border(edge)) {
        if done[start.fix().index()] {
            continue;
        }
        let mut ring: Vec<Point> = Vec::new();
        let mut edge = start;
        while !std::mem::replace(&mut done[edge.fix().index()], true) {
            let from = point(edge.from().position());
            if ring.last() != Some(&from) {
                ring.push(from);
            }
            // On around the corner, through the covered faces at it.
            edge = edge.next();
            while !is_border(&edge) {
                edge = edge.rev().next();
            }
        }
        if ring.len() > 1 && ring.last() == ring.first() {
            ring.pop();
        }
        let ring = straightened(&ring);
        let area = twice_area(ring.iter().copied());
        let part = part_of[start.face().fix().index()];
        parts.resize(parts.len().max(part + 1), Part::new());
        match area.signum() {
            1 => parts[part].insert(0, ring),
            -1 => parts[part].push(ring),
            _ => {}
        }
    }
    parts.retain(|rings| rings.first().is_some_and(|outer| twice_area(outer.iter().copied()) > 0));
    parts
}

/// Numbers of the connected parts of the covered faces, one per face; over edges, not over corners.
fn connected(net: &Net, covered: &[bool]) -> Vec<usize> {
    let mut part_of = vec![usize::MAX; covered.len()];
    let mut count = 0;
    for face in net.inner_faces().filter(|face| covered[face.fix().index()]) {
        if part_of[face.fix().index()] != usize::MAX {
            continue;
        }
        part_of[face.fix().index()] = count;
        let mut open = vec![face];
        while let Some(face) = open.pop() {
            let beyond = face.adjacent_edges().into_iter().filter_map(|edge| edge.rev().face().as_inner());
            for next in beyond.filter(|next| covered[next.fix().index()]) {
                if part_of[next.fix().index()] == usize::MAX {
                    part_of[next.fix().index()] = count;
                    open.push(next);
                }
            }
        }
        count += 1;
    }
    part_of
}

/// The convex hull of points, counter-clockwise from the lowest x, without corners on straight edges (Andrew's monotone chain).
/// Fewer than three corners: the points are on one line.
pub fn convex(points: impl IntoIterator<Item = Point>) -> Vec<Point> {
    let mut sorted: Vec<Point> = points.into_iter().collect();
    sorted.sort_unstable();
    sorted.dedup();
    if sorted.len() < 3 {
        return sorted;
    }
    let chain = |points: &mut dyn Iterator<Item = Point>| {
        let mut kept: Vec<Point> = Vec::new();
        for p in points {
            while let [.., a, b] = kept[..]
                && orient(a, b, p) <= 0
            {
                kept.pop();
            }
            kept.push(p);
        }
        kept.pop();
        kept
    };
    let mut hull = chain(&mut sorted.iter().copied());
    hull.extend(chain(&mut sorted.iter().rev().copied()));
    hull
}

/// The smallest rectangle around a convex ring, counter-clockwise; one of its sides holds one of the ring's (Freeman and Shapira
/// 1975). Of rectangles equally small to 10⁻⁹ that along the axes wins, then the first.
pub fn smallest_rectangle(ring: &[Point]) -> [DVec2; 4] {
    let origin = ring.first().copied().unwrap_or_default();
    let local = |p: &Point| DVec2::new((p[0] - origin[0]) as f64, (p[1] - origin[1]) as f64);
    let around = |along: DVec2| {
        let across = along.perp();
        let ends = |axis: DVec2| {
            let at = ring.iter().map(|p| axis.dot(local(p)));
            at.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
        };
        let ((a, b), (c, d)) = (ends(along), ends(across));
        let corner = |u: f64, v: f64| along * u + across * v + DVec2::new(origin[0] as f64, origin[1] as f64);
        ((b - a) * (d - c), [corner(a, c), corner(b, c), corner(b, d), corner(a, d)])
    };
    let mut best = around(DVec2::X);
    for i in 0..ring.len() {
        let along = (local(&ring[(i + 1) % ring.len()]) - local(&ring[i])).normalize_or(DVec2::X);
        let found = around(along);
        if found.0 < best.0 * (1.0 - 1e-9) {
            best = found;
        }
    }
    best.1
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(parts: &[Part]) -> i128 {
        parts.iter().flatten().map(|ring| twice_area(ring.iter().copied())).sum()
    }

    fn rectangle(x: [i64; 2], y: [i64; 2]) -> [[Point; 3]; 2] {
        let corners = [[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]];
        [[corners[0], corners[1], corners[2]], [corners[0], corners[2], corners[3]]]
    }

    fn all(rectangles: &[[[Point; 3]; 2]]) -> Vec<[Point; 3]> {
        rectangles.concat()
    }

    #[test]
    fn nothing_has_no_outline() {
        assert_eq!(union(&[]), Vec::<Part>::new());
        assert_eq!(union(&[[[0, 0], [5, 0], [9, 0]]]), Vec::<Part>::new(), "no area");
    }

    #[test]
    fn neighbours_become_one_ring_whichever_way_they_turn() {
        let mut two = all(&[rectangle([0, 1000], [0, 1000]), rectangle([1000, 3000], [0, 1000])]);
        two[1].reverse();
        assert_eq!(union(&two), [[vec![[0, 0], [3000, 0], [3000, 1000], [0, 1000]]]]);
    }

    #[test]
    fn overlaps_count_once() {
        let cross = all(&[rectangle([0, 9000], [3000, 6000]), rectangle([3000, 6000], [0, 9000])]);
        let found = union(&cross);
        assert_eq!((found.len(), found[0].len(), found[0][0].len()), (1, 1, 12));
        assert_eq!(area(&found), 2 * (27_000_000 + 27_000_000 - 9_000_000));
        let twice = all(&[rectangle([0, 9000], [0, 3000]), rectangle([0, 9000], [0, 3000])]);
        assert_eq!(area(&union(&twice)), 2 * 27_000_000);
    }

    #[test]
    fn courtyards_are_holes_and_islands_are_parts() {
        let ring = all(&[
            rectangle([0, 9000], [0, 3000]),
            rectangle([0, 9000], [6000, 9000]),
            rectangle([0, 3000], [2000, 7000]),
            rectangle([6000, 9000], [2000, 7000]),
        ]);
        let found = union(&ring);
        assert_eq!((found.len(), found[0].len()), (1, 2), "{found:?}");
        assert_eq!(area(&found), 2 * 72_000_000);
        let apart = all(&[rectangle([0, 100], [0, 100]), rectangle([200, 300], [0, 100])]);
        assert_eq!((union(&apart).len(), area(&union(&apart))), (2, 40_000));
        let at_a_corner = all(&[rectangle([0, 100], [0, 100]), rectangle([100, 200], [100, 200])]);
        assert_eq!((union(&at_a_corner).len(), area(&union(&at_a_corner))), (2, 40_000));
    }

    #[test]
    fn thousands_that_overlap_have_an_outline_and_what_crosses_too_often_has_none() {
        // Squares of 300 units, 200 apart: each overlaps its neighbours.
        let squares: Vec<_> = (0..3600)
            .map(|i| [200 * (i % 60), 200 * (i / 60)])
            .map(|[x, y]| rectangle([x, x + 300], [y, y + 300]))
            .collect();
        let found = union(&all(&squares));
        assert_eq!((found.len(), found[0].len(), area(&found)), (1, 1, 2 * 12_100 * 12_100));
        // Bars across bars: 4 · 250² crossings.
        let bars = (0..250).flat_map(|i| {
            let (from, long) = (40 * i, [-10, 10_000]);
            [rectangle([from, from + 20], long), rectangle(long, [from, from + 20])]
        });
        assert_eq!(union(&all(&bars.collect::<Vec<_>>())), Vec::<Part>::new());
    }

    #[test]
    fn gaps_of_rounding_are_closed_and_wider_ones_stay() {
        let gap = |width: i64| {
            area(&union(&all(&[rectangle([0, 5000], [0, 4000]), rectangle([0, 5000], [4000 + width, 8000])])))
        };
        assert_eq!(gap(1), 2 * 40_000_000);
        assert_eq!(gap(10), 2 * (40_000_000 - 50_000));
    }

    /// Against rays down a fine grid: a point is in the union's rings as often as not iff some triangle holds it.
    #[test]
    fn rings_hold_what_triangles_hold() {
        let mut x = 9_u32;
        let mut next = |below: i64| {
            x = x.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            i64::from(x >> 8) % below
        };
        for round in 0..200 {
            let triangles: Vec<[Point; 3]> =
                (0..2 + round % 9).map(|_| [0; 3].map(|_| [next(20_000), next(20_000)])).collect();
            let parts = union(&triangles);
            for _ in 0..200 {
                let p = [next(20_000), next(20_000)];
                let distance = |a: Point, b: Point| {
                    let [a, b, p] = [a, b, p].map(|p| DVec2::new(p[0] as f64, p[1] as f64));
                    let t = ((p - a).dot(b - a) / (b - a).length_squared().max(1.0)).clamp(0.0, 1.0);
                    p.distance(a + t * (b - a))
                };
                let ends = |t: &[Point; 3]| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])];
                if triangles.iter().flat_map(ends).any(|(a, b)| distance(a, b) < 4.0) {
                    continue;
                }
                let holds = |t: &[Point; 3]| {
                    let sides = ends(t).map(|(a, b)| orient(a, b, p).signum());
                    sides == [1; 3] || sides == [-1; 3]
                };
                let crossings = parts.iter().flatten().flat_map(|ring| {
                    (0..ring.len()).filter(move |&i| {
                        let (a, b) = (ring[i], ring[(i + 1) % ring.len()]);
                        (a[1] > p[1]) != (b[1] > p[1]) && (orient(a, b, p) > 0) == (b[1] > a[1])
                    })
                });
                let is_in = crossings.count() % 2 == 1;
                assert_eq!(is_in, triangles.iter().any(holds), "{p:?} {triangles:?} {parts:?}");
            }
        }
    }

    #[test]
    fn hulls_and_rectangles() {
        let hull = convex([[0, 0], [4, 0], [2, 0], [4, 4], [0, 4], [2, 2], [0, 0]]);
        assert_eq!(hull, [[0, 0], [4, 0], [4, 4], [0, 4]]);
        assert_eq!(convex([[0, 0], [1, 1], [2, 2]]).len(), 2, "on one line");
        // A square on its corner: the box along the axes is twice as large.
        let turned = smallest_rectangle(&convex([[10, 0], [20, 10], [10, 20], [0, 10]]));
        let sides = [turned[0].distance_squared(turned[1]), turned[1].distance_squared(turned[2])];
        assert!(sides.iter().all(|s| (s - 200.0).abs() < 1e-9), "{turned:?}");
        let along = smallest_rectangle(&[[0, 0], [9, 0], [9, 4], [0, 4]]);
        assert_eq!(along, [[0.0, 0.0], [9.0, 0.0], [9.0, 4.0], [0.0, 4.0]].map(DVec2::from));
    }

    fn doubled(t: &[Point; 3]) -> i128 {
        orient(t[0], t[1], t[2]).abs()
    }

    fn around(t: &[Point; 3]) -> f64 {
        let length = |a: Point, b: Point| ((b[0] - a[0]) as f64).hypot((b[1] - a[1]) as f64);
        length(t[0], t[1]) + length(t[1], t[2]) + length(t[2], t[0])
    }

    /// The area of the outline: no less than that of the largest triangle and no more than of all, but for what rounding moves along their borders.
    fn is_as_large_as_they_are(triangles: &[[[i64; 2]; 3]]) -> Result<(), proptest::test_runner::TestCaseError> {
        let largest = triangles.iter().map(doubled).max().unwrap_or(0) as f64;
        let all = triangles.iter().map(doubled).sum::<i128>() as f64;
        let rim = 4.0 * triangles.iter().map(around).sum::<f64>();
        let area = area(&union(triangles)) as f64;
        proptest::prop_assert!(area >= largest - rim && area <= all + rim, "{area}: {largest}, {all}");
        Ok(())
    }

    proptest::proptest! {
        #![proptest_config(crate::seeds::config())]

        /// Triangles that cross each other in any way, so near that their crossings are rounded onto each other, have an outline.
        #[test]
        fn whatever_crosses_has_an_outline(
            triangles in proptest::collection::vec(proptest::array::uniform3(proptest::array::uniform2(0..40_i64)), 1..40)
        ) {
            is_as_large_as_they_are(&triangles)?;
        }

        /// The same of far larger ones, of which hardly any crossing lies on the lattice: next to nothing is lost.
        #[test]
        fn large_triangles_lose_nothing_to_rounding(
            triangles in proptest::collection::vec(proptest::array::uniform3(proptest::array::uniform2(-90_000..90_000_i64)), 1..12)
        ) {
            is_as_large_as_they_are(&triangles)?;
        }
    }
}
