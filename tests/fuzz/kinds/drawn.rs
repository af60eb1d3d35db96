//! Scenes and effects that were read, drawn: what is right in a file may still ask for what cannot be drawn.

use std::path::Path;

use veduta::{
    figure::{
        self,
        scene_file::{Options, parse},
    },
    render::{
        frame::Backend,
        picture::{Aovs, RenderError, Request, Studio},
    },
    scene::{CitySpec, Scene},
    shader::{
        EffectDefinition, Mode,
        effect::{AskedBy, ParameterDefinition, ParameterKind, replace},
        effect_file::checked,
    },
};

use super::{DRAWN_S, Kind, effect, random_scenes, refused, refused_in_lines};
use crate::studio;

/// The city that all are drawn over.
const CITY: &str = "builtin:square";
const SIZE: [u32; 2] = [32, 20];

/// A studio that is made when it is needed, and anew after a picture that did not come to its end.
#[derive(Default)]
struct Drawing(Option<Studio>);

impl Drawing {
    fn draw(&mut self, scene: &Scene, backend: Backend) -> Result<bool, String> {
        let mut studio = self.0.take().unwrap_or_else(|| studio::of_scene(&scene_of("")));
        let aovs = Aovs { depth: true, object_id: true, normal: true, lens_mask: true };
        let request = Request { aovs, backend, statistics: true, ..Request::plain(SIZE) };
        let drawn = figure::draw(&mut studio, scene, &request);
        self.0 = Some(studio);
        match drawn {
            Ok(picture) if picture.rgba.len() != (SIZE[0] * SIZE[1]) as usize => {
                Err("a picture of the wrong size".into())
            }
            Ok(_) => Ok(true),
            Err(RenderError::Gpu(error)) => Err(format!("the driver: {error}")),
            Err(error) => refused_in_lines(&error.to_string()),
        }
    }
}

fn scene_of(rest: &str) -> Scene {
    let text = format!("veduta = 1\n[city]\nfiles = [\"{CITY}\"]\n{rest}");
    parse(&text, "drawn.toml", &Options::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// What other kinds try is refused there; here it would cost a try and nothing else.
fn scene_in(bytes: &[u8]) -> Option<Scene> {
    let scene = parse(std::str::from_utf8(bytes).ok()?, "fuzz.toml", &Options::default()).ok()?;
    Some(Scene { city: CitySpec { files: vec![CITY.into()], ..scene.city.clone() }, ..scene })
}

pub fn scenes() -> Kind {
    let mut drawing = Drawing::default();
    let read = move |_: &Path, _: &str, bytes: &[u8]| match scene_in(bytes) {
        Some(scene) => drawing.draw(&scene, Backend::Uber),
        None => Ok(false),
    };
    Kind {
        name: "drawn scenes",
        files: random_scenes(200),
        sample: 6,
        is_worth: |_, bytes| scene_in(bytes).is_some(),
        most_s: DRAWN_S,
        read: Box::new(read),
    }
}

/// An effect that is right. Of another name it would be one more, and one more, to the limit.
fn effect_in<'t>(name: &str, bytes: &'t [u8]) -> Option<(EffectDefinition, &'t str)> {
    let text = std::str::from_utf8(bytes).ok()?;
    let effect =
        checked(name, text).ok().filter(|effect| effect.name.starts_with("drawn-") && effect.mode != Mode::Ignore)?;
    Some((effect, text))
}

pub fn effects() -> Kind {
    let mut drawing = Drawing::default();
    let read = move |_: &Path, name: &str, bytes: &[u8]| {
        let Some((effect, text)) = effect_in(name, bytes) else { return Ok(false) };
        if let Err(error) = replace(name, text) {
            return refused(&error.to_string());
        }
        if let Some(studio) = &mut drawing.0 {
            studio.renderer.forget_shaders();
        }
        drawing.draw(&scene_of(&using(&effect)), Backend::Specialised)
    };
    let mut files = effect::files();
    for file in &mut files {
        file.bytes =
            String::from_utf8_lossy(&file.bytes).replacen("//! name = \"my-", "//! name = \"drawn-", 1).into_bytes();
    }
    files.retain(|file| file.bytes.starts_with(b"//! name = \"drawn-"));
    let is_worth = |name: &str, bytes: &[u8]| effect_in(name, bytes).is_some();
    Kind { name: "drawn effects", files, sample: 4, is_worth, most_s: DRAWN_S, read: Box::new(read) }
}

/// A lens that has an effect do something.
fn using(effect: &EffectDefinition) -> String {
    let name = &effect.name;
    let lens = |kind: &str, shape: &str, rest: String| {
        format!(
            "[[lens]]\nname = \"l\"\nkind = \"{kind}\"\nshape = {{ kind = \"{shape}\", center = [0, 0, 10], size = [60, 60, 40] }}\n{rest}\n"
        )
    };
    // What must be given, of those that time operators alone have.
    let given = |p: &ParameterDefinition| {
        let value = match p.kind {
            ParameterKind::Moment => "1900",
            ParameterKind::Span | ParameterKind::Unit => "1 day",
            ParameterKind::Clock => "12:00",
            _ => return None,
        };
        p.is_required().then(|| format!(", {} = \"{value}\"", p.name))
    };
    match effect.kind.prototype().asked_by {
        AskedBy::Times => {
            let given: String = effect.parameters.iter().filter_map(given).collect();
            format!("[time]\nat = \"1900\"\n{}", lens("time", "box", format!("time = [{{ op = \"{name}\"{given} }}]")))
        }
        AskedBy::Steps => lens("deformation", "box", format!("deform = [{{ kind = \"{name}\" }}]")),
        AskedBy::Shapes => lens("color", name, "effects = [\"sepia\"]".into()),
        AskedBy::Rays => format!(
            "[[lens]]\nname = \"l\"\nkind = \"ray\"\nray = {{ radius = 0.4, bend = {{ kind = \"{name}\" }} }}\n"
        ),
        AskedBy::Contents => lens("content", "box", format!("content = {{ transform = {{ kind = \"{name}\" }} }}")),
        _ => lens("color", "box", format!("effects = [\"{name}\"]")),
    }
}
