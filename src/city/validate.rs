//! Properties that always hold in a city model, whatever was read.

use glam::DVec3;

use crate::{
    city::model::{Attribute, CityModel, Geometry, NONE, StringId, Surface, TexelOpacity, Tile, Value},
    geom::Aabb,
};

impl CityModel {
    /// Checks every index, range and number of the model; the error names the first that is wrong.
    ///
    /// Loaders and the builder keep this for any input; the fuzzer asks after each file.
    pub fn validate(&self) -> Result<(), String> {
        self.validate_objects()?;
        self.validate_surfaces()?;
        for (i, geometry) in self.geometries.iter().enumerate() {
            self.validate_geometry(geometry).map_err(|e| format!("geometry {i}: {e}"))?;
        }
        for (i, tile) in self.tiles.iter().enumerate() {
            self.validate_tile(i as u32, tile).map_err(|e| format!("tile {i}: {e}"))?;
        }
        let per_triangle = self.planes.len() * 3 == self.indices.len();
        ensure(per_triangle, || format!("{} planes for {} indices", self.planes.len(), self.indices.len()))?;
        let cuts = &self.cut_polygons;
        let is_ordered = cuts.windows(2).all(|w| w[0].triangle < w[1].triangle);
        let is_inside = cuts.last().is_none_or(|cut| (cut.triangle as usize) < self.planes.len());
        ensure(is_ordered && is_inside, || "triangles of cut polygons".into())?;
        self.attributes.iter().try_for_each(|a| self.validate_attribute(a))
    }

    fn validate_objects(&self) -> Result<(), String> {
        let count = self.objects.len() as u32;
        let mut ids = rustc_hash::FxHashSet::default();
        for (i, object) in self.objects.iter().enumerate() {
            let at = |what: &str| format!("object {i} ({:?}): {what}", object.id);
            ensure(ids.insert(&object.id), || at("its id is taken"))?;
            ensure(self.has_string(object.kind), || at("type"))?;
            ensure(fits(&object.attributes, self.attributes.len()), || at("attributes"))?;
            ensure(fits(&object.geometries, self.geometries.len()), || at("geometries"))?;
            let own = &self.geometries[object.geometries.start as usize..object.geometries.end as usize];
            ensure(own.iter().all(|g| g.object == i as u32), || at("a geometry of another object"))?;
            let mut links = object.parents.iter().map(|p| (p, true)).chain(object.children.iter().map(|c| (c, false)));
            ensure(links.all(|(other, _)| *other < count), || at("a link past the objects"))?;
        }
        let numbered = || (0u32..).zip(&self.objects);
        let mut up: Vec<_> = numbered().flat_map(|(i, o)| o.parents.iter().map(move |p| (*p, i))).collect();
        let mut down: Vec<_> = numbered().flat_map(|(i, o)| o.children.iter().map(move |c| (i, *c))).collect();
        up.sort_unstable();
        down.sort_unstable();
        ensure(up == down, || "parents and children do not agree".into())?;
        ensure(up.windows(2).all(|w| w[0] != w[1]), || "a parent is named twice".into())?;
        self.validate_descent()
    }

    /// No object is its own ancestor: taking away objects without parents, again and again, takes all.
    fn validate_descent(&self) -> Result<(), String> {
        let mut parents: Vec<usize> = self.objects.iter().map(|o| o.parents.len()).collect();
        let mut open: Vec<usize> = (0..parents.len()).filter(|o| parents[*o] == 0).collect();
        let mut taken = 0;
        while let Some(object) = open.pop() {
            taken += 1;
            for child in &self.objects[object].children {
                let left = &mut parents[*child as usize];
                *left = left.saturating_sub(1);
                if *left == 0 {
                    open.push(*child as usize);
                }
            }
        }
        ensure(taken == self.objects.len(), || {
            format!("{} objects are their own ancestors", self.objects.len() - taken)
        })
    }

    fn validate_surfaces(&self) -> Result<(), String> {
        for (i, surface) in self.surfaces.iter().enumerate() {
            let Surface { object, material, kind, detail } = *surface;
            let right = (object as usize) < self.objects.len()
                && optional(material, self.materials.len())
                && (kind == StringId(NONE) || self.has_string(kind))
                && optional(detail, self.details.len());
            ensure(right, || format!("surface {i}: {surface:?}"))?;
        }
        for (i, detail) in self.details.iter().enumerate() {
            let right = fits(&detail.attributes, self.attributes.len()) && optional(detail.parent, self.details.len());
            ensure(right, || format!("surface detail {i}: {detail:?}"))?;
        }
        for (i, material) in self.materials.iter().enumerate() {
            let least = if let TexelOpacity::Holes(least) = &material.texels { least } else { &0.0 };
            let numbers = material.base_color.iter().chain(&material.emissive);
            let mut numbers = numbers.chain([&material.roughness, least]);
            let are_textures = material.textures().iter().all(|texture| optional(*texture, self.textures.len()));
            let right = numbers.all(|n| n.is_finite() && *n >= 0.0) && material.normal_scale.is_finite();
            ensure(right && are_textures, || format!("material {i}: {material:?}"))?;
        }
        Ok(())
    }

    fn validate_geometry(&self, geometry: &Geometry) -> Result<(), String> {
        ensure((geometry.object as usize) < self.objects.len(), || "its object".into())?;
        ensure((geometry.grid as usize) < self.steps.len(), || "its grid".into())?;
        ensure(fits(&geometry.tiles, self.tiles.len()), || "its tiles".into())?;
        let tiles = &self.tiles[geometry.tiles.start as usize..geometry.tiles.end as usize];
        let indices: u64 = tiles.iter().map(|t| u64::from(t.indices.end - t.indices.start)).sum();
        ensure(indices == 3 * u64::from(geometry.triangles), || {
            format!("{} triangles, {indices} indices in its tiles", geometry.triangles)
        })?;
        // Faces that were refused count in the bounds too; vertices are rounded to f32 around their tile's origin.
        let drawn = tiles.iter().fold(Aabb::EMPTY, |all, t| all.union(t.bounds));
        let slack = geometry.bounds.size() * f64::from(f32::EPSILON) + DVec3::splat(1e-5);
        let inside = drawn.min.cmpge(geometry.bounds.min - slack) & drawn.max.cmple(geometry.bounds.max + slack);
        ensure(inside.all(), || format!("tiles reach {drawn:?}, out of its bounds {:?}", geometry.bounds))
    }

    fn validate_tile(&self, index: u32, tile: &Tile) -> Result<(), String> {
        let geometry = self.geometries.get(tile.geometry as usize).ok_or("its geometry")?;
        ensure(geometry.tiles.contains(&index), || "its geometry does not know it".into())?;
        ensure(fits(&tile.vertices, self.vertices.len()), || "its vertices".into())?;
        ensure(fits(&tile.indices, self.indices.len()), || "its indices".into())?;
        let count = tile.vertices.end - tile.vertices.start;
        let indices = &self.indices[tile.indices.start as usize..tile.indices.end as usize];
        ensure(indices.len().is_multiple_of(3) && indices.iter().all(|i| *i < count), || {
            "an index past its vertices".into()
        })?;
        if tile.texcoords != NONE {
            let end = u64::from(tile.texcoords) + u64::from(count);
            ensure(end <= self.texcoords.len() as u64, || "its texture coordinates".into())?;
            let own = &self.texcoords[tile.texcoords as usize..end as usize];
            ensure(own.as_flattened().iter().all(|c| c.is_finite()), || "a texture coordinate is not finite".into())?;
        }
        for vertex in tile.vertices.clone() {
            let surface = self.surfaces.get(self.vertices[vertex as usize].surface as usize).ok_or("a surface")?;
            ensure(surface.object == geometry.object, || "a surface of another object".into())?;
            let at = self.position(tile, vertex);
            let inside = at.cmpge(tile.bounds.min).all() && at.cmple(tile.bounds.max).all();
            ensure(inside, || format!("a vertex at {at}, outside its bounds {:?}", tile.bounds))?;
        }
        Ok(())
    }

    fn validate_attribute(&self, attribute: &Attribute) -> Result<(), String> {
        let right = match attribute.value {
            Value::Number(n) => n.is_finite(),
            Value::String(s) | Value::Array(s) | Value::Object(s) => self.has_string(s),
            Value::Null | Value::Boolean(_) | Value::Integer(_) => true,
        };
        ensure(right && self.has_string(attribute.name), || format!("attribute {attribute:?}"))
    }

    fn has_string(&self, id: StringId) -> bool {
        (id.0 as usize) < self.strings.len()
    }
}

fn ensure(right: bool, wrong: impl FnOnce() -> String) -> Result<(), String> {
    if right { Ok(()) } else { Err(wrong()) }
}

/// Whether a range lies inside a list.
fn fits(range: &std::ops::Range<u32>, count: usize) -> bool {
    range.start <= range.end && range.end as usize <= count
}

/// Whether an index that may be [`NONE`] is one of a list.
fn optional(index: u32, count: usize) -> bool {
    index == NONE || (index as usize) < count
}
