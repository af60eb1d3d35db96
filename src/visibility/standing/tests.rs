//! Places to stand in random cities, against sight lines to boxes; and one whose answer is known by thought.

use proptest::prelude::*;

use super::*;
use crate::{
    city::{
        CityModel,
        ground::{Ground, plain_ground},
        place::LEAST_ABOVE_M,
        spatial::SpatialIndex,
        test_city::{LATTICE, add_box, builder},
    },
    view::{Camera, Projection, View, navigate},
};

/// Boxes as buildings, all of which are shown.
struct Town {
    model: CityModel,
    shown: Vec<u32>,
    index: SpatialIndex,
    ground: Option<Ground>,
}

impl Town {
    /// Of boxes by their least and greatest corners, metres from the origin of the lattice.
    fn new(boxes: &[Aabb]) -> Self {
        let mut city = builder();
        for (i, one) in boxes.iter().enumerate() {
            let mm = |p: DVec3| (p * 1e3).to_array().map(|c| c.round() as i64);
            add_box(&mut city, &i.to_string(), mm(one.min), mm(one.max));
        }
        let model = city.finish();
        let shown: Vec<u32> = (0..model.geometries.len() as u32).collect();
        let index = SpatialIndex::build(&model, &shown);
        let ground = plain_ground(&model, &shown);
        Self { model, shown, index, ground }
    }

    fn places(&self) -> Places<'_> {
        Places { model: &self.model, index: &self.index, ground: self.ground.as_ref() }
    }

    fn subject(&self, object: u32) -> Subject<'_> {
        Subject::new(&self.model, &self.shown, &self.index, object).unwrap()
    }
}

/// A box that stands on the ground of the lattice's origin, metres from there.
fn block(at: [f64; 2], size: [f64; 3]) -> Aabb {
    let min = DVec3::new(at[0], at[1], 0.0);
    Aabb { min, max: min + DVec3::from(size) }
}

/// The share of the walls of one of several boxes that is seen from an eye, by sight lines to 16 × 16 places of each.
fn walls_seen(boxes: &[Aabb], object: usize, eye: DVec3) -> f64 {
    const GRID: u32 = 16;
    let own = &boxes[object];
    let (mut seen, mut all) = (0.0, 0.0);
    for (axis, other) in [(0, 1), (1, 0)] {
        let part = own.size()[other] * own.size().z / f64::from(GRID * GRID);
        for outer in [own.min[axis], own.max[axis]] {
            for i in 0..GRID * GRID {
                let share = |k: u32| (f64::from(k) + 0.5) / f64::from(GRID);
                let mut at = own.min.lerp(own.max, share(i / GRID)).with_z(own.min.z + own.size().z * share(i % GRID));
                at[axis] = outer;
                all += part;
                seen += if boxes.iter().all(|one| !is_between(one, eye, at)) { part } else { 0.0 };
            }
        }
    }
    seen / all
}

/// Whether a box is met on the way from an eye to a place, before that.
fn is_between(one: &Aabb, eye: DVec3, at: DVec3) -> bool {
    let way = at - eye;
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64 - 1e-6);
    for axis in 0..3 {
        let to = |side: f64| (side - eye[axis]) / way[axis];
        let (a, b) = (to(one.min[axis]), to(one.max[axis]));
        if way[axis] == 0.0 {
            if eye[axis] <= one.min[axis] || eye[axis] >= one.max[axis] {
                return false;
            }
            continue;
        }
        (enter, leave) = (enter.max(a.min(b)), leave.min(a.max(b)));
    }
    enter < leave
}

fn looking(standing: &Standing, field: &Field) -> View {
    let projection = Projection::Perspective { fov_y: field.fov_y };
    let camera =
        Camera { eye: standing.eye + DVec3::X, target: standing.target, up: DVec3::Z, projection, near_m: 0.01 };
    let camera = navigate::landed(&camera, standing.eye, Some(standing.target));
    View::new(camera, [(field.aspect * 720.0) as u32, 720], &Aabb::EMPTY).unwrap()
}

#[test]
fn one_stands_back_from_a_wall_or_goes_around_it() {
    // A house, and to its south a wall that is higher and three times as wide, 8 m away.
    let boxes = [block([0.0, 0.0], [12.0, 10.0, 7.0]), block([-12.0, -9.0], [36.0, 1.0, 20.0])];
    let town = Town::new(&boxes);
    let subject = town.subject(0);
    let field = Field::default();
    let before = Before { subject: &subject, places: town.places(), field };
    let from = LATTICE.origin + DVec3::new(6.0, -120.0, 60.0);
    // Right before the wall nothing is seen of the house, and behind it there is no room for all of the house in the picture.
    let close = before.standing_at((LATTICE.origin + DVec3::new(6.0, -20.0, 0.0)).truncate()).unwrap();
    assert_eq!(close.seen, 0.0);
    let standing = before.standing(from).unwrap();
    assert!(standing.seen >= ENOUGH, "{standing:?}");
    assert!((walls_seen(&boxes, 0, standing.eye - LATTICE.origin) - standing.seen).abs() < 0.03);
    // Of the places that do it is one on the side of the eye: beside the wall, not behind the house.
    let turned = (standing.eye - subject.bounds.center()).truncate().angle_to(DVec2::NEG_Y).to_degrees().abs();
    assert!((15.0..=105.0).contains(&turned), "{turned}");
}

#[test]
fn a_house_in_the_open_is_looked_at_from_where_one_comes() {
    let boxes = [block([0.0, 0.0], [9.0, 9.0, 6.0])];
    let town = Town::new(&boxes);
    let subject = town.subject(0);
    let before = Before { subject: &subject, places: town.places(), field: Field::default() };
    // From a corner two walls are seen; from before a wall a quarter of all: one goes aside until it is a third.
    for (from, most_turned) in [(DVec3::new(80.0, 80.0, 30.0), 1.0), (DVec3::new(4.5, 90.0, 30.0), 46.0)] {
        let standing = before.standing(LATTICE.origin + from).unwrap();
        let side = |at: DVec3| (at - subject.bounds.center()).truncate();
        let turned = side(standing.eye).angle_to(side(LATTICE.origin + from)).to_degrees().abs();
        assert!(turned <= most_turned && standing.seen >= ENOUGH, "{turned} {standing:?}");
        assert!(side(standing.eye).length() < 25.0, "no farther away than need be: {standing:?}");
    }
}

/// Up to nine blocks in a grid with streets of 4 to 20 m, not all of them there.
fn towns() -> impl Strategy<Value = Vec<Aabb>> {
    let one = (prop::bool::weighted(0.8), 4.0..16.0, 4.0..16.0, 3.0..40.0);
    (prop::collection::vec(one, 9), 20.0..36.0_f64).prop_map(|(all, apart)| {
        let place = |i: usize| [apart * (i % 3) as f64, apart * (i / 3) as f64];
        let block = |(i, (is_there, x, y, z)): (usize, (bool, f64, f64, f64))| {
            (is_there || i == 4).then(|| block(place(i), [x, y, z].map(|side| (side * 1e3).round() / 1e3)))
        };
        all.into_iter().enumerate().filter_map(block).collect()
    })
}

proptest! {
    #![proptest_config(crate::seeds::config())]

    #[test]
    fn all_of_it_is_in_view_and_a_third_seen_where_that_can_be(
        boxes in towns(),
        start in (-60.0..120.0, -60.0..120.0, 2.0..80.0),
        walk in prop::collection::vec((-15.0..15.0, -15.0..15.0, -15.0..10.0), 1..6),
        chosen in prop::collection::vec(any::<prop::sample::Index>(), 2),
    ) {
        let town = Town::new(&boxes);
        let places = town.places();
        let field = Field { fov_y: 50_f64.to_radians(), aspect: 1.5 };
        let mut eye = LATTICE.origin + DVec3::from(start);
        for object in chosen.iter().map(|chosen| chosen.index(boxes.len())) {
            let subject = town.subject(object as u32);
            let before = Before { subject: &subject, places, field };
            let tried = || turns().flat_map(|turn| before.eyes(eye, turn)).filter_map(|at| before.standing_at(at));
            let Some(standing) = before.standing(eye) else {
                prop_assert!(tried().next().is_none());
                continue;
            };
            let ground = places.ground(standing.eye.truncate()).unwrap();
            prop_assert!(standing.eye.z >= ground + LEAST_ABOVE_M);
            prop_assert_eq!(places.building_around(standing.eye), None);
            let at = standing.eye - LATTICE.origin;
            let is_beside = |one: &Aabb| at.cmplt(one.min).any() || at.cmpgt(one.max).any();
            prop_assert!(boxes.iter().all(is_beside));
            // In the picture, to the last corner.
            let view = looking(&standing, &field);
            for corner in boxes[object].corners() {
                let at = view.pixel(corner + LATTICE.origin).unwrap().truncate();
                let [w, h] = view.size.map(f64::from);
                prop_assert!(at.cmpge(DVec2::ZERO).all() && at.cmple(DVec2::new(w, h)).all(), "{at}");
            }
            let known = walls_seen(&boxes, object, standing.eye - LATTICE.origin);
            prop_assert!((known - standing.seen).abs() < 0.06, "{known} {}", standing.seen);
            if known < ENOUGH - 0.06 {
                let most = tried().map(|one| walls_seen(&boxes, object, one.eye - LATTICE.origin)).fold(0.0, f64::max);
                prop_assert!(known >= ENOUGH.min(most) - 0.06, "{known} of {most}");
            }
            // And on, as a person walks.
            eye = walk.iter().fold(standing.eye, |from, step| places.kept(from, from + DVec3::from(*step)));
            prop_assert!(eye.z >= places.ground(eye.truncate()).unwrap() + LEAST_ABOVE_M - 1e-9);
            prop_assert_eq!(places.building_around(eye), None);
        }
    }
}
