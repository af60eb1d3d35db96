//! What occlusion lenses have in scene files: points of interest, a test, choices, a rendering; read and written.

use std::fmt::Write as _;

use glam::DVec3;

use crate::{
    figure::scene_file::{
        check::{Checker, Fields, Place},
        focus::{self, Reader},
        node::{Data, Node},
        test_keys::{CHOICE, TESTS},
        write::{list, number, point, quoted},
    },
    geom::combination::Operation,
    lens::{Focus, Lens, Occluders, chosen::Choice, nearest::did_you_mean},
    visibility::{Margin, Pace, Reference, Test},
};

/// The keys that only occlusion lenses have.
pub(super) const OWN: [&str; 8] = ["poi", "test", "force", "forbid", "margin", "fade", "render", "poi_effects"];

/// Whom a lens looks for.
pub(super) fn read(reader: &mut Reader, fields: &Fields) -> Occluders {
    let pois = fields.node("poi").map(texts).unwrap_or_default();
    let listed = fields.node("poi").and_then(Node::list).unwrap_or_default();
    for (i, node) in listed.iter().enumerate() {
        if let Some(first) = listed[..i].iter().position(|earlier| earlier.text() == node.text()) {
            let message = format!("{} stands in the list already, as poi.{first}; once is enough", node.quoted());
            reader.checker.note(&fields.place, &format!("poi.{i}"), node.line, message);
        }
    }
    let test = match fields.node("test") {
        None => Some(Test::default()),
        Some(node) => read_test(reader.checker, node, &fields.place.within("test", node.line)),
    };
    let needs_poi = test.as_ref().is_some_and(Test::needs_poi);
    if needs_poi && pois.is_empty() && !(fields.given("poi") && fields.node("poi").is_none()) {
        let message = "is missing: the test asks what hides a point of interest. For example poi = \"hall\", the name of a [[poi]]";
        reader.checker.note(&fields.place, "poi", fields.line("poi"), message);
    }
    let mut choice = |key: &'static str| {
        let node = fields.node(key)?;
        let own = reader.checker.fields(node, &CHOICE, &[], fields.place.within(key, node.line));
        reader.choice(&own)
    };
    let (force, forbid) = (choice("force"), choice("forbid"));
    let margin = fields.number("margin").map_or_else(Margin::default, |metres| Margin { metres });
    let pace = fields.number("fade").map_or_else(Pace::default, |fade_s| Pace { fade_s });
    Occluders { pois, test: test.unwrap_or_default(), force, forbid, margin, pace }
}

/// The focus areas of an occlusion lens of these shapes: its occluders, or what of them is in the shapes.
pub(super) fn areas(of: Occluders, shapes: Vec<Focus>) -> Vec<Focus> {
    if shapes.is_empty() {
        return vec![Focus::Occluders(of)];
    }
    let within =
        |shape| Focus::Combined { how: Operation::Intersection, parts: vec![Focus::Occluders(of.clone()), shape] };
    shapes.into_iter().map(within).collect()
}

pub(super) fn texts(node: &Node) -> Vec<String> {
    let all = node.list().unwrap_or(std::slice::from_ref(node));
    all.iter().filter_map(|n| n.text().map(str::to_owned)).collect()
}

/// A test; `None` where something is wrong (and noted).
fn read_test(checker: &mut Checker, node: &Node, place: &Place) -> Option<Test> {
    let Data::Table(entries) = &node.data else {
        checker.note(place, "", node.line, format!("must be a table {{ kind = ..., ... }}, is {}", node.quoted()));
        return None;
    };
    let find = |name: &str| entries.iter().find(|(k, ..)| k == name).map(|(.., n)| n);
    let joints = ["any", "all", "not"];
    let kinds = || TESTS.iter().map(|t| t.name).filter(|name| !joints.contains(name));
    let table = match (joints.iter().find(|name| find(name).is_some()), find("kind")) {
        (Some(name), _) => TESTS.iter().find(|t| t.name == *name),
        (None, Some(kind)) => TESTS.iter().find(|t| kind.text() == Some(t.name) && !joints.contains(&t.name)),
        (None, None) => None,
    };
    let Some(table) = table else {
        let all = kinds().collect::<Vec<_>>().join(", ");
        let (line, message) = match find("kind") {
            None => {
                let mut hints = entries.iter().map(|(name, ..)| did_you_mean(name, joints.into_iter().chain(["kind"])));
                let hint = hints.find(|hint| !hint.is_empty()).unwrap_or_default();
                (
                    node.line,
                    format!(
                        "is missing: one of {all}, or a table {{ any = [...] }}, {{ all = [...] }} or {{ not = ... }}{hint}"
                    ),
                )
            }
            Some(n) => {
                let hint = did_you_mean(n.text().unwrap_or_default(), kinds());
                (n.line, format!("must be one of {all}, is {}{hint}", n.quoted()))
            }
        };
        checker.note(place, "kind", line, message);
        return None;
    };
    let fields = checker.fields(node, table, &[], place.clone());
    let up = || unit(fields.point("up").unwrap_or(DVec3::Z));
    let reference = || fields.text("reference").and_then(Reference::of_word).unwrap_or_default();
    let mut parts = |key: &str| -> Option<Vec<Test>> {
        let nodes = fields.node(key).and_then(Node::list)?;
        let part = |(i, node): (usize, &Node)| {
            read_test(checker, node, &fields.place.within(&format!("{key}.{i}"), node.line))
        };
        let read: Vec<Option<Test>> = nodes.iter().enumerate().map(part).collect();
        read.into_iter().collect()
    };
    Some(match table.name {
        "exact" => Test::Exact {
            coverage: fields.number("coverage").unwrap_or(0.0),
            rays: fields.integer("rays").unwrap_or(Test::RAYS),
        },
        "view-axis" => Test::ViewAxis,
        "spherical" => Test::Spherical { radius: fields.number("radius")?, reference: reference() },
        "cylindrical" => Test::Cylindrical { radius: fields.number("radius")?, up: up()? },
        "viewer-height" => Test::ViewerHeight { radius: fields.number("radius")?, reference: reference(), up: up()? },
        "ground" => Test::Ground { radius: fields.number("radius")? },
        "route" => {
            let points = fields.node("points").and_then(Node::list)?;
            Test::Route { points: points.iter().filter_map(|p| p.numbers::<3>().map(DVec3::from)).collect() }
        }
        "any" => Test::Any(parts("any")?),
        "all" => Test::All(parts("all")?),
        _ => {
            let inner = fields.node("not")?;
            Test::Not(Box::new(read_test(checker, inner, &fields.place.within("not", inner.line))?))
        }
    })
}

/// A unit vector; one that is one stays as it is, to the bit.
fn unit(v: DVec3) -> Option<DVec3> {
    if (v.length_squared() - 1.0).abs() < 1e-15 { Some(v) } else { v.try_normalize() }
}

/// The keys of a lens that looks for occluders, but for its rendering.
pub(super) fn written(lens: &Lens) -> Vec<(&'static str, String)> {
    lens.shapes.first().and_then(Focus::occluders).map_or_else(Vec::new, occluders_written)
}

/// The keys of whom to look for.
pub(super) fn occluders_written(of: &Occluders) -> Vec<(&'static str, String)> {
    let mut keys = Vec::new();
    match &of.pois[..] {
        [] => {}
        [one] => keys.push(("poi", quoted(one))),
        many => keys.push(("poi", list(many.iter().map(|name| quoted(name))))),
    }
    // The default too: `--set` changes a part of it.
    keys.push(("test", test_written(&of.test)));
    let choice = |choice: &Choice| focus::choice_written("", choice);
    keys.extend(of.force.as_ref().map(|c| ("force", choice(c))));
    keys.extend(of.forbid.as_ref().map(|c| ("forbid", choice(c))));
    keys.extend((of.margin != Margin::default()).then(|| ("margin", number(of.margin.metres))));
    keys.extend((of.pace != Pace::default()).then(|| ("fade", number(of.pace.fade_s))));
    keys
}

fn test_written(test: &Test) -> String {
    let all = |parts: &[Test]| list(parts.iter().map(test_written));
    let mut out = match test {
        Test::Any(parts) => return format!("{{ any = {} }}", all(parts)),
        Test::All(parts) => return format!("{{ all = {} }}", all(parts)),
        Test::Not(part) => return format!("{{ not = {} }}", test_written(part)),
        one => format!("{{ kind = \"{}\"", one.word()),
    };
    let near = |radius: f64, reference: Reference| match reference {
        Reference::Centre => format!(", radius = {}", number(radius)),
        other => format!(", radius = {}, reference = \"{}\"", number(radius), other.word()),
    };
    let tilted = |up: DVec3| if up == DVec3::Z { String::new() } else { format!(", up = {}", point(up)) };
    match test {
        Test::Spherical { radius, reference } => out += &near(*radius, *reference),
        Test::Cylindrical { radius, up } => out += &(near(*radius, Reference::Centre) + &tilted(*up)),
        Test::ViewerHeight { radius, reference, up } => out += &(near(*radius, *reference) + &tilted(*up)),
        Test::Ground { radius } => out += &near(*radius, Reference::Centre),
        Test::Route { points } => {
            let _ = write!(out, ", points = {}", list(points.iter().map(|p| point(*p))));
        }
        Test::Exact { coverage, rays } => {
            if *coverage != 0.0 {
                let _ = write!(out, ", coverage = {}", number(*coverage));
            }
            if *rays != Test::RAYS {
                let _ = write!(out, ", rays = {rays}");
            }
        }
        Test::ViewAxis | Test::Any(_) | Test::All(_) | Test::Not(_) => {}
    }
    out + " }"
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        figure::scene_file::{Options, parse},
        lens::{LensKind, Rendering},
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
        assert_eq!((plain.kind, &plain.shapes[..]), (LensKind::Occlusion, &[Focus::Occluders(of.clone())][..]));
        assert_eq!(plain.render, Some(Rendering::default()));
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
            |lens: &Lens| written(lens).into_iter().filter(|(key, _)| ["margin", "fade"].contains(key)).collect();
        let [none, both]: [Vec<_>; 2] = [&plain, &other].map(keys);
        assert_eq!(none, []);
        assert_eq!(both, [("margin", "0.0".to_owned()), ("fade", "2.5".to_owned())]);
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
