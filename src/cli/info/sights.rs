//! Best views and landmarks as `info --json` has them.

use std::path::{Path, PathBuf};

use glam::DVec3;
use serde::Serialize;

use crate::{
    city::{CityModel, builtin},
    figure::scene_file::{self, Options},
    lens::{
        self, Lens,
        best_view::{DEFAULT_FOV, Depiction, LocalView},
        color::parse_hex,
        kind::BestViewLens,
    },
    scene::{Overlay, Poi, PoiPlace, Scene, overlay::BuiltInFrame, overlay::Frame},
    visibility::{BestView, Landmark},
};

/// Colours of context lines, told apart by people who do not see all colours (Okabe and Ito), the darker ones.
const LINE_COLORS: [&str; 10] =
    ["#d55e00", "#0072b2", "#009e73", "#882255", "#332288", "#999933", "#aa4499", "#117733", "#6b4c2a", "#44aa99"];

/// A view of an object. `eye`, `target`, `up`, `fov_deg` and `near_m` are those of a scene's camera.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ViewFacts {
    /// Best-view normal: from the middle of the object to the eye, unit.
    pub normal: [f64; 3],
    /// Where the eye is from the object, degrees clockwise from north, 0..360; straight above 0.
    pub azimuth_deg: f64,
    /// The elevation of the eye over the object's middle, degrees above the horizon.
    pub elevation_deg: f64,
    /// The eye, metres.
    pub eye: [f64; 3],
    /// The middle of the ball around the object, metres.
    pub target: [f64; 3],
    /// Up in the picture.
    pub up: [f64; 3],
    /// Vertical field of view.
    pub fov_deg: f64,
    /// Where the ball around the object begins, metres along the view axis.
    pub near_m: f64,
    /// Where it ends, metres.
    pub far_m: f64,
    /// Share of the area of its facades that is seen, 0..1.
    pub visible: f64,
    /// The share that is seen of what would be were the object alone, 0..1.
    pub unoccluded: f64,
    /// The score of the view, 0..1.
    pub score: f64,
}

impl ViewFacts {
    /// The facts about a view.
    pub fn new(view: &BestView) -> Self {
        let framing = &view.framing;
        let n = framing.normal;
        Self {
            normal: n.into(),
            azimuth_deg: to_degrees(n.x.atan2(n.y)).rem_euclid(360.0),
            elevation_deg: to_degrees(n.z.clamp(-1.0, 1.0).asin()),
            eye: to_micrometres(framing.eye),
            target: to_micrometres(framing.target),
            up: framing.up.into(),
            fov_deg: to_degrees(framing.fov_y),
            near_m: framing.near_m,
            far_m: framing.far_m,
            visible: view.seen.visible,
            unoccluded: view.seen.unoccluded,
            score: view.score,
        }
    }
}

/// Degrees without the dust of their computation: to a billionth.
fn to_degrees(radians: f64) -> f64 {
    (radians.to_degrees() * 1e9).round() / 1e9
}

/// To the micrometre, finer than which coordinates of countries are not.
fn to_micrometres(p: DVec3) -> [f64; 3] {
    p.to_array().map(|x| (x * 1e6).round() / 1e6)
}

/// An object that stands out.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LandmarkFacts {
    /// Unique id.
    pub id: String,
    /// Type as the file names it.
    #[serde(rename = "type")]
    pub kind: String,
    /// Its name, where attributes give one.
    pub name: Option<String>,
    /// Weighted sum of the terms, 0..1.
    pub score: f64,
    /// From its lowest point to its highest, metres.
    pub height_m: f64,
    /// Mean height of what is within 200 m, by footprint, metres.
    pub neighbours_m: f64,
    /// The ground that it covers, square metres.
    pub footprint_m2: f64,
    /// Whether that is the area of a convex hull: what is covered has too many crossings for an outline.
    pub footprint_is_hull: bool,
    /// The distance to the nearest object that is at least as high, metres in plan; `null`: there is none.
    pub isolation_m: Option<f64>,
    /// The terms of the score.
    pub terms: TermFacts,
}

/// The terms of a landmark's score, each 0..1.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TermFacts {
    /// Its height over that of its neighbours.
    pub height: f64,
    /// Its footprint over that of its neighbours.
    pub footprint: f64,
    /// The term of the distance to the next that is as high.
    pub isolation: f64,
    /// The term of its attributes.
    pub attributes: f64,
}

impl LandmarkFacts {
    /// The facts about a landmark of a city.
    pub fn new(city: &CityModel, landmark: Landmark) -> Self {
        let object = &city.objects[landmark.object as usize];
        let terms = landmark.terms;
        Self {
            id: object.id.to_string(),
            kind: city.strings.get(object.kind).to_owned(),
            name: landmark.name,
            score: landmark.score,
            height_m: landmark.height_m,
            neighbours_m: landmark.neighbours_m,
            footprint_m2: landmark.footprint_m2,
            footprint_is_hull: landmark.footprint_is_hull,
            isolation_m: landmark.isolation_m,
            terms: TermFacts {
                height: terms.height,
                footprint: terms.footprint,
                isolation: terms.isolation,
                attributes: terms.attributes,
            },
        }
    }
}

/// A scene of a city of files in which each landmark has a best-view lens, as the text of `file`: paths are relative to it where they
/// can be.
pub fn scene<'a>(files: &[PathBuf], landmarks: impl Iterator<Item = &'a LandmarkFacts>, file: &Path) -> String {
    let absolute = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let is_builtin = |path: &Path| path.to_str().is_some_and(|name| name.starts_with(builtin::PREFIX));
    let mut made = Scene::default();
    made.city.files = files.iter().map(|f| if is_builtin(f) { f.clone() } else { absolute(f) }).collect();
    for (i, landmark) in landmarks.enumerate() {
        let called = landmark.name.clone().unwrap_or_else(|| format!("Landmark {}", i + 1));
        let is_taken = |name: &str| made.pois.iter().any(|poi| poi.name == name);
        let name = if is_taken(&called) { format!("{called} ({})", i + 1) } else { called };
        let color = parse_hex(LINE_COLORS[i % LINE_COLORS.len()]).unwrap_or_default();
        made.pois.push(Poi { name: name.clone(), place: PoiPlace::Object(landmark.id.clone()) });
        let view = LocalView::Best { normal: None, fov_y: DEFAULT_FOV, highlight: true };
        let shown =
            lens::BestView { pois: vec![name.clone()], depiction: Depiction::View(view), lenses: None, look: None };
        made.lenses.push(Lens::plain(name.clone(), BestViewLens { shown }, color));
        // Those that stand out most are placed first.
        let priority = (1e3 * landmark.score).round() / 1e3;
        let frame = Frame::BuiltIn(BuiltInFrame::Print);
        made.overlays.push(Overlay { priority, frame, caption: Some(name.clone()), ..Overlay::of(&name) });
    }
    let options = Options::for_file(&absolute(file));
    format!(
        "# Landmarks, as `veduta info --landmarks` finds them, each in an overlay.\n{}",
        scene_file::to_toml_for(&made, &options)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scene_of_landmarks_is_one_that_is_read() {
        let landmark = |id: &str, name: Option<&str>| LandmarkFacts {
            id: id.into(),
            kind: "Building".into(),
            name: name.map(str::to_owned),
            score: 0.123_456_7,
            height_m: 30.0,
            neighbours_m: 10.0,
            footprint_m2: 400.0,
            footprint_is_hull: false,
            isolation_m: None,
            terms: TermFacts { height: 0.5, footprint: 0.5, isolation: 1.0, attributes: 0.0 },
        };
        let all = [landmark("a", Some("Church")), landmark("b", None), landmark("c", Some("Church"))];
        let file = Path::new("out/sights.toml");
        let text = scene(&["builtin:square".into(), "city/a.json".into()], all.iter(), file);
        let options = Options { allow_outside: true, ..Options::for_file(file) };
        let read = scene_file::parse(&text, "sights.toml", &options).unwrap_or_else(|error| panic!("{error}\n{text}"));
        let names: Vec<&str> = read.lenses.iter().map(|lens| lens.name.as_str()).collect();
        assert_eq!(names, ["Church", "Landmark 2", "Church (3)"]);
        assert_eq!(read.city.files[1], std::path::absolute("city/a.json").unwrap());
        assert!(read.overlays.iter().all(|overlay| overlay.priority == 0.123));
    }
}
