//! Which combinations of lenses a place can be inside of: what Best and Borst's region analyzer finds with solid geometry (Tiesel
//! §1.4), here by distances. A cell of space is inside of a lens, outside, or undecided; one with two undecided lenses is cut
//! into eight, down to a 64th of the space. So none is missed, and few are too many.

use rustc_hash::FxHashSet;

use crate::{
    geom::{Aabb, Volume, shape::Sphere},
    render::volume::LensVolume,
};

/// How often cells are cut.
const MOST_CUTS: u32 = 6;

/// The combinations, each a bitmask of `lenses` by their places in that list; ascending, and none of them first.
pub(super) fn combinations(volumes: &[LensVolume], lenses: &[u32]) -> Vec<u32> {
    let of = |lens: u32| volumes.iter().filter(move |v| v.lens == lens);
    let is_bounded = |lens: u32| of(lens).all(|v| v.region.is_bounded());
    let all: Vec<Lens> = (0..)
        .zip(lenses)
        .filter(|(_, lens)| is_bounded(**lens))
        .map(|(bit, &lens)| Lens { bit: 1 << bit, volumes: of(lens).collect() })
        .collect();
    let room = all.iter().flat_map(|lens| &lens.volumes).fold(Aabb::EMPTY, |room, v| room.union(v.bounds));
    let mut found = FxHashSet::from_iter([0]);
    if !room.is_empty() {
        search(&room, &all.iter().collect::<Vec<_>>(), 0, MOST_CUTS, &mut found);
    }
    // What has no end may be anywhere.
    for (bit, _) in (0..).zip(lenses).filter(|(_, lens)| !is_bounded(**lens)) {
        let with: Vec<u32> = found.iter().map(|mask| mask | 1 << bit).collect();
        found.extend(with);
    }
    let mut found: Vec<u32> = found.into_iter().collect();
    found.sort_unstable();
    found
}

/// Whether two volumes may have a place in common; `false` only where they have none.
pub(super) fn may_meet(a: &LensVolume, b: &LensVolume) -> bool {
    let sphere = |v: &LensVolume| match v.region.volume() {
        Some(Volume::Sphere(Sphere { center, radius })) => Some((*center, *radius)),
        _ => None,
    };
    match sphere(a).zip(sphere(b)) {
        Some(((c, r), (d, s))) => c.distance(d) <= (r + s) * (1.0 + 1e-9),
        None => a.bounds.meets(&b.bounds),
    }
}

struct Lens<'a> {
    bit: u32,
    volumes: Vec<&'a LensVolume>,
}

/// Where a cell is with regard to a lens.
#[derive(Clone, Copy, PartialEq)]
enum Side {
    Inside,
    Outside,
    Undecided,
}

impl Lens<'_> {
    fn side(&self, cell: &Aabb) -> Side {
        let of_volume = |volume: &&LensVolume| {
            if !volume.bounds.meets(cell) {
                return Side::Outside;
            }
            let Some(own) = volume.region.volume() else { return Side::Undecided };
            // And what rounds on the GPU.
            let radius = 0.5 * cell.size().length() * (1.0 + 1e-6) + 1e-3;
            match own.signed_distance(cell.center()) {
                d if d > radius => Side::Outside,
                d if d < -radius => Side::Inside,
                _ => Side::Undecided,
            }
        };
        let sides = || self.volumes.iter().map(of_volume);
        match () {
            () if sides().any(|side| side == Side::Inside) => Side::Inside,
            () if sides().all(|side| side == Side::Outside) => Side::Outside,
            () => Side::Undecided,
        }
    }
}

fn search(cell: &Aabb, lenses: &[&Lens], mut mask: u32, cuts: u32, found: &mut FxHashSet<u32>) {
    let mut undecided: Vec<&Lens> = Vec::new();
    for lens in lenses {
        match lens.side(cell) {
            Side::Inside => mask |= lens.bit,
            Side::Outside => {}
            Side::Undecided => undecided.push(lens),
        }
    }
    let possible = undecided.iter().fold(vec![mask], |masks, lens| {
        let with: Vec<u32> = masks.iter().map(|mask| mask | lens.bit).collect();
        [masks, with].concat()
    });
    if possible.iter().all(|mask| found.contains(mask)) {
        return;
    }
    if undecided.len() < 2 || cuts == 0 {
        found.extend(possible);
        return;
    }
    let middle = cell.center();
    for corner in cell.corners() {
        let part = Aabb { min: middle.min(corner), max: middle.max(corner) };
        search(&part, &undecided, mask, cuts - 1, found);
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::{
        geom::Shape,
        render::placed_region::{Leaf, PlacedRegion},
    };

    fn volumes(shapes: &[Shape]) -> Vec<LensVolume> {
        let volume = |(lens, shape): (usize, &Shape)| {
            let volume = shape.volume().expect("a volume");
            LensVolume::plain(lens as u32, PlacedRegion::One(Leaf::Volume(volume).into()))
        };
        shapes.iter().enumerate().map(volume).collect()
    }

    fn row(count: usize, apart: DVec3) -> Vec<Shape> {
        let at = |i: usize| DVec3::new(100.0, -20.0, 3.0) + i as f64 * apart;
        (0..count).map(|i| Shape::Sphere { center: at(i), radius: 10.0 }).collect()
    }

    fn of(shapes: &[Shape]) -> Vec<u32> {
        combinations(&volumes(shapes), &(0..shapes.len() as u32).collect::<Vec<_>>())
    }

    #[test]
    fn spheres_that_are_apart_or_touch_only_their_neighbours() {
        assert_eq!(of(&row(4, DVec3::X * 21.0)), [0, 1, 2, 4, 8]);
        assert_eq!(of(&row(4, DVec3::X * 15.0)), [0, 1, 2, 3, 4, 6, 8, 12]);
        assert_eq!(of(&[]), [0]);
        let nested = [10.0, 4.0].map(|radius| Shape::Sphere { center: DVec3::ZERO, radius });
        assert_eq!(of(&nested), [0, 1, 3], "the small one is nowhere alone");
    }

    #[test]
    fn no_combination_is_missed_and_few_are_too_many() {
        let turn = glam::DQuat::from_rotation_y(0.6);
        let mut mixed = row(3, DVec3::new(5.0, 2.0, 0.0));
        mixed.push(Shape::Box { center: mixed_center(), size: DVec3::new(22.0, 6.0, 9.0), rotation: turn });
        mixed.push(Shape::Cylinder { center: mixed_center(), radius: 4.0, height: 30.0, axis: DVec3::Z });
        for (shapes, most) in [(row(10, DVec3::new(1.8, 1.8, 0.0)), 120), (mixed, 32)] {
            let found = of(&shapes);
            let bodies: Vec<Volume> = shapes.iter().map(|s| s.volume().expect("a volume")).collect();
            let room = bodies.iter().fold(Aabb::EMPTY, |room, v| room.union(v.bounds()));
            let mut met = FxHashSet::default();
            for i in 0..200_000_u32 {
                // Additive recurrences: spread evenly.
                let share = [0.819_172_513, 0.671_043_607, 0.549_700_478].map(|step| (f64::from(i) * step).fract());
                let p = room.min + room.size() * DVec3::from(share);
                met.insert((0..).zip(&bodies).map(|(i, b)| u32::from(b.contains(p)) << i).sum::<u32>());
            }
            assert!(met.iter().all(|mask| found.contains(mask)), "{met:?} are not all in {found:?}");
            assert!(found.len() <= most, "{} combinations of which {} occur", found.len(), met.len());
        }
    }

    fn mixed_center() -> DVec3 {
        DVec3::new(104.0, -18.0, 5.0)
    }
}
