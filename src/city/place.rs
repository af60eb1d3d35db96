//! What is at a place of a city: ground, what stands highest there, and whether an eye is in a building.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

use crate::{
    city::{
        ground::Ground,
        model::{CityModel, ObjectClass},
        spatial::{Hit, SpatialIndex},
    },
    geom::Ray,
};

/// An eye never comes lower than this above the ground by itself, metres.
pub const LEAST_ABOVE_M: f64 = 0.5;
/// Higher than anything, metres: rays down begin there.
const ABOVE_ALL_M: f64 = 1e6;
/// Directions to the sides in which an eye looks for the walls around it.
const SIDES: [DVec3; 4] = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y];
/// In so many of them there must be walls of the building whose roof is above: in an arcade there are fewer.
const MOST_OPEN: usize = 1;

/// A city in which places are asked for.
#[derive(Clone, Copy, Debug)]
pub struct Places<'a> {
    /// The city.
    pub model: &'a CityModel,
    /// Finds the triangles that are shown.
    pub index: &'a SpatialIndex,
    /// Its plain ground, where it has one.
    pub ground: Option<&'a Ground>,
}

/// What stands highest at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Top {
    /// Its height, metres.
    pub height: f64,
    /// The object, by index.
    pub object: u32,
}

impl Places<'_> {
    /// The height of the ground at a place in plan, metres: the highest of terrain, roads, water and land, else of the plain ground. `None`
    /// where there is neither.
    pub fn ground(&self, at: DVec2) -> Option<f64> {
        let of_terrain = self.highest(at, |object| self.model.objects[object as usize].class.is_ground());
        of_terrain.map(|top| top.height).or_else(|| self.ground.map(|ground| ground.height(at)))
    }

    /// What stands highest at a place in plan but for the ground; `None`: nothing does.
    pub fn top(&self, at: DVec2) -> Option<Top> {
        self.highest(at, |object| !self.model.objects[object as usize].class.is_ground())
    }

    /// Whether nothing but ground is at a place in plan and so far around it (metres), whatever the height.
    pub fn is_free(&self, at: DVec2, room_m: f64) -> bool {
        let is_open = |at: DVec2| self.top(at).is_none();
        is_open(at) && (0..8).all(|i| is_open(at + room_m * DVec2::from_angle(TAU * f64::from(i) / 8.0)))
    }

    fn highest(&self, at: DVec2, accept: impl Fn(u32) -> bool) -> Option<Top> {
        let above = ABOVE_ALL_M;
        let ray = Ray { origin: at.extend(above), direction: DVec3::NEG_Z };
        let hit = self.first(&ray, accept)?;
        Some(Top { height: above - hit.t, object: hit.object })
    }

    /// The nearest hit of a ray on the objects that `accept` takes.
    fn first(&self, ray: &Ray, accept: impl Fn(u32) -> bool) -> Option<Hit> {
        let mut first: Option<Hit> = None;
        self.index.hits(self.model, ray, f64::INFINITY, |hit| {
            if accept(hit.object) && first.is_none_or(|before| hit.t < before.t) {
                first = Some(*hit);
            }
        });
        first
    }

    /// Whether what a ray meets first is something that stands on the ground.
    pub fn shows_building(&self, ray: &Ray) -> bool {
        let first = self.first(ray, |_| true);
        first.is_some_and(|hit| !self.model.objects[hit.object as usize].class.is_ground())
    }

    /// The building (its root) that an eye is in: its roof is above, and its walls are on three sides at least.
    pub fn building_around(&self, eye: DVec3) -> Option<u32> {
        let is_building = |object: u32| self.model.objects[object as usize].class == ObjectClass::Building;
        let seen = |direction: DVec3| {
            let ray = Ray { origin: eye, direction };
            Some(self.model.root(self.first(&ray, is_building)?.object))
        };
        let above = seen(DVec3::Z)?;
        let open = SIDES.iter().filter(|side| seen(**side) != Some(above)).count();
        (open <= MOST_OPEN).then_some(above)
    }

    /// Where an eye comes that moves from one place to another by itself: not below the ground, and not into a building, where it stays
    /// before it. From where it should not be it may go anywhere.
    pub fn kept(&self, from: DVec3, to: DVec3) -> DVec3 {
        let least = |eye: DVec3| self.ground(eye.truncate()).map_or(f64::NEG_INFINITY, |ground| ground + LEAST_ABOVE_M);
        let raised = if from.z < least(from) { to } else { to.with_z(to.z.max(least(to))) };
        let is_caught = self.building_around(raised).is_some() && self.building_around(from).is_none();
        if is_caught { from } else { raised }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::city::{
        ground::plain_ground,
        test_city::{grid_of_cubes, terrain},
    };

    fn all(model: &CityModel) -> Vec<u32> {
        (0..model.geometries.len() as u32).collect()
    }

    #[test]
    fn roofs_and_ground_are_where_they_are() {
        let model = grid_of_cubes(4, 3);
        let (shown, index) = (all(&model), SpatialIndex::build(&model, &all(&model)));
        let ground = plain_ground(&model, &shown);
        let places = Places { model: &model, index: &index, ground: ground.as_ref() };
        for (number, object) in model.objects.iter().enumerate() {
            let bounds = model.geometries[object.geometries.start as usize].bounds;
            let top = places.top(bounds.center().truncate()).unwrap();
            assert_eq!(top.object as usize, number);
            assert!((top.height - bounds.max.z).abs() < 1e-6);
            assert_eq!(places.building_around(bounds.center()), Some(number as u32));
            assert_eq!(places.building_around(bounds.center().with_z(bounds.max.z + 1.0)), None);
            let beside = bounds.center() - DVec3::X * (0.5 * bounds.size().x + 2.5);
            assert_eq!(places.building_around(beside), None);
        }
        let far = model.extent().min.truncate() - 30.0;
        assert_eq!(places.top(far), None);
        assert!((places.ground(far).unwrap() - model.extent().min.z).abs() < 0.2);
        assert_eq!(Places { ground: None, ..places }.ground(far), None);
    }

    #[test]
    fn terrain_is_ground() {
        let model = terrain(6);
        let index = SpatialIndex::build(&model, &all(&model));
        let places = Places { model: &model, index: &index, ground: None };
        let tile = &model.tiles[0];
        for vertex in &model.vertices[tile.vertices.start as usize..tile.vertices.end as usize] {
            let p = tile.origin.as_dvec3() + glam::Vec3::from(vertex.position).as_dvec3();
            let inside = p.truncate().lerp(tile.bounds.center().truncate(), 1e-4);
            assert!((places.ground(inside).unwrap() - p.z).abs() < 0.1);
        }
        assert_eq!(places.top(tile.bounds.center().truncate()), None);
    }

    proptest! {
        #![proptest_config(crate::seeds::config())]

        #[test]
        fn an_eye_that_moves_by_itself_is_never_below_ground_or_in_a_building(
            steps in prop::collection::vec((-9.0..9.0, -9.0..9.0, -6.0..5.0), 1..80),
        ) {
            let model = grid_of_cubes(5, 5);
            let (shown, index) = (all(&model), SpatialIndex::build(&model, &all(&model)));
            let ground = plain_ground(&model, &shown);
            let places = Places { model: &model, index: &index, ground: ground.as_ref() };
            let mut eye = model.extent().min - DVec3::new(4.0, 4.0, -2.0);
            for (x, y, z) in steps {
                let wanted = eye + DVec3::new(x, y, z);
                let kept = places.kept(eye, wanted);
                prop_assert!(kept.z >= places.ground(kept.truncate()).unwrap() + LEAST_ABOVE_M - 1e-9);
                prop_assert_eq!(places.building_around(kept), None);
                if wanted.z > model.extent().max.z {
                    prop_assert_eq!(kept, wanted, "in the open it goes where it wants");
                }
                eye = kept;
            }
        }
    }
}
