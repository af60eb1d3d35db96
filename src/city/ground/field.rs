//! Heights of the plain ground on a square grid: what is known of them, and smooth ones between.

use glam::{DVec2, DVec3};

/// Grid points along a side are at most a power of two and one: about 66,000 in all.
const MOST_CELLS: usize = 256;
const LEAST_CELLS: usize = 8;
/// No grid is finer, metres.
const LEAST_STEP_M: f64 = 2.0;
/// What stands so much higher than something beside it stands on something else than the ground, metres.
const MOST_RISE_M: f64 = 2.5;
/// Rounds of relaxation; heights start smooth.
const ROUNDS: usize = 30;
/// Cells that are looked at, for all triangles together; of triangles beyond that only the first cell.
const MOST_LOOKS: usize = 200_000_000;

/// Heights on a square grid.
#[derive(Clone, Debug, PartialEq)]
pub struct HeightField {
    /// The grid's middle, metres.
    pub middle: DVec2,
    /// Metres between points.
    pub step: f64,
    /// Cells along a side: a power of two. Points are one more.
    pub cells: usize,
    /// Row by row, metres; NaN: nothing is known.
    pub heights: Vec<f64>,
    /// Whether the height of a point is that of terrain.
    is_terrain: Vec<bool>,
    /// The lowest base at each point, metres.
    lowest: Vec<f64>,
    looks: usize,
}

impl HeightField {
    /// A field that reaches at least `half` metres from its middle each way, of which nothing is known.
    pub fn over(middle: DVec2, half: f64) -> Self {
        let cells = ((2.0 * half / LEAST_STEP_M).ceil() as usize).next_power_of_two().clamp(LEAST_CELLS, MOST_CELLS);
        let step = (2.0 * half / cells as f64).max(f64::MIN_POSITIVE);
        let count = (cells + 1) * (cells + 1);
        Self {
            middle,
            step,
            cells,
            heights: vec![f64::NAN; count],
            is_terrain: vec![false; count],
            lowest: vec![f64::INFINITY; count],
            looks: 0,
        }
    }

    /// The number of a grid point.
    pub fn index(&self, column: usize, row: usize) -> usize {
        row * (self.cells + 1) + column
    }

    /// Where a grid point is, metres.
    pub fn place(&self, column: usize, row: usize) -> DVec2 {
        self.middle + self.step * (DVec2::new(column as f64, row as f64) - 0.5 * self.cells as f64)
    }

    /// The grid points around a place; where it is beyond the grid, those of its border.
    fn around(&self, place: DVec2) -> [usize; 4] {
        let last = DVec2::splat((self.cells - 1) as f64);
        let cell = ((place - self.middle) / self.step + 0.5 * self.cells as f64).floor().clamp(DVec2::ZERO, last);
        let first = self.index(cell.x as usize, cell.y as usize);
        [first, first + 1, first + self.cells + 1, first + self.cells + 2]
    }

    /// The height at a place, metres, between the grid points around it; beyond the grid that of the nearest place.
    pub fn height(&self, place: DVec2) -> f64 {
        let last = DVec2::splat(self.cells as f64);
        let at = ((place - self.middle) / self.step + 0.5 * self.cells as f64).clamp(DVec2::ZERO, last);
        let part = at - at.floor().min(last - 1.0);
        let [a, b, c, d] = self.around(place).map(|i| self.heights[i]);
        let (low, high) = (a + part.x * (b - a), c + part.x * (d - c));
        low + part.y * (high - low)
    }

    /// Whether there is terrain in all corners of the cell of a place.
    pub fn has_terrain(&self, place: DVec2) -> bool {
        self.around(place).iter().all(|&i| self.is_terrain[i])
    }

    /// The least height around a place, metres.
    pub fn least_around(&self, place: DVec2) -> f64 {
        self.around(place).iter().map(|&i| self.heights[i]).fold(f64::INFINITY, f64::min)
    }

    /// The ground lies `below` metres below a triangle of terrain, at the corners of all cells that it touches: no higher than its lowest
    /// point in the cell.
    pub fn lies_below(&mut self, triangle: &[DVec3; 3], below: f64) {
        let [a, b, c] = *triangle;
        let normal = (b - a).cross(c - a);
        let lowest = a.z.min(b.z).min(c.z);
        let highest = a.z.max(b.z).max(c.z);
        let slope = -normal.truncate() / normal.z;
        let is_steep = !slope.is_finite() || slope.abs().max_element() > 1e3;
        let reach = 0.5 * self.step * (slope.x.abs() + slope.y.abs());
        self.each_cell(triangle, |field, corners, middle| {
            let at_middle = a.z + slope.dot(middle - a.truncate());
            let height = if is_steep { lowest } else { (at_middle - reach).clamp(lowest, highest) } - below;
            for i in corners {
                // Not what buildings said, nor what is not known.
                let before = if field.is_terrain[i] { field.heights[i] } else { f64::INFINITY };
                field.heights[i] = before.min(height);
                field.is_terrain[i] = true;
            }
        });
    }

    /// The ground reaches up to what stands on it with this triangle, at the corners of all cells that it touches. What is told later must
    /// not be lower.
    pub fn reaches(&mut self, triangle: &[DVec3; 3], height: f64) {
        self.each_cell(triangle, |field, corners, _| {
            for i in corners.into_iter().filter(|&i| !field.is_terrain[i]) {
                field.lowest[i] = field.lowest[i].min(height);
                if height <= field.lowest[i] + MOST_RISE_M {
                    field.heights[i] = height;
                }
            }
        });
    }

    /// Calls with the corners and the middle of each cell that a triangle touches, seen from above; where it is beyond the grid,
    /// with none.
    fn each_cell(&mut self, triangle: &[DVec3; 3], mut call: impl FnMut(&mut Self, [usize; 4], DVec2)) {
        let corners = triangle.map(|p| (p.truncate() - self.middle) / self.step + 0.5 * self.cells as f64);
        let last = DVec2::splat((self.cells - 1) as f64);
        let low = corners[0].min(corners[1]).min(corners[2]).floor().clamp(DVec2::ZERO, last);
        let mut high = corners[0].max(corners[1]).max(corners[2]).floor().clamp(DVec2::ZERO, last);
        let turned = (corners[1] - corners[0]).perp_dot(corners[2] - corners[0]) < 0.0;
        let [a, b, c] = if turned { [corners[0], corners[2], corners[1]] } else { corners };
        let sides = [(a, b), (b, c), (c, a)].map(|(from, to)| {
            // Outwards, of a triangle that is counter-clockwise.
            let normal = -(to - from).perp();
            (normal, normal.dot(from) + 0.5 * (normal.x.abs() + normal.y.abs()))
        });
        if self.looks > MOST_LOOKS {
            high = low;
        }
        for row in low.y as usize..=high.y as usize {
            for column in low.x as usize..=high.x as usize {
                self.looks += 1;
                let middle = DVec2::new(column as f64 + 0.5, row as f64 + 0.5);
                if sides.iter().any(|(normal, most)| normal.dot(middle) > *most) {
                    continue;
                }
                let first = self.index(column, row);
                let above = first + self.cells + 1;
                let place = self.middle + self.step * (middle - 0.5 * self.cells as f64);
                call(self, [first, first + 1, above, above + 1], place);
            }
        }
    }

    /// Gives all other points smooth heights: by a pyramid of weighted means (Gortler and others 1996, "The Lumigraph", section 3.4), then
    /// by Laplace's equation; at the border there is no slope.
    pub fn fill(&mut self) {
        let fixed: Vec<bool> = self.heights.iter().map(|height| height.is_finite()).collect();
        if !fixed.contains(&true) {
            self.heights.fill(0.0);
            return;
        }
        let weights: Vec<f64> = fixed.iter().map(|&is| f64::from(u8::from(is))).collect();
        let known: Vec<f64> = self.heights.iter().map(|h| if h.is_finite() { *h } else { 0.0 }).collect();
        self.heights = filled(known, weights, self.cells);
        for _ in 0..ROUNDS {
            for i in (0..self.heights.len()).filter(|&i| !fixed[i]) {
                let (sum, count) =
                    self.neighbours(i).fold((0.0, 0.0), |(sum, count), j| (sum + self.heights[j], count + 1.0));
                self.heights[i] = sum / count;
            }
        }
    }

    fn neighbours(&self, i: usize) -> impl Iterator<Item = usize> + use<> {
        let side = self.cells + 1;
        let (row, column) = (i / side, i % side);
        [
            (column > 0).then(|| i - 1),
            (column + 1 < side).then_some(i + 1),
            (row > 0).then(|| i - side),
            (row + 1 < side).then_some(i + side),
        ]
        .into_iter()
        .flatten()
    }
}

/// Heights of a grid of so many cells a side (a power of two), where those of weight 1 are known and stay, those of weight 0 are not.
fn filled(known: Vec<f64>, weights: Vec<f64>, cells: usize) -> Vec<f64> {
    if cells == 1 || weights.iter().all(|weight| *weight >= 1.0) {
        let sum: f64 = weights.iter().sum();
        let mean = known.iter().zip(&weights).map(|(height, weight)| height * weight).sum::<f64>() / sum;
        return known.iter().zip(&weights).map(|(height, weight)| mean + weight * (height - mean)).collect();
    }
    let (side, half) = (cells + 1, cells / 2);
    let coarse_side = half + 1;
    let (mut sums, mut of_coarse) = (vec![0.0; coarse_side * coarse_side], vec![0.0; coarse_side * coarse_side]);
    for row in 0..coarse_side {
        for column in 0..coarse_side {
            let (mut sum, mut weight) = (0.0, 0.0);
            for (i, share) in around(2 * column, 2 * row, side) {
                sum += share * weights[i] * known[i];
                weight += share * weights[i];
            }
            let i = row * coarse_side + column;
            sums[i] = if weight > 0.0 { sum / weight } else { 0.0 };
            of_coarse[i] = weight.min(1.0);
        }
    }
    let coarse = filled(sums, of_coarse, half);
    let between = |column: usize, row: usize| {
        let [x, y] = [column, row].map(|k| [k / 2, k.div_ceil(2)]);
        let at = |x: usize, y: usize| coarse[y * coarse_side + x];
        0.25 * (at(x[0], y[0]) + at(x[1], y[0]) + at(x[0], y[1]) + at(x[1], y[1]))
    };
    let height = |i: usize| {
        let beside = between(i % side, i / side);
        beside + weights[i] * (known[i] - beside)
    };
    (0..known.len()).map(height).collect()
}

/// A point of a grid and those around it, with their shares: half, quarter, eighth.
fn around(column: usize, row: usize, side: usize) -> impl Iterator<Item = (usize, f64)> {
    const OFFSETS: [isize; 3] = [-1, 0, 1];
    OFFSETS.into_iter().flat_map(move |y| {
        OFFSETS.into_iter().filter_map(move |x| {
            let (column, row) = (column.checked_add_signed(x)?, row.checked_add_signed(y)?);
            let share = 0.5 / (1 << (x.abs() + y.abs())) as f64;
            (column < side && row < side).then_some((row * side + column, share))
        })
    })
}
