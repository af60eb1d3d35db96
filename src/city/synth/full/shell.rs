//! Shells of solids: points in whole millimetres and faces over them, each with what it is.

use crate::city::synth::full::field::{P2, P3};

/// What a surface is: the semantic surfaces of CityJSON that are used.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Surface {
    /// Below.
    Ground,
    /// Upright.
    Wall,
    /// Above.
    Roof,
    /// A window.
    Window,
    /// A door.
    Door,
    /// The floor of a room, seen from outside the room: it faces down.
    Floor,
    /// The ceiling of a room: it faces up, out of the room.
    Ceiling,
    /// A wall of a room.
    InteriorWall,
    /// Where carriages go.
    Traffic,
    /// Beside it.
    Pavement,
    /// The surface of water.
    Water,
    /// None of these.
    Plain,
}

impl Surface {
    /// Its name in CityJSON; `None` of [`Surface::Plain`].
    pub fn name(self) -> Option<&'static str> {
        Some(match self {
            Self::Ground => "GroundSurface",
            Self::Wall => "WallSurface",
            Self::Roof => "RoofSurface",
            Self::Window => "Window",
            Self::Door => "Door",
            Self::Floor => "FloorSurface",
            Self::Ceiling => "CeilingSurface",
            Self::InteriorWall => "InteriorWallSurface",
            Self::Traffic => "TrafficArea",
            Self::Pavement => "AuxiliaryTrafficArea",
            Self::Water => "WaterSurface",
            Self::Plain => return None,
        })
    }
}

/// A face: what it is, and its rings of indices, the outer one first.
pub type Face = (Surface, Vec<Vec<u32>>);

/// A set of faces over points, closed or not.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shell {
    /// Points, millimetres.
    pub points: Vec<P3>,
    /// Faces over them.
    pub faces: Vec<Face>,
}

impl Shell {
    /// An upright prism over a footprint, counter-clockwise from above, from the height `low` to `high`, millimetres.
    pub fn prism(footprint: &[P2], low: i64, high: i64) -> Self {
        Self::prism_of(footprint, low, high, [Surface::Ground, Surface::Wall, Surface::Roof])
    }

    /// The same of other surfaces: below, at the sides, above.
    pub fn prism_of(footprint: &[P2], low: i64, high: i64, [below, side, above]: [Surface; 3]) -> Self {
        let n = footprint.len() as u32;
        let at = |z: i64| footprint.iter().map(move |[x, y]| [*x, *y, z]);
        let mut faces = vec![(below, vec![(0..n).rev().collect()])];
        faces.extend((0..n).map(|i| {
            let next = (i + 1) % n;
            (side, vec![vec![i, next, n + next, n + i]])
        }));
        faces.push((above, vec![(n..2 * n).collect()]));
        Self { points: at(low).chain(at(high)).collect(), faces }
    }

    /// Adds a triangle that looks up; others are left away.
    pub fn triangle(&mut self, surface: Surface, corners: [u32; 3]) {
        let [a, b, c] = corners.map(|i| self.points[i as usize]);
        let cross = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        if cross > 0 {
            self.faces.push((surface, vec![corners.to_vec()]));
        }
    }

    /// Adds two triangles over four corners, counter-clockwise from above, cut along the diagonal that keeps both upright.
    pub fn quad(&mut self, surface: Surface, [a, b, c, d]: [u32; 4]) {
        let at = |i: u32| self.points[i as usize];
        let turn = |a: P3, b: P3, c: P3| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        if turn(at(a), at(b), at(c)) >= 0 && turn(at(a), at(c), at(d)) >= 0 {
            self.triangle(surface, [a, b, c]);
            self.triangle(surface, [a, c, d]);
        } else {
            self.triangle(surface, [a, b, d]);
            self.triangle(surface, [b, c, d]);
        }
    }

    /// A net of rows of points, west to east, the rows south to north; `surface` says what is between columns and rows.
    pub fn net(&mut self, rows: &[Vec<P3>], surface: impl Fn(usize, usize) -> Surface) {
        let first = self.points.len() as u32;
        let across = rows[0].len() as u32;
        rows.iter().for_each(|row| self.points.extend(row));
        for j in 0..rows.len() as u32 - 1 {
            for i in 0..across - 1 {
                let at = first + j * across + i;
                self.quad(surface(i as usize, j as usize), [at, at + 1, at + across + 1, at + across]);
            }
        }
    }
}
