use glam::{DQuat, DVec2, DVec3};
use proptest::prelude::*;

use super::*;
use crate::{
    city::derived::{Derive, Form, Height},
    geom::{Shape, combination::Operation, shape::FlatFigure},
    lens::{
        Border, BorderUnit, Class, Content, Copied, Discrete, EffectUse, Focus, Lens, LensBody, LensKind, LensSprite,
        Occluders, OwnEye, Parameter, Placement, Rendering,
        chosen::Choice,
        rendering::{Case, ROWS, When},
        sprite::{Format, Mapping},
    },
    scene::{
        Animation, Background, BaseStyle, Corner, Figure, LegendPlace, Poi, PoiPlace, Style, Sun, Technique,
        Transparency,
        animation::{Change, ChangeKey, Numbers},
        transparency::{MOST_PEELED, SLOTS},
    },
    shader::{
        Blend, Clip, EffectKind,
        effect::{ParameterDefinition, ParameterKind, find},
    },
    view::{
        Camera, Projection,
        path::{CameraKey, Speed},
    },
    visibility::{Margin, Pace, Reference, Test},
};

const MINIMAL: &str = "veduta = 1\n";

fn read_text(text: &str) -> Result<Scene, String> {
    parse(text, "s.toml", &Options::for_command_line()).map_err(|e| e.to_string())
}

/// A scene of one lens, with `lines` in its table.
fn lens_text(lines: &str) -> String {
    format!("veduta = 1\n[[lens]]\n{lines}\n")
}

const BALL: &str = "shape = { kind = \"sphere\", center = [1, 2, 3], radius = 60.0 }\n";

#[test]
fn the_contracts_example_is_read() {
    let text = r#"
veduta = 1
[city]
files = ["city.city.json"]
[camera]
eye = [1.0, -90, 60]
target = [0, 0, 5]
up = [0, 0, 1]
fov_deg = 45.0
[[poi]]
name = "hall"
object = "ID"
[[lens]]
name = "a"
kind = "color"
enabled = true
shape = { kind = "sphere", center = [4, 5, 6], radius = 60.0 }
effects = ["sepia", { effect = "thematic", attribute = "yearOfConstruction", class = "inside" }]
"#;
    let scene = read_text(text).unwrap();
    let camera = scene.camera.unwrap();
    assert_eq!((camera.eye, camera.target), (DVec3::new(1.0, -90.0, 60.0), DVec3::new(0.0, 0.0, 5.0)));
    assert_eq!(camera.projection, Projection::Perspective { fov_y: std::f64::consts::FRAC_PI_4 });
    assert_eq!(scene.city.files, [std::path::PathBuf::from("city.city.json")]);
    assert_eq!(scene.pois, [Poi { name: "hall".into(), place: PoiPlace::Object("ID".into()) }]);
    let lens = &scene.lenses[0];
    assert_eq!(lens.shapes, [Shape::Sphere { center: DVec3::new(4.0, 5.0, 6.0), radius: 60.0 }.into()]);
    assert_eq!(
        (lens.effects[0].effect.as_str(), lens.effects[1].text("attribute")),
        ("sepia", Some("yearOfConstruction"))
    );
}

#[test]
fn an_almost_empty_file_is_a_scene() {
    assert_eq!(read_text(MINIMAL), Ok(Scene::default()));
    assert_eq!(read_text("\u{feff}veduta = 1"), Ok(Scene::default()));
}

#[test]
fn every_mistake_names_its_line_place_and_remedy() {
    for (text, expected) in [
        ("", "s.toml:1: veduta: is missing: Version of the format."),
        ("veduta = 2", "s.toml:1: veduta: must be 1, is 2"),
        ("veduta = 1\nx = [", "s.toml:2: "),
        ("veduta = 1\n\n[camra]\n", "s.toml:3: camra: unknown key; did you mean \"camera\"?"),
        ("veduta = 1\n[time]\n", "time: is not available yet"),
        ("veduta = 1\ncity = 3\n", "city: must be a table, is 3"),
        (
            "veduta = 1\n[camera]\neye = [0, 0, 0]\ntarget = [0, 0, 0]",
            "s.toml:4: [camera] target: eye and target are the same point",
        ),
        ("veduta = 1\n[camera]\neye = [0, 0, 0]", "s.toml:2: [camera] target: is missing"),
        (
            "veduta = 1\n[camera]\neye = [nan, 0, 0]\ntarget = [0, 0, 1]",
            "s.toml:3: [camera] eye: must be [x, y, z], three numbers from -1e9 to 1e9, is [NaN, 0, 0]",
        ),
        (
            "veduta = 1\n[camera]\neye = [0, 0, 0]\ntarget = [0, 0, 1]\nup = [0, 0, 2e9]",
            "[camera] up: must be [x, y, z], three numbers from -1e9 to 1e9, not all 0, is [0, 0, 2000000000]",
        ),
        (
            "veduta = 1\n[[poi]]\nat = [1e10, 0, 0]",
            "s.toml:3: [poi.0] at: must be [x, y, z], three numbers from -1e9 to 1e9, is [10000000000, 0, 0]",
        ),
        (
            "veduta = 1\n[camera]\neye = [0, 0, 0]\ntarget = [0, 0, 1]\nfov_deg = 180",
            "[camera] fov_deg: must be a number 0.01 to 179, is 180",
        ),
        (
            "veduta = 1\n[camera]\neye = [0, 0, 0]\ntarget = [0, 0, 1]\nup = [0, 0, 0]",
            "[camera] up: must be [x, y, z], three numbers from -1e9 to 1e9, not all 0",
        ),
        (
            "veduta = 1\n[camera]\neye = [0, 0, 0]\ntarget = [0, 0, 1]\nheight_m = 9",
            "height_m: has a meaning only with projection = \"orthographic\"",
        ),
        (
            "veduta = 1\n[figure]\nsize = [16385, 1]",
            "[figure] size: must be [width, height], two whole numbers 1 to 16384, is [16385, 1]",
        ),
        ("veduta = 1\n[figure]\nsize = [0, 100]", "[figure] size: must be"),
        ("veduta = 1\n[figure]\nsamples = 1.5", "[figure] samples: must be a whole number 1 to 1024, is 1.5"),
        (
            "veduta = 1\n[city]\nfiles = [\"a\"]\nlod = \"fine\"",
            "[city] lod: must be a level of detail like \"2\" or \"1.3\", is \"fine\"",
        ),
        ("veduta = 1\n[city]\nfiles = [1]", "[city] files: must be a list of texts"),
        (
            "veduta = 1\n[style]\nbase = \"cley\"",
            "[style] base: must be \"natural\" or \"clay\", is \"cley\"; did you mean \"clay\"?",
        ),
        (
            "veduta = 1\n[style]\ntransparency = \"weihted\"",
            "s.toml:3: [style] transparency: must be \"exact\" or \"peel\" or \"k-buffer\" or \"weighted\" or \"stochastic\", or a table { method = ..., layers = ... }, is \"weihted\"; did you mean \"weighted\"?",
        ),
        (
            "veduta = 1\n[style]\ntransparency = { method = \"k-buffer\", layers = 5 }",
            "s.toml:3: [style] transparency.layers: must be 4, 8 or 16 for \"k-buffer\", is 5",
        ),
        (
            "veduta = 1\n[style]\ntransparency = { method = \"weighted\", layers = 4 }",
            "[style] transparency.layers: \"weighted\" takes none; \"peel\" and \"k-buffer\" do",
        ),
        (
            "veduta = 1\n[style]\ntransparency = { method = \"peel\", layers = 4097 }",
            "[style] transparency.layers: must be a whole number 0 to 4096, is 4097",
        ),
        ("veduta = 1\n[style]\ntransparency = { layers = 4 }", "[style] transparency.method: is missing"),
        (
            "veduta = 1\n[style]\neffects = [{ effect = \"sepia\", class = \"front\" }]",
            "[style] effects.0.class: has a meaning only in a lens",
        ),
        ("veduta = 1\n[[poi]]\nname = \"a\"", "[poi.0] at: is missing: give object"),
        ("veduta = 1\n[[poi]]\nat = [0,0,0]\nobject = \"x\"", "[poi.0] at: is given together with object"),
        (
            "veduta = 1\n[[poi]]\nname=\"a\"\nat = [0,0,0]\n[[poi]]\nname=\"a\"\nat = [0,0,0]",
            "s.toml:5: [poi.1] name: \"a\" is the name of poi.0 already",
        ),
        ("veduta = 99999999999999999999", "s.toml:1: 99999999999999999999 does not fit 64 bits"),
        ("veduta = 1\nveduta = 1", "s.toml:2: duplicate key"),
    ] {
        let message = read_text(text).unwrap_err();
        assert!(message.contains(expected), "{text}\n  gave     {message}\n  expected {expected}");
    }
}

#[test]
fn every_mistake_in_a_lens_is_named() {
    for (lines, expected) in [
        ("name = \"a\"", "s.toml:2: [lens.0] shape: is missing"),
        (
            "shape = { kind = \"sphere\", center = [0, 0, 0], radius = -3 }",
            "s.toml:3: [lens.0] shape.radius: must be a number ≥ 0, is -3",
        ),
        (
            "shape = { kind = \"sphere\", center = [0, 0, 0], radius = nan }",
            "shape.radius: must be a number ≥ 0, is NaN",
        ),
        (
            "shape = { kind = \"sphere\", centre = [0, 0, 0], radius = 3 }",
            "shape.centre: unknown key; did you mean \"center\"?",
        ),
        (
            "shape = { kind = \"shpere\" }",
            "shape.kind: must be one of sphere, ellipsoid, box, cylinder, cone, frustum, convex, polytope, corridor, flat, mesh, mask, mask3d, sprite, objects, thematic, enclosed, union, intersection, difference, is \"shpere\"; did you mean \"sphere\"?",
        ),
        ("shape = { kind = \"union\" }", "shape.shapes: is missing: The shapes, of any kind"),
        (
            "shape = { kind = \"union\", shapes = [{ kind = \"sphere\", center = [0,0,0], radius = 1 }, { kind = \"box\", center = [0,0,0] }] }",
            "shape.shapes.1.size: is missing",
        ),
        ("shape = { kind = \"mesh\" }", "shape.file: is missing: The file, of any format"),
        (
            "shape = { kind = \"mesh\", file = \"a.obj\", scale = 0 }",
            "s.toml:3: [lens.0] shape.scale: must be > 0, is 0",
        ),
        (
            "shape = { kind = \"mask\", base = 0, height = 3 }",
            "shape.image: is missing: give image = \"FILE\" or points",
        ),
        (
            "shape = { kind = \"mask\", image = \"a.png\", points = [[0,0],[1,0],[0,1]], base = 0, height = 3 }",
            "shape.image: is given together with points: a mask is one of them",
        ),
        (
            "shape = { kind = \"mask\", image = \"a.png\", base = 0, height = 3 }",
            "shape.corner: is missing: an image needs",
        ),
        (
            "shape = { kind = \"mask\", points = [[0,0],[1,0],[0,1,2]], base = 0, height = 3 }",
            "shape.points: point 2 must be [x, y], two numbers from -1e9 to 1e9, is [0, 1, 2]",
        ),
        (
            "shape = { kind = \"mask\", points = [[0,0],[9,9],[9,0],[0,9]], base = 0, height = 3 }",
            "shape.points: the polygon crosses itself",
        ),
        (
            "shape = { kind = \"mask\", points = [[0,0],[9,0],[0,9]], corner = [0,0], base = 0, height = 3 }",
            "shape.corner: has a meaning only with image",
        ),
        (
            "shape = { kind = \"mask3d\", images = [], corner = [0,0,0], size = [1,1,1] }",
            "shape.images: must name at least one image",
        ),
        ("shape = { kind = \"objects\" }", "shape.ids: is missing: give ids = [\"ID\", ...] or attribute = \"NAME\""),
        (
            "shape = { kind = \"thematic\", ids = [\"a\"], attribute = \"b\" }",
            "shape.attribute: is given together with ids",
        ),
        ("shape = { kind = \"thematic\", ids = [] }", "shape.ids: must name at least one object"),
        ("shape = { kind = \"thematic\", ids = [\"a\"], min = 3 }", "shape.min: has a meaning only with attribute"),
        (
            "shape = { kind = \"corridor\", points = [[0, 0, 0]], width = 3, height = 2 }",
            "shape.points: must be a list of at least 2 points [x, y, z], has 1",
        ),
        ("shape = { kind = \"enclosed\", shapes = [] }", "shape.shapes: must be a list of at least one shape, is []"),
        (
            "shape = { kind = \"enclosed\", shapes = [{ kind = \"sphere\", center = [0, 0, 0], radius = -1 }] }",
            "shape.shapes.0.radius: must be",
        ),
        (
            "shape = { kind = \"enclosed\", shapes = [{ kind = \"thematic\", ids = [\"a\"] }], types = [] }",
            "shape.types: must name at least one type",
        ),
        ("shape = { center = [0, 0, 0] }", "shape.kind: is missing: one of sphere"),
        ("shape = \"sphere\"", "shape: must be a table { kind = ..., ... }, is \"sphere\""),
        ("shapes = []", "shapes: must be a list of at least one shape, is []"),
        (
            "shapes = [{ kind = \"convex\", points = [[0,0,0],[1,0,0],[0,1,0],[1,1,0]] }]",
            "shapes.0.points: all 4 points lie on one plane",
        ),
        (
            "shape = { kind = \"polytope\", planes = [[1,0,0,9],[-1,0,0,0],[0,1,0,9],[0,-1,0,0],[0,0,1,9]] }",
            "shape.planes: the planes must close a body",
        ),
        (
            "shape = { kind = \"polytope\", planes = [[1,0,0,9],[-1,0,0],[0,1,0,9],[0,-1,0,0]] }",
            "shape.planes: plane 1 must be [x, y, z, d], four finite numbers, is [-1, 0, 0]",
        ),
        (
            "shape = { kind = \"convex\", points = [[0,0,0],[1,0],[0,1,0],[1,1,0]] }",
            "shape.points: point 1 must be [x, y, z]",
        ),
        (
            "shape = { kind = \"cylinder\", center = [0,0,0], radius = 1, height = 1, axis = [0,0,0] }",
            "shape.axis: must be [x, y, z], three numbers from -1e9 to 1e9, not all 0",
        ),
        (
            "shape = { kind = \"ellipsoid\", center = [0,0,0], radii = 3 }",
            "shape.radii: must be [x, y, z], three numbers from 0 to 1e9, is 3",
        ),
        (
            "shape = { kind = \"polytope\", planes = [] }",
            "shape.planes: must be a list of at least 4 planes [x, y, z, d], has none",
        ),
        (
            "shape = { kind = \"box\", center = [0,0,0], size = [1, 1, 2e9] }",
            "shape.size: must be [x, y, z], three numbers from 0 to 1e9, is [1, 1, 2000000000]",
        ),
        (
            "shape = { kind = \"corridor\", points = [[0, 0, 0], [0, -2e9, 0]], width = 3, height = 2 }",
            "shape.points: point 1 must be [x, y, z], three numbers from -1e9 to 1e9, is [0, -2000000000, 0]",
        ),
        (
            "shape = { kind = \"flat\", center = [0,0,0], size = [2e9, 1] }",
            "shape.size: must be [width, height], two numbers from 0 to 1e9, is [2000000000, 1]",
        ),
        ("shape = { kind = \"frustum\", center = [0,0,0], radius = 3, height = 2 }", "shape.top_radius: is missing"),
        (
            "shape = { kind = \"cone\", center = [0,0,0], radius = 3, top_radius = 1, height = 2 }",
            "shape.top_radius: unknown key",
        ),
        (
            "shape = { kind = \"box\", center = [0,0,0], size = [1, -1, 1] }",
            "shape.size: must be [x, y, z], three numbers from 0 to 1e9, is [1, -1, 1]",
        ),
        (
            "shape = { kind = \"flat\", center = [0,0,0] }",
            "shape.radius: is missing: a flat lens has a radius, a size = [width, height] or points",
        ),
        (
            "shape = { kind = \"flat\", center = [0,0,0], radius = 3, size = [1, 2] }",
            "shape.size: is given together with radius: a flat lens has one figure",
        ),
        (
            "shape = { kind = \"flat\", center = [0,0,0], size = [1, -2] }",
            "shape.size: must be [width, height], two numbers from 0 to 1e9, is [1, -2]",
        ),
        (
            "shape = { kind = \"flat\", center = [0,0,0], points = [[0, 0], [1, 0, 0], [0, 1]] }",
            "shape.points: point 1 must be [x, y], two numbers from -1e9 to 1e9, is [1, 0, 0]",
        ),
        (
            "shape = { kind = \"flat\", center = [0,0,0], points = [[0, 0], [1, 0]] }",
            "shape.points: must be a list of at least 3 points [x, y], has 2",
        ),
        (
            "shape = { kind = \"sphere\", center = [0, 0, 0], radius = 3 }\nshapes = []",
            "shapes: is given together with shape",
        ),
    ] {
        let message = read_text(&lens_text(lines)).unwrap_err();
        assert!(message.contains(expected), "{lines}\n  gave     {message}\n  expected {expected}");
    }
    for (lines, expected) in [
        (
            "kind = \"deformation\"",
            "s.toml:4: [lens.0] kind: \"deformation\" is not available yet; available: color, content, occlusion",
        ),
        (
            "kind = \"colour\"",
            "[lens.0] kind: must be \"color\" or \"content\" or \"occlusion\", is \"colour\"; did you mean \"color\"?",
        ),
        (
            "placement = \"camara\"",
            "placement: must be \"scene\" or \"camera\", is \"camara\"; did you mean \"camera\"?",
        ),
        (
            "placement = \"camera\"\nattached_to = { object = \"a\" }",
            "s.toml:5: [lens.0] attached_to: is given together with placement = \"camera\": a lens is fixed to one of them",
        ),
        (
            "attached_to = { object = \"a\", poi = \"b\" }",
            "attached_to.poi: is given together with object: a lens is attached to one of them",
        ),
        ("attached_to = {}", "[lens.0] attached_to: is empty: give object = \"ID\" or poi = \"NAME\""),
        ("attached_to = { objekt = \"a\" }", "attached_to.objekt: unknown key; did you mean \"object\"?"),
        ("attached_to = \"a\"", "attached_to: must be a table, is \"a\""),
        ("space = \"rest\"", "space: \"rest\" is not available yet"),
        ("color = \"red\"", "color: must be a colour: \"#rrggbb\" or [r, g, b] of 0 to 1, is \"red\""),
        (
            "effects = [\"sepai\"]",
            "s.toml:4: [lens.0] effects.0: there is no effect \"sepai\"; did you mean \"sepia\"?",
        ),
        ("kind = \"content\"", "[lens.0] content: is missing: a content lens shows something"),
        ("clip = \"merge\"", "[lens.0] clip: has a meaning only for a lens with content"),
        ("content = {}\nclip = \"mix\"", "clip: must be \"order\" or \"merge\" or \"discard\", is \"mix\""),
        ("content = { lod = \"x\" }", "content.lod: must be a level of detail"),
        ("content = { file = \"a\" }", "content.file: unknown key; did you mean \"files\"?"),
        ("content = { files = [] }", "content.files: is empty: name the files"),
        ("content = { files = [\"builtin:moon\"] }", "content.files.0: there is no \"builtin:moon\""),
        (
            "content = { derive = \"cube\" }",
            "content.derive: must be \"box\" or \"prism\" or \"hull\" or \"flat\" or \"top\" or \"lod1\" or \"height\", is \"cube\"",
        ),
        (
            "content = { derive = \"prism\", oriented = true }",
            "content.oriented: has a meaning only with derive = \"box\"",
        ),
        ("content = { lift = 1.0 }", "content.lift: has a meaning only with derive = \"flat\""),
        ("content = { derive = \"flat\", lift = -1.0 }", "content.lift: must be a number 0 to 1000, is -1"),
        ("content = { parts = true }", "content.parts: has a meaning only with derive"),
        ("content = { derive = \"height\" }", "content.derive: \"height\" needs a height in metres or a factor"),
        (
            "content = { derive = \"height\", height = 3.0, factor = 2.0 }",
            "content.derive: height and factor are both given; either says how high",
        ),
        ("content = { scale = 0 }", "content.scale: must be a number 0.001 to 1000, is 0"),
        (
            "content = {}\neffects = [{ effect = \"lod\", lod = 1.2 }]",
            "content: is given together with the effect \"lod\"",
        ),
        (
            "effects = [{ effect = \"lod\", lod = 1.2 }, { effect = \"lod\", lod = 2 }]",
            "effects.1: is a second \"lod\"",
        ),
        ("effects = [\"lod\"]", "effects.0.lod: is missing: a level of detail like"),
        ("effects = [{ effect = \"lod\", lod = \"fine\" }]", "effects.0.lod: must be a level of detail like"),
        ("effects = [{ effect = \"lod\", lod = 2, weight = 0.5 }]", "effects.0.weight: \"lod\" shows something else"),
        (
            "effects = [{ effect = \"lod\", lod = 2, clas = \"rest\" }]",
            "\"lod\" has no such parameter; did you mean \"class\"?",
        ),
        ("effects = [\"xray\"]", "effects.0: there is no effect \"xray\"; did you mean \"x-ray\"?"),
        (
            "effects = [{ effect = \"x-ray\", blend = \"add\" }]",
            "says how opaque things are; there is nothing to blend",
        ),
        ("effects = [{ effect = \"thematic\" }]", "effects.0.attribute: is missing"),
        (
            "effects = [{ effect = \"sepia\", amuont = 1 }]",
            "effects.0.amuont: \"sepia\" has no such parameter; did you mean \"amount\"?",
        ),
        (
            "effects = [{ effect = \"sepia\", class = \"infront\" }]",
            "effects.0.class: must be one of inside, front, behind, rest, is \"infront\"",
        ),
        ("effects = [{ amount = 1 }]", "effects.0.effect: is missing"),
        ("effects = [3]", "effects.0: must be a name or a table"),
        (
            "effects = [{ effect = \"thematic\", attribute = \"a\" }, { effect = \"thematic\", attribute = \"b\" }]",
            "effects.1: \"thematic\" is a second scene style beside \"thematic\"",
        ),
        ("sprite = { resolution = 4 }", "sprite.resolution: must be a whole number 16 to 16384, is 4"),
        ("sprite = { near = 9, far = 8.5 }", "sprite.far: must lie beyond near, 9 m, is 8.5"),
        (
            "sprite = { mapping = \"1/z\" }",
            "sprite.mapping: must be \"z\" or \"complementary-z\" or \"w\" or \"1/w\", is \"1/z\"",
        ),
        ("border = {}", "border.width: is missing: From where"),
        ("border = { width = -1 }", "border.width: must be a number 0 to 100000, is -1"),
        ("border = { width = 1, unit = \"cm\" }", "border.unit: must be \"m\" or \"px\" or \"ray\", is \"cm\""),
        ("sprite = {}\nborder = { width = 1 }", "border: is given together with sprite"),
        ("sprite = { camera = { eye = [0, 0, 1] } }", "sprite.camera.target: is missing: What it looks at"),
        (
            "sprite = { camera = { eye = [0, 0, 1], target = [0, 0, 1] } }",
            "sprite.camera.target: eye and target are the same point",
        ),
        (
            "sprite = { camera = { eye = [0, 0, 1], target = [0, 0, 2], aspect = 0 } }",
            "sprite.camera.aspect: must be a number 0.01 to 100, is 0",
        ),
        (
            "[[lens]]\nname = \"lens-0\"\nshape = { kind = \"sphere\", center = [1, 2, 3], radius = 60.0 }",
            "[lens.1] name: \"lens-0\" is the name of lens.0 already",
        ),
    ] {
        let message = read_text(&lens_text(&format!("{BALL}{lines}"))).unwrap_err();
        assert!(message.contains(expected), "{lines}\n  gave     {message}\n  expected {expected}");
    }
}

#[test]
fn of_a_lens_of_a_wrong_kind_only_that_is_told() {
    let rest = "poi = \"hall\"\ntest = { kind = \"spherical\", radius = 9 }\nrender = \"x-ray\"\npoi_effects = [\"gooch\"]\nmagnification = 3\nmargin = -1";
    for (kind, expected) in [
        (
            "occlusionn",
            "must be \"color\" or \"content\" or \"occlusion\", is \"occlusionn\"; did you mean \"occlusion\"?",
        ),
        ("see-through", "\"see-through\" is not available yet; available: color, content, occlusion"),
    ] {
        let message = read_text(&lens_text(&format!("{rest}\nkind = \"{kind}\""))).unwrap_err();
        assert_eq!(message, format!("s.toml:9: [lens.0] kind: {expected}"));
    }
    // Other lenses keep theirs.
    let two = format!("[[lens]]\nkind = \"colour\"\n[[lens]]\n{BALL}effects = [\"sepai\"]\n[sun]\nshadows = 1");
    let message = read_text(&format!("veduta = 1\n{two}")).unwrap_err();
    let lines: Vec<&str> = message.lines().collect();
    assert_eq!(lines.len(), 3, "{message}");
    assert!(
        lines[0].starts_with("s.toml:3: [lens.0] kind: ") && lines[1].contains("[lens.1] effects.0: "),
        "{message}"
    );
}

#[test]
fn all_mistakes_are_told_at_once_and_their_number_is_bounded() {
    let message = read_text("veduta = 1\n[sun]\nazimuth_deg = 999\nshadows = 1\n[figure]\nsamples = 0").unwrap_err();
    assert_eq!(message.lines().count(), 3);
    let many = format!("veduta = 1\n{}", (0..100).map(|i| format!("zz{i} = 1\n")).collect::<String>());
    let message = read_text(&many).unwrap_err();
    assert!(message.lines().count() == MAX_SHOWN + 1 && message.ends_with("... and 80 more"));
}

#[test]
fn deep_nesting_is_an_error_and_not_a_crash() {
    for (open, close) in [("[", "]"), ("{ a = ", " }")] {
        let text = format!("veduta = 1\nx = {}1{}", open.repeat(100_000), close.repeat(100_000));
        assert!(read_text(&text).is_err());
    }
}

#[test]
fn a_zero_size_lens_is_a_lens_that_holds_nothing() {
    let scene = read_text(&lens_text("shape = { kind = \"sphere\", center = [0, 0, 0], radius = 0 }")).unwrap();
    let Focus::Shape(shape) = &scene.lenses[0].shapes[0] else { panic!("a sphere") };
    assert!(shape.volume().unwrap().is_empty());
}

#[test]
fn yaw_turns_counter_clockwise_pitch_lifts_and_roll_turns_about_x() {
    let close = |a: DVec3, b: DVec3| a.distance(b) < 1e-12;
    assert!(close(rotation([90.0, 0.0, 0.0]) * DVec3::X, DVec3::Y));
    assert!(close(rotation([0.0, 90.0, 0.0]) * DVec3::X, DVec3::Z));
    assert!(close(rotation([0.0, 0.0, 90.0]) * DVec3::Y, DVec3::Z));
    assert!(close(rotation([90.0, 90.0, 0.0]) * DVec3::X, DVec3::Z));
    assert_eq!(rotation([0.0; 3]), DQuat::IDENTITY);
}

#[test]
fn absent_data_is_told_apart_from_mistakes() {
    let options = Options { data: None, ..Options::for_file(Path::new("scenes/a.toml")) };
    let text = "veduta = 1\n[city]\nfiles = [\"${VEDUTA_DATA}/x.json\"]";
    let error = parse(text, "s", &options).unwrap_err();
    assert!(error.is_data_absent, "{error}");
    let error = parse(&format!("{text}\nlodd = 1"), "s", &options).unwrap_err();
    assert!(!error.is_data_absent);
}

fn point() -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-1e6..1e6f64).prop_map(DVec3::from)
}

fn shapes() -> impl Strategy<Value = Shape> {
    let angles = || prop::array::uniform3(-1800..1800i32).prop_map(|a| a.map(|a| f64::from(a) / 10.0));
    prop_oneof![
        (point(), 0.0..1e4f64).prop_map(|(center, radius)| Shape::Sphere { center, radius }),
        (point(), prop::array::uniform3(0.0..1e3f64), angles()).prop_map(|(center, s, a)| Shape::Box {
            center,
            size: s.into(),
            rotation: rotation(a)
        }),
        (point(), 0.0..1e3f64, 0.0..1e3f64, point()).prop_filter_map("an axis", |(center, radius, height, a)| {
            Some(Shape::Cylinder { center, radius, height, axis: a.try_normalize()? })
        }),
        (point(), prop::array::uniform3(0.0..1e3f64), angles()).prop_map(|(center, r, a)| Shape::Ellipsoid {
            center,
            radii: r.into(),
            rotation: rotation(a)
        }),
        (point(), 0.0..1e3f64, prop_oneof![Just(0.0), 0.0..1e3f64], 0.0..1e3f64, point()).prop_filter_map(
            "an axis",
            |(center, radius, top_radius, height, a)| {
                Some(Shape::Frustum { center, radius, top_radius, height, axis: a.try_normalize()? })
            }
        ),
        prop::collection::vec(point(), 5..9).prop_map(|points| Shape::Convex { points }),
        (point(), prop::array::uniform6(0.1..1e3f64)).prop_map(|(at, ends)| {
            let sides = [DVec3::X, DVec3::Y, DVec3::Z, -DVec3::X, -DVec3::Y, -DVec3::Z].into_iter().zip(ends);
            Shape::Polytope { planes: sides.map(|(n, d)| [n.x, n.y, n.z, d + n.dot(at)]).collect() }
        }),
        (prop::collection::vec(point(), 2..9), 0.0..1e3f64, 0.0..1e3f64)
            .prop_map(|(points, width, height)| Shape::Corridor { points, width, height }),
        (point(), angles(), figures_of_flats()).prop_map(|(center, a, figure)| Shape::Flat {
            center,
            rotation: rotation(a),
            figure
        }),
    ]
}

fn figures_of_flats() -> impl Strategy<Value = FlatFigure> {
    let pair = || prop::array::uniform2(-1e3..1e3f64).prop_map(DVec2::from);
    prop_oneof![
        (0.0..1e3f64).prop_map(|radius| FlatFigure::Disc { radius }),
        pair().prop_map(|size| FlatFigure::Rectangle { size: size.abs() }),
        prop::collection::vec(pair(), 3..9).prop_map(|points| FlatFigure::Polygon { points }),
    ]
}

fn placements() -> impl Strategy<Value = Placement> {
    prop_oneof![
        Just(Placement::World),
        Just(Placement::Camera),
        ".{1,6}".prop_map(Placement::Object),
        ".{1,6}".prop_map(Placement::Poi),
    ]
}

fn plan() -> impl Strategy<Value = DVec2> {
    prop::array::uniform2(-1e6..1e6f64).prop_map(DVec2::from)
}

fn choices() -> impl Strategy<Value = Choice> {
    let ids = prop::collection::vec("[a-z\"]{1,5}", 1..3).prop_map(|ids| (ids, None));
    let attribute = (".{1,5}", prop::option::of(prop::collection::vec(".{1,4}", 1..3)))
        .prop_map(|(name, values)| (Vec::new(), Some((name, values))));
    (prop_oneof![ids, attribute], prop::option::of(-1e3..1e3f64), any::<bool>()).prop_map(|((ids, of), min, except)| {
        let (attribute, values) = of.map_or((None, None), |(name, values)| (Some(name), values));
        let min = min.filter(|_| attribute.is_some());
        Choice { ids, attribute, values, min, max: min.map(|m| m + 1.0), except }
    })
}

fn focuses() -> impl Strategy<Value = Focus> {
    plain_focuses().prop_recursive(2, 6, 3, |inner| {
        let how = prop::option::of(prop::sample::select(Operation::ALL.to_vec()));
        let types = prop::collection::vec("[A-Z\"]{1,5}", 0..3);
        (how, any::<bool>(), types, prop::collection::vec(inner, 1..3)).prop_map(|(how, whole, types, parts)| match how
        {
            Some(how) => Focus::Combined { how, parts },
            None => Focus::Enclosed { parts, whole, types },
        })
    })
}

fn plain_focuses() -> impl Strategy<Value = Focus> {
    let angles = prop::array::uniform3(-1800..1800i32).prop_map(|a| a.map(|a| f64::from(a) / 10.0));
    // With area, and a smaller one in it.
    let ring = (plan(), 1.0..1e3f64).prop_map(|(at, size)| {
        let corners =
            move |size: f64| [[0.0, 0.0], [3.0, 0.4], [1.0, 2.0]].map(|c| at + size * (DVec2::from(c) - 1.0)).to_vec();
        (corners(size), corners(0.3 * size))
    });
    let size = || prop::array::uniform2(0.0..1e3f64).prop_map(DVec2::from);
    prop_oneof![
        4 => shapes().prop_map(Focus::from),
        1 => (point(), angles, 0.1..1e3f64).prop_map(|(at, a, scale)| Focus::Mesh {
            file: "b.obj".into(),
            at,
            rotation: rotation(a),
            scale
        }),
        1 => (ring, any::<bool>(), -1e3..1e3f64, 0.0..1e3f64).prop_map(|((points, hole), holed, base, height)| {
            Focus::Prism { points, holes: if holed { vec![hole] } else { vec![] }, base, height }
        }),
        1 => (plan(), size(), -1e3..1e3f64, 0.0..1e3f64).prop_map(|(corner, size, base, height)| Focus::Mask {
            image: "m.png".into(),
            corner,
            size,
            base,
            height
        }),
        1 => (point(), prop::array::uniform3(0.0..1e3f64)).prop_map(|(corner, size)| Focus::Mask3d {
            images: vec!["0.png".into(), "1.png".into()],
            corner,
            size: size.into()
        }),
        1 => Just(Focus::Sprite { file: "s.exr".into() }),
        1 => choices().prop_map(Focus::Objects),
        1 => choices().prop_map(Focus::Thematic),
    ]
}

fn effects() -> impl Strategy<Value = EffectUse> {
    let class = prop_oneof![Just(Class::Inside), Just(Class::Front), Just(Class::Behind), Just(Class::Rest)];
    let used = |effect: &str, class, parameters: Vec<(&str, Parameter)>| EffectUse {
        effect: effect.into(),
        class,
        blend: None,
        weight: None,
        parameters: parameters.into_iter().map(|(k, v)| (k.to_owned(), v)).collect(),
    };
    let laid = (prop::option::of(prop::sample::select(Blend::ALL.to_vec())), prop::option::of(0.0..=1.0f64));
    let lay = |(used, (blend, weight))| EffectUse { blend, weight, ..used };
    let used = (class, 0.0..=1.0f64, ".{1,8}", any::<bool>(), any::<bool>()).prop_map(
        move |(class, amount, text, plain, flag)| {
            if plain {
                let parameters = if flag { vec![("amount", Parameter::Number(amount))] } else { vec![] };
                used("sepia", class, parameters)
            } else {
                let list = vec![
                    ("attribute", Parameter::Text(text.clone())),
                    ("reverse", Parameter::Boolean(flag)),
                    ("breaks", Parameter::Numbers(vec![amount, amount + 1.0])),
                    ("categories", Parameter::Texts(vec![text])),
                    ("no_data", Parameter::Text("#123456".into())),
                ];
                used("thematic", class, list)
            }
        },
    );
    (used, laid).prop_map(lay)
}

/// A sprite or a border, or neither.
fn ends() -> impl Strategy<Value = (Option<LensSprite>, Option<Border>)> {
    let sprite = sprites().prop_map(|sprite| (Some(sprite), None));
    let units = prop::sample::select(vec![BorderUnit::Metres, BorderUnit::Pixels, BorderUnit::Ray]);
    let border = (0.0..1e5, units, any::<bool>()).prop_map(|(width, unit, dithers)| {
        let discrete = if dithers { Discrete::Dither } else { Discrete::Threshold };
        (None, Some(Border { width, unit, discrete }))
    });
    prop_oneof![Just((None, None)), sprite, border]
}

fn derives() -> impl Strategy<Value = Derive> {
    let form = prop_oneof![
        any::<bool>().prop_map(|oriented| Form::Box { oriented }),
        Just(Form::Prism),
        Just(Form::Hull),
        prop_oneof![Just(0.05), 0.0..1000.0f64].prop_map(|lift_m| Form::Flat { lift_m }),
        (0.0..1000.0f64).prop_map(|lift_m| Form::Top { lift_m }),
        Just(Form::Lod1),
        (1e-3..1e5f64).prop_map(|metres| Form::Height(Height::Metres(metres))),
        (1e-3..1e3f64).prop_map(|factor| Form::Height(Height::Factor(factor))),
    ];
    (form, any::<bool>()).prop_map(|(form, parts)| Derive { form, parts })
}

prop_compose! {
    fn contents()(files in prop::collection::vec("[ -~äß]{1,9}", 0..3), tenths in prop::option::of(0..99u8),
        derive in prop::option::of(derives()),
        class in prop::sample::select(vec![Class::Inside, Class::Front, Class::Behind, Class::Rest]),
        clip in prop::sample::select(Clip::ALL.to_vec()), keep_terrain in any::<bool>(),
        copied in prop::option::of((prop::option::of(point()), prop::option::of(point()), 1e-3..1e3f64, any::<bool>(), prop::array::uniform3(-1800..1800i32)))) -> Content {
        let copied = copied.map(|(from, to, scale, plain, angles)| match plain {
            true => Copied { from, to, ..Copied::default() },
            false => Copied { from, to, rotation: rotation(angles.map(|a| f64::from(a) / 10.0)), scale },
        });
        let files = files.into_iter().filter(|f| !f.contains("${") && !f.starts_with("builtin:")).map(Into::into).collect();
        Content { files, lod: tenths.map(|tenths| crate::city::Lod { tenths }), derive, class, clip, keep_terrain, copied }
    }
}

prop_compose! {
    fn sprites()(resolution in prop::option::of(16..16_384u32), format in 0..5usize, mapping in 0..4usize,
        near_m in prop::option::of(1e-3..10.0f64), far_m in prop::option::of(11.0..1e4f64), layers in 1..17u32,
        aggregate in any::<bool>(), own in prop::option::of((point(), point(), 1..1790u32, any::<bool>(), 0.01..100.0f64))) -> LensSprite {
        let (format, mapping) = (Format::WORDS[format].1, Mapping::WORDS[mapping].1);
        let own = own.map(|(eye, target, tenths, is_flat, aspect)| {
            let fov_y = (f64::from(tenths) / 10.0).to_radians();
            let projection = if is_flat { Projection::Orthographic { height_m: f64::from(tenths) } } else { Projection::Perspective { fov_y } };
            OwnEye { camera: Camera { projection, ..Camera::looking(eye, target, fov_y) }, aspect }
        });
        LensSprite { own, resolution, format, mapping, near_m, far_m, layers, aggregate }
    }
}

fn detections() -> impl Strategy<Value = Test> {
    let reference = prop::sample::select(Reference::WORDS.map(|(_, reference)| reference).to_vec());
    let up = || prop_oneof![Just(DVec3::Z), point().prop_filter_map("a direction", |v| v.try_normalize())];
    let radius = || 0.0..1e3f64;
    let one = prop_oneof![
        (radius(), reference.clone()).prop_map(|(radius, reference)| Test::Spherical { radius, reference }),
        (radius(), up()).prop_map(|(radius, up)| Test::Cylindrical { radius, up }),
        (radius(), reference, up()).prop_map(|(radius, reference, up)| Test::ViewerHeight { radius, reference, up }),
        Just(Test::ViewAxis),
        radius().prop_map(|radius| Test::Ground { radius }),
        (0.0..=1.0f64, 1..=65_536u32).prop_map(|(coverage, rays)| Test::Exact { coverage, rays }),
        prop::collection::vec(point(), 2..4).prop_map(|points| Test::Route { points }),
    ];
    one.prop_recursive(2, 6, 3, |inner| {
        (0..3, prop::collection::vec(inner, 1..3)).prop_map(|(how, mut parts)| match how {
            0 => Test::Any(parts),
            1 => Test::All(parts),
            _ => Test::Not(Box::new(parts.remove(0))),
        })
    })
}

/// An occlusion lens's part of a lens: whom it looks for, and how it draws them.
fn occluded() -> impl Strategy<Value = (Occluders, Rendering, bool)> {
    let choice = |id: String| Choice { ids: vec![id], ..Choice::default() };
    let choice = prop::option::of("[a-z\"]{1,5}".prop_map(choice));
    let render = prop_oneof![
        Just(Rendering::default()),
        // A second scene style beside those of `effects` is refused.
        effects().prop_filter_map("no scene style", |used| {
            (used.effect == "sepia").then(|| Rendering::of_effects(vec![used]))
        }),
    ];
    let row = prop::sample::select(ROWS.iter().collect::<Vec<_>>());
    let types = prop::collection::vec("[a-z\"]{1,5}", 0..3);
    let case = (row, 0.0..1e6f64, types, prop::option::of("[a-z\"]{1,5}")).prop_map(move |(row, nearer, types, id)| {
        let of = id.map(|id| Choice { ids: vec![id], ..Choice::default() });
        // Each number that the word takes, somewhere in its range.
        let number = |p: ParameterDefinition| match p.kind {
            ParameterKind::Number { min, max } => Some((p.name, Parameter::Number(min + (max - min) * (nearer / 1e6)))),
            _ => None,
        };
        let given = row.parameters().into_iter().filter_map(number).collect();
        Case { when: When { nearer_m: Some(nearer), types, of }, ..Case::of_row(row, given) }
    });
    let cases = prop::collection::vec(case, 1..4).prop_map(|mut cases| {
        // Scene styles of cases would meet those of `effects`.
        cases.retain(|case| {
            case.effects.iter().all(|used| find(&used.effect).is_some_and(|e| e.kind != EffectKind::Scene))
        });
        if cases.is_empty() { Rendering::default() } else { Rendering::of_cases(cases) }
    });
    let render = prop_oneof![2 => render, 1 => cases];
    let names = prop::collection::btree_set("[a-z\"]{1,5}", 1..3).prop_map(|names| names.into_iter().collect());
    let over_time = (0.0..=1000.0f64, 0.0..=60.0f64).prop_map(|(metres, fade_s)| (Margin { metres }, Pace { fade_s }));
    let over_time = prop_oneof![Just(Default::default()), over_time];
    (names, detections(), choice.clone(), choice, over_time, render, any::<bool>()).prop_map(
        |(pois, test, force, forbid, (margin, pace), render, has_shape)| {
            (Occluders { pois, test, force, forbid, margin, pace }, render, has_shape)
        },
    )
}

prop_compose! {
    fn lenses()(occluded in prop::option::weighted(0.3, occluded()),
        shapes in prop::collection::vec(focuses(), 1..3), used in prop::collection::vec(effects(), 0..2),
        enabled in any::<bool>(), color in prop::array::uniform3(0.0..=1.0f32), body in 0..LensBody::WORDS.len(),
        ends in ends(), placement in placements(), content in prop::option::of(contents()), is_content in any::<bool>(),
        section in prop::option::of(prop::array::uniform3(0.0..=1.0f32)), keeps_shadows in any::<bool>()) -> Lens {
        // A soft border needs shapes that have a distance; what shapes of files have, `sprite` does not give.
        let is_saved = |s: &Focus| matches!(s, Focus::Sprite { .. });
        let (sprite, border) = if shapes.iter().any(|s| s.any(&is_saved)) { (None, None) } else { ends };
        let body = LensBody::WORDS[body].1;
        let mut kind = if content.is_some() && is_content { LensKind::Content } else { LensKind::Color };
        let (mut shapes, mut render) = (shapes, None);
        // Depth sprites are not combined.
        if let Some((of, drawn, has_shape)) = occluded && !shapes.iter().any(|s| s.any(&is_saved)) {
            (kind, render) = (LensKind::Occlusion, Some(drawn));
            shapes = occlusion::areas(of, if has_shape { shapes } else { vec![] });
        }
        Lens { name: String::new(), kind, enabled, color, placement, shapes, render, effects: used, content, body, sprite, border, keeps_shadows, section }
    }
}

prop_compose! {
    fn figures()(place in 0..6usize, title in prop::option::of(".{1,8}"), caption in prop::option::of("[a-z\n\"]{1,8}"),
        text_px in prop::option::of(6.0..=400.0f64)) -> Figure {
        let corner = |i: usize| LegendPlace::Corner(Corner::WORDS[i].1);
        let legend = if place < 2 { [LegendPlace::None, LegendPlace::Auto][place] } else { corner(place - 2) };
        Figure { legend, title, caption, text_px, ..Figure::default() }
    }
}

prop_compose! {
    fn changes()(path in "[a-z.\"]{1,9}", is_place in any::<bool>(), constant in any::<bool>(), steps in prop::collection::vec((0.01..9.0f64, point()), 1..4)) -> Change {
        let mut at = 0.0;
        let key = |(step, p): (f64, DVec3)| {
            at += step;
            let place = Numbers::List(p.to_array().map(Numbers::One).to_vec());
            ChangeKey { at, value: if is_place { place } else { Numbers::List(vec![place, Numbers::One(p.x)]) } }
        };
        let keys = steps.into_iter().map(key).collect();
        let speed = if constant && is_place { Speed::Constant } else { Speed::Keys };
        Change { path: format!("lens.{path}.{}", if is_place { "center" } else { "points" }), speed, is_place, keys }
    }
}

prop_compose! {
    /// Its camera's keys are of the projection of `camera`.
    fn animations()(frames in 1..1_000_000u32, fps in 0.01..1000.0f64, constant in any::<bool>(),
        changes in prop::collection::vec(changes(), 0..3), keys in prop::collection::vec((0.01..9.0f64, point(), point(), 1..1790u32), 0..4)) -> (Animation, Vec<u32>) {
        let (mut at, mut tenths) = (0.0, Vec::new());
        let mut camera: Vec<CameraKey> = Vec::new();
        for (step, eye, target, tenth) in keys {
            at += step;
            camera.push(CameraKey { at, eye, target, up: DVec3::new(0.0, 0.5, 2.0), projection: Projection::Orthographic { height_m: 1.0 } });
            tenths.push(tenth);
        }
        let speed = if constant { Speed::Constant } else { Speed::Keys };
        (Animation { frames, fps, speed, camera, changes }, tenths)
    }
}

fn transparencies() -> impl Strategy<Value = Transparency> {
    prop_oneof![
        prop::sample::select(&Transparency::WORDS[..]).prop_map(|word| Transparency::of(word, None).unwrap().unwrap()),
        (0..=MOST_PEELED).prop_map(|layers| Transparency::Peel { layers }),
        prop::sample::select(&SLOTS[..]).prop_map(|layers| Transparency::KBuffer { layers }),
    ]
}

prop_compose! {
    fn scenes()(eye in point(), target in point(), ortho in any::<bool>(), tenths in 1..1790u32, with_camera in any::<bool>(),
        near_m in 1e-3..10.0f64, sun in (-3600..3600i32, -900..900i32, any::<bool>()), clay in any::<bool>(),
        background in prop::option::of(prop::array::uniform3(0.0..=1.0f32)), poi in prop::collection::vec((".{1,6}", point(), any::<bool>()), 0..3),
        mut lenses in prop::collection::vec(lenses(), 0..4), size in prop::array::uniform2(1..=16_384u32), samples in 1..=1024u32,
        figure in figures(), lod in prop::option::of(0..99u8), technique in prop::sample::select(&Technique::ALL[..]), transparency in transparencies(), ground in any::<bool>(), files in prop::collection::vec("[ -~äß]{1,9}", 0..3),
        animation in prop::option::of(animations())) -> Scene {
        let projection_of = |tenths: u32, ortho: bool| match ortho {
            true => Projection::Orthographic { height_m: f64::from(tenths) },
            false => Projection::Perspective { fov_y: (f64::from(tenths) / 10.0).to_radians() },
        };
        let projection = projection_of(tenths, ortho);
        let animation = animation.map(|(mut animation, tenths)| {
            for (key, tenths) in animation.camera.iter_mut().zip(tenths) {
                key.projection = projection_of(tenths, ortho && with_camera);
            }
            animation
        });
        let up = if clay { DVec3::Z } else { target };
        for (i, lens) in lenses.iter_mut().enumerate() {
            lens.name = format!("n\"{i}\\ü");
        }
        let mut scene = Scene {
            camera: with_camera.then_some(Camera { eye, target, up, projection, near_m }),
            sun: Sun { azimuth: (f64::from(sun.0) / 10.0).to_radians(), elevation: (f64::from(sun.1) / 10.0).to_radians(), shadows: sun.2 },
            style: Style { base: if clay { BaseStyle::Clay } else { BaseStyle::Natural }, effects: vec![], background: background.map_or(Background::Sky, Background::Color), technique, transparency },
            pois: poi.into_iter().enumerate().map(|(i, (text, at, o))| Poi { name: format!("p{i}"), place: if o { PoiPlace::Object(text) } else { PoiPlace::At(at) } }).collect(),
            lenses,
            figure: Figure { size, samples, ..figure },
            animation,
            ..Scene::default()
        };
        scene.city.files = files.into_iter().filter(|f| !f.contains("${")).map(Into::into).collect();
        scene.city.lod = lod.map(|tenths| crate::city::Lod { tenths }.to_string());
        scene.city.ground = ground;
        scene
    }
}

/// Rotations agree within a rounding, all else to the bit.
fn same(a: &Scene, b: &Scene) -> bool {
    let mut b = b.clone();
    for (la, lb) in a.lenses.iter().zip(&mut b.lenses) {
        la.shapes.iter().zip(&mut lb.shapes).for_each(|(sa, sb)| turn_alike(sa, sb));
        let copied = |lens: &Lens| lens.content.as_ref().and_then(|c| c.copied);
        if let (Some(a), Some(b)) = (copied(la), lb.content.as_mut().and_then(|c| c.copied.as_mut()))
            && a.rotation.dot(b.rotation).abs() > 1.0 - 1e-12
        {
            b.rotation = a.rotation;
        }
    }
    *a == b
}

/// Gives `b` the rotations of `a` where they agree within a rounding.
fn turn_alike(a: &Focus, b: &mut Focus) {
    let turns = match (a, b) {
        (Focus::Combined { parts: a, .. }, Focus::Combined { parts: b, .. })
        | (Focus::Enclosed { parts: a, .. }, Focus::Enclosed { parts: b, .. }) => {
            a.iter().zip(b).for_each(|(a, b)| turn_alike(a, b));
            None
        }
        (Focus::Shape(Shape::Box { rotation: ra, .. }), Focus::Shape(Shape::Box { rotation: rb, .. }))
        | (Focus::Shape(Shape::Ellipsoid { rotation: ra, .. }), Focus::Shape(Shape::Ellipsoid { rotation: rb, .. }))
        | (Focus::Shape(Shape::Flat { rotation: ra, .. }), Focus::Shape(Shape::Flat { rotation: rb, .. }))
        | (Focus::Mesh { rotation: ra, .. }, Focus::Mesh { rotation: rb, .. }) => Some((ra, rb)),
        _ => None,
    };
    if let Some((ra, rb)) = turns.filter(|(ra, rb)| ra.dot(**rb).abs() > 1.0 - 1e-12) {
        *rb = *ra;
    }
}

proptest! {
    #[test]
    fn what_is_written_is_read_back(scene in scenes()) {
        let text = to_toml(&scene);
        let back = read_text(&text).map_err(|e| TestCaseError::fail(format!("{e}\n{text}")))?;
        prop_assert!(same(&scene, &back), "{text}\n{scene:?}\n{back:?}");
        prop_assert_eq!(to_toml(&back), text, "writing again changes nothing");
    }

    #[test]
    fn no_text_makes_it_crash(text in "[a-z\\[\\]{}=\", .0-9\n]{0,200}") {
        let _ = read_text(&text);
        let _ = read_text(&format!("veduta = 1\n[[lens]]\n{text}"));
    }
}
