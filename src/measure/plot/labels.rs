//! Labels beside their points: each takes the place around its point where least is in the way.

use crate::measure::plot::svg::{Anchor, text_width};

/// A box in the drawing: left, top, right, bottom.
pub type Frame = [f64; 4];

/// Where a label stands: base line and anchor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// On the base line.
    pub at: [f64; 2],
    /// Which part of the text stands there.
    pub anchor: Anchor,
}

/// Distance of a label from its point.
const GAP: f64 = 9.0;

/// One place per label; `obstacles` are boxes that should stay free, `page` is what labels should not leave.
pub fn places(points: &[[f64; 2]], texts: &[String], size: f64, obstacles: &[Frame], page: Frame) -> Vec<Place> {
    let mut taken: Vec<Frame> = obstacles.to_vec();
    taken.extend(points.iter().map(|[x, y]| [x - 6.0, y - 6.0, x + 6.0, y + 6.0]));
    let mut places = Vec::with_capacity(points.len());
    for (&[x, y], text) in points.iter().zip(texts) {
        let low = y + 0.36 * size;
        let (above, below) = (y - GAP, y + GAP + 0.72 * size);
        // The order is the taste of a map maker: right above is best, left below worst.
        let around = [
            ([x + GAP, low], Anchor::Start),
            ([x + 0.7 * GAP, above + 2.0], Anchor::Start),
            ([x, above], Anchor::Middle),
            ([x + 0.7 * GAP, below - 2.0], Anchor::Start),
            ([x - GAP, low], Anchor::End),
            ([x - 0.7 * GAP, above + 2.0], Anchor::End),
            ([x, below], Anchor::Middle),
            ([x - 0.7 * GAP, below - 2.0], Anchor::End),
        ]
        .map(|(at, anchor)| Place { at, anchor });
        let cost = |rank: usize, place: &Place| {
            let own = frame(place, text, size);
            let outside = area(own) - shared(own, page);
            let over: f64 = taken.iter().map(|other| shared(own, *other)).sum();
            over + 10.0 * outside + 0.5 * rank as f64
        };
        let best = around.iter().enumerate().min_by(|a, b| cost(a.0, a.1).total_cmp(&cost(b.0, b.1)));
        let place = best.map_or(around[0], |(_, place)| *place);
        taken.push(frame(&place, text, size));
        places.push(place);
    }
    places
}

/// Heights of labels that stand in a column, so far apart that none lies on another, near where they are wanted.
pub fn apart(wanted: &[f64], distance: f64) -> Vec<f64> {
    let mut order: Vec<usize> = (0..wanted.len()).collect();
    order.sort_by(|&a, &b| wanted[a].total_cmp(&wanted[b]));
    // Runs of labels that touch are centred on the mean of what they want.
    let mut runs: Vec<(f64, Vec<usize>)> = Vec::new();
    for i in order {
        runs.push((wanted[i], vec![i]));
        while let [.., a, b] = &runs[..] {
            let reach = |run: &(f64, Vec<usize>)| 0.5 * distance * run.1.len() as f64;
            if b.0 - a.0 >= reach(a) + reach(b) {
                break;
            }
            let members: Vec<usize> = a.1.iter().chain(&b.1).copied().collect();
            let mean = members.iter().map(|&i| wanted[i]).sum::<f64>() / members.len() as f64;
            runs.truncate(runs.len() - 2);
            runs.push((mean, members));
        }
    }
    let mut heights = wanted.to_vec();
    for (mean, members) in runs {
        for (k, &i) in members.iter().enumerate() {
            heights[i] = mean + (k as f64 - 0.5 * (members.len() - 1) as f64) * distance;
        }
    }
    heights
}

/// Where on a base line a text lies on the least: its left end. `page` bounds it, the left is preferred.
pub fn along_line(y: f64, text: &str, size: f64, obstacles: &[Frame], page: Frame) -> f64 {
    let last = (page[2] - text_width(text, size)).max(page[0]);
    let candidates = (0..=32).map(|i| page[0] + (last - page[0]) * f64::from(i) / 32.0);
    let cost = |x: &f64| {
        let own = frame(&Place { at: [*x, y], anchor: Anchor::Start }, text, size);
        obstacles.iter().map(|other| shared(own, *other)).sum::<f64>()
    };
    candidates.min_by(|a, b| cost(a).total_cmp(&cost(b))).unwrap_or(page[0])
}

/// Boxes along a line, so that labels keep off it.
pub fn along(from: [f64; 2], to: [f64; 2]) -> Vec<Frame> {
    let steps = ((to[0] - from[0]).hypot(to[1] - from[1]) / 6.0).ceil().clamp(1.0, 400.0) as usize;
    let at = |i: usize, k: usize| from[k] + (to[k] - from[k]) * i as f64 / steps as f64;
    (0..=steps).map(|i| [at(i, 0) - 2.0, at(i, 1) - 2.0, at(i, 0) + 2.0, at(i, 1) + 2.0]).collect()
}

/// The box that a label takes.
pub fn frame(place: &Place, text: &str, size: f64) -> Frame {
    let width = text_width(text, size);
    let left = place.at[0]
        - match place.anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => 0.5 * width,
            Anchor::End => width,
        };
    [left, place.at[1] - 0.78 * size, left + width, place.at[1] + 0.22 * size]
}

fn area(f: Frame) -> f64 {
    (f[2] - f[0]) * (f[3] - f[1])
}

fn shared(a: Frame, b: Frame) -> f64 {
    let side = |k: usize| (a[k + 2].min(b[k + 2]) - a[k].max(b[k])).max(0.0);
    side(0) * side(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_lie_neither_on_each_other_nor_outside() {
        let points: Vec<[f64; 2]> = (0..9)
            .map(|i| [40.0 + 14.0 * f64::from(i), 90.0 - 9.0 * f64::from(i % 4)])
            .chain([[395.0, 10.0]])
            .collect();
        let texts: Vec<String> = (0..10).map(|i| i.to_string()).collect();
        let page = [0.0, 0.0, 400.0, 200.0];
        let frames: Vec<Frame> =
            places(&points, &texts, 12.0, &[], page).iter().zip(&texts).map(|(p, t)| frame(p, t, 12.0)).collect();
        for (i, a) in frames.iter().enumerate() {
            assert!((shared(*a, page) - area(*a)).abs() < 1e-9, "label {i} leaves the page");
            assert!(frames[..i].iter().all(|b| shared(*a, *b) == 0.0), "label {i} lies on another");
        }
    }

    #[test]
    fn a_text_on_a_line_steps_aside() {
        let page = [10.0, 0.0, 200.0, 100.0];
        assert_eq!(along_line(50.0, "plain", 10.0, &[], page), 10.0);
        let moved = along_line(50.0, "plain", 10.0, &[[0.0, 0.0, 60.0, 100.0]], page);
        assert!((60.0..70.0).contains(&moved), "{moved}");
    }

    #[test]
    fn columns_of_labels() {
        assert_eq!(apart(&[10.0, 50.0], 15.0), [10.0, 50.0], "far enough apart: where they want to be");
        assert_eq!(apart(&[50.0, 50.0], 10.0), [45.0, 55.0]);
        assert_eq!(apart(&[52.0, 48.0, 100.0], 10.0), [55.0, 45.0, 100.0]);
        let many = apart(&[5.0, 1.0, 2.0, 3.0, 9.0, 4.0], 12.0);
        let mut sorted = many.clone();
        sorted.sort_by(f64::total_cmp);
        assert!(sorted.windows(2).all(|w| w[1] - w[0] > 11.99));
        assert_eq!(apart(&[], 10.0), [0.0; 0]);
    }
}
