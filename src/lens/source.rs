//! Where the values of thematic colours come from: attributes of objects, of their semantic surfaces, or measures.

use crate::{
    city::{CityModel, StringId, SurfaceDetail, Value},
    lens::{
        measures::{self, Measure},
        nearest::did_you_mean,
        thematic::attribute_names,
    },
};

/// Where values come from.
#[derive(Clone, Copy, Debug)]
pub enum Source {
    /// An attribute.
    Attribute(StringId),
    /// What is measured.
    Measure(&'static Measure),
    /// An attribute of semantic surfaces, of each face its own.
    Faces(StringId),
    /// The same, of each object that of most of the area of its faces that have it.
    LargestFace(StringId),
}

/// What attributes of semantic surfaces begin with where faces have their own colours.
pub const OF_SURFACES: &str = "surface:";

impl Source {
    /// That of a name: an attribute of objects, or else a measure, or else an attribute of semantic surfaces.
    pub fn find(model: &CityModel, name: &str) -> Option<Self> {
        let attribute = |name: &str| model.strings.find(name).filter(|id| has_attribute(model, *id));
        let of_surfaces = |name: &str| model.strings.find(name).filter(|id| surfaces_have(model, *id));
        let own = attribute(name).map(Self::Attribute).or_else(|| measures::find(name).map(Self::Measure));
        let faces = || of_surfaces(name.strip_prefix(OF_SURFACES)?).map(Self::Faces);
        own.or_else(faces).or_else(|| of_surfaces(name).map(Self::LargestFace))
    }

    /// Whether faces have colours of their own.
    pub fn is_of_faces(&self) -> bool {
        match self {
            Self::Measure(measure) => measure.what.is_of_faces(),
            Self::Faces(_) => true,
            Self::Attribute(_) | Self::LargestFace(_) => false,
        }
    }

    /// The value of every object, by index, or of every face.
    pub fn all_values(&self, model: &CityModel) -> Vec<Option<Value>> {
        match self {
            Self::Attribute(id) => (0..model.objects.len() as u32).map(|o| model.attribute(o, *id)).collect(),
            Self::Measure(measure) => measure.what.values(model).into_iter().map(|n| n.map(Value::Number)).collect(),
            Self::Faces(id) => {
                model.measured_faces().iter().map(|face| model.attribute_of_surface(face.detail, *id)).collect()
            }
            Self::LargestFace(id) => largest(model, *id),
        }
    }

    /// The values of the objects of a city that are drawn, or of its faces.
    pub fn values(&self, model: &CityModel) -> Vec<Option<Value>> {
        let values = self.all_values(model);
        if self.is_of_faces() { values } else { drawn(model).map(|object| values[object as usize]).collect() }
    }
}

/// Of each object the value of a surface attribute that most of the area of its faces has; of equal areas the first by their normals.
fn largest(model: &CityModel, id: StringId) -> Vec<Option<Value>> {
    let mut found = vec![None; model.objects.len()];
    for faces in model.measured_faces().chunk_by(|a, b| a.object == b.object) {
        let mut areas: Vec<(Value, f64)> = Vec::new();
        for face in faces {
            let Some(value) = model.attribute_of_surface(face.detail, id).filter(|v| *v != Value::Null) else {
                continue;
            };
            match areas.iter_mut().find(|(known, _)| *known == value) {
                Some((_, area)) => *area += face.area,
                None => areas.push((value, face.area)),
            }
        }
        let most = areas.iter().map(|(_, area)| *area).fold(0.0, f64::max);
        found[faces[0].object as usize] = areas.into_iter().find(|(_, area)| *area == most).map(|(value, _)| value);
    }
    found
}

/// Whether a semantic surface has the attribute.
fn surfaces_have(model: &CityModel, id: StringId) -> bool {
    let own = |detail: &SurfaceDetail| detail.attributes.start as usize..detail.attributes.end as usize;
    model.details.iter().any(|detail| model.attributes[own(detail)].iter().any(|a| a.name == id))
}

/// Whether an object has the attribute, or a value of it that is null.
fn has_attribute(model: &CityModel, id: StringId) -> bool {
    (0..model.objects.len() as u32).any(|object| model.attributes_of(object).iter().any(|a| a.name == id))
}

/// Whether an attribute of this name colours something: of an object, or measured.
pub fn is_known(model: &CityModel, name: &str) -> bool {
    Source::find(model, name).is_some()
}

/// What is known and similar to a name that is not, in words.
pub fn hint_for(model: &CityModel, name: &str) -> String {
    let measures = measures::MEASURES.iter().map(|measure| measure.name.to_owned());
    let mut of_surfaces: Vec<StringId> = Vec::new();
    for detail in &model.details {
        let own = &model.attributes[detail.attributes.start as usize..detail.attributes.end as usize];
        of_surfaces.extend(own.iter().map(|attribute| attribute.name));
    }
    of_surfaces.sort_unstable();
    of_surfaces.dedup();
    let of_surfaces = of_surfaces.into_iter().map(|id| format!("{OF_SURFACES}{}", model.strings.get(id)));
    let own = attribute_names(model).into_iter().map(str::to_owned);
    let all: Vec<String> = own.chain(measures).chain(of_surfaces).collect();
    did_you_mean(name, all.iter().map(String::as_str))
}

/// Objects that are drawn by default, or all where none has a geometry.
pub fn drawn(model: &CityModel) -> impl Iterator<Item = u32> {
    let shown = model.shown_objects();
    let is_any = shown.contains(&true);
    (0..model.objects.len() as u32).filter(move |object| !is_any || shown.get(*object as usize) != Some(&false))
}
