use glam::{DQuat, DVec3};

use super::*;
use crate::{
    geom::Shape,
    lens::Region,
    scene::{Poi, PoiPlace},
    view::Projection,
};

const MINIMAL: &str = "veduta = 1\n";

pub(super) fn read_text(text: &str) -> Result<Scene, String> {
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
        (
            "veduta = 1\n[time]\nat = 3\n",
            "[time] at: must be a time: \"1890\", \"1890-05-03\" or \"1890-05-03T14:00\", is 3",
        ),
        (
            "veduta = 1\n[time]\nat = \"1890-13\"\n",
            "[time] at: \"1890-13\" is no time; a year, a date or a date-time as in",
        ),
        ("veduta = 1\n[time]\nat = \"../1890\"\n", "[time] at: \"../1890\" has no beginning"),
        (
            "veduta = 1\n[city]\nundated = \"gone\"\n",
            "[city] undated: must be \"show\" or \"hide\" or \"ghost\", is \"gone\"",
        ),
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
        ("veduta = 1\n[figure]\ndpi = 9", "[figure] dpi: must be a number 10 to 2400, is 9"),
        (
            "veduta = 1\n[figure]\ntext_px = 16\ntext_pt = 9",
            "s.toml:4: [figure] text_pt: is given together with text_px: one of them would be right",
        ),
        (
            "veduta = 1\n[figure]\ntext_pt = 72\ndpi = 600",
            "s.toml:3: [figure] text_pt: 72 points at 600 dpi are 600 pixels; 6 to 400 pixels would be right",
        ),
        ("veduta = 1\n[figure]\ntext_pt = 4", "text_pt: 4 points at 96 dpi are 5.33 pixels; 6 to 400"),
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
            "shape.kind: must be one of sphere, ellipsoid, box, cylinder, cone, frustum, convex, polytope, corridor, flat, mesh, mask, mask3d, sprite, magnified, objects, thematic, enclosed, union, intersection, difference, is \"shpere\"; did you mean \"sphere\"?",
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
        (
            "shape = { kind = \"objects\" }",
            "shape.ids: is missing: give ids = [\"ID\", ...], types = [\"TYPE\", ...], where = \"EXPRESSION\" or attribute = \"NAME\"",
        ),
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
            "kind = \"time\"",
            "s.toml:2: [lens.0] time: is missing: which moment shows in the lens. For example time = [{ op = \"set\", at = \"1650\" }]",
        ),
        (
            "time = [{ op = \"sett\", at = \"1650\" }]",
            "s.toml:4: [lens.0] time.0.op: there is no handler \"sett\"; did you mean \"set\"?",
        ),
        (
            "time = [{ op = \"set\", at = \"1650\" }, { op = \"shift\", by = \"10\" }]",
            "s.toml:4: [lens.0] time.1.by: \"10\" is no span of time",
        ),
        ("time = []", "s.toml:4: [lens.0] time: must be a list of at least one step { op = ..., ... }, is []"),
        ("time = [{ at = \"1650\" }]", "s.toml:4: [lens.0] time.0.op: is missing: which operator"),
        (
            "time = [{ op = \"loop\", begin = \"1900\", end = \"1800\" }]",
            "s.toml:4: [lens.0] time.0: end must be later than begin = 1900, is 1800",
        ),
        (
            "ray = {}",
            "s.toml:4: [lens.0] ray: has a meaning only for a lens of kind = \"magnifier\", \"feature\", \"sampling\", \"fisheye\" or \"ray\"",
        ),
        (
            "kind = \"magnifier\"",
            "s.toml:3: [lens.0] shape: has no meaning for a lens of kind = \"magnifier\": ray says where it is",
        ),
        ("kind = \"deformation\"", "[lens.0] deform: is missing: what the lens does with space; for example deform ="),
        (
            "kind = \"deformation\"\ndeform = [{ kind = \"twsit\", angle_deg = 3 }]",
            "[lens.0] deform.0.kind: must be one of translate, scale, shear, taper, twist, bend, open-street, heights, lower, panorama, is \"twsit\"; did you mean \"twist\"?",
        ),
        (
            "kind = \"deformation\"\ndeform = [{ kind = \"scale\", factors = [1, 0, 1] }]",
            "[lens.0] deform.0.factors: must be three numbers from 0.01 to 100, is [1.0, 0.0, 1.0]",
        ),
        (
            "kind = \"deformation\"\ndeform = [{ kind = \"panorama\", near = 9, far = 5, angle_deg = 30 }]",
            "[lens.0] deform.0.far: must be above near, 9, is 5",
        ),
        (
            "kind = \"deformation\"\ndeform = [{ kind = \"twist\", angle_deg = 3 }]\ncontrol = { image = \"k.png\", profile = \"bump\" }",
            "[lens.0] control.image: is given together with profile: a control is one of them",
        ),
        (
            "kind = \"deformation\"\ndeform = [{ kind = \"heights\", attribute = \"a\", from = [9, 5], to = [1, 2] }]",
            "[lens.0] deform.0.from: must be two numbers, ascending, is [9.0, 5.0]",
        ),
        (
            "kind = \"deformation\"\ndeform = [{ kind = \"heights\", attribute = \"a\", from = [5, 9], to = [0, 2] }]",
            "[lens.0] deform.0.to: must be two numbers from 0.01 to 100, is [0.0, 2.0]",
        ),
        (
            "kind = \"deformation\"\ndeform = [{ kind = \"lower\" }]",
            "[lens.0] deform.0.poi: is missing: the test asks what hides a point of interest",
        ),
        (
            "kind = \"deformation\"\ndeform = [{ kind = \"heights\", attribute = \"a\", from = [5, 9], to = [1, 2] }, { kind = \"twist\", angle_deg = 3 }]",
            "[lens.0] deform: heights and lower are about city objects: their lens has no shape, and no other kinds of steps",
        ),
        ("strength = 0.5", "[lens.0] strength: has a meaning only for a lens of kind = \"deformation\""),
        (
            "kind = \"deformation\"\ndeform = []",
            "[lens.0] deform: must be a list of at least one step { kind = ..., ... }, is []",
        ),
        (
            "kind = \"colour\"",
            "[lens.0] kind: must be \"color\" or \"content\" or \"occlusion\" or \"deformation\" or \"time\" or \"magnifier\" or \"feature\" or \"sampling\" or \"fisheye\" or \"ray\" or \"annotation\" or \"best-view\" or \"map-view\" or \"worldlet\" or \"see-through\" or \"portal\", is \"colour\"; did you mean \"color\"?",
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
        ("space = \"west\"", "space: must be \"displayed\" or \"rest\", is \"west\"; did you mean \"rest\"?"),
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
fn every_mistake_in_a_lens_that_bends_rays_is_named() {
    let of =
        |kind: &str, ray: &str| read_text(&lens_text(&format!("kind = \"{kind}\"\nray = {{ {ray} }}"))).map(|_| ());
    for (kind, ray, expected) in [
        ("magnifier", "magnification = 0", "ray.magnification: must be a number 0.1 to 1000, is 0"),
        ("magnifier", "border = 1.5", "ray.border: must be a number 0 to 1, is 1.5"),
        ("magnifier", "center = [0.5, 2]", "ray.center: must be"),
        ("magnifier", "distance = 0", "ray.distance: must be a number ≥ 0.001, is 0"),
        ("magnifier", "fineness = 9", "ray.fineness: must be a number 0.1 to 8, is 9"),
        ("magnifier", "method = \"image\", only = { ids = [\"a\"] }", "ray.only: goes with method = \"rays\" alone"),
        (
            "feature",
            "of = { ids = [\"a\"] }, only = { ids = [\"a\"] }",
            "ray.only: has a meaning only for a lens of kind",
        ),
        ("magnifier", "method = \"warp\"", "ray.method: must be \"rays\" or \"image\" or \"vertices\", is \"warp\""),
        ("magnifier", "angle_deg = 90", "ray.angle_deg: has a meaning only for a lens of kind = \"fisheye\""),
        (
            "fisheye",
            "magnification = 2",
            "ray.magnification: has a meaning only for a lens of kind = \"magnifier\" or \"feature\" or \"sampling\"",
        ),
        ("sampling", "at = 20", "ray.at: has a meaning only for a lens of kind = \"magnifier\" or \"feature\""),
        ("sampling", "rate = [[0, 1], [0.5, 2]]", "ray.rate: must go from 0 to 1, ascending"),
        ("sampling", "rate = [[0, 1], [0.5, 0], [1, 1]]", "ray.rate: has a rate of 0; 0.01 to 1000 would be right"),
        ("sampling", "magnification = 2, rate = [[0, 1], [1, 2]]", "ray.rate: is given together with magnification"),
        ("fisheye", "angle_deg = 200, projection = \"hemispherical\"", "ray.angle_deg: must be 180 at most"),
        ("feature", "magnification = 3", "ray.of: is missing: what the lens magnifies"),
        ("feature", "of = { ids = [\"a\"] }, center = [0.2, 0.2]", "ray.center: has a meaning only for a lens of kind"),
        ("magnifier", "of = { ids = [\"a\"] }", "ray.of: has a meaning only for a lens of kind = \"feature\""),
        ("fisheye", "mask = \"a.png\"", "ray.mask: has a meaning only for a lens of kind = \"magnifier\""),
        ("magnifier", "mask = \"a.png\", outline = \"square\"", "ray.mask: is given together with outline"),
        ("magnifier", "radious = 2", "ray.radious: unknown key; did you mean \"radius\"?"),
    ] {
        let message = of(kind, ray).unwrap_err();
        assert!(message.contains(expected), "{kind} {ray}\n  gave     {message}\n  expected {expected}");
    }
    assert_eq!(of("magnifier", "magnification = 4, at = 30, distance = 20, border = 0"), Ok(()));
    assert_eq!(of("sampling", "rate = [[0, 4], [1, 1]]"), Ok(()));
    assert_eq!(of("fisheye", "angle_deg = 360"), Ok(()));
    assert_eq!(of("magnifier", "mask = \"a.png\""), Ok(()));
    let text = lens_text("kind = \"magnifier\"\nray = { mask = \"a.png\" }\neffects = [\"sepia\"]");
    let message = read_text(&text).map(|_| ()).unwrap_err();
    assert!(
        message.contains("effects: has no meaning for a lens that bends rays in an outline of its own"),
        "{message}"
    );
}

#[test]
fn of_a_lens_of_a_wrong_kind_only_that_is_told() {
    let rest = "poi = \"hall\"\ntest = { kind = \"spherical\", radius = 9 }\nrender = \"x-ray\"\npoi_effects = [\"gooch\"]\nmagnification = 3\nmargin = -1";
    let message = read_text(&lens_text(&format!("{rest}\nkind = \"occlusionn\""))).unwrap_err();
    let expected = "must be \"color\" or \"content\" or \"occlusion\" or \"deformation\" or \"time\" or \"magnifier\" or \"feature\" or \"sampling\" or \"fisheye\" or \"ray\" or \"annotation\" or \"best-view\" or \"map-view\" or \"worldlet\" or \"see-through\" or \"portal\", is \"occlusionn\"; did you mean \"occlusion\"?";
    assert_eq!(message, format!("s.toml:9: [lens.0] kind: {expected}"));
    // What is no table has no kind.
    for (lens, quoted) in [("3", "3"), ("[1, 2]", "[1, 2]"), ("\"color\"", "\"color\"")] {
        let message = read_text(&format!("veduta = 1\nlens = [{lens}]")).unwrap_err();
        assert_eq!(message, format!("s.toml:2: [lens.0] must be a table, is {quoted}"));
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
    assert!(message.lines().count() == problems::MAX_SHOWN + 1 && message.ends_with("... and 80 more"));
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
    let Region::Shape(shape) = &scene.lenses[0].shapes[0] else { panic!("a sphere") };
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
