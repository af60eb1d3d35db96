//! What of a picture a lens may touch: an 8-DOP with sides along the rows, the columns and both diagonals. It is what
//! shading and filters are drawn over; a rectangle around a ball holds a quarter more pixels than the ball shows.

use std::ops::Range;

use glam::DVec2;

use crate::render::eye::PictureTile;

/// The pixels between four pairs of parallel lines: x, y, x + y and x - y, pixels from the picture's upper left corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ScreenBound {
    low: [i32; 4],
    high: [i32; 4],
}

/// Beyond any picture, and far from overflowing.
const FAR: f64 = 1e6;

impl ScreenBound {
    /// The whole picture.
    pub fn whole(size: [u32; 2]) -> Self {
        let [w, h] = size.map(|side| side as i32);
        Self { low: [0, 0, 0, -h], high: [w, h, w + h, w] }
    }

    /// Around what lies between these values of x, y, x + y and x - y; whole pixels.
    pub fn around(low: [f64; 4], high: [f64; 4]) -> Self {
        Self {
            low: low.map(|v| v.floor().clamp(-FAR, FAR) as i32),
            high: high.map(|v| v.ceil().clamp(-FAR, FAR) as i32),
        }
    }

    /// The least that holds both.
    pub fn with(self, other: Self) -> Self {
        Self {
            low: std::array::from_fn(|i| self.low[i].min(other.low[i])),
            high: std::array::from_fn(|i| self.high[i].max(other.high[i])),
        }
    }

    /// With so many pixels more to the left and right, and above and below.
    pub fn grown(self, [x, y]: [i32; 2]) -> Self {
        let by = [x, y, x + y, x + y];
        Self { low: std::array::from_fn(|i| self.low[i] - by[i]), high: std::array::from_fn(|i| self.high[i] + by[i]) }
    }

    /// As a part of the picture sees it whose upper left corner is `origin`; `None` where nothing of it is in the part.
    pub fn within(self, part: PictureTile) -> Option<Self> {
        let [x, y] = part.origin.map(|o| o as i32);
        let from = [x, y, x + y, x - y];
        let moved = Self {
            low: std::array::from_fn(|i| self.low[i] - from[i]),
            high: std::array::from_fn(|i| self.high[i] - from[i]),
        };
        let whole = Self::whole(part.size);
        let cut = Self {
            low: std::array::from_fn(|i| moved.low[i].max(whole.low[i])),
            high: std::array::from_fn(|i| moved.high[i].min(whole.high[i])),
        };
        cut.has_inside().then_some(cut)
    }

    /// Whether it has an area. Of what its lines leave for x and for y: y lies between pairs of lines at an x, if each lower one is
    /// below each upper one there.
    fn has_inside(&self) -> bool {
        let [x0, y0, ..] = self.low.map(f64::from);
        let [x1, y1, ..] = self.high.map(f64::from);
        let [[s0, s1], [d0, d1]] = self.slants();
        let low = x0.max(y0 + d0).max(s0 - y1).max(0.5 * (s0 + d0));
        let high = x1.min(s1 - y0).min(y1 + d1).min(0.5 * (s1 + d1));
        x0 < x1 && y0 < y1 && s0 < s1 && d0 < d1 && low < high
    }

    /// The rectangle around its first two pairs of lines; of an 8-DOP inside its picture.
    pub fn rectangle(&self) -> PictureTile {
        let at = |i: usize| self.low[i].max(0) as u32;
        let length = |i: usize| (self.high[i].max(0) as u32).saturating_sub(at(i));
        PictureTile { origin: [at(0), at(1)], size: [length(0), length(1)] }
    }

    /// Its slanted sides, as `around` says: half a pixel farther out, so that none goes through the centre of a pixel, where a
    /// GPU that rounds would draw it twice or not at all.
    fn slants(&self) -> [[f64; 2]; 2] {
        [2, 3].map(|i| [f64::from(self.low[i]) - 0.5, f64::from(self.high[i]) + 0.5])
    }

    /// Whether a pixel's centre is in it.
    #[cfg(test)]
    pub fn holds(&self, pixel: [u32; 2]) -> bool {
        let [x, y] = pixel.map(|i| f64::from(i) + 0.5);
        let lies = |i: usize, at: f64| f64::from(self.low[i]) <= at && at <= f64::from(self.high[i]);
        [x, y, x + y, x - y].into_iter().enumerate().all(|(i, at)| lies(i, at))
    }

    /// Its corners in order; three to eight, or none.
    fn corners(&self) -> Vec<DVec2> {
        let [x0, y0, ..] = self.low.map(f64::from);
        let [x1, y1, ..] = self.high.map(f64::from);
        let mut corners = vec![DVec2::new(x0, y0), DVec2::new(x1, y0), DVec2::new(x1, y1), DVec2::new(x0, y1)];
        if x1 <= x0 || y1 <= y0 {
            return Vec::new();
        }
        for ([low, high], direction) in self.slants().into_iter().zip([DVec2::new(1.0, 1.0), DVec2::new(1.0, -1.0)]) {
            corners = cut(&corners, direction, high);
            corners = cut(&corners, -direction, -low);
        }
        corners
    }

    /// Pixels.
    pub fn area(&self) -> f64 {
        let corners = self.corners();
        let next = corners.iter().cycle().skip(1);
        0.5 * corners.iter().zip(next).map(|(a, b)| a.perp_dot(*b)).sum::<f64>()
    }

    /// Triangles that cover it once; three corners each, pixels.
    pub fn triangles(&self) -> Vec<DVec2> {
        let corners = self.corners();
        let n = corners.len();
        // From side to side: few blocks of pixels lie on two of them.
        let zigzag = |i: usize| corners[if i.is_multiple_of(2) { i / 2 } else { n - 1 - i / 2 }];
        (2..n).flat_map(|i| [zigzag(i - 2), zigzag(i - 1), zigzag(i)]).collect()
    }

    /// The same as one triangle for its left half and one for its right, each with the rectangle of texels that cuts it, of blocks of so
    /// many pixels; `None` where a side of one half reaches into the other. No four by four texels lie on two triangles then.
    pub fn halves(&self, block: [u32; 2]) -> Option<[([DVec2; 3], PictureTile); 2]> {
        let [[s0, s1], [d0, d1]] = self.slants();
        let [[x0, y0], [x1, y1]] = [self.low, self.high].map(|[x, y, ..]| [x, y].map(f64::from));
        // Between the slanted sides of the left half and those of the right.
        let from = (s0 - y0).max(d0 + y1).max(x0);
        let side = f64::from(4 * block[0]);
        let middle = (from / side).ceil() * side;
        if middle > (s1 - y1).min(d1 + y0).min(x1) {
            return None;
        }
        let half = |[s, d]: [f64; 2], along: f64| {
            // Where its two slanted sides would meet.
            let tip = 0.5 * DVec2::new(s + d, s - d);
            let reach = (tip.x - middle).abs() + 1.0;
            [tip, tip + DVec2::new(along * reach, -reach), tip + DVec2::new(along * reach, reach)]
        };
        // The first texel whose middle is not before a pixel.
        let texel = |i: usize, pixel: f64| (pixel / f64::from(block[i]) - 0.5).ceil().max(0.0) as u32;
        let texels = |from: f64, to: f64| {
            let (low, high) = ([texel(0, from), texel(1, y0)], [texel(0, to), texel(1, y1)]);
            PictureTile { origin: low, size: [high[0] - low[0], high[1] - low[1]] }
        };
        Some([(half([s0, d0], 1.0), texels(x0, middle)), (half([s1, d1], -1.0), texels(middle, x1))])
    }

    /// Triangles that cover once what of a picture it leaves; they reach beyond the picture.
    pub fn beyond(&self, size: [u32; 2]) -> Vec<DVec2> {
        let end = DVec2::new(size[0].into(), size[1].into());
        let corners = self.corners();
        let (low, high) = corners.iter().fold((end, DVec2::ZERO), |(low, high), c| (low.min(*c), high.max(*c)));
        let mut triangles = Vec::new();
        // Above and below one triangle each: few blocks of pixels lie on two.
        let broad = DVec2::new(end.x, 0.0);
        for (level, away) in [(low.y, -low.y), (high.y, end.y - high.y)] {
            let side = DVec2::new(0.0, level);
            let beyond = DVec2::new(0.5 * end.x, level + 2.0 * away);
            if away != 0.0 {
                triangles.extend([side - broad, side + 2.0 * broad, beyond]);
            }
        }
        let mut rectangle = |a: DVec2, b: DVec2| {
            if a.cmplt(b).all() {
                let (c, d) = (DVec2::new(b.x, a.y), DVec2::new(a.x, b.y));
                triangles.extend([a, c, d, d, c, b]);
            }
        };
        rectangle(DVec2::new(0.0, low.y), DVec2::new(low.x, high.y));
        rectangle(DVec2::new(high.x, low.y), DVec2::new(end.x, high.y));
        for (a, b) in corners.iter().zip(corners.iter().cycle().skip(1)) {
            // A slanted side cuts a corner off the rectangle around it.
            if a.x != b.x && a.y != b.y {
                let [one, other] = [DVec2::new(a.x, b.y), DVec2::new(b.x, a.y)];
                let is_corner = |c: DVec2| (c.x == low.x || c.x == high.x) && (c.y == low.y || c.y == high.y);
                triangles.extend([*a, if is_corner(one) { one } else { other }, *b]);
            }
        }
        triangles
    }
}

/// Triangles over parts of pictures, as the vertex shaders of shading and filters take them: corners in clip space.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// Three to a triangle.
    pub corners: Vec<[f32; 2]>,
}

impl Mesh {
    /// Adds a part of a target whose texels are blocks of so many pixels: all blocks that hold a pixel of it. In as few triangles as it
    /// takes: which corners these are, each cut by a rectangle of texels.
    pub fn add(&mut self, part: ScreenBound, size: [u32; 2], block: [u32; 2]) -> Vec<(Range<u32>, PictureTile)> {
        // A pixel's centre is so near to that of its block.
        let grown = part.grown(block.map(|side| side as i32 / 2));
        let target = in_blocks(size, block);
        let whole = PictureTile::whole(std::array::from_fn(|i| target[i] / block[i]));
        let Some(part) = grown.within(PictureTile::whole(target)) else { return Vec::new() };
        if part.area() == f64::from(target[0]) * f64::from(target[1]) {
            return vec![(self.all(), whole)];
        }
        match part.halves(block) {
            Some(halves) => halves.map(|(half, tile)| (self.triangles(&half, target), tile)).to_vec(),
            None => vec![(self.triangles(&part.triangles(), target), whole)],
        }
    }

    /// Adds what of a picture a part leaves.
    pub fn add_beyond(&mut self, part: ScreenBound, size: [u32; 2]) -> Range<u32> {
        self.triangles(&part.beyond(size), size)
    }

    /// Adds all of a target, by one triangle: no block of pixels lies on two.
    pub fn all(&mut self) -> Range<u32> {
        self.pushed([[-1.0, -1.0], [3.0, -1.0], [-1.0, 3.0]].into_iter())
    }

    fn triangles(&mut self, triangles: &[DVec2], size: [u32; 2]) -> Range<u32> {
        let target = DVec2::new(size[0].into(), size[1].into());
        let clip = |p: &DVec2| (DVec2::new(-1.0, 1.0) + *p * DVec2::new(2.0, -2.0) / target).as_vec2().to_array();
        self.pushed(triangles.iter().map(clip))
    }

    fn pushed(&mut self, corners: impl Iterator<Item = [f32; 2]>) -> Range<u32> {
        let first = self.corners.len() as u32;
        self.corners.extend(corners);
        first..self.corners.len() as u32
    }
}

/// Pixels that all blocks of a picture hold.
fn in_blocks(size: [u32; 2], block: [u32; 2]) -> [u32; 2] {
    std::array::from_fn(|i| size[i].next_multiple_of(block[i]))
}

/// What of a convex polygon lies on one side of a line.
fn cut(corners: &[DVec2], direction: DVec2, most: f64) -> Vec<DVec2> {
    let over = |c: DVec2| direction.dot(c) - most;
    let mut kept = Vec::with_capacity(corners.len() + 1);
    for (a, b) in corners.iter().zip(corners.iter().cycle().skip(1)) {
        let (from, to) = (over(*a), over(*b));
        if from <= 0.0 {
            kept.push(*a);
        }
        if from < 0.0 && to > 0.0 || from > 0.0 && to < 0.0 {
            kept.push(*a + (*b - *a) * (from / (from - to)));
        }
    }
    kept.dedup();
    kept
}

/// The same bounds; two become one where that is no larger than both.
pub fn merged(mut parts: Vec<ScreenBound>) -> Vec<ScreenBound> {
    let mut i = 0;
    while i < parts.len() {
        let joined = |k: usize| (k, parts[i].with(parts[k]));
        let fits = |(k, all): &(usize, ScreenBound)| all.area() <= parts[i].area() + parts[*k].area();
        match (i + 1..parts.len()).map(joined).find(fits) {
            Some((k, all)) => {
                parts.swap_remove(k);
                parts[i] = all;
                // What did not fit one of them may fit both.
                i = 0;
            }
            None => i += 1,
        }
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bound(low: [i32; 4], high: [i32; 4]) -> ScreenBound {
        ScreenBound { low, high }
    }

    /// How many of these triangles hold a point that is on no line between pixels.
    fn hits(triangles: &[DVec2], p: DVec2) -> usize {
        let side = |a: DVec2, b: DVec2| (b - a).perp_dot(p - a) > 0.0;
        let holds = |[a, b, c]: [DVec2; 3]| {
            let sides = [side(a, b), side(b, c), side(c, a)];
            sides == [true; 3] || sides == [false; 3]
        };
        triangles.as_chunks().0.iter().filter(|t| holds(**t)).count()
    }

    #[test]
    fn what_it_covers_and_what_it_leaves_are_the_picture_once() {
        let size = [23, 17];
        let part = PictureTile::whole(size);
        let mut some = vec![
            bound([3, 2, 9, -9], [15, 14, 24, 9]),
            bound([3, 2, 5, -11], [15, 14, 29, 13]),
            // A side of no length, a triangle, a sliver, all of it, sides that meet between pixels.
            bound([4, 4, 12, -4], [12, 12, 20, 4]),
            bound([0, 0, 0, -17], [23, 17, 9, 23]),
            bound([-50, 3, 20, -99], [50, 9, 21, 99]),
            bound([-9, -9, -99, -99], [99, 99, 99, 99]),
            bound([0, 0, 11, -5], [23, 17, 26, 6]),
        ];
        some.push(some[0].with(some[4]));
        some.push(some[1].grown([5, 1]));
        let (mut slanted, mut halved, mut in_blocks) = (0, 0, 0);
        for bound in some.into_iter().filter_map(|o| o.within(part)) {
            let (inside, outside, halves) = (bound.triangles(), bound.beyond(size), bound.halves([1, 1]));
            halved += usize::from(halves.is_some());
            slanted += usize::from(bound.area() < f64::from(bound.rectangle().size.iter().product::<u32>()));
            let mut area = 0.0;
            for (x, y) in (0..17).flat_map(|y| (0..23).map(move |x| (x, y))) {
                // Beside the centre, so that no side goes through it.
                let p = DVec2::new(f64::from(x) + 0.4999, f64::from(y) + 0.49);
                let lines = [p.x, p.y, p.x + p.y, p.x - p.y];
                let out = [0.0, 0.0, 0.5, 0.5];
                let range = |i: usize| f64::from(bound.low[i]) - out[i]..f64::from(bound.high[i]) + out[i];
                let is_in = (0..4).all(|i| range(i).contains(&lines[i]));
                let found = [hits(&inside, p), hits(&outside, p)];
                if let Some(halves) = &halves {
                    let holds = |t: &PictureTile| {
                        let at = [p.x as u32, p.y as u32];
                        (0..2).all(|i| (t.origin[i]..t.origin[i] + t.size[i]).contains(&at[i]))
                    };
                    let drawn: usize = halves.iter().filter(|(_, t)| holds(t)).map(|(half, _)| hits(half, p)).sum();
                    assert_eq!(drawn, usize::from(is_in), "halves of {bound:?} at {x} {y}");
                }
                assert_eq!(found, [usize::from(is_in), usize::from(!is_in)], "{bound:?} at {x} {y}");
                area += f64::from(u8::from(is_in));
            }
            for block in [[4, 1], [4, 4]] {
                let Some(halves) = bound.halves(block) else { continue };
                for (i, k) in (0..5).flat_map(|k| (0..6).map(move |i| (i, k))) {
                    let centre = |i: u32, side: u32| f64::from(side) * (f64::from(i) + 0.5);
                    // What is drawn of which a side goes through the middle.
                    let p = DVec2::new(centre(i, block[0]) + 1e-4, centre(k, block[1]) + 3e-4);
                    let holds =
                        |t: &PictureTile| (0..2).all(|a| (t.origin[a]..t.origin[a] + t.size[a]).contains(&[i, k][a]));
                    let drawn: usize = halves.iter().filter(|(_, t)| holds(t)).map(|(half, _)| hits(half, p)).sum();
                    assert_eq!(drawn, hits(&inside, p), "texel {i} {k} of {block:?}, {bound:?}");
                    in_blocks += drawn;
                }
            }
            assert!((area - bound.area()).abs() <= 12.0, "{bound:?}: {area} pixels, {}", bound.area());
            assert!(bound.has_inside() && bound.area() > 0.0);
        }
        assert!(slanted > 5 && halved > 2 && in_blocks > 50, "{slanted} {halved} {in_blocks}");
    }

    #[test]
    fn it_has_an_area_where_its_corners_span_one() {
        let (mut with, mut without, mut seed) = (0, 0, 7_u32);
        for _ in 0..20_000 {
            let mut number = |most: u32| {
                seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                ((seed >> 16) % most) as i32
            };
            let low = [number(12), number(12), number(24), number(24) - 12];
            let one = bound(low, low.map(|least| least + number(9)));
            assert_eq!(one.has_inside(), one.area() > 0.0, "{one:?}: {}", one.area());
            *(if one.has_inside() { &mut with } else { &mut without }) += 1;
        }
        assert!(with > 2000 && without > 2000, "{with} {without}");
    }

    #[test]
    fn it_is_nothing_beside_the_picture() {
        let one = bound([3, 2, 5, -11], [15, 14, 29, 13]);
        assert_eq!(one.within(PictureTile { origin: [15, 0], size: [9, 9] }), None);
        assert_eq!(one.within(PictureTile { origin: [0, 14], size: [9, 9] }), None);
        // The corner that its slanted side leaves.
        assert_eq!(one.within(PictureTile { origin: [3, 2], size: [0, 9] }), None);
        assert!(
            bound([3, 2, 12, -11], [15, 14, 29, 13]).within(PictureTile { origin: [3, 2], size: [2, 2] }).is_none()
        );
        let part = PictureTile { origin: [2, 4], size: [40, 40] };
        let seen = one.within(part).expect("it is seen");
        assert_eq!(seen.rectangle(), PictureTile { origin: [1, 0], size: [12, 10] });
    }

    #[test]
    fn those_that_overlap_much_become_one_and_nothing_is_lost() {
        let tile =
            |x: i32, y: i32, w: i32, h: i32| bound([x, y, x + y, x - y - h], [x + w, y + h, x + w + y + h, x + w - y]);
        assert_eq!(merged(vec![tile(0, 0, 10, 10), tile(0, 1, 10, 10)]), [tile(0, 0, 10, 11)]);
        let apart = vec![tile(0, 0, 2, 2), tile(90, 90, 2, 2)];
        assert_eq!(merged(apart.clone()), apart);
        // Two halves of a square, then its other half.
        let three = vec![tile(0, 0, 4, 4), tile(4, 4, 4, 4), tile(4, 0, 4, 4), tile(0, 4, 4, 4)];
        assert_eq!(merged(three), [tile(0, 0, 8, 8)]);
    }
}
