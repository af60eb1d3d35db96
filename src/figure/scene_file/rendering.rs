//! `render` and `poi_effects` of an occlusion lens in scene files: words with parameters, effects, and cases; read and written.

use std::sync::LazyLock;

use crate::{
    figure::scene_file::{
        check::{Fields, Place},
        choice::{self, CHOICE},
        effects::{self, without_sights},
        forms::{parameter, parameter_data},
        keys::{FAR_M, Key, Kind, Table, key},
        node::{Data, Node},
        paths::Options,
        reader::Reader,
        text::quoted,
    },
    lens::{
        EffectUse, Rendering,
        nearest::did_you_mean,
        rendering::{Case, Given, ROWS, Row, When},
    },
    shader::effect::{EffectKind, ParameterDefinition, ParameterKind, find as find_effect},
};

/// The key that says which word it is.
pub const AS: &str = "as";

const NEARER: Key = key(
    "nearer",
    Kind::Number { min: 0.0, max: FAR_M },
    "at any distance",
    "m",
    "Only occluders whose box (edges along x, y, z, parts included) comes nearer to the eye than this.",
    "150.0",
);
const TYPES: Key = key(
    "types",
    Kind::Texts,
    "any",
    "",
    "Only occluders of these types, as their files call them.",
    "[\"SolitaryVegetationObject\"]",
);
const WHERE: Key = key(
    "where",
    Kind::Table(&CHOICE),
    "all",
    "",
    "Only occluders that are chosen, or parts of them.",
    "{ attribute = \"measuredHeight\", min = 20.0 }",
);

/// A case by effects.
pub const BY_EFFECTS: Table = Table {
    name: "effects",
    doc: "Effects of your choice, in place of a word.",
    keys: &[
        key("effects", Kind::Effects, "", "", "As `effects` of a lens. At most one scene style.", "[\"sepia\"]"),
        NEARER,
        TYPES,
        WHERE,
    ],
};

/// The words, each with `as`, its parameters and its conditions.
pub static WORDS: LazyLock<Vec<Table>> = LazyLock::new(|| ROWS.iter().map(table_of).collect());

// Tables of keys are static, as all others are; there are as many as words, made once.
fn table_of(row: &'static Row) -> Table {
    let quoted_word: &'static str = Box::leak(quoted(row.word).into());
    let mut keys = vec![key(AS, Kind::Text, "", "", "Which word.", quoted_word)];
    keys.extend(row.parameters().into_iter().map(key_of));
    keys.extend([NEARER, TYPES, WHERE]);
    Table { name: row.word, doc: row.doc, keys: Vec::leak(keys) }
}

fn key_of(of: ParameterDefinition) -> Key {
    let leak = |text: String| -> &'static str { Box::leak(text.into()) };
    let kind = match &of.kind {
        ParameterKind::Boolean => Kind::Boolean,
        ParameterKind::Number { min, max } => Kind::Number { min: *min, max: *max },
        ParameterKind::Word(words) => {
            let words: Vec<&'static str> = words.iter().map(|word| leak(word.clone())).collect();
            Kind::Word { now: Vec::leak(words), later: &[] }
        }
        ParameterKind::Color => Kind::Color,
        ParameterKind::Vector => Kind::Point,
        ParameterKind::Text | ParameterKind::Texts | ParameterKind::Instants => Kind::Names,
        ParameterKind::Moment | ParameterKind::Span | ParameterKind::Unit | ParameterKind::Clock => Kind::Text,
        ParameterKind::Numbers | ParameterKind::Weights => Kind::Numbers,
        ParameterKind::Shares => Kind::Shares,
        ParameterKind::Colors => Kind::Colors,
    };
    let default = leak(of.default_text());
    let (name, unit, doc) = (leak(of.name), leak(of.unit), leak(of.doc));
    Key { name, kind, default, unit, doc, example: default }
}

/// Whether the elements of `render` are cases, not effects.
fn has_cases(nodes: &[Node]) -> bool {
    let is_case = |node: &Node| {
        let Data::Table(entries) = &node.data else { return false };
        let has = |name: &str| entries.iter().any(|(key, ..)| key == name);
        !has("effect") && [AS, "effects", NEARER.name, TYPES.name, WHERE.name].into_iter().any(has)
    };
    nodes.iter().any(is_case)
}

/// Whether `render` has no effects at all: an empty list, or cases that have none.
fn is_empty(node: &Node) -> bool {
    let is_empty_case = |node: &Node| {
        let Data::Table(entries) = &node.data else { return false };
        let find = |name: &str| entries.iter().find(|(key, ..)| key == name).map(|(.., node)| node);
        find(AS).is_none() && find("effects").and_then(Node::list).is_some_and(<[Node]>::is_empty)
    };
    node.list().map_or_else(|| is_empty_case(node), |nodes| nodes.iter().all(is_empty_case))
}

/// Whether an occlusion lens does something besides its `render`.
fn does_more(fields: &Fields) -> bool {
    let is_filled =
        |key: &&str| fields.given(key) && !fields.node(key).and_then(Node::list).is_some_and(<[Node]>::is_empty);
    let has_body = fields.given("body") && fields.text("body") != Some("none");
    has_body || ["effects", "poi_effects", "content"].iter().any(is_filled)
}

/// How an occlusion lens with these effects draws occluders and points of interest.
pub fn read(reader: &mut Reader, fields: &Fields, effects: &[EffectUse]) -> Rendering {
    let cases = match fields.node("render") {
        None => Rendering::default().cases,
        Some(node) => match (&node.data, node.text().and_then(Row::of_word)) {
            (_, Some(row)) => vec![Case::of_row(row, Given::new())],
            (Data::Table(_), _) => case(reader, node, &fields.place.within("render", node.line)).into_iter().collect(),
            (Data::List(nodes), _) if has_cases(nodes) => {
                let mut cases = Vec::new();
                let mut is_all = false;
                for (i, node) in nodes.iter().enumerate() {
                    let (key, noted) = (format!("render.{i}"), reader.checker.problems.len());
                    let case = case(reader, node, &fields.place.within(&key, node.line));
                    // Where something is wrong in a case, whom it is for is not known.
                    let is_known = reader.checker.problems.len() == noted;
                    let holds = is_known && case.as_ref().is_some_and(|case| case.when.is_always());
                    if holds && !is_all && i + 1 < nodes.len() {
                        is_all = true;
                        let message = "holds of all occluders: none is left for the cases after it; it would be right as the last";
                        reader.checker.note(&fields.place, &key, node.line, message);
                    }
                    cases.extend(case);
                }
                cases
            }
            _ => vec![Case::of_effects(own_effects(reader, fields, "render"))],
        },
    };
    if let Some(node) = fields.node("render").filter(|node| is_empty(node) && !does_more(fields)) {
        let message = "is empty, and so nothing is drawn in another way; a word like \"x-ray\" or a list of effects like [\"sepia\"] would be right";
        reader.checker.note(&fields.place, "render", node.line, message);
    }
    let scene_style = |used: &&EffectUse| find_effect(&used.effect).is_some_and(|e| e.kind == EffectKind::Scene);
    let first = cases.iter().find_map(|case| case.effects.iter().find(scene_style));
    if let (Some(first), Some(second)) = (first, effects.iter().find(scene_style)) {
        let message = format!(
            "\"{}\" is a second scene style beside \"{}\" of render; only one is possible",
            second.effect, first.effect
        );
        reader.checker.note(&fields.place, "effects", fields.line("effects"), message);
    }
    let poi_effects = own_effects(reader, fields, "poi_effects");
    without_sights(reader, fields, "poi_effects", &poi_effects);
    if !fields.given("poi") {
        for case in &cases {
            without_sights(reader, fields, "render", &case.effects);
        }
        without_sights(reader, fields, "effects", effects);
        if !poi_effects.is_empty() {
            let message = "has a meaning only with poi: they are drawn so";
            reader.checker.note(&fields.place, "poi_effects", fields.line("poi_effects"), message);
        }
    }
    Rendering { cases, poi_effects }
}

/// Effects that stand for themselves: what a lens shows stands in its `effects`.
fn own_effects(reader: &mut Reader, fields: &Fields, key: &str) -> Vec<EffectUse> {
    let (effects, lod) = effects::effects(reader, fields, key, true);
    if let Some(shown) = lod {
        let message = "\"lod\" shows something else in a lens; it stands in effects";
        reader.checker.note(&fields.place, key, shown.line, message);
    }
    effects
}

/// A case; `None` where it says nothing (and that is noted).
fn case(reader: &mut Reader, node: &Node, place: &Place) -> Option<Case> {
    let Data::Table(entries) = &node.data else {
        let message =
            format!("must be a case, a table {{ as = ..., ... }} or {{ effects = [...], ... }}, is {}", node.quoted());
        reader.checker.note(place, "", node.line, message);
        return None;
    };
    let find = |name: &str| entries.iter().find(|(key, ..)| key == name).map(|(.., node)| node);
    let row = match (find(AS), find("effects")) {
        (None, Some(_)) => None,
        (None, None) => {
            let hint = entries.iter().map(|(name, ..)| did_you_mean(name, [AS, "effects"]));
            let hint = hint.into_iter().find(|hint| !hint.is_empty()).unwrap_or_default();
            let message = format!("is missing: a word, one of {}; or effects = [...]{hint}", words());
            reader.checker.note(place, AS, node.line, message);
            return None;
        }
        (Some(word), _) => match word.text().and_then(Row::of_word) {
            Some(row) => Some(row),
            None => {
                let hint = did_you_mean(word.text().unwrap_or_default(), Rendering::words());
                let message = format!("must be one of {}, is {}{hint}", words(), word.quoted());
                reader.checker.note(place, AS, word.line, message);
                return None;
            }
        },
    };
    let table = row.and_then(|row| WORDS.iter().find(|table| table.name == row.word)).unwrap_or(&BY_EFFECTS);
    let fields = reader.checker.fields(node, table, &[], place.clone());
    let mut case = match row {
        None => Case::of_effects(own_effects(reader, &fields, "effects")),
        Some(row) => {
            let names = row.parameters().into_iter().map(|parameter| parameter.name);
            let given = names.filter_map(|name| Some((parameter(fields.node(&name)?)?, name)));
            Case::of_row(row, given.map(|(value, name)| (name, value)).collect())
        }
    };
    let chosen = fields.node(WHERE.name).map(|node| {
        let place = fields.place.within(WHERE.name, node.line);
        let own = reader.checker.fields(node, &CHOICE, &[], place);
        choice::read(reader, &own)
    });
    case.when = When {
        nearer_m: fields.number(NEARER.name),
        types: fields.node(TYPES.name).map(Node::texts).unwrap_or_default(),
        of: chosen,
    };
    if fields.given(TYPES.name) && case.when.types.is_empty() {
        reader.checker.note(&fields.place, TYPES.name, fields.line(TYPES.name), "must name at least one type");
    }
    Some(case)
}

fn words() -> String {
    Rendering::words().collect::<Vec<_>>().join(", ")
}

/// `render`; the default too: `--set` changes a part of it.
pub fn written(render: &Rendering, options: &Options) -> Data {
    match &render.cases[..] {
        [one] => case_written(one, options),
        several => Data::list(several.iter().map(|case| case_table(case, options))),
    }
}

/// A case alone, as short as it may be.
fn case_written(case: &Case, options: &Options) -> Data {
    match case.word {
        Some(word) if case.when.is_always() && case.given.is_empty() => word.into(),
        None if case.when.is_always() => all_effects(case),
        _ => case_table(case, options),
    }
}

fn all_effects(case: &Case) -> Data {
    Data::list(case.effects.iter().map(effects::written))
}

fn case_table(case: &Case, options: &Options) -> Data {
    let mut table = match case.word {
        Some(word) => Data::table([(AS, word.into())]),
        None => Data::table([("effects", all_effects(case))]),
    };
    case.given.iter().for_each(|(name, value)| table.push(name, parameter_data(value)));
    let When { nearer_m, types, of } = &case.when;
    nearer_m.iter().for_each(|nearer| table.push(NEARER.name, *nearer));
    if !types.is_empty() {
        table.push(TYPES.name, Data::list(types));
    }
    of.iter().for_each(|chosen| table.push(WHERE.name, choice::written(chosen, options)));
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        city::derived::{Form, Height},
        figure::scene_file::{Options, parse, to_toml},
        lens::{Parameter, chosen::Choice},
        scene::Scene,
    };

    fn scene(lines: &str) -> Result<Scene, String> {
        let text = format!(
            "veduta = 1\n[[poi]]\nname = \"a\"\nobject = \"a\"\n[[lens]]\nkind = \"occlusion\"\npoi = \"a\"\n{lines}\n"
        );
        parse(&text, "s", &Options::for_command_line()).map_err(|e| e.to_string())
    }

    #[test]
    fn words_take_parameters() {
        let of = |lines: &str| scene(lines).unwrap().lenses[0].rendering().unwrap().clone();
        let render = of("render = { as = \"transparent-box\", opacity = 0.3, oriented = true }");
        let [case] = &render.cases[..] else { panic!("{render:?}") };
        assert_eq!((case.word, case.effects[0].number("opacity")), (Some("transparent-box"), Some(0.3)));
        let form = |case: &Case| case.content.as_ref().and_then(|c| c.derive).map(|d| d.form);
        assert_eq!(form(case), Some(Form::Box { oriented: true }));
        assert_eq!(
            form(&of("render = { as = \"low\", height = 7 }").cases[0]),
            Some(Form::Height(Height::Metres(7.0)))
        );
        let plain = of("render = { as = \"flatten\" }");
        assert!(plain.is_plain() && plain == Rendering::of_word("flatten").unwrap());
        let colored = of("render = { as = \"x-ray-color\", color = \"#ff0000\", exponent = 2 }");
        let [ray, clay, lines] = &colored.cases[0].effects[..] else { panic!("three effects") };
        assert_eq!((ray.number("exponent"), clay.color("color")), (Some(2.0), Some([1.0, 0.0, 0.0])));
        assert_eq!((ray.color("color"), clay.number("exponent")), (None, None), "each has its own");
        assert_eq!((&*lines.effect, lines.parameters.len()), ("feature-lines", 0));
    }

    #[test]
    fn cases_are_read_and_written() {
        let lines = "render = [{ as = \"flatten\", nearer = 150, lift = 0.1 }, { effects = [\"sepia\"], types = [\"Bridge\"], where = { attribute = \"h\", min = 3 } }, { as = \"x-ray\" }]\npoi_effects = [\"gooch\"]";
        let read = scene(lines).unwrap();
        let render = read.lenses[0].rendering().unwrap();
        let [near, chosen, rest] = &render.cases[..] else { panic!("three cases") };
        assert_eq!(
            (near.when.nearer_m, rest.when.is_always(), near.given.get("lift")),
            (Some(150.0), true, Some(&Parameter::Number(0.1)))
        );
        let choice = Choice { attribute: Some("h".into()), min: Some(3.0), ..Choice::default() };
        assert_eq!(chosen.when, When { nearer_m: None, types: vec!["Bridge".into()], of: Some(choice) });
        assert_eq!((chosen.word, &*chosen.effects[0].effect, &*render.poi_effects[0].effect), (None, "sepia", "gooch"));
        for lines in [
            lines,
            "render = { as = \"low\", height = 4.5, nearer = 9 }",
            "render = { effects = [\"sepia\", \"invert\"], nearer = 9 }",
            "render = [\"sepia\"]",
            "render = \"x-ray\"\npoi_effects = [{ effect = \"overlay\", opacity = 0.5 }]",
        ] {
            let read = scene(lines).unwrap();
            let text = to_toml(&read);
            let again = parse(&text, "s", &Options::for_command_line()).unwrap();
            assert_eq!(again, read, "{text}");
        }
    }

    #[test]
    fn a_case_that_is_wrong_does_not_hold_of_all() {
        for (lines, expected) in [
            (
                "render = [{ as = \"flatten\", nearer = -4 }, { as = \"x-ray\" }]",
                "s:8: [lens.0] render.0.nearer: must be a number ≥ 0, is -4",
            ),
            (
                "render = [{ as = \"flatten\", nearr = 4 }, { as = \"x-ray\" }]",
                "s:8: [lens.0] render.0.nearr: unknown key; did you mean \"nearer\"?",
            ),
            (
                "render = [{ as = \"hull\", nearer = 4 }, { as = \"low\", where = { ids = [] } }, { as = \"x-ray\" }]",
                "s:8: [lens.0] render.1.where.ids: must name at least one object",
            ),
        ] {
            assert_eq!(scene(lines).unwrap_err(), expected, "{lines}");
        }
        // One that holds of all is named by its own place, whatever is wrong before it.
        let message =
            scene("render = [{ as = \"low\", types = [] }, { nearer = 3 }, { as = \"hull\" }, { as = \"x-ray\" }]");
        let message = message.unwrap_err();
        assert!(message.contains("[lens.0] render.2: holds of all occluders"), "{message}");
        assert_eq!(message.matches("holds of all").count(), 1, "{message}");
    }

    #[test]
    fn mistakes_are_named_with_what_would_be_right() {
        for (lines, expected) in [
            ("render = { as = \"flaten\" }", "[lens.0] render.as: must be one of discard, "),
            ("render = { as = \"flaten\" }", "did you mean \"flatten\"?"),
            ("render = { nearer = 3 }", "[lens.0] render.as: is missing: a word, one of discard, "),
            ("render = { as = \"x-ray\", opacity = 0.3 }", "[lens.0] render.opacity: unknown key"),
            (
                "render = { as = \"transparent\", opacity = 1.5 }",
                "[lens.0] render.opacity: must be a number 0 to 1, is 1.5",
            ),
            ("render = { as = \"low\", height = 0 }", "[lens.0] render.height: must be a number 0.001 to 100000, is 0"),
            ("render = { as = \"hull\", color = \"red\" }", "[lens.0] render.color: must be "),
            (
                "render = [{ as = \"low\", nearer = 9 }, \"hull\"]",
                "[lens.0] render.1: must be a case, a table { as = ..., ... } or { effects = [...], ... }, is \"hull\"",
            ),
            ("render = [{ as = \"low\" }, { as = \"hull\" }]", "[lens.0] render.0: holds of all occluders"),
            ("render = [{ as = \"low\", nearer = -1 }]", "[lens.0] render.0.nearer: must be "),
            ("render = [{ as = \"low\", types = [] }]", "[lens.0] render.0.types: must name at least one type"),
            ("render = [{ as = \"low\", where = {} }]", "[lens.0] render.0.where.ids: is missing"),
            (
                "render = [{ effects = [\"sepai\"], nearer = 1 }]",
                "[lens.0] render.0.effects.0: there is no effect \"sepai\"; did you mean \"sepia\"?",
            ),
            (
                "poi_effects = [{ effect = \"lod\", lod = 1 }]",
                "[lens.0] poi_effects: \"lod\" shows something else in a lens",
            ),
        ] {
            let message = scene(lines).unwrap_err();
            assert!(message.contains(expected), "{lines}: {message}");
        }
    }
}
