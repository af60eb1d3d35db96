//! The vertex list, and what its numbers mean.

use glam::DVec3;

use crate::city::{
    build::{
        lattice::Lattice,
        points::{Points, Pool},
    },
    crs::{Axes, LocalFrame, UtmZone},
    json::{Json, Kind, Number, Step},
};

/// Stands for a coordinate that is none: far outside the 1e9 m of a usable one on every lattice used here.
const LOST: i64 = 1 << 62;
/// Steps below a nanometre are no lattice worth keeping, and [`LOST`] must stay far away.
const SMALLEST_STEP_M: f64 = 1e-9;

/// Vertices as read.
#[derive(Clone, Debug, PartialEq)]
pub enum Vertices {
    /// All are whole numbers: the file's own lattice.
    Integers(Points),
    /// Some are not; NaN where something else than three numbers stood.
    Reals(Vec<DVec3>),
}

impl Default for Vertices {
    fn default() -> Self {
        Self::Integers(Points::default())
    }
}

/// `transform`: metres = translate + scale × number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    /// Metres (or degrees) per unit.
    pub scale: DVec3,
    /// Metres (or degrees) at 0.
    pub translate: DVec3,
}

impl Transform {
    /// Numbers are what they say.
    pub const IDENTITY: Self = Self { scale: DVec3::ONE, translate: DVec3::ZERO };

    fn apply(&self, p: DVec3) -> DVec3 {
        self.translate + self.scale * p
    }
}

/// The way from numbers of a file to metres of the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placing {
    /// The file's transform.
    pub transform: Transform,
    /// The meaning of the transformed numbers.
    pub axes: Axes,
    /// The zone, for degrees.
    pub zone: UtmZone,
    /// The frame, for earth-centred coordinates.
    pub frame: Option<LocalFrame>,
}

impl Placing {
    /// World metres of transformed numbers.
    pub fn world(&self, p: DVec3) -> DVec3 {
        match self.axes {
            Axes::LatLon => self.zone.project(p.x, p.y, p.z),
            Axes::LonLat => self.zone.project(p.y, p.x, p.z),
            Axes::Geocentric => self.frame.map_or(p, |frame| frame.local_from_earth().transform_point3(p)),
            Axes::Metric | Axes::Feet => p,
        }
    }

    /// Whether integers can stay what they are.
    fn keeps_lattice(&self) -> bool {
        let Transform { scale, translate } = self.transform;
        !matches!(self.axes, Axes::LatLon | Axes::LonLat | Axes::Geocentric)
            && scale.is_finite()
            && translate.is_finite()
            && scale.cmpge(DVec3::splat(SMALLEST_STEP_M)).all()
    }
}

impl Vertices {
    /// Reads the value of `vertices`; what was read before a damage stays.
    pub fn read(&mut self, json: &mut Json<'_>) -> Step<()> {
        if json.peek()? != Kind::Array {
            return json.skip();
        }
        json.array(|json| {
            let vertex = read_vertex(json)?;
            self.push(vertex);
            Ok(())
        })
    }

    /// The number of vertices.
    pub fn len(&self) -> usize {
        match self {
            Self::Integers(list) => list.len(),
            Self::Reals(list) => list.len(),
        }
    }

    fn push(&mut self, vertex: [Number; 3]) {
        match self {
            Self::Integers(list) => match lattice_point(vertex) {
                Some(point) => list.push(point),
                None => {
                    let mut reals: Vec<DVec3> = list.iter().map(to_real).collect();
                    reals.push(real_point(vertex));
                    *self = Self::Reals(reals);
                }
            },
            Self::Reals(list) => list.push(real_point(vertex)),
        }
    }

    /// One vertex, transformed, not yet placed; NaN where it is none.
    pub fn transformed(&self, index: u32, transform: &Transform) -> DVec3 {
        let number = match self {
            Self::Integers(list) => list.get(index).map(to_real),
            Self::Reals(list) => list.get(index as usize).copied(),
        };
        transform.apply(number.unwrap_or(DVec3::NAN))
    }

    /// The pool that polygons index into.
    pub fn into_pool(self, placing: &Placing) -> Pool {
        let reals = match self {
            Self::Integers(mut points) if placing.keeps_lattice() => {
                points.shrink_to_fit();
                let Transform { scale, translate } = placing.transform;
                return Pool { lattice: Lattice { step: scale, origin: translate }, points };
            }
            Self::Integers(points) => points.iter().map(to_real).collect::<Vec<_>>(),
            Self::Reals(reals) => reals,
        };
        let points = reals.into_iter().map(|p| fine_point(placing.world(placing.transform.apply(p)))).collect();
        Pool { lattice: Lattice::FINE, points }
    }
}

/// The point of [`Lattice::FINE`] nearest to world metres; [`LOST`] for NaN.
pub fn fine_point(world: DVec3) -> [i64; 3] {
    Lattice::FINE.nearest(world).unwrap_or([LOST; 3])
}

/// Three numbers; NaN in all where it is anything else. More than three: the first three.
fn read_vertex(json: &mut Json<'_>) -> Step<[Number; 3]> {
    const NOTHING: [Number; 3] = [Number::Real(f64::NAN); 3];
    let mut vertex = NOTHING;
    let mut count = 0;
    if json.peek()? != Kind::Array {
        json.skip()?;
        return Ok(NOTHING);
    }
    json.array(|json| {
        let number = match json.peek()? {
            Kind::Number => json.number()?,
            _ => {
                json.skip()?;
                Number::Real(f64::NAN)
            }
        };
        if let Some(slot) = vertex.get_mut(count) {
            *slot = number;
        }
        count += 1;
        Ok(())
    })?;
    Ok(if count < 3 { NOTHING } else { vertex })
}

fn lattice_point(vertex: [Number; 3]) -> Option<[i64; 3]> {
    let mut point = [0; 3];
    for (p, number) in point.iter_mut().zip(vertex) {
        *p = match number {
            // What writers leave where a coordinate overflowed 32 bits.
            Number::Integer(i) if i == i64::from(i32::MIN) => return Some([LOST; 3]),
            Number::Integer(i) if i.unsigned_abs() < LOST as u64 => i,
            Number::Real(r) if r.fract() == 0.0 && r.abs() < 9e15 => r as i64,
            _ => return None,
        };
    }
    Some(point)
}

fn real_point(vertex: [Number; 3]) -> DVec3 {
    match lattice_point(vertex) {
        Some([LOST, ..]) => DVec3::NAN,
        _ => DVec3::from_array(vertex.map(Number::as_f64)),
    }
}

fn to_real(p: [i64; 3]) -> DVec3 {
    if p[0] == LOST { DVec3::NAN } else { DVec3::new(p[0] as f64, p[1] as f64, p[2] as f64) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MILLIMETRES: Placing = Placing {
        transform: Transform { scale: DVec3::splat(0.001), translate: DVec3::new(85_000.0, 446_000.0, 0.0) },
        axes: Axes::Metric,
        zone: UtmZone { number: 31, is_south: false },
        frame: None,
    };

    fn pool(text: &str, placing: &Placing) -> Pool {
        let mut vertices = Vertices::default();
        vertices.read(&mut Json::new(text.as_bytes())).unwrap();
        vertices.into_pool(placing)
    }

    #[test]
    fn integers_stay_the_integers_of_the_file() {
        let pool = pool("[[1,-2,3],[4.0,5,6]]", &MILLIMETRES);
        assert_eq!(pool.points, Points::from(vec![[1, -2, 3], [4, 5, 6]]));
        assert_eq!(pool.lattice.step, DVec3::splat(0.001));
        assert_eq!(pool.lattice.origin, MILLIMETRES.transform.translate);
    }

    #[test]
    fn one_real_puts_all_on_the_fine_lattice() {
        let pool = pool("[[1,2,3],[4.5,5,6],null,[1,2]]", &MILLIMETRES);
        assert_eq!(pool.lattice, Lattice::FINE);
        let at = |i: u32| pool.lattice.to_world(pool.points.get(i).unwrap());
        assert!((at(0) - DVec3::new(85_000.001, 446_000.002, 0.003)).abs().max_element() < 1e-6);
        assert!((at(1) - DVec3::new(85_000.004_5, 446_000.005, 0.006)).abs().max_element() < 1e-6);
        for i in [2, 3] {
            assert!(at(i).abs().max_element() > 1e9, "what is no vertex must be far away");
        }
    }

    #[test]
    fn overflowed_coordinates_are_no_coordinates() {
        let placing = Placing { transform: Transform::IDENTITY, ..MILLIMETRES };
        let pool = pool("[[0,0,-2147483648],[0,0,9223372036854775807],[0,0,1]]", &placing);
        for (i, is_lost) in [(0, true), (1, true), (2, false)] {
            assert_eq!(pool.lattice.to_world(pool.points.get(i).unwrap()).abs().max_element() > 1e9, is_lost);
        }
    }

    #[test]
    fn degrees_become_metres() {
        let placing =
            Placing { transform: Transform::IDENTITY, axes: Axes::LatLon, zone: UtmZone::at(48.9, 2.3), frame: None };
        let pool = pool("[[48.8582, 2.2945, 35.5]]", &placing);
        let at = pool.lattice.to_world(pool.points.get(0).unwrap());
        assert!((at - DVec3::new(448_252.0, 5_411_933.0, 35.5)).abs().max_element() < 1.0, "{at}");
    }
}
