//! City objects of other heights: what deformation lenses multiply them with, before anything else moves them.

use glam::DVec3;

use crate::{geom::Aabb, lens::solids::ShownCity};

/// What the height of an object is multiplied with, and the height that stays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Height {
    /// > 0.
    pub factor: f64,
    /// The lowest of the object and of all that belongs to it, metres.
    pub base_m: f64,
}

impl Height {
    /// Where a place of the object is.
    pub fn place(&self, place: DVec3) -> DVec3 {
        DVec3::new(place.x, place.y, self.base_m + self.factor * (place.z - self.base_m))
    }

    /// What a normal becomes, of unit length.
    pub fn normal(&self, normal: DVec3) -> DVec3 {
        (normal * DVec3::new(self.factor, self.factor, 1.0)).normalize_or(DVec3::Z)
    }
}

/// Heights of the objects of a city that are changed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Heights {
    /// One per object; none: no object is changed.
    of: Vec<Option<Height>>,
    /// Around those that are, at rest and as they are shown.
    bounds: Option<Aabb>,
}

impl Heights {
    /// Whether all stays as it is.
    pub fn is_empty(&self) -> bool {
        self.bounds.is_none()
    }

    /// What an object's height becomes; `None`: it stays.
    pub fn of(&self, object: u32) -> Option<&Height> {
        self.of.get(object as usize)?.as_ref()
    }

    /// Where a place of an object is.
    pub fn place(&self, object: u32, place: DVec3) -> DVec3 {
        self.of(object).map_or(place, |height| height.place(place))
    }

    /// Whether what is changed may have something of a box.
    pub fn reaches(&self, bounds: &Aabb) -> bool {
        self.bounds.is_some_and(|own| own.meets(bounds))
    }

    /// A box around all that a box of the city becomes.
    pub fn changed_bounds(&self, bounds: &Aabb) -> Aabb {
        self.bounds.map_or(*bounds, |own| bounds.union(own))
    }

    /// Multiplies the heights of objects with these factors, as far as `strength` says.
    pub(super) fn multiply(&mut self, city: ShownCity, factors: &[f64], strength: f64) {
        let model = city.model;
        let roots = model.roots();
        for &geometry in city.geometries {
            let bounds = model.geometries[geometry as usize].bounds;
            let object = model.geometries[geometry as usize].object;
            let factor = 1.0 + strength * (factors.get(object as usize).copied().unwrap_or(1.0) - 1.0);
            if factor == 1.0 || model.objects[object as usize].class.is_ground() || bounds.is_empty() {
                continue;
            }
            self.of.resize(model.objects.len(), None);
            let base_m = model.family_bounds(roots[object as usize]).min.z;
            let own = self.of[object as usize].get_or_insert(Height { factor: 1.0, base_m });
            own.factor *= factor;
            let shown = Aabb { min: own.place(bounds.min), max: own.place(bounds.max) };
            self.bounds = Some(self.bounds.unwrap_or(Aabb::EMPTY).union(bounds).union(shown));
        }
    }
}
