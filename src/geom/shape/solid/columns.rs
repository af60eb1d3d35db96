//! The faces of a solid by where they stand in plan.

use glam::{DVec2, DVec3};

use crate::geom::aabb::Aabb;

/// Columns per side, at most.
const MOST: f64 = 512.0;
/// Faces reach this part of the extent further than they are: the column of a place is computed in f32, and who asks for a
/// place asks for those beside it too, half as far away (`BESIDE` of `shape/solid.wgsl`).
const MARGIN: f64 = 1.0 / 16_384.0;

/// A grid in plan; each of its columns lists the faces that stand over or under it.
#[derive(Clone, Debug, PartialEq)]
pub struct Columns {
    low: DVec2,
    per_metre: DVec2,
    count: [u32; 2],
    /// Where the list of each column begins; one more for the end of the last.
    starts: Vec<u32>,
    faces: Vec<u32>,
}

impl Columns {
    /// About as many columns as faces.
    pub fn new(faces: &[[DVec3; 3]], bounds: &Aabb) -> Self {
        let size = bounds.size().truncate();
        let low = bounds.min.truncate();
        let side = (size.x * size.y / faces.len().max(1) as f64).sqrt().max(size.max_element() / MOST);
        let count = [size.x, size.y].map(|s| (s / side).ceil().clamp(1.0, MOST) as u32);
        let margin = MARGIN * size.max_element();
        let grown = size + 2.0 * margin;
        let low = low - margin;
        // As an f32 holds them, so that both sides find the same column.
        let low = low.as_vec2().as_dvec2();
        let per_metre = (DVec2::new(count[0].into(), count[1].into()) / grown).as_vec2().as_dvec2();
        let mut columns = Self { low, per_metre, count, starts: Vec::new(), faces: Vec::new() };
        let places: Vec<[[u32; 2]; 2]> = faces
            .iter()
            .map(|face| {
                let flat = face.map(DVec3::truncate);
                let (near, far) = (flat[0].min(flat[1]).min(flat[2]), flat[0].max(flat[1]).max(flat[2]));
                [columns.nearest(near - margin), columns.nearest(far + margin)]
            })
            .collect();
        let mut lists = vec![0_u32; (count[0] * count[1]) as usize + 1];
        let all = |[low, high]: [[u32; 2]; 2]| {
            (low[1]..=high[1]).flat_map(move |y| (low[0]..=high[0]).map(move |x| (y * count[0] + x) as usize))
        };
        for place in &places {
            all(*place).for_each(|cell| lists[cell + 1] += 1);
        }
        for i in 1..lists.len() {
            lists[i] += lists[i - 1];
        }
        columns.starts.clone_from(&lists);
        columns.faces = vec![0; lists.last().copied().unwrap_or(0) as usize];
        for (face, place) in places.iter().enumerate() {
            for cell in all(*place) {
                columns.faces[lists[cell] as usize] = face as u32;
                lists[cell] += 1;
            }
        }
        columns
    }

    fn cell(&self, p: DVec2) -> DVec2 {
        ((p - self.low) * self.per_metre).floor()
    }

    /// The column of a place, or the one nearest to it.
    fn nearest(&self, p: DVec2) -> [u32; 2] {
        let cell = self.cell(p);
        [0, 1].map(|i| cell[i].clamp(0.0, f64::from(self.count[i] - 1)) as u32)
    }

    /// The faces that may stand over a place in plan.
    pub fn at(&self, p: DVec2) -> &[u32] {
        let cell = self.cell(p);
        let is_in = (0..2).all(|i| cell[i] >= 0.0 && cell[i] < f64::from(self.count[i]));
        if !is_in {
            return &[];
        }
        let cell = (cell.y as u32 * self.count[0] + cell.x as u32) as usize;
        &self.faces[self.starts[cell] as usize..self.starts[cell + 1] as usize]
    }

    /// As `shape/solid.wgsl` reads it: the grid; where the faces of each column begin; their numbers, which are `places` there.
    pub fn words(&self, places: &[u32]) -> [Vec<[u32; 4]>; 3] {
        let bits = |v: f64| (v as f32).to_bits();
        let fours = |list: &[u32]| -> Vec<[u32; 4]> {
            list.chunks(4).map(|some| std::array::from_fn(|i| some.get(i).copied().unwrap_or(0))).collect()
        };
        let grid = vec![
            [bits(self.low.x), bits(self.low.y), bits(self.per_metre.x), bits(self.per_metre.y)],
            [self.count[0], self.count[1], 0, 0],
        ];
        let numbers: Vec<u32> = self.faces.iter().map(|face| places[*face as usize]).collect();
        [grid, fours(&self.starts), fours(&numbers)]
    }
}
