//! Houses: closed, outward-facing shells on whole millimetres, a table of shapes.
//!
//! A house stands in its own frame: x along the street, y away from it, front left corner at the origin.
//! Footprints run counter-clockwise from above, so that `[a, b, b', a']` is the wall above the edge from a to b.

/// The part of a house that a face is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Below.
    Ground,
    /// Upright.
    Wall,
    /// Above.
    Roof,
}

/// A face: its rings, the outer one first.
pub type Face = (Part, &'static [&'static [u8]]);

/// The shape of a house.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// A box.
    Flat,
    /// One slope, low at the street.
    Shed,
    /// Two slopes, ridge along the street.
    Gable,
    /// Four slopes.
    Hip,
    /// Four steep slopes below a flat top.
    Mansard,
    /// Two gabled wings that meet at a corner.
    Corner,
    /// A ring around a courtyard.
    Court,
    /// A box on a wider box.
    Tower,
}

use Part::{Ground, Roof, Wall};

const FLAT: &[Face] = &[
    (Ground, &[&[0, 3, 2, 1]]),
    (Wall, &[&[0, 1, 5, 4]]),
    (Wall, &[&[1, 2, 6, 5]]),
    (Wall, &[&[2, 3, 7, 6]]),
    (Wall, &[&[3, 0, 4, 7]]),
    (Roof, &[&[4, 5, 6, 7]]),
];

const GABLE: &[Face] = &[
    (Ground, &[&[0, 3, 2, 1]]),
    (Wall, &[&[0, 1, 5, 4]]),
    (Wall, &[&[1, 2, 6, 9, 5]]),
    (Wall, &[&[2, 3, 7, 6]]),
    (Wall, &[&[3, 0, 4, 8, 7]]),
    (Roof, &[&[4, 5, 9, 8]]),
    (Roof, &[&[6, 7, 8, 9]]),
];

const HIP: &[Face] = &[
    (Ground, &[&[0, 3, 2, 1]]),
    (Wall, &[&[0, 1, 5, 4]]),
    (Wall, &[&[1, 2, 6, 5]]),
    (Wall, &[&[2, 3, 7, 6]]),
    (Wall, &[&[3, 0, 4, 7]]),
    (Roof, &[&[4, 5, 9, 8]]),
    (Roof, &[&[5, 6, 9]]),
    (Roof, &[&[6, 7, 8, 9]]),
    (Roof, &[&[7, 4, 8]]),
];

const MANSARD: &[Face] = &[
    (Ground, &[&[0, 3, 2, 1]]),
    (Wall, &[&[0, 1, 5, 4]]),
    (Wall, &[&[1, 2, 6, 5]]),
    (Wall, &[&[2, 3, 7, 6]]),
    (Wall, &[&[3, 0, 4, 7]]),
    (Roof, &[&[4, 5, 9, 8]]),
    (Roof, &[&[5, 6, 10, 9]]),
    (Roof, &[&[6, 7, 11, 10]]),
    (Roof, &[&[7, 4, 8, 11]]),
    (Roof, &[&[8, 9, 10, 11]]),
];

/// ```text
/// 5─14─4      eaves of corner i: 6 + i; ridge 12 ─ 13 ─ 14
/// │ │  │
/// │ │  3──2
/// │ 13────12
/// 0───────1
/// ```
const CORNER: &[Face] = &[
    (Ground, &[&[5, 4, 3, 2, 1, 0]]),
    (Wall, &[&[0, 1, 7, 6]]),
    (Wall, &[&[1, 2, 8, 12, 7]]),
    (Wall, &[&[2, 3, 9, 8]]),
    (Wall, &[&[3, 4, 10, 9]]),
    (Wall, &[&[4, 5, 11, 14, 10]]),
    (Wall, &[&[5, 0, 6, 11]]),
    (Roof, &[&[6, 7, 12, 13]]),
    (Roof, &[&[8, 9, 13, 12]]),
    (Roof, &[&[9, 10, 14, 13]]),
    (Roof, &[&[11, 6, 13, 14]]),
];

const COURT: &[Face] = &[
    (Ground, &[&[0, 3, 2, 1], &[4, 5, 6, 7]]),
    (Wall, &[&[0, 1, 9, 8]]),
    (Wall, &[&[1, 2, 10, 9]]),
    (Wall, &[&[2, 3, 11, 10]]),
    (Wall, &[&[3, 0, 8, 11]]),
    (Wall, &[&[5, 4, 12, 13]]),
    (Wall, &[&[6, 5, 13, 14]]),
    (Wall, &[&[7, 6, 14, 15]]),
    (Wall, &[&[4, 7, 15, 12]]),
    (Roof, &[&[8, 9, 10, 11], &[12, 15, 14, 13]]),
];

const TOWER: &[Face] = &[
    (Ground, &[&[0, 3, 2, 1]]),
    (Wall, &[&[0, 1, 5, 4]]),
    (Wall, &[&[1, 2, 6, 5]]),
    (Wall, &[&[2, 3, 7, 6]]),
    (Wall, &[&[3, 0, 4, 7]]),
    (Roof, &[&[4, 5, 6, 7], &[8, 11, 10, 9]]),
    (Wall, &[&[8, 9, 13, 12]]),
    (Wall, &[&[9, 10, 14, 13]]),
    (Wall, &[&[10, 11, 15, 14]]),
    (Wall, &[&[11, 8, 12, 15]]),
    (Roof, &[&[12, 13, 14, 15]]),
];

impl Shape {
    /// The faces of its shell, over the indices of [`House::points`].
    pub fn faces(self) -> &'static [Face] {
        match self {
            Self::Flat | Self::Shed => FLAT,
            Self::Gable => GABLE,
            Self::Hip => HIP,
            Self::Mansard => MANSARD,
            Self::Corner => CORNER,
            Self::Court => COURT,
            Self::Tower => TOWER,
        }
    }
}

/// One building. All lengths in millimetres, multiples of 100.
#[derive(Clone, Debug, PartialEq)]
pub struct House {
    /// Its shape.
    pub shape: Shape,
    /// Its front left corner, seen from the street.
    pub corner: [i64; 2],
    /// Quarter turns counter-clockwise about that corner.
    pub turn: u8,
    /// Length along the street.
    pub width: i64,
    /// Length away from it.
    pub depth: i64,
    /// Height of the eaves (of the podium of a tower), above the ground.
    pub eaves: i64,
    /// The height of the ridge or top above the rest; 0 where the shape is flat.
    pub rise: i64,
    /// Width of what lies within or above the outline: wings of a corner, depth of a ring, setback of a hip or tower.
    pub inset: i64,
    /// Its use.
    pub function: &'static str,
    /// When it was built.
    pub year: i64,
}

impl House {
    /// Height of its highest point above the ground.
    pub fn height(&self) -> i64 {
        match self.shape {
            Shape::Flat | Shape::Court => self.eaves,
            _ => self.eaves + self.rise,
        }
    }

    /// The vertices of its shell, in the city's frame, millimetres.
    pub fn points(&self) -> Vec<[i64; 3]> {
        let mut points = self.local_points();
        for [x, y, _] in &mut points {
            let (dx, dy) = match self.turn % 4 {
                0 => (*x, *y),
                1 => (-*y, *x),
                2 => (-*x, -*y),
                _ => (*y, -*x),
            };
            (*x, *y) = (self.corner[0] + dx, self.corner[1] + dy);
        }
        points
    }

    fn local_points(&self) -> Vec<[i64; 3]> {
        let Self { width: w, depth: d, eaves: e, inset: i, .. } = *self;
        let top = self.eaves + self.rise;
        let rectangle = |inset: i64, z: i64| {
            [[inset, inset, z], [w - inset, inset, z], [w - inset, d - inset, z], [inset, d - inset, z]]
        };
        let outline = [rectangle(0, 0), rectangle(0, e)];
        match self.shape {
            Shape::Flat => outline.concat(),
            Shape::Shed => [rectangle(0, 0), [[0, 0, e], [w, 0, e], [w, d, top], [0, d, top]]].concat(),
            Shape::Gable => [&outline.concat()[..], &[[0, d / 2, top], [w, d / 2, top]]].concat(),
            Shape::Hip => [&outline.concat()[..], &[[i, d / 2, top], [w - i, d / 2, top]]].concat(),
            Shape::Mansard => [outline[0], outline[1], rectangle(i, top)].concat(),
            Shape::Corner => {
                let footprint = [[0, 0], [w, 0], [w, i], [i, i], [i, d], [0, d]];
                let at = |z: i64| footprint.map(|[x, y]| [x, y, z]);
                let ridge = [[w, i / 2, top], [i / 2, i / 2, top], [i / 2, d, top]];
                [&at(0)[..], &at(e)[..], &ridge[..]].concat()
            }
            Shape::Court => [rectangle(0, 0), rectangle(i, 0), rectangle(0, e), rectangle(i, e)].concat(),
            Shape::Tower => [outline[0], outline[1], rectangle(i, e), rectangle(i, top)].concat(),
        }
    }
}
