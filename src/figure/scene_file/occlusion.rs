//! What occlusion lenses have in scene files: points of interest, a test, choices, a rendering; read and written.

use crate::{
    figure::scene_file::{
        check::Fields,
        choice::{self, CHOICE},
        forms::{Form as _, Names},
        node::{Data, Node},
        paths::Options,
        reader::Reader,
        test_keys::{self, test_data},
    },
    geom::combination::Operation,
    lens::{Occluders, Region, chosen::Choice},
    visibility::{Margin, Pace, Test},
};

/// The keys that only occlusion lenses have.
pub const OWN: [&str; 8] = ["poi", "test", "force", "forbid", "margin", "fade", "render", "poi_effects"];

/// Whom a lens looks for.
pub fn read(reader: &mut Reader, fields: &Fields) -> Occluders {
    let pois = fields.node("poi").map(Node::names).unwrap_or_default();
    let listed = fields.node("poi").and_then(Node::list).unwrap_or_default();
    for (i, node) in listed.iter().enumerate() {
        if let Some(first) = listed[..i].iter().position(|earlier| earlier.text() == node.text()) {
            let message = format!("{} stands in the list already, as poi.{first}; once is enough", node.quoted());
            reader.checker.note(&fields.place, &format!("poi.{i}"), node.line, message);
        }
    }
    let test = match fields.node("test") {
        None => Some(Test::default()),
        Some(node) => test_keys::read(reader, node, &fields.place.within("test", node.line)),
    };
    let needs_poi = test.as_ref().is_some_and(Test::needs_poi);
    if needs_poi && pois.is_empty() && !(fields.given("poi") && fields.node("poi").is_none()) {
        let message = "is missing: the test asks what hides a point of interest. For example poi = \"hall\", the name of a [[poi]]";
        reader.checker.note(&fields.place, "poi", fields.line("poi"), message);
    }
    let mut chosen = |key: &'static str| {
        let node = fields.node(key)?;
        let own = reader.checker.fields(node, &CHOICE, &[], fields.place.within(key, node.line));
        Some(choice::read(reader, &own))
    };
    let (force, forbid) = (chosen("force"), chosen("forbid"));
    let margin = fields.number("margin").map_or_else(Margin::default, |metres| Margin { metres });
    let pace = fields.number("fade").map_or_else(Pace::default, |fade_s| Pace { fade_s });
    Occluders { pois, test: test.unwrap_or_default(), force, forbid, margin, pace }
}

/// The focus areas of an occlusion lens of these shapes: its occluders, or what of them is in the shapes.
pub fn areas(of: Occluders, shapes: Vec<Region>) -> Vec<Region> {
    if shapes.is_empty() {
        return vec![Region::Occluders(of)];
    }
    let within =
        |shape| Region::Combined { how: Operation::Intersection, parts: vec![Region::Occluders(of.clone()), shape] };
    shapes.into_iter().map(within).collect()
}

/// One of the keys of whom to look for.
pub fn written(of: &Occluders, key: &str, options: &Options) -> Option<Data> {
    let choice = |choice: &Choice| choice::written(choice, options);
    match key {
        "poi" if of.pois.is_empty() => None,
        "poi" => Names::data(&of.pois),
        // The default too: `--set` changes a part of it.
        "test" => Some(test_data(&of.test)),
        "force" => of.force.as_ref().map(choice),
        "forbid" => of.forbid.as_ref().map(choice),
        "margin" => (of.margin != Margin::default()).then(|| of.margin.metres.into()),
        "fade" => (of.pace != Pace::default()).then(|| of.pace.fade_s.into()),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        figure::scene_file::parse,
        lens::{Lens, Rendering},
    };

    fn lens(lines: &str) -> Result<Lens, String> {
        let text = format!("veduta = 1\n[[lens]]\nkind = \"occlusion\"\n{lines}\n");
        let scene = parse(&text, "s", &Options::for_command_line()).map_err(|e| e.to_string())?;
        Ok(scene.lenses[0].clone())
    }

    #[test]
    fn little_is_needed() {
        let plain = lens("poi = \"hall\"").unwrap();
        let of = Occluders { pois: vec!["hall".into()], ..Occluders::default() };
        assert_eq!((plain.kind.word(), &plain.shapes[..]), ("occlusion", &[Region::Occluders(of.clone())][..]));
        assert_eq!(plain.rendering(), Some(&Rendering::default()));
        assert_eq!(plain.uses().map(|used| used.effect.as_str()).collect::<Vec<_>>(), ["eraser"]);
        let several = lens(
            "poi = [\"a\", \"b\"]\ntest = { not = { any = [{ kind = \"view-axis\" }, { kind = \"ground\", radius = 3 }] } }\nrender = [\"sepia\"]\neffects = [\"invert\"]",
        );
        let several = several.unwrap();
        let test = Test::Not(Box::new(Test::Any(vec![Test::ViewAxis, Test::Ground { radius: 3.0 }])));
        assert_eq!(several.occluders(), Some(&Occluders { pois: vec!["a".into(), "b".into()], test, ..of }));
        assert_eq!(several.uses().map(|used| used.effect.as_str()).collect::<Vec<_>>(), ["sepia", "invert"]);
        assert!(
            lens("test = { kind = \"spherical\", radius = 9 }").is_ok(),
            "who is near asks for no point of interest"
        );
    }

    #[test]
    fn what_they_have_over_time_is_read_and_written() {
        let plain = lens("poi = \"a\"").unwrap();
        let of = plain.occluders().unwrap();
        assert_eq!((of.margin, of.pace), (Margin { metres: 1.0 }, Pace { fade_s: 0.3 }));
        let other = lens("poi = \"a\"\nmargin = 0\nfade = 2.5\nshadows = true").unwrap();
        let of = other.occluders().unwrap();
        assert_eq!((of.margin, of.pace, other.keeps_shadows), (Margin { metres: 0.0 }, Pace { fade_s: 2.5 }, true));
        let keys =
            |lens: &Lens| ["margin", "fade"].map(|key| written(lens.occluders().unwrap(), key, &Options::default()));
        assert_eq!(keys(&plain), [None, None]);
        assert_eq!(keys(&other), [Some(Data::Number(0.0)), Some(Data::Number(2.5))]);
    }

    #[test]
    fn an_empty_rendering_is_right_where_the_lens_does_something_else() {
        for other in [
            "effects = [\"sepia\"]",
            "poi_effects = [\"gooch\"]",
            "body = \"outline\"",
            "content = { derive = \"box\" }",
        ] {
            let read = lens(&format!("poi = \"a\"\nrender = []\n{other}"));
            assert!(read.is_ok(), "{other}: {read:?}");
        }
    }

    #[test]
    fn mistakes_are_named_with_what_would_be_right() {
        for (lines, expected) in [
            ("", "[lens.0] poi: is missing: the test asks what hides a point of interest"),
            ("poi = []", "[lens.0] poi: must be a text that is not empty, or a list of at least one such text, is []"),
            (
                "poi = [\"b\", \"a\", \"b\"]",
                "s:4: [lens.0] poi.2: \"b\" stands in the list already, as poi.0; once is enough",
            ),
            (
                "poi = \"a\"\nrender = []",
                "s:5: [lens.0] render: is empty, and so nothing is drawn in another way; a word like \"x-ray\" or a list of effects like [\"sepia\"] would be right",
            ),
            ("poi = \"a\"\nrender = { effects = [] }", "s:5: [lens.0] render: is empty"),
            ("poi = \"a\"\nrender = []\nbody = \"none\"", "[lens.0] render: is empty"),
            (
                "poi = \"a\"\ntest = { kind = \"exakt\" }",
                "[lens.0] test.kind: must be one of exact, view-axis, spherical, cylindrical, viewer-height, ground, route, is \"exakt\"; did you mean \"exact\"?",
            ),
            ("poi = \"a\"\ntest = { any = [{ kind = \"spherical\" }] }", "[lens.0] test.any.0.radius: is missing"),
            (
                "poi = \"a\"\ntest = { kind = \"exact\", coverage = 1.5 }",
                "[lens.0] test.coverage: must be a number 0 to 1, is 1.5",
            ),
            ("poi = \"a\"\ntest = { kind = \"exact\", radius = 1.5 }", "[lens.0] test.radius: unknown key"),
            ("poi = \"a\"\ntest = { al = [] }", "did you mean \"all\"?"),
            ("poi = \"a\"\ntest = { all = [] }", "[lens.0] test.all: must be a list of at least one test, is []"),
            (
                "poi = \"a\"\ntest = { not = { kind = \"ground\", radius = -1 } }",
                "[lens.0] test.not.radius: must be a number ≥ 0, is -1",
            ),
            (
                "test = { kind = \"route\", points = [] }",
                "s:4: [lens.0] test.points: must be a list of at least 2 points [x, y, z], has none",
            ),
            (
                "test = { kind = \"route\", points = [[0, 0, 0]] }",
                "s:4: [lens.0] test.points: must be a list of at least 2 points [x, y, z], has 1",
            ),
            ("poi = \"a\"\nmargin = -1", "[lens.0] margin: must be a number 0 to 1000, is -1"),
            ("poi = \"a\"\nfade = 61", "[lens.0] fade: must be a number 0 to 60, is 61"),
            ("poi = \"a\"\nfade = \"slow\"", "[lens.0] fade: must be a number 0 to 60, is \"slow\""),
            ("poi = \"a\"\nshadows = 1", "[lens.0] shadows: must be true or false, is 1"),
            ("poi = \"a\"\nrender = \"discrad\"", "[lens.0] render: must be \"discard\""),
            ("poi = \"a\"\nrender = \"xray\"", "; did you mean \"x-ray\"?"),
            ("poi = \"a\"\nrender = \"cutaway\"", "; did you mean \"cut-away\"?"),
            ("poi = \"a\"\nrender = { as = \"xray\" }", "; did you mean \"x-ray\"?"),
            ("poi = \"a\"\nrender = \"discrad\"", "did you mean \"discard\"?"),
            (
                "poi = \"a\"\nrender = [\"sepai\"]",
                "[lens.0] render.0: there is no effect \"sepai\"; did you mean \"sepia\"?",
            ),
            (
                "poi = \"a\"\nrender = [\"gooch\"]\neffects = [\"cel\"]",
                "\"cel\" is a second scene style beside \"gooch\" of render",
            ),
            ("poi = \"a\"\nforce = {}", "[lens.0] force.ids: is missing"),
            (
                "poi = \"a\"\nforbid = { ids = [\"b\"], min = 3 }",
                "[lens.0] forbid.min: has a meaning only with attribute",
            ),
            (
                "poi = \"a\"\nshape = { kind = \"sprite\", file = \"a.exr\" }",
                "[lens.0] shape: a depth sprite cannot be combined with occluders",
            ),
        ] {
            let message = lens(lines).unwrap_err();
            assert!(message.contains(expected), "{lines}: {message}");
        }
        let other =
            "veduta = 1\n[[lens]]\nshape = { kind = \"sphere\", center = [0, 0, 0], radius = 1 }\nrender = \"discard\"";
        let message = parse(other, "s", &Options::for_command_line()).unwrap_err().to_string();
        assert!(
            message.contains("[lens.0] render: has a meaning only for a lens of kind = \"occlusion\""),
            "{message}"
        );
    }
}
