//! Which faces of a solid may be the nearest of a place: a grid whose cells list them.

use glam::DVec3;

use crate::geom::{aabb::Aabb, shape::solid::Solid, triangle::nearest_to_origin};

/// Cells of a grid, at most.
const MOST_CELLS: f64 = 262_144.0;
/// Cells for each face.
const CELLS_PER_FACE: f64 = 8.0;
/// Places are computed in f32: a cell lists what may be the nearest of places this part of its size beside it, too.
const MARGIN: f64 = 1.0 / 64.0;

/// Faces by where they may be the nearest, up to a distance from the surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Near {
    low: DVec3,
    reach: f64,
    per_metre: f64,
    count: [u32; 3],
    /// Where the list of each cell begins; one more for the end of the last.
    starts: Vec<u32>,
    faces: Vec<u32>,
}

/// A box of cells: the first, and how many along each axis.
#[derive(Clone, Copy)]
struct Block {
    first: [u32; 3],
    count: [u32; 3],
}

impl Near {
    /// For places up to `reach` metres from the surface, at least.
    pub fn new(solid: &Solid, reach: f64) -> Self {
        let bounds = solid.bounds();
        // A little more: places are computed in f32.
        let margin = reach + 1e-5 * bounds.size().max_element();
        let low = (bounds.min - margin).as_vec3().as_dvec3();
        let size = bounds.max + margin - low;
        let wanted = (CELLS_PER_FACE * solid.faces().len() as f64).clamp(1.0, MOST_CELLS);
        let side = (size.element_product() / wanted).cbrt().max(size.max_element() / 256.0);
        let per_metre = f64::from((1.0 / side) as f32);
        let count = size.to_array().map(|s| ((s * per_metre).ceil() as u32).max(1));
        let mut near = Self { low, reach, per_metre, count, starts: Vec::new(), faces: Vec::new() };
        let mut lists = vec![Vec::new(); count.iter().product::<u32>() as usize];
        let all: Vec<u32> = (0..).zip(solid.faces()).filter(|(_, f)| is_border(solid, f)).map(|(i, _)| i).collect();
        near.fill(solid, reach, &all, Block { first: [0; 3], count }, &mut lists);
        for list in lists {
            near.starts.push(near.faces.len() as u32);
            near.faces.extend(list);
        }
        near.starts.push(near.faces.len() as u32);
        near
    }

    /// Of the faces that may be the nearest of places in a block, those that may be of each of its cells: what is nearer to the
    /// middle of a box than another by its diagonal is nearer to every place in it.
    fn fill(&self, solid: &Solid, reach: f64, faces: &[u32], block: Block, lists: &mut [Vec<u32>]) {
        let at = |i: [u32; 3]| self.low + DVec3::from(i.map(f64::from)) / self.per_metre;
        let end = std::array::from_fn(|i| block.first[i] + block.count[i]);
        let (low, high) = (at(block.first), at(end));
        let middle = low.midpoint(high);
        let radius = 0.5 * low.distance(high) + MARGIN / self.per_metre;
        let distance = |face: &u32| {
            let [a, b, c] = solid.faces()[*face as usize];
            nearest_to_origin(a - middle, b - middle, c - middle).length()
        };
        let distances: Vec<f64> = faces.iter().map(distance).collect();
        let least = distances.iter().copied().fold(f64::INFINITY, f64::min);
        if least > reach + radius {
            return;
        }
        let chosen: Vec<u32> =
            faces.iter().zip(&distances).filter(|(_, d)| **d <= least + 2.0 * radius).map(|(f, _)| *f).collect();
        let Some(axis) = (0..3).filter(|i| block.count[*i] > 1).max_by_key(|i| block.count[*i]) else {
            let [x, y, z] = block.first;
            lists[((z * self.count[1] + y) * self.count[0] + x) as usize] = chosen;
            return;
        };
        let mut halves = [block; 2];
        halves[0].count[axis] = block.count[axis] / 2;
        halves[1].first[axis] += halves[0].count[axis];
        halves[1].count[axis] -= halves[0].count[axis];
        for half in halves {
            self.fill(solid, reach, &chosen, half, lists);
        }
    }

    /// The faces of which one is the nearest of a place, own coordinates; none where all are further away than the reach.
    pub fn at(&self, p: DVec3) -> &[u32] {
        let cell = ((p - self.low) * self.per_metre).floor();
        if !(0..3).all(|i| cell[i] >= 0.0 && cell[i] < f64::from(self.count[i])) {
            return &[];
        }
        let [x, y, z] = cell.to_array().map(|c| c as u32);
        let cell = ((z * self.count[1] + y) * self.count[0] + x) as usize;
        &self.faces[self.starts[cell] as usize..self.starts[cell + 1] as usize]
    }

    /// As `lib/solid-distance.wgsl` reads it: the grid, where each cell's faces begin, the numbers of the faces of all cells, the
    /// corners of all faces.
    pub fn words(&self, faces: &[[DVec3; 3]]) -> Vec<[u32; 4]> {
        let bits = |v: f64| (v as f32).to_bits();
        let fours = |list: &[u32]| -> Vec<[u32; 4]> {
            list.chunks(4).map(|some| std::array::from_fn(|i| some.get(i).copied().unwrap_or(0))).collect()
        };
        let [starts, numbers] = [fours(&self.starts), fours(&self.faces)];
        let mut words = vec![
            [bits(self.low.x), bits(self.low.y), bits(self.low.z), bits(self.per_metre)],
            [self.count[0], self.count[1], self.count[2], starts.len() as u32],
            [numbers.len() as u32, bits(self.reach), 0, 0],
        ];
        words.extend(starts);
        words.extend(numbers);
        words.extend(faces.iter().flatten().map(|p| [bits(p.x), bits(p.y), bits(p.z), 0]));
        words
    }
}

/// Whether one side of a face is outside: not where bodies touch or overlap. Asked beside its middle alone.
fn is_border(solid: &Solid, face: &[DVec3; 3]) -> bool {
    let [a, b, c] = *face;
    let beside = 1e-3_f64.max(1e-6 * solid.bounds().size().max_element());
    let Some(normal) = (b - a).cross(c - a).try_normalize() else { return true };
    let middle = (a + b + c) / 3.0;
    [beside, -beside].iter().any(|d| solid.winding(middle + d * normal) == 0)
}

/// How many metres a grid made for a reach of so many is good for: so that a border that is drawn wider makes few grids.
pub fn rounded_reach(reach: f64) -> f64 {
    if reach > 0.0 { reach.log2().ceil().exp2() } else { 0.0 }
}

/// The widest reach that is told from a solid whose border is in pixels: half the diagonal of the box around it.
pub fn widest_reach(bounds: &Aabb) -> f64 {
    0.5 * bounds.size().length()
}
