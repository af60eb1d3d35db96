//! Case 20, overlays with coincident anchors: no line crosses where an order without crossings exists, and else as few as in the best of all orders.
//! Oracle: all
//! permutations, with crossings told by fractions of the lattice coordinates, which share no code with the layout.

use glam::DVec2;
use veduta::overlay::{
    Align, Arrangement, Focus, Layout, LineKind, Overlay, Rect, Request,
    lane::Side,
    line::{Target, way},
    place,
};

fn request(anchors: &[Vec<[f64; 2]>], arrangement: Arrangement, lines: &[LineKind]) -> Request {
    let size = DVec2::new(120.0, 56.0);
    let overlay = |(id, anchors): (u32, &Vec<[f64; 2]>)| Overlay {
        id,
        priority: 0.0,
        min: size,
        preferred: size,
        max: size,
        anchors: anchors.iter().map(|at| Focus::Point(DVec2::from_array(*at))).collect(),
        lines: lines[id as usize % lines.len()],
        weight: 0.5,
        distance: 10.0,
    };
    Request {
        picture: [1280, 720],
        overlays: (0..).zip(anchors).map(overlay).collect(),
        avoid: anchors.iter().flatten().map(|at| DVec2::from_array(*at)).collect(),
        clearance: 6.0,
        blocked: vec![],
        layout: Layout { arrangement, ..Layout::default() },
    }
}

/// Points on the lattice of 1/256 pixel.
type Line = Vec<[i128; 2]>;

/// Whether two lines share a point, other than a focus where both end.
fn cross(a: &Line, b: &Line) -> bool {
    let same = a.last() == b.last();
    let area = |u: [i128; 2], v: [i128; 2]| u[0] * v[1] - u[1] * v[0];
    let less = |p: [i128; 2], q: [i128; 2]| [p[0] - q[0], p[1] - q[1]];
    (1..a.len()).any(|i| {
        (1..b.len()).any(|j| {
            let (p, u) = (a[i - 1], less(a[i], a[i - 1]));
            let (q, v) = (b[j - 1], less(b[j], b[j - 1]));
            let is_last = same && i + 1 == a.len() && j + 1 == b.len();
            let turn = area(u, v);
            let from = less(q, p);
            if turn != 0 {
                // p + s u = q + t v, in s and t by Cramer's rule.
                let (s, t) = (area(from, v) * turn.signum(), area(from, u) * turn.signum());
                let is_end = s == turn.abs() && t == turn.abs();
                return (0..=turn.abs()).contains(&s) && (0..=turn.abs()).contains(&t) && !(is_last && is_end);
            }
            if area(from, u) != 0 {
                return false;
            }
            let along = |x: [i128; 2]| less(x, p)[0] * u[0] + less(x, p)[1] * u[1];
            let (low, high) = (along(q).min(along(b[j])).max(0), along(q).max(along(b[j])).min(along(a[i])));
            if is_last { low < high } else { low <= high }
        })
    })
}

/// Whether a line shares a point with a rectangle, border included: it has an end in it, or crosses a side of it.
fn over(line: &Line, rect: &Rect) -> bool {
    let [low, high] = [rect.min, rect.max].map(|c| c.map(|v| i128::from(v) * 256));
    let inside = |p: &[i128; 2]| (0..2).all(|i| (low[i]..=high[i]).contains(&p[i]));
    let corners = [low, [high[0], low[1]], high, [low[0], high[1]]];
    // Sides have no focus: one more corner keeps their ends from being one.
    let sides = (0..4).map(|i| vec![corners[i], corners[(i + 1) % 4], corners[(i + 2) % 4]]);
    line.iter().any(inside) || sides.into_iter().any(|side| cross(line, &side))
}

fn line(rect: &Rect, side: Side, at: [f64; 2], kind: LineKind) -> Option<Line> {
    let way = way(rect, side, &Target::new(&Focus::Point(DVec2::from_array(at)))?, kind)?;
    Some(way.points().iter().map(|p| p.map(i128::from)).collect())
}

/// Crossings if overlay `order[i]` stands at the i-th place.
fn crossings(asked: &[Vec<[f64; 2]>], kinds: &[LineKind], places: &[(Rect, Side)], order: &[usize]) -> u32 {
    let lines: Vec<Vec<Line>> = places
        .iter()
        .zip(order)
        .map(|((rect, side), &i)| {
            asked[i].iter().filter_map(|at| line(rect, *side, *at, kinds[i % kinds.len()])).collect()
        })
        .collect();
    let mut sum = 0;
    for i in 0..lines.len() {
        for j in 0..lines.len() {
            if j < i {
                sum += lines[i].iter().map(|a| lines[j].iter().filter(|b| cross(a, b)).count()).sum::<usize>();
            }
            if j != i {
                sum += lines[i].iter().filter(|a| over(a, &places[j].0)).count();
            }
        }
    }
    sum as u32
}

fn least(look: &mut impl FnMut(&[usize]) -> u32, order: &mut Vec<usize>, left: &mut Vec<usize>) -> u32 {
    if left.is_empty() {
        return look(order);
    }
    let mut best = u32::MAX;
    for n in 0..left.len() {
        order.push(left.remove(n));
        best = best.min(least(look, order, left));
        left.insert(n, order.pop().unwrap());
    }
    best
}

#[test]
fn lines_to_coincident_anchors_cross_as_little_as_in_the_best_order() {
    let one = [640.0, 360.0];
    let cases: Vec<(&str, Vec<Vec<[f64; 2]>>)> = vec![
        ("all on one pixel", vec![vec![one]; 5]),
        ("all at one place between pixels", vec![vec![[640.25, 360.0]]; 5]),
        (
            "three pairs",
            [[400.0, 200.0], [640.0, 500.0], [900.0, 300.0]].iter().flat_map(|at| vec![vec![*at]; 2]).collect(),
        ),
        (
            "each at one pixel and one of its own",
            (0..5).map(|i| vec![one, [300.0 + 150.0 * f64::from(i), 500.0]]).collect(),
        ),
        ("twice at one pixel", vec![vec![one, one]; 4]),
        ("in a column", (0..6).map(|i| vec![[640.0, 200.0 + 60.0 * f64::from(i % 3)]]).collect()),
    ];
    let arrangements = [
        Arrangement::Border,
        Arrangement::Vertical(Align::First),
        Arrangement::Vertical(Align::Both),
        Arrangement::Horizontal(Align::Last),
    ];
    let kinds: [&[LineKind]; 4] = [
        &[LineKind::Straight],
        &[LineKind::Orthogonal],
        &[LineKind::Curved],
        &[LineKind::Straight, LineKind::Curved, LineKind::Orthogonal],
    ];
    let mut with_crossings = 0;
    for (what, anchors) in &cases {
        for arrangement in arrangements {
            for kinds in kinds {
                let asked = request(anchors, arrangement, kinds);
                let placed = place(&asked, None);
                let about = format!("{what}, {arrangement:?}, {kinds:?}");
                assert!(placed.is_least && placed.folded.is_empty(), "{about}");
                let places: Vec<_> = placed.placements.iter().map(|p| (p.rect, p.seat.side())).collect();
                let own: Vec<usize> = (0..anchors.len()).collect();
                let told = placed.crossings.sum();
                assert_eq!(told, crossings(anchors, kinds, &places, &own), "{about}");
                // All are of one size: another order is another way to stand at these places.
                let mut look = |order: &[usize]| crossings(anchors, kinds, &places, order);
                assert_eq!(told, least(&mut look, &mut Vec::new(), &mut own.clone()), "{about}");
                with_crossings += u32::from(told > 0);
                if kinds == [LineKind::Straight] && anchors.iter().all(|a| a.len() == 1) {
                    assert_eq!(told, 0, "{about}");
                }
            }
        }
    }
    assert!(with_crossings > 5, "the oracle had little to say: {with_crossings}");
}
