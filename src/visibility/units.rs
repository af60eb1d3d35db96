//! Units that can hide something: root city objects with their parts.

use glam::DVec3;

use crate::{
    city::CityModel,
    geom::{Aabb, bvh::Bvh},
    visibility::set::Set,
};

/// The units of a city: what is part of the same city object, by any way up or down. A member of a group stands for itself.
#[derive(Clone, Debug)]
pub struct Units {
    /// Per object, the number of its unit.
    pub of_object: Vec<u32>,
    /// Per unit, its object that is part of nothing (the first, where there are several).
    pub roots: Vec<u32>,
    /// Per unit, the box around what is shown of it and can hide something, metres; empty without any. What others stand on
    /// (terrain, water, roads, land use) hides nothing.
    pub boxes: Vec<Aabb>,
    /// Per unit, the box around all that is shown of it, metres.
    pub shown: Vec<Aabb>,
    /// Shown geometries, by unit, and where those of each unit begin.
    geometries: Vec<u32>,
    starts: Vec<u32>,
    /// Finds `boxes`.
    pub(super) tree: Bvh,
}

/// From where it is looked: L of the spec, without a direction of view, which no test asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viewer {
    /// LF, metres.
    pub eye: DVec3,
    /// The direction of the sight lines of an orthographic view, unit; `None`: they begin at the eye.
    pub along: Option<DVec3>,
}

/// A point of interest, resolved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Poi {
    /// The unit of this object.
    Object(u32),
    /// A point, metres.
    At(DVec3),
}

impl Viewer {
    /// Where sight lines to places in a box begin: the eye. Parallel ones are taken as those of an eye 2²⁰ times as far away as
    /// box and eye are from each other, so that they are parallel to a millionth.
    pub(super) fn eye_for(&self, target: &Aabb) -> DVec3 {
        match self.along {
            None => self.eye,
            Some(along) => {
                let reach = target.size().length() + target.center().distance(self.eye) + 1.0;
                target.center() - along * (reach * f64::from(1 << 20))
            }
        }
    }

    /// Where the sight line to a point begins: at the eye, or in its plane.
    pub(super) fn start_for(&self, target: DVec3) -> DVec3 {
        self.along.map_or(self.eye, |along| target - along * along.dot(target - self.eye))
    }
}

impl Units {
    /// The units of a city of which these geometries are shown.
    pub fn new(model: &CityModel, shown: &[u32]) -> Self {
        let mut lead: Vec<u32> = (0..model.objects.len() as u32).collect();
        for (object, entry) in model.objects.iter().enumerate() {
            for &parent in entry.parents.iter().filter(|&&parent| !is_group(model, parent)) {
                let (a, b) = (first(&mut lead, object as u32), first(&mut lead, parent));
                lead[a.max(b) as usize] = a.min(b);
            }
        }
        let is_top = |object: u32| model.objects[object as usize].parents.iter().all(|&parent| is_group(model, parent));
        let mut number = vec![u32::MAX; lead.len()];
        let mut units = Self {
            of_object: vec![0; lead.len()],
            roots: vec![],
            boxes: vec![],
            shown: vec![],
            geometries: vec![],
            starts: vec![],
            tree: Bvh::build(&[]),
        };
        let mut has_top = Vec::new();
        for object in 0..lead.len() as u32 {
            let leader = first(&mut lead, object) as usize;
            if number[leader] == u32::MAX {
                number[leader] = units.roots.len() as u32;
                units.roots.push(object);
                has_top.push(false);
            }
            let unit = number[leader] as usize;
            units.of_object[object as usize] = unit as u32;
            if !has_top[unit] && is_top(object) {
                (has_top[unit], units.roots[unit]) = (true, object);
            }
        }
        units.boxes = vec![Aabb::EMPTY; units.roots.len()];
        units.shown = units.boxes.clone();
        for geometry in shown.iter().map(|&g| &model.geometries[g as usize]) {
            let unit = units.of_object[geometry.object as usize] as usize;
            units.shown[unit] = units.shown[unit].union(geometry.bounds);
            if !model.objects[geometry.object as usize].class.is_ground() {
                units.boxes[unit] = units.boxes[unit].union(geometry.bounds);
            }
        }
        units.geometries = shown.to_vec();
        let unit_of = |g: u32| units.of_object[model.geometries[g as usize].object as usize];
        units.geometries.sort_by_key(|&g| unit_of(g));
        let begin = |unit: u32| units.geometries.partition_point(|&g| unit_of(g) < unit) as u32;
        units.starts = (0..=units.roots.len() as u32).map(begin).collect();
        units.tree = Bvh::build(&units.boxes);
        units
    }

    /// The number of units.
    pub fn len(&self) -> usize {
        self.roots.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.roots.is_empty()
    }

    /// The geometries that are shown of a unit.
    pub fn geometries(&self, unit: u32) -> &[u32] {
        let [start, end] = [0, 1].map(|i| self.starts[unit as usize + i] as usize);
        &self.geometries[start..end]
    }

    /// The box around a point of interest, metres; empty where nothing of it is shown, and of a place that is not finite (hard case
    /// 22): nothing lies before it.
    pub fn box_of(&self, poi: Poi) -> Aabb {
        match poi {
            Poi::At(at) if !at.is_finite() => Aabb::EMPTY,
            Poi::At(at) => Aabb { min: at, max: at },
            Poi::Object(object) => self.shown[self.of_object[object as usize] as usize],
        }
    }

    /// The unit that a point of interest is, if it is one.
    pub fn unit_of(&self, poi: Poi) -> Option<u32> {
        match poi {
            Poi::At(_) => None,
            Poi::Object(object) => Some(self.of_object[object as usize]),
        }
    }

    /// The units of which some object is flagged and can hide something; one flag per object.
    pub fn flagged(&self, model: &CityModel, flags: &[bool]) -> Set {
        let mut set = Set::new(self.len());
        let marked = flags.iter().zip(&model.objects).zip(&self.of_object);
        marked
            .filter(|((flag, object), _)| **flag && !object.class.is_ground())
            .for_each(|(_, unit)| set.insert(*unit));
        set
    }

    /// The units of which all objects that can hide something are flagged; one flag per object.
    pub fn all_flagged(&self, model: &CityModel, flags: &[bool]) -> Set {
        let left = flags.iter().zip(&model.objects).zip(&self.of_object);
        let mut has_left = vec![false; self.len()];
        left.filter(|((flag, object), _)| !**flag && !object.class.is_ground())
            .for_each(|(_, unit)| has_left[*unit as usize] = true);
        let all: Vec<bool> = has_left.into_iter().map(|has| !has).collect();
        Set::of(&all)
    }

    /// The objects of some units, one flag per object of the city; what others stand on is never among them.
    pub fn objects_of(&self, model: &CityModel, units: &Set) -> Vec<bool> {
        let each = self.of_object.iter().zip(&model.objects);
        each.map(|(&unit, object)| units.has(unit) && !object.class.is_ground()).collect()
    }
}

/// The smallest number known of what an object is joined with.
fn first(lead: &mut [u32], object: u32) -> u32 {
    let mut at = object as usize;
    while lead[at] as usize != at {
        // Shortens the way for the next.
        lead[at] = lead[lead[at] as usize];
        at = lead[at] as usize;
    }
    at as u32
}

fn is_group(model: &CityModel, object: u32) -> bool {
    model.strings.get(model.objects[object as usize].kind) == "CityObjectGroup"
}
