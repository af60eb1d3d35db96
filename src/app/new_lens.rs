//! Lenses as they are put into a scene: what a person means who asks for one, in the words of scene files.

use glam::DVec3;

use crate::{
    app::document::Document,
    scene::{PoiPlace, Scene},
};

/// Kinds of new lenses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NewLens {
    /// Restyles what is in it.
    Color,
    /// Lets what is in it shine through.
    XRay,
    /// Takes what is in it away.
    Eraser,
    /// Shows the city pressed flat in it.
    Content,
    /// Shows another moment in it.
    Time,
    /// Draws what hides an object as x-ray.
    Occlusion,
    /// Moves what is in it.
    Deformation,
    /// Presses down what hides an object.
    Lower,
    /// A picture of an object.
    BestView,
    /// A text about an object.
    Annotation,
    /// A map.
    Map,
}

/// Where a new lens is put.
#[derive(Clone, Debug)]
pub struct Spot {
    /// Its middle, on the ground or on what was picked, metres.
    pub at: DVec3,
    /// Its size, metres.
    pub radius: f64,
    /// The object it is about, by id.
    pub object: Option<String>,
}

impl NewLens {
    /// Whether it is about an object.
    pub fn needs_object(self) -> bool {
        matches!(self, Self::Occlusion | Self::Lower | Self::BestView | Self::Annotation)
    }

    fn stem(self) -> &'static str {
        match self {
            Self::Color => "colour",
            Self::XRay => "x-ray",
            Self::Eraser => "eraser",
            Self::Content => "flat",
            Self::Time => "time",
            Self::Occlusion => "revealed",
            Self::Deformation => "raised",
            Self::Lower => "lowered",
            Self::BestView => "view",
            Self::Annotation => "note",
            Self::Map => "map",
        }
    }

    /// Puts one on top of a scene; its place among the lenses.
    ///
    /// # Errors
    /// It is about an object, and none is chosen.
    pub fn add(self, document: &mut Document, spot: &Spot) -> Result<usize, String> {
        if self.needs_object() && spot.object.is_none() {
            return Err("Choose an object first: click on it, or find it by its id.".to_owned());
        }
        let index = document.scene().lenses.len();
        let name = free_name(document.scene(), self.stem());
        let mut draft = Document::new(document.scene().clone(), document.file().map(Into::into));
        let poi = spot.object.as_ref().map(|id| poi_of(&mut draft, id)).transpose()?.unwrap_or_default();
        let (DVec3 { x, y, z }, r) = (spot.at, spot.radius);
        let shape = format!("shape = {{ kind = \"sphere\", center = [{x:.2}, {y:.2}, {z:.2}], radius = {r:.1} }}");
        let upright = format!(
            "shape = {{ kind = \"cylinder\", center = [{x:.2}, {y:.2}, {z:.2}], radius = {r:.1}, height = {:.1} }}",
            2.0 * r
        );
        let poi = quoted(&poi);
        let what = match self {
            Self::Color => format!("kind = \"color\", {shape}, effects = [\"sepia\"]"),
            Self::XRay => format!("kind = \"color\", {shape}, effects = [\"x-ray\"]"),
            Self::Eraser => format!("kind = \"color\", {shape}, effects = [\"eraser\"]"),
            Self::Content => format!("kind = \"content\", {shape}, content = {{ derive = \"flat\" }}"),
            Self::Time => format!("kind = \"time\", {upright}, time = {}", other_time(document.scene())),
            Self::Occlusion => format!("kind = \"occlusion\", poi = {poi}, render = \"x-ray\""),
            Self::Deformation => {
                format!("kind = \"deformation\", {upright}, deform = [{{ kind = \"scale\", factors = [1, 1, 2] }}]")
            }
            Self::Lower => {
                format!("kind = \"deformation\", deform = [{{ kind = \"lower\", poi = {poi}, factor = 0.15 }}]")
            }
            Self::BestView => format!("kind = \"best-view\", poi = {poi}"),
            Self::Annotation => format!("kind = \"annotation\", poi = {poi}, text = \"{{name}}\""),
            Self::Map => "kind = \"map-view\"".to_owned(),
        };
        draft.set(&format!("lens.{index}={{ name = {}, {what} }}", quoted(&name)))?;
        let after = draft.scene().clone();
        document.edit(format!("add lens {name}"), |scene| *scene = after);
        Ok(index)
    }
}

/// Time operators for a new lens: fifty years before what the scene shows; where it shows all times, 1900.
fn other_time(scene: &Scene) -> &'static str {
    match scene.moment {
        Some(_) => "[{ op = \"shift\", by = \"-50 years\" }]",
        None => "[{ op = \"set\", at = \"1900\" }]",
    }
}

/// The name of the point of interest that an object is; a new one where there is none.
fn poi_of(draft: &mut Document, id: &str) -> Result<String, String> {
    let is_it = |place: &PoiPlace| matches!(place, PoiPlace::Object(own) if own == id);
    if let Some(poi) = draft.scene().pois.iter().find(|poi| is_it(&poi.place)) {
        return Ok(poi.name.clone());
    }
    let index = draft.scene().pois.len();
    let mut name = id.to_owned();
    let mut number = 2;
    while draft.scene().pois.iter().any(|poi| poi.name == name) {
        name = format!("{id} {number}");
        number += 1;
    }
    draft.set(&format!("poi.{index}={{ name = {}, object = {} }}", quoted(&name), quoted(id)))?;
    Ok(name)
}

/// A name that no lens has: the stem, or the stem and a number.
pub fn free_name(scene: &Scene, stem: &str) -> String {
    let is_free = |name: &String| scene.lenses.iter().all(|lens| lens.name != *name);
    let numbered = (2..).map(|number| format!("{stem} {number}"));
    std::iter::once(stem.to_owned()).chain(numbered).find(is_free).unwrap_or_default()
}

/// A text as TOML has it.
pub fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}
