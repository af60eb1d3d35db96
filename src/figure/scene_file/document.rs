//! The docs' tables and the JSON schema for editors, both made from the table of keys and the table of effects.

use std::fmt::Write;

use serde_json::{Map, Value, json};

use crate::{
    figure::scene_file::{
        animation,
        best_view::{LOOK, VIEWS},
        camera::CAMERA,
        choice::CHOICE,
        city::{CHANGE, CITY, JOIN, SUN},
        content::CONTENT,
        deformation::{CONTROL, STEPS},
        figure::FIGURE,
        keys::{self, CLASSES, Key, Kind, Table},
        lens::{ATTACHED_TO, BORDER, LENS},
        overlay::{CALL_OUT, FRAME, LAYOUT, LINE, OVERLAY},
        poi::POI,
        ray::RAY,
        rendering::{AS, BY_EFFECTS, WORDS},
        scene::ROOT,
        shape_keys::SHAPES,
        sprite::{SPRITE, SPRITE_CAMERA},
        style::{STYLE, TRANSPARENCY},
        test_keys::TESTS,
        trajectory::{TIME, TRAJECTORY},
        volume::{SLICE, TRANSFER, VOLUME},
    },
    lens::{effect::LOD, measures::MEASURES, ramp::RAMPS, rendering::ROWS},
    shader::{
        Blend, EffectDefinition,
        effect::{
            AskedBy, EffectKind, MAX_INSTANTS, MAX_RAMP, ParameterDefinition, ParameterKind, PerObject, asked_for,
            effects as all_effects,
        },
    },
};

/// All tables of the file with the way to them, for the docs and for tests.
pub const TABLES: &[(&str, &Table)] = &[
    ("top level", &ROOT),
    ("[city]", &CITY),
    ("join of [city]", &JOIN),
    ("change of [city]", &CHANGE),
    ("[camera]", &CAMERA),
    ("[sun]", &SUN),
    ("[time]", &TIME),
    ("[style]", &STYLE),
    ("transparency of [style]", &TRANSPARENCY),
    ("[[trajectory]]", &TRAJECTORY),
    ("[[volume]]", &VOLUME),
    ("transfer of a volume", &TRANSFER),
    ("slice of a volume", &SLICE),
    ("[[poi]]", &POI),
    ("[[lens]]", &LENS),
    ("attached_to of a lens", &ATTACHED_TO),
    ("content of a lens", &CONTENT),
    ("sprite of a lens", &SPRITE),
    ("camera of a sprite", &SPRITE_CAMERA),
    ("border of a lens", &BORDER),
    ("force and forbid of a lens", &CHOICE),
    ("look of a lens", &LOOK),
    ("control of a lens", &CONTROL),
    ("ray of a lens", &RAY),
    ("[[overlay]]", &OVERLAY),
    ("frame of an overlay", &FRAME),
    ("line of an overlay", &LINE),
    ("call_out of an overlay", &CALL_OUT),
    ("[layout]", &LAYOUT),
    ("[figure]", &FIGURE),
    animation::TABLES[0],
    animation::TABLES[1],
    animation::TABLES[2],
    animation::TABLES[3],
];

/// The reference part of `docs/scene.md`: every key with what it takes, unit, default and an example.
pub fn reference() -> String {
    let mut out = String::new();
    for (head, table) in TABLES {
        section(&mut out, head, table);
    }
    let _ = write!(out, "## Shapes\n\nThe tables `shape` and the elements of `shapes` of a lens.\n\n");
    for table in SHAPES {
        let _ = write!(out, "### {}\n\n{}\n\n", table.name, table.doc);
        rows(&mut out, table.keys);
    }
    out += "## Views\n\nThe table `view` of a lens with an overlay. `best-view` lenses have any of them but `map` and `worldlet`, `best` without being told; \
            `map-view` and `worldlet` lenses have theirs, `see-through` and `portal` lenses a `camera`.\n\n";
    for table in VIEWS {
        let _ = write!(out, "### {}\n\n{}\n\n", table.name, table.doc);
        rows(&mut out, table.keys);
    }
    out += "## Steps of deformations\n\nThe tables in `deform` of a deformation lens. Lengths and angles are in the frame of its shape: from the middle of its base, along its own axes; `open-street` needs a \
            corridor, `panorama`, `heights` and `lower` no shape, the others a box, a cylinder or a sphere.\n\n";
    for table in STEPS {
        let _ = write!(out, "### {}\n\n{}\n\n", table.name, table.doc);
        rows(&mut out, table.keys);
    }
    out += "## Time operators\n\nThe tables in `time` of a lens: `op` names one of these, or one of your own ([effects.md](effects.md)). See Time.\n\n";
    for operator in asked_for(AskedBy::Times).filter(|operator| !operator.is_users) {
        handler(&mut out, operator);
    }
    out += "## Detection tests\n\nThe table `test` of an occlusion lens. The box of an object is the one (edges along x, y, z) around what is shown of it and its parts;\n\
            all tests but `exact` and `route` count an object whose box holds the eye. What others stand on (terrain, water, roads, land use) is never asked.\n\n";
    for table in TESTS {
        let _ = write!(out, "### {}\n\n{}\n\n", table.name, table.doc);
        rows(&mut out, table.keys);
    }
    renderings(&mut out);
    out += "## Effects\n\n`effects` is a list; each element is a name (`\"sepia\"`) or a table of `effect` (the name), `class` and parameters.\n\
            `class` says which part of the sight line it acts on: `\"inside\"` the lens (default), in `\"front\"` of it, `\"behind\"` it,\n\
            or the `\"rest\"`, where the sight line misses the lens. It has a meaning only in a lens.\n\n";
    let _ = write!(
        out,
        "`blend` says how its result is laid over what is below, channel by channel: {}. Without it the result replaces that.\n\
         `weight`, 0 to 1, says how much of it is laid over. A material, the light and the colour are channels of their own.\n\n",
        words(&Blend::WORDS)
    );
    let names: Vec<&str> = all_effects().map(|e| e.name.as_str()).collect();
    let _ = write!(out, "The effects are {}; [effects.md](effects.md) has their parameters.\n\n", words(&names));
    out += "`lod` may stand among them too: `{ effect = \"lod\", lod = \"1.2\" }`, with a `class`, is `content = { lod = \"1.2\" }` of its\nlens, and written as that.\n\n";
    out
}

fn renderings(out: &mut String) {
    *out += "## Renderings\n\nWords for `render` of an occlusion lens: `render = \"x-ray\"`, or with parameters \
             `render = { as = \"x-ray\", exponent = 0.8 }`.\n\n\
             | word | what one sees | made of | parameters, with what they take and are without being given |\n| --- | --- | --- | --- |\n";
    for row in ROWS {
        let form = row.form.map(|form| (form.make)(&Default::default()));
        let form = form.map(|form| format!("`content.derive = \"{}\"`", form.row().word));
        let effects = row.effects.iter().map(|(effect, _)| format!("`{effect}`"));
        let made: Vec<String> = form.into_iter().chain(effects).collect();
        let of = |p: ParameterDefinition| {
            let unit = if p.unit.is_empty() { String::new() } else { format!(" {}", p.unit) };
            format!("`{}`: {}{unit}, {}", p.name, p.kind.describe(), p.default_text())
        };
        let parameters: Vec<String> = row.parameters().into_iter().map(of).collect();
        let (made, parameters) = (made.join(", "), cell(&parameters.join("; ")));
        let _ = writeln!(out, "| `{}` | {} ({}) | {made} | {parameters} |", row.word, row.doc, row.spec);
    }
    *out += "\n`render` may be a list of cases, tables of a word and its parameters, or of `effects`, and of which occluders it holds. \
             Each occluder is drawn by the first case that holds; one of which none holds stays as it is.\n\n";
    rows(out, BY_EFFECTS.keys);
}

/// The effects and their parameters, for `docs/effects.md`.
pub fn effects_reference() -> String {
    let mut out = String::new();
    for kind in EffectKind::ALL {
        if !all_effects().any(|e| e.kind == kind) {
            continue;
        }
        let _ = write!(out, "## {}s\n\n", capital(kind.name()));
        for effect in all_effects().filter(|e| e.kind == kind) {
            handler(&mut out, effect);
            if effect.objects == Some(PerObject::Colors) {
                ramps(&mut out);
                measures(&mut out);
            }
        }
    }
    out
}

/// A handler and its parameters.
fn handler(out: &mut String, of: &EffectDefinition) {
    let _ = write!(out, "### {}\n\n{} ({})\n\n", of.name, of.doc, of.spec);
    *out += "| parameter | takes | unit | default | meaning |\n| --- | --- | --- | --- | --- |\n";
    for p in &of.parameters {
        let default = if p.is_required() { "must be given".to_owned() } else { p.default_text() };
        let takes = cell(&p.kind.describe());
        let _ = writeln!(out, "| `{}` | {takes} | {} | {default} | {} |", p.name, p.unit, p.doc);
    }
    out.push('\n');
}

/// The ramps, for `docs/effects.md`.
fn ramps(out: &mut String) {
    *out += "Ramps, by kind; the licences of their numbers stand in [NOTICE.md](../src/lens/ramp/NOTICE.md):\n\n\
             | ramp | kind | by, licence |\n| --- | --- | --- |\n";
    for row in &RAMPS {
        let _ = writeln!(out, "| `{}` | {} | {} |", row.name, row.kind.name(), row.source);
    }
    out.push('\n');
}

/// What is measured, for `docs/effects.md`.
fn measures(out: &mut String) {
    *out += "Measures of the city's geometry, of what is shown by default; a file's attribute of such a name is meant before them. Terrain, \
             water, roads and land use have none of `geometry:`:\n\n\
             | attribute | unit | meaning |\n| --- | --- | --- |\n";
    for measure in &MEASURES {
        let _ = writeln!(out, "| `{}` | {} | {} |", measure.name, measure.unit, measure.doc);
    }
    out.push('\n');
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

fn words(list: &[&str]) -> String {
    list.iter().map(|w| format!("`{w}`")).collect::<Vec<_>>().join(", ")
}

fn cell(text: &str) -> String {
    text.replace('|', "\\|")
}

/// A table of the docs.
pub(in crate::figure) fn section(out: &mut String, head: &str, table: &Table) {
    let _ = write!(out, "## {head}\n\n{}\n\n", table.doc);
    rows(out, table.keys);
}

fn rows(out: &mut String, keys: &[Key]) {
    *out += "| key | takes | unit | default | meaning | example |\n| --- | --- | --- | --- | --- | --- |\n";
    for key in keys {
        let default = if key.default.is_empty() { "must be given" } else { key.default };
        let takes = match key.kind {
            Kind::Word { later, .. } if !later.is_empty() => {
                format!("{}; later: {}", key.kind.describe(), later.join(", "))
            }
            _ => key.kind.describe(),
        };
        let _ = writeln!(
            out,
            "| `{}` | {} | {} | {} | {} | `{}` |",
            key.name,
            cell(&takes),
            key.unit,
            cell(default),
            cell(key.doc),
            cell(key.example)
        );
    }
    out.push('\n');
}

/// The JSON schema (draft 2020-12) of scene files, for editors that check TOML with one.
pub fn schema() -> Value {
    let mut schema = object(&ROOT);
    schema.insert("$schema".into(), "https://json-schema.org/draft/2020-12/schema".into());
    schema.insert("title".into(), "Veduta scene".into());
    // Shapes may hold shapes.
    schema.insert(
        "$defs".into(),
        json!({ "shape": shapes(), "test": tests(), "case": cases(), "effect": { "anyOf": effects() } }),
    );
    Value::Object(schema)
}

/// Where the schema describes shapes.
const SHAPE: &str = "#/$defs/shape";
/// Where it describes detection tests.
const TEST: &str = "#/$defs/test";
/// Where it describes uses of effects.
const EFFECT: &str = "#/$defs/effect";
/// Where it describes cases of renderings.
const CASE: &str = "#/$defs/case";

/// The schema as the file `docs/scene.schema.json` holds it.
pub fn schema_text() -> String {
    format!("{:#}\n", schema())
}

/// The schema of a table.
pub(in crate::figure) fn object(table: &Table) -> Map<String, Value> {
    let mut properties = Map::new();
    for key in table.keys {
        let mut of_key = of_kind(&key.kind);
        if let Value::Object(map) = &mut of_key {
            let unit = if key.unit.is_empty() { String::new() } else { format!(" Unit: {}.", key.unit) };
            let default = if key.default.is_empty() { String::new() } else { format!(" Default: {}.", key.default) };
            map.insert("description".into(), format!("{}{unit}{default}", key.doc).into());
        }
        properties.insert(key.name.into(), of_key);
    }
    let mut map = Map::new();
    map.insert("type".into(), "object".into());
    map.insert("description".into(), table.doc.into());
    map.insert("properties".into(), properties.into());
    let required: Vec<&str> =
        table.keys.iter().filter(|k| k.default.is_empty() && k.name != "shape").map(|k| k.name).collect();
    if !required.is_empty() {
        map.insert("required".into(), required.into());
    }
    if table.keys.iter().any(|k| k.name == "shape") {
        let none = json!({ "not": { "anyOf": [{ "required": ["shape"] }, { "required": ["shapes"] }] } });
        let of_occluders =
            json!({ "properties": { "kind": { "const": "occlusion" } }, "required": ["kind"], "allOf": [none] });
        map.insert("oneOf".into(), json!([{ "required": ["shape"] }, { "required": ["shapes"] }, of_occluders]));
    }
    let one_of: &[&str] = match table.name {
        "flat" => &["radius", "size", "points"],
        "attached_to" => &["object", "poi"],
        "choice" => &["ids", "attribute"],
        _ => &[],
    };
    if !one_of.is_empty() {
        map.insert("oneOf".into(), one_of.iter().map(|key| json!({ "required": [key] })).collect());
    }
    if table.name == "overlay" {
        map.insert("not".into(), json!({ "required": ["at", "call_out"] }));
    }
    map.insert("additionalProperties".into(), false.into());
    map
}

fn of_kind(kind: &Kind) -> Value {
    let three = |min: f64, max: f64| json!({ "type": "array", "items": { "type": "number", "minimum": min, "maximum": max }, "minItems": 3, "maxItems": 3 });
    let pair = |min: f64, max: f64| json!({ "type": "array", "items": { "type": "number", "minimum": min, "maximum": max }, "minItems": 2, "maxItems": 2 });
    let two = |min: f64| pair(min, keys::FAR_M);
    match kind {
        Kind::Integer { min, max } => json!({ "type": "integer", "minimum": min, "maximum": max }),
        Kind::Number { min, max } if *min == f64::MIN && *max == f64::MAX => json!({ "type": "number" }),
        Kind::Number { min, max } => json!({ "type": "number", "minimum": min, "maximum": max }),
        Kind::Boolean => json!({ "type": "boolean" }),
        Kind::Text => json!({ "type": "string", "minLength": 1 }),
        Kind::Texts => json!({ "type": "array", "items": { "type": "string", "minLength": 1 } }),
        Kind::Word { now, .. } => json!({ "enum": now }),
        Kind::Point | Kind::Direction => three(-keys::FAR_M, keys::FAR_M),
        Kind::Lengths => three(0.0, keys::FAR_M),
        Kind::Angles => three(-360.0, 360.0),
        Kind::Points(least) => {
            json!({ "type": "array", "items": three(-keys::FAR_M, keys::FAR_M), "minItems": least, "maxItems": 4096 })
        }
        Kind::PlanPoint => two(-keys::FAR_M),
        Kind::PlanLengths => two(0.0),
        Kind::PicturePlace => pair(0.0, 1.0),
        Kind::PlanPoints(least) => json!({ "type": "array", "items": two(-keys::FAR_M), "minItems": least }),
        Kind::Rings => {
            json!({ "type": "array", "items": { "type": "array", "items": two(-keys::FAR_M), "minItems": 3 } })
        }
        Kind::Planes(least) => {
            let four = json!({ "type": "array", "items": { "type": "number" }, "minItems": 4, "maxItems": 4 });
            json!({ "type": "array", "items": four, "minItems": least, "maxItems": 64 })
        }
        Kind::Color => color(),
        Kind::Background => json!({ "anyOf": [{ "const": "sky" }, color()] }),
        Kind::Lod => json!({ "type": ["string", "number"], "pattern": "^ *[0-9](\\.[0-9]0*)? *$" }),
        Kind::Size => {
            json!({ "type": "array", "items": { "type": "integer", "minimum": 1, "maximum": 16384 }, "minItems": 2, "maxItems": 2 })
        }
        Kind::PaperSize => pair(0.1, 1e4),
        Kind::Table(table) => Value::Object(object(table)),
        Kind::Tables(table) => json!({ "type": "array", "items": object(table) }),
        Kind::Shape => json!({ "$ref": SHAPE }),
        Kind::Shapes => json!({ "type": "array", "items": { "$ref": SHAPE }, "minItems": 1 }),
        Kind::Times(least) => {
            json!({ "type": "array", "items": { "type": "number", "minimum": 0, "maximum": 1e6 }, "minItems": least })
        }
        Kind::Numbers => json!({ "type": ["number", "array"] }),
        Kind::Effects => json!({ "type": "array", "items": { "$ref": EFFECT } }),
        Kind::Names => {
            let name = json!({ "type": "string", "minLength": 1 });
            json!({ "anyOf": [name, { "type": "array", "items": name, "minItems": 1 }] })
        }
        Kind::Shares => {
            let share = json!({ "type": "number", "minimum": 0, "maximum": 1 });
            json!({ "type": "array", "items": share, "minItems": 1, "maxItems": MAX_RAMP })
        }
        Kind::Colors => {
            let color = json!({ "type": "string", "pattern": "^#([0-9a-fA-F]{3}|[0-9a-fA-F]{6})$" });
            json!({ "type": "array", "items": color, "minItems": 1, "maxItems": MAX_RAMP })
        }
        Kind::Test => json!({ "$ref": TEST }),
        Kind::View => by(VIEWS, "kind"),
        Kind::Handler => json!({ "type": "object", "required": ["kind"] }),
        Kind::Moment => json!({ "type": ["string", "integer"] }),
        Kind::Operators => {
            let names: Vec<&str> = asked_for(AskedBy::Times).filter(|h| !h.is_users).map(|h| h.name.as_str()).collect();
            let op = json!({ "anyOf": [{ "enum": names }, { "type": "string" }] });
            let one = json!({ "type": "object", "properties": { "op": op }, "required": ["op"] });
            json!({ "type": "array", "items": one, "minItems": 1 })
        }
        Kind::Steps => json!({ "type": "array", "items": by(STEPS, "kind"), "minItems": 1 }),
        Kind::Tests => json!({ "type": "array", "items": { "$ref": TEST }, "minItems": 1 }),
        Kind::Rendering => {
            let words: Vec<&str> = ROWS.iter().map(|row| row.word).collect();
            let one = json!({ "$ref": CASE });
            let cases = json!({ "type": "array", "items": one, "minItems": 1 });
            json!({ "anyOf": [{ "enum": words }, one, cases, of_kind(&Kind::Effects)] })
        }
        Kind::WordOrPlace(words) => json!({ "anyOf": [{ "enum": words }, pair(0.0, 1.0)] }),
        Kind::WordOrTable(words, table) => json!({ "anyOf": [{ "enum": words }, object(table)] }),
    }
}

fn color() -> Value {
    json!({ "anyOf": [
        { "type": "string", "pattern": "^#([0-9a-fA-F]{3}|[0-9a-fA-F]{6})$" },
        { "type": "array", "items": { "type": "number", "minimum": 0, "maximum": 1 }, "minItems": 3, "maxItems": 3 },
    ] })
}

fn shapes() -> Value {
    by(SHAPES, "kind")
}

fn cases() -> Value {
    let mut all = by(&WORDS, AS);
    if let Some(list) = all["oneOf"].as_array_mut() {
        list.push(Value::Object(object(&BY_EFFECTS)));
    }
    all
}

fn tests() -> Value {
    by(TESTS, "kind")
}

/// One of some tables, by this key where they have it.
fn by(tables: &[Table], key: &str) -> Value {
    let each: Vec<Value> = tables
        .iter()
        .map(|table| {
            let mut map = object(table);
            if let Some(kind) = map.get_mut("properties").and_then(|p| p.get_mut(key)) {
                *kind = json!({ "const": table.name });
            }
            Value::Object(map)
        })
        .collect();
    json!({ "oneOf": each })
}

fn effects() -> Vec<Value> {
    let alone: Vec<&str> =
        all_effects().filter(|e| !e.parameters.iter().any(|p| p.is_required())).map(|e| e.name.as_str()).collect();
    let mut all = vec![json!({ "enum": alone })];
    all.push(json!({
        "type": "object",
        "description": "Content. The city in another level of detail, in place of what is below.",
        "properties": {
            "effect": { "const": LOD },
            "class": { "enum": CLASSES },
            "lod": of_kind(&Kind::Lod),
        },
        "required": ["effect", "lod"],
        "additionalProperties": false,
    }));
    for effect in all_effects() {
        let mut properties = Map::new();
        properties.insert("effect".into(), json!({ "const": effect.name }));
        properties.insert("class".into(), json!({ "enum": CLASSES }));
        properties.insert("blend".into(), json!({ "enum": Blend::WORDS }));
        properties.insert("weight".into(), json!({ "type": "number", "minimum": 0, "maximum": 1 }));
        for p in &effect.parameters {
            let mut value = of_parameter(&p.kind);
            if let Value::Object(map) = &mut value {
                map.insert("description".into(), p.doc.clone().into());
            }
            properties.insert(p.name.clone(), value);
        }
        let required: Vec<&str> = ["effect"]
            .into_iter()
            .chain(effect.parameters.iter().filter(|p| p.is_required()).map(|p| p.name.as_str()))
            .collect();
        let style = capital(effect.kind.name());
        all.push(json!({
            "type": "object",
            "description": format!("{style}. {}", effect.doc),
            "properties": properties,
            "required": required,
            "additionalProperties": false,
        }));
    }
    all
}

fn of_parameter(kind: &ParameterKind) -> Value {
    match kind {
        ParameterKind::Boolean => json!({ "type": "boolean" }),
        ParameterKind::Number { min, max } if *max == f64::MAX && *min == f64::MIN => json!({ "type": "number" }),
        ParameterKind::Number { min, max } => json!({ "type": "number", "minimum": min, "maximum": max }),
        ParameterKind::Text => json!({ "type": "string" }),
        ParameterKind::Word(words) => json!({ "enum": words }),
        ParameterKind::Color => color(),
        ParameterKind::Vector => of_kind(&Kind::Point),
        ParameterKind::Numbers => {
            json!({ "type": "array", "items": { "type": "number" }, "minItems": 1, "maxItems": 256 })
        }
        ParameterKind::Instants => {
            let item = json!({ "type": ["string", "integer"] });
            json!({ "type": "array", "items": item, "minItems": 1, "maxItems": MAX_INSTANTS })
        }
        ParameterKind::Weights => {
            let item = json!({ "type": "number", "exclusiveMinimum": 0 });
            json!({ "type": "array", "items": item, "minItems": 1, "maxItems": MAX_INSTANTS })
        }
        ParameterKind::Texts => {
            json!({ "type": "array", "items": { "type": "string" }, "minItems": 1, "maxItems": 256 })
        }
        ParameterKind::Shares => of_kind(&Kind::Shares),
        ParameterKind::Colors => of_kind(&Kind::Colors),
        ParameterKind::Moment | ParameterKind::Span | ParameterKind::Unit | ParameterKind::Clock => {
            json!({ "type": "string", "minLength": 1 })
        }
    }
}

#[cfg(test)]
pub(in crate::figure) mod tests {
    use super::*;

    /// Compares with the committed file; `VEDUTA_UPDATE=docs` writes it instead.
    pub(in crate::figure) fn committed(name: &str, made: impl Fn(&str) -> String) {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("docs").join(name);
        let old = std::fs::read_to_string(&path).unwrap_or_default();
        let new = made(&old);
        if std::env::var_os("VEDUTA_UPDATE").is_some_and(|v| v == "docs") {
            std::fs::write(&path, &new).unwrap();
        } else {
            assert!(old == new, "docs/{name} is not what the tables say: VEDUTA_UPDATE=docs cargo test document");
        }
    }

    /// Every key stands in the docs, with a sentence and an example that is TOML.
    pub(in crate::figure) fn check_examples(table: &Table, text: &str) {
        for key in table.keys {
            assert!(text.contains(&format!("| `{}` |", key.name)), "{}", key.name);
            assert!(key.doc.ends_with('.') && !key.example.is_empty(), "{}", key.name);
            format!("v = {}", key.example).parse::<toml::Table>().unwrap_or_else(|e| panic!("{}: {e}", key.name));
        }
    }

    #[test]
    fn the_schema_is_committed() {
        committed("scene.schema.json", |_| schema_text());
    }

    #[test]
    fn the_reference_is_committed() {
        const MARK: &str = "<!-- From here on made from the tables in src/figure/scene_file. -->\n";
        committed("scene.md", |old| {
            let prose = old.split(MARK).next().unwrap_or_default();
            format!("{prose}{MARK}\n{}", reference())
        });
    }

    #[test]
    fn the_effects_are_committed() {
        const MARK: &str = "<!-- From here on made from the files in shaders/effect. -->\n";
        committed("effects.md", |old| {
            let prose = old.split(MARK).next().unwrap_or_default();
            format!("{prose}{MARK}\n{}", effects_reference())
        });
    }

    #[test]
    fn every_key_is_documented_with_an_example_that_is_right() {
        let text = reference();
        for (_, table) in
            TABLES.iter().copied().chain(SHAPES.iter().chain(TESTS).chain(VIEWS).chain(STEPS).map(|s| ("", s)))
        {
            check_examples(table, &text);
        }
        for effect in all_effects() {
            assert!(text.contains(&format!("`{}`", effect.name)));
        }
    }
}
