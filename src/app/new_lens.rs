//! Lenses as they are put into a scene: what a person means who asks for one, in the words of scene files.

use glam::{DVec2, DVec3};

use crate::{
    app::document::Document,
    city::change::{ATTRIBUTE, Between},
    scene::{PiecePlace, PoiPlace, Scene},
    time::{Moment, Span},
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
    /// Shows what became of its objects from one time to another.
    Change,
    /// Draws what hides an object as x-ray.
    Occlusion,
    /// Moves what is in it.
    Deformation,
    /// Presses down what hides an object.
    Lower,
    /// Shows larger what lies behind its plane.
    Magnifier,
    /// Shows an object larger, in its own outline.
    Feature,
    /// Shows its middle larger, without a plane.
    Sampling,
    /// Shows more directions than the picture.
    Fisheye,
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
    /// Where that is in the picture: shares of its width and height.
    pub share: DVec2,
    /// Its size, metres.
    pub radius: f64,
    /// The object it is about, by id.
    pub object: Option<String>,
}

impl NewLens {
    /// Whether it is about an object.
    pub fn needs_object(self) -> bool {
        self.has_poi() || self == Self::Feature
    }

    /// Whether the object becomes a point of interest.
    fn has_poi(self) -> bool {
        matches!(self, Self::Occlusion | Self::Lower | Self::BestView | Self::Annotation)
    }

    fn stem(self) -> &'static str {
        match self {
            Self::Color => "colour",
            Self::XRay => "x-ray",
            Self::Eraser => "eraser",
            Self::Content => "flat",
            Self::Time => "time",
            Self::Change => "change",
            Self::Occlusion => "revealed",
            Self::Deformation => "raised",
            Self::Lower => "lowered",
            Self::Magnifier => "magnifier",
            Self::Feature => "larger",
            Self::Sampling => "sampling",
            Self::Fisheye => "fisheye",
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
        let about = spot.object.as_ref().filter(|_| self.has_poi());
        let poi = about.map(|id| poi_of(&mut draft, id)).transpose()?.unwrap_or_default();
        let (DVec3 { x, y, z }, r) = (spot.at, spot.radius);
        let shape = format!("shape = {{ kind = \"sphere\", center = [{x:.2}, {y:.2}, {z:.2}], radius = {r:.1} }}");
        let upright = format!(
            "shape = {{ kind = \"cylinder\", center = [{x:.2}, {y:.2}, {z:.2}], radius = {r:.1}, height = {:.1} }}",
            2.0 * r
        );
        let poi = quoted(&poi);
        let [sx, sy] = spot.share.to_array().map(|share| (share.clamp(0.0, 1.0) * 1e4).round() / 1e4);
        let what = match self {
            Self::Color => format!("kind = \"color\", {shape}, effects = [\"sepia\"]"),
            Self::XRay => format!("kind = \"color\", {shape}, effects = [\"x-ray\"]"),
            Self::Eraser => format!("kind = \"color\", {shape}, effects = [\"eraser\"]"),
            Self::Content => format!("kind = \"content\", {shape}, content = {{ derive = \"flat\" }}"),
            Self::Time => format!("kind = \"time\", {upright}, time = {}", other_time(document.scene())),
            Self::Change => {
                let (attribute, [since, until]) = states(&mut draft)?;
                format!(
                    "kind = \"time\", {upright}, time = [{{ op = \"aggregate\", at = [{since}, {until}], show = \"any\" }}], \
                     effects = [{{ effect = \"thematic\", attribute = {attribute}, counts = true, categories = [\"added\", \"removed\", \"kept\", \"at neither\"], \
                     colors = [\"#2f9e5b\", \"#c94f3d\", \"#d9d2c5\", \"#8a9bb0\"], no_data = \"#e6e2d8\" }}]"
                )
            }
            Self::Occlusion => format!("kind = \"occlusion\", poi = {poi}, render = \"x-ray\""),
            Self::Deformation => {
                format!("kind = \"deformation\", {upright}, deform = [{{ kind = \"scale\", factors = [1, 1, 2] }}]")
            }
            Self::Lower => {
                format!("kind = \"deformation\", deform = [{{ kind = \"lower\", poi = {poi}, factor = 0.15 }}]")
            }
            Self::Magnifier => format!("kind = \"magnifier\", ray = {{ center = [{sx}, {sy}] }}"),
            Self::Feature => {
                let id = quoted(spot.object.as_deref().unwrap_or_default());
                format!("kind = \"feature\", ray = {{ of = {{ ids = [{id}] }}, magnification = 1.6 }}")
            }
            Self::Sampling => format!("kind = \"sampling\", ray = {{ center = [{sx}, {sy}] }}"),
            Self::Fisheye => format!("kind = \"fisheye\", ray = {{ center = [{sx}, {sy}], radius = 0.3 }}"),
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

/// The attribute that says what became of objects from one time to another, and these times, quoted; new ones where the scene has none: a hundred
/// years up to what it shows.
fn states(draft: &mut Document) -> Result<(String, [String; 2]), String> {
    let found = draft.scene().city.changes.iter().find_map(|change| match change.between {
        Between::Moments(times) => Some((change.attribute.clone(), times)),
        Between::Files { .. } => None,
    });
    let (attribute, times) = match found {
        Some(found) => found,
        None => {
            let changes = &draft.scene().city.changes;
            let is_free = |name: &String| changes.iter().all(|change| change.attribute != *name);
            let names = std::iter::once(ATTRIBUTE.to_owned()).chain((2..).map(|i| format!("{ATTRIBUTE} {i}")));
            let attribute = names.into_iter().find(is_free).unwrap_or_default();
            let until = draft.scene().moment.or(Moment::of_year(2000)).ok_or("no time")?;
            let times = [until.shifted(Span::of_months(-1200)), until];
            let [since, until] = times.map(|time| quoted(&time.written()));
            let (at, name) = (changes.len(), quoted(&attribute));
            draft.set(&format!("city.change.{at}={{ attribute = {name}, since = {since}, until = {until} }}"))?;
            if draft.scene().figure.legend == PiecePlace::None {
                draft.set("figure.legend=\"auto\"")?;
            }
            (attribute, times)
        }
    };
    Ok((quoted(&attribute), times.map(|time| quoted(&time.written()))))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_lens_brings_what_it_shows() {
        let mut document = Document::new(Scene::default(), None);
        document.set("time.at=\"1850-06-01\"").expect("a scene");
        let spot = Spot { at: DVec3::ZERO, share: DVec2::splat(0.5), radius: 50.0, object: None };
        assert_eq!(NewLens::Change.add(&mut document, &spot), Ok(0));
        let year = |year: i64| Moment::of_date(year, 6, 1).expect("a day");
        let changes = document.scene().city.changes.clone();
        let [change] = &changes[..] else { panic!("one change") };
        assert_eq!((&change.attribute[..], &change.between), (ATTRIBUTE, &Between::Moments([year(1750), year(1850)])));
        assert_eq!(document.scene().figure.legend, PiecePlace::Auto);
        // Another is of the same times.
        document.set("time.at=\"1600\"").expect("a scene");
        assert_eq!(NewLens::Change.add(&mut document, &spot), Ok(1));
        assert_eq!(document.scene().city.changes, changes);
        let [first, second] = &document.scene().lenses[..] else { panic!("two lenses") };
        assert_eq!((&first.time, &first.effects), (&second.time, &second.effects));
        assert!(first.name == "change" && second.name == "change 2");
        assert!((0..3).all(|_| document.undo().is_some()));
        assert!(document.scene().city.changes.is_empty() && document.scene().lenses.is_empty());
    }

    #[test]
    fn lenses_that_bend_rays_stand_where_they_are_put_or_on_the_object() {
        let mut document = Document::new(Scene::default(), None);
        let spot = Spot { at: DVec3::ZERO, share: DVec2::new(0.25, 0.75), radius: 50.0, object: None };
        assert!(NewLens::Feature.add(&mut document, &spot).is_err());
        for (index, kind) in [NewLens::Magnifier, NewLens::Sampling, NewLens::Fisheye].into_iter().enumerate() {
            assert_eq!(kind.add(&mut document, &spot), Ok(index));
            let ray = document.scene().lenses[index].ray().expect("a lens that bends rays");
            assert_eq!(ray.center, spot.share);
        }
        let spot = Spot { object: Some("house".into()), ..spot };
        assert_eq!(NewLens::Feature.add(&mut document, &spot), Ok(3));
        let lens = &document.scene().lenses[3];
        let feature = lens.ray().and_then(|ray| ray.bend.feature()).expect("a feature lens");
        assert_eq!((&feature.of.ids[..], lens.name.as_str()), (&["house".to_owned()][..], "larger"));
        assert!(document.scene().pois.is_empty(), "it needs no point of interest");
    }
}
