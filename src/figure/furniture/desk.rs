//! The room of a picture that pieces of a figure stand in: each where it is wanted, or as near to there as the others leave it free.

use crate::{overlay::Rect, scene::Anchor};

/// How much dearer a way across is than one up or down: what stands in a corner stays at its side.
const ACROSS: f32 = 4.0;

/// A rectangle, pixels of the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Area {
    /// Left, top.
    pub low: [f32; 2],
    /// Right, bottom.
    pub high: [f32; 2],
}

impl Area {
    /// One of this size, from its upper left corner.
    pub fn new(low: [f32; 2], size: [f32; 2]) -> Self {
        Self { low, high: [low[0] + size[0], low[1] + size[1]] }
    }

    /// Whether both have some area in common.
    pub fn meets(&self, other: &Self) -> bool {
        (0..2).all(|axis| self.low[axis] < other.high[axis] && other.low[axis] < self.high[axis])
    }

    /// The whole pixels that it touches.
    pub fn rect(&self) -> Rect {
        Rect { min: self.low.map(|v| v.floor() as i32), max: self.high.map(|v| v.ceil() as i32) }
    }
}

impl From<&Rect> for Area {
    fn from(rect: &Rect) -> Self {
        Self { low: rect.min.map(|v| v as f32), high: rect.max.map(|v| v as f32) }
    }
}

/// A picture, and what of it is taken.
#[derive(Clone, Debug)]
pub struct Desk {
    /// Width and height, pixels.
    size: [f32; 2],
    /// From the picture's border, whole pixels.
    margin: f32,
    /// Between pieces where one makes way for another, whole pixels.
    gap: f32,
    taken: Vec<Area>,
}

impl Desk {
    pub fn new(size: [f32; 2], margin: f32, gap: f32, taken: Vec<Area>) -> Self {
        Self { size, margin, gap, taken }
    }

    /// Where a piece of this size stands at an anchor, were it alone.
    pub fn at_anchor(&self, anchor: Anchor, size: [f32; 2]) -> [f32; 2] {
        let share = anchor.share();
        std::array::from_fn(|axis| {
            let room = self.size[axis] - 2.0 * self.margin - size[axis];
            self.margin + (share[axis] * room).round()
        })
    }

    /// The same of one with its middle at these shares of the picture, moved as far as the border asks for it.
    pub fn at_share(&self, at: [f64; 2], size: [f32; 2]) -> [f32; 2] {
        std::array::from_fn(|axis| {
            let low = (at[axis] as f32 * self.size[axis] - 0.5 * size[axis]).round();
            let most = self.size[axis] - self.margin - size[axis];
            low.min(most).max(self.margin)
        })
    }

    /// Whether all of an area is in the picture, and nobody's.
    pub fn is_free(&self, area: &Area) -> bool {
        let is_in = (0..2).all(|axis| {
            area.low[axis] >= self.margin.min(1.0) && area.high[axis] <= self.size[axis] - self.margin.min(1.0)
        });
        is_in && !self.taken.iter().any(|other| other.meets(area))
    }

    /// The free place for a piece of this size that is nearest to where it is wanted; `None`: there is none.
    pub fn nearest(&self, wanted: [f32; 2], size: [f32; 2]) -> Option<[f32; 2]> {
        let most: [f32; 2] = std::array::from_fn(|axis| self.size[axis] - self.margin - size[axis]);
        let places = |axis: usize| -> Vec<f32> {
            let beside = |other: &Area| [other.low[axis] - self.gap - size[axis], other.high[axis] + self.gap];
            let all = std::iter::once(wanted[axis]).chain(self.taken.iter().flat_map(beside));
            all.filter(|low| (self.margin..=most[axis]).contains(low)).collect()
        };
        let ys = places(1);
        let free = places(0).into_iter().flat_map(|x| ys.iter().map(move |y| [x, *y]));
        let way = |low: &[f32; 2]| ACROSS * (low[0] - wanted[0]).abs() + (low[1] - wanted[1]).abs();
        free.filter(|low| self.is_free(&Area::new(*low, size))).min_by(|a, b| way(a).total_cmp(&way(b)))
    }

    /// The first of these anchors where a piece of this size stands at once; else as near as may be to the first of them.
    pub fn at_first(&self, anchors: &[Anchor], size: [f32; 2]) -> Option<[f32; 2]> {
        let at = |anchor: &Anchor| self.at_anchor(*anchor, size);
        let most = |axis: usize| self.size[axis] - 2.0 * self.margin - size[axis];
        if most(0) < 0.0 || most(1) < 0.0 {
            return None;
        }
        let free = anchors.iter().map(at).find(|low| self.is_free(&Area::new(*low, size)));
        free.or_else(|| self.nearest(anchors.first().map(at)?, size))
    }

    /// Takes an area.
    pub fn take(&mut self, area: Area) {
        self.taken.push(area);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn desk(taken: &[[f32; 4]]) -> Desk {
        let taken = taken.iter().map(|[a, b, c, d]| Area { low: [*a, *b], high: [*c, *d] });
        Desk::new([400.0, 300.0], 10.0, 5.0, taken.collect())
    }

    #[test]
    fn anchors_are_at_the_border() {
        let desk = desk(&[]);
        let at = |anchor| desk.at_anchor(anchor, [100.0, 50.0]);
        assert_eq!(at(Anchor::TopLeft), [10.0, 10.0]);
        assert_eq!(at(Anchor::BottomRight), [290.0, 240.0]);
        assert_eq!(at(Anchor::Top), [150.0, 10.0]);
        assert_eq!(at(Anchor::Right), [290.0, 125.0]);
        assert_eq!(desk.at_share([0.5, 0.5], [100.0, 50.0]), [150.0, 125.0]);
        assert_eq!(desk.at_share([0.0, 1.0], [100.0, 50.0]), [10.0, 240.0]);
    }

    #[test]
    fn what_is_in_the_way_is_passed_on_the_shortest_way_up_or_down_first() {
        let desk = desk(&[[10.0, 10.0, 150.0, 60.0]]);
        let [w, h] = [100.0, 50.0];
        assert_eq!(desk.nearest([10.0, 10.0], [w, h]), Some([10.0, 65.0]), "below, with a gap");
        assert_eq!(desk.nearest([10.0, 200.0], [w, h]), Some([10.0, 200.0]), "where it is wanted");
        assert_eq!(desk.at_first(&[Anchor::TopLeft, Anchor::TopRight], [w, h]), Some([290.0, 10.0]));
        assert_eq!(desk.nearest([10.0, 10.0], [380.0, 280.0]), None, "too large beside the other");
        assert_eq!(desk.at_first(&[Anchor::TopLeft], [390.0, 20.0]), None, "too wide for the picture");
        // The only free place is beside it.
        let tall = self::desk(&[[10.0, 10.0, 150.0, 290.0]]);
        assert_eq!(tall.nearest([10.0, 10.0], [w, h]), Some([155.0, 10.0]));
    }
}
