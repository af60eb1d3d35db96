//! Facts about a city, counted: the object behind `veduta info --json` and its text form.
//!
//! Everything is taken from the loaded [`CityModel`]: counts are counted, never copied from a header.

use rustc_hash::{FxHashMap, FxHashSet};
use serde::{Serialize, Serializer, ser::SerializeMap};

use crate::{
    city::{
        lifetime::{Dating, Lifetimes},
        model::{Attribute, CityModel, Geometry, Lod, NONE, StringId, Value},
        side_table::JoinFacts,
        timetable::TimetableFacts,
    },
    geom::Aabb,
    time::Granularity,
};

/// The number of distinct values of an attribute that are listed at most.
const LISTED_VALUES: usize = 64;

/// The number of steps of parents that the type tree goes down at most.
const TREE_DEPTH: usize = 8;

/// Facts about a city. Fields marked *text only* are for people and not part of the JSON object.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Facts {
    /// `CityJSON`, `CityJSONSeq`, `glTF`, `OBJ`; several files of several formats: each once, joined by `+`.
    pub format: String,
    /// The format's version as stated, `2.0`; several: each once, joined by `+`; `None` where no file states one.
    pub version: Option<String>,
    /// Canonical reference system.
    pub crs: Option<String>,
    /// The reference system as the file spells it.
    pub crs_raw: Option<String>,
    /// Box around the vertices used by any geometry, metres; `None` when there are none.
    pub extent: Option<Extent>,
    /// City objects.
    pub objects: ObjectFacts,
    /// Per level of detail, coarse to fine; `none` for formats without levels.
    #[serde(serialize_with = "as_map")]
    pub lods: Vec<(String, LodFacts)>,
    /// Per attribute of city objects, in the order of first appearance.
    #[serde(serialize_with = "as_map")]
    pub attributes: Vec<(String, AttributeFacts)>,
    /// Side tables that were joined, in order.
    pub joins: Vec<JoinFacts>,
    /// The timetables by which objects move.
    pub timetables: Vec<TimetableFacts>,
    /// When objects are there; `None`: no attribute says so.
    pub time: Option<TimeFacts>,
    /// Texture images.
    pub textures: TextureFacts,
    /// Faces that are in the files but not drawn, because something is wrong with them.
    pub faces_dropped: u64,
    /// The faults that were lived with.
    pub warnings: Vec<WarningFacts>,
    /// *Text only*: types below the types of their parents, depth first.
    #[serde(skip)]
    pub tree: Vec<TreeLine>,
    /// *Text only*: drawn triangles per semantic surface type, most first; the last may be those without (`""`).
    #[serde(skip)]
    pub semantics: Vec<(String, u64)>,
    /// *Text only*: geometries made of closed shells, and all geometries.
    #[serde(skip)]
    pub solids: [u64; 2],
}

/// When objects are there, by their attributes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TimeFacts {
    /// The attribute that says since when.
    pub from: Option<String>,
    /// The attribute that says until when.
    pub until: Option<String>,
    /// The first moment at which something comes or goes, as short as it is exact.
    pub first: Option<String>,
    /// The last.
    pub last: Option<String>,
    /// How finely most dates are said: `year`, `month`, `day`, `minute`, `second`, `microsecond`.
    pub granularity: Option<&'static str>,
    /// Objects with one date or two, of their own or a parent's.
    pub dated: u64,
    /// Objects without.
    pub undated: u64,
    /// Objects that end when they begin, or before.
    pub empty: u64,
    /// Values that are no times.
    pub unreadable: u64,
    /// The first of them: whose, and what would be right.
    pub first_unreadable: Option<String>,
}

impl TimeFacts {
    /// Of a city, by the attributes that are asked for or known; `None`: there is none.
    ///
    /// # Errors
    /// An attribute that is asked for is not there.
    pub fn new(city: &CityModel, dating: &Dating) -> Result<Option<Self>, String> {
        let found = Lifetimes::new(city, dating)?;
        if found.from.is_none() && found.until.is_none() {
            return Ok(None);
        }
        let [first, last] = found.span.map_or([None, None], |span| span.map(|moment| Some(moment.written())));
        let unreadable = found.unreadable.as_ref();
        Ok(Some(Self {
            from: found.from,
            until: found.until,
            first,
            last,
            granularity: found.granularity.map(Granularity::word),
            dated: found.dated,
            undated: found.undated,
            empty: found.empty,
            unreadable: unreadable.map_or(0, |unreadable| unreadable.count),
            first_unreadable: unreadable.map(|unreadable| format!("{}: {}", unreadable.object, unreadable.message)),
        }))
    }
}

/// A box.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Extent {
    /// Smallest corner, metres.
    pub min: [f64; 3],
    /// Largest corner, metres.
    pub max: [f64; 3],
}

impl Extent {
    /// `None` of what is empty.
    fn of(bounds: Aabb) -> Option<Self> {
        (!bounds.is_empty()).then(|| Self { min: bounds.min.into(), max: bounds.max.into() })
    }
}

/// City objects, counted.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ObjectFacts {
    /// All of them.
    pub total: u64,
    /// Per type as the file names it, most first, then by name.
    #[serde(serialize_with = "as_map")]
    pub by_type: Vec<(String, u64)>,
    /// Each of them, in object order; only when asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub list: Option<Vec<ListedObject>>,
}

/// One city object.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ListedObject {
    /// Unique id.
    pub id: String,
    /// Type as the file names it.
    #[serde(rename = "type")]
    pub kind: String,
    /// Ids of its parents.
    pub parents: Vec<String>,
    /// Levels of detail it has geometry of, coarse to fine.
    pub lods: Vec<String>,
    /// Box around its geometry and that of all below it, of every level of detail; `null` without any.
    pub extent: Option<Extent>,
}

/// One level of detail.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct LodFacts {
    /// Objects that have geometry of it.
    pub objects: u64,
    /// Polygons as read.
    pub polygons: u64,
    /// Triangles as drawn, after de-duplication and refusal.
    pub triangles: u64,
}

/// One attribute, over all objects that have it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AttributeFacts {
    /// Objects that have a value that is not null.
    pub count: u64,
    /// Objects that have it as null.
    pub nulls: u64,
    /// `integer`, `number` (integers among them or not), `string`, `boolean`, `date` (all are ISO 8601 dates),
    /// `array`, `object`, `mixed`; `None` when all are null.
    #[serde(rename = "type")]
    pub kind: Option<&'static str>,
    /// Smallest integer, number or date.
    pub min: Option<serde_json::Value>,
    /// Largest integer, number or date.
    pub max: Option<serde_json::Value>,
    /// The most frequent values with how often they occur, most first, ties by value; at most 64.
    pub values: Vec<(serde_json::Value, u64)>,
    /// *Text only*: how many distinct values there are.
    #[serde(skip)]
    pub distinct: u64,
}

/// Texture images, counted.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TextureFacts {
    /// Named by the files.
    pub declared: u64,
    /// The number of those that were found.
    pub found: u64,
}

/// All occurrences of one warning.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WarningFacts {
    /// Code of the closed table (docs/warnings.md).
    pub code: &'static str,
    /// The number of times that it happened.
    pub count: u64,
    /// The first objects it happened to.
    pub objects: Vec<String>,
    /// The first occurrence in words.
    pub message: String,
    /// *Text only*: what the code means.
    #[serde(skip)]
    pub meaning: &'static str,
}

/// A line of the type tree.
#[derive(Clone, Debug, PartialEq)]
pub struct TreeLine {
    /// 0 for objects without parents.
    pub depth: usize,
    /// Type as the file names it.
    pub kind: String,
    /// Objects of this type below such parents.
    pub count: u64,
}

/// Writes pairs as an object, in their order.
pub fn as_map<S: Serializer, T: Serialize>(pairs: &[(String, T)], serializer: S) -> Result<S::Ok, S::Error> {
    let mut map = serializer.serialize_map(Some(pairs.len()))?;
    for (key, value) in pairs {
        map.serialize_entry(key, value)?;
    }
    map.end()
}

/// Counts what is in `city`; `list` names every object.
pub fn facts(city: &CityModel, list: bool) -> Facts {
    let joined = |part: &dyn Fn(usize) -> String| {
        let mut parts: Vec<String> = Vec::new();
        for part in (0..city.sources.len()).map(part).filter(|part| !part.is_empty()) {
            if !parts.contains(&part) {
                parts.push(part);
            }
        }
        parts.join("+")
    };
    let version = joined(&|i| city.sources[i].version.clone());
    let extent = city.extent_as_read;
    Facts {
        format: joined(&|i| city.sources[i].format.to_owned()),
        version: (!version.is_empty()).then_some(version),
        crs: city.crs.clone(),
        crs_raw: city.crs_raw.clone(),
        extent: Extent::of(extent),
        objects: object_facts(city, list),
        lods: lod_facts(city),
        attributes: attribute_facts(city),
        joins: city.joins.clone(),
        timetables: city.timetables.clone(),
        // Without being asked for nothing can be missing.
        time: TimeFacts::new(city, &Dating::default()).unwrap_or_default(),
        textures: TextureFacts {
            declared: city.textures.len() as u64,
            found: city.textures.iter().filter(|t| !t.image.is_missing()).count() as u64,
        },
        faces_dropped: city.faces_dropped + city.geometries.iter().map(|g| u64::from(g.dropped)).sum::<u64>(),
        warnings: warning_facts(city),
        tree: type_tree(city),
        semantics: semantic_facts(city),
        solids: [city.geometries.iter().filter(|g| g.solid).count() as u64, city.geometries.len() as u64],
    }
}

/// Most first, then by name.
fn by_count(counts: FxHashMap<StringId, u64>, name: impl Fn(StringId) -> String) -> Vec<(String, u64)> {
    let mut list: Vec<_> = counts.into_iter().map(|(id, count)| (name(id), count)).collect();
    list.sort_by(|a, b| b.1.cmp(&a.1).then_with(|| a.0.cmp(&b.0)));
    list
}

fn object_facts(city: &CityModel, list: bool) -> ObjectFacts {
    let mut counts = FxHashMap::default();
    for object in &city.objects {
        *counts.entry(object.kind).or_insert(0) += 1;
    }
    let listed = |(object, number): (&crate::city::model::CityObject, u32)| {
        let range = object.geometries.start as usize..object.geometries.end as usize;
        let mut lods: Vec<_> = city.geometries[range].iter().map(|g| g.lod).collect();
        lods.sort();
        lods.dedup();
        ListedObject {
            id: object.id.to_string(),
            kind: city.strings.get(object.kind).to_owned(),
            parents: object.parents.iter().map(|&p| city.objects[p as usize].id.to_string()).collect(),
            lods: lods.iter().map(ToString::to_string).collect(),
            extent: Extent::of(city.family_bounds(number)),
        }
    };
    ObjectFacts {
        total: city.objects.len() as u64,
        by_type: by_count(counts, |kind| city.strings.get(kind).to_owned()),
        list: list.then(|| city.objects.iter().zip(0..).map(listed).collect()),
    }
}

fn lod_facts(city: &CityModel) -> Vec<(String, LodFacts)> {
    let mut lods = std::collections::BTreeMap::new();
    // Several geometries of one object and one LoD stand anywhere in the object's range.
    let mut seen = FxHashSet::default();
    for geometry in &city.geometries {
        let entry: &mut LodFacts = lods.entry(geometry.lod).or_default();
        entry.objects += u64::from(seen.insert((geometry.object, geometry.lod)));
        entry.polygons += u64::from(geometry.polygons);
        entry.triangles += u64::from(geometry.triangles);
    }
    lods.into_iter().map(|(lod, facts)| (lod.to_string(), facts)).collect()
}

fn semantic_facts(city: &CityModel) -> Vec<(String, u64)> {
    let mut per_surface = vec![0_u64; city.surfaces.len()];
    for tile in &city.tiles {
        let indices = &city.indices[tile.indices.start as usize..tile.indices.end as usize];
        for triangle in indices.chunks_exact(3) {
            let vertex = &city.vertices[(tile.vertices.start + triangle[0]) as usize];
            per_surface[vertex.surface as usize] += 1;
        }
    }
    let mut counts = FxHashMap::default();
    let mut without = 0;
    for (surface, triangles) in city.surfaces.iter().zip(per_surface) {
        if surface.kind == StringId(NONE) {
            without += triangles;
        } else if triangles > 0 {
            *counts.entry(surface.kind).or_insert(0) += triangles;
        }
    }
    if counts.is_empty() {
        return Vec::new();
    }
    let mut list = by_count(counts, |kind| city.strings.get(kind).to_owned());
    if without > 0 {
        list.push((String::new(), without));
    }
    list
}

/// The warnings of a city as they stand in `info --json` and `--stats`.
pub fn warning_facts(city: &CityModel) -> Vec<WarningFacts> {
    let fact = |(code, warning): (crate::city::warning::WarningCode, &crate::city::warning::Warning)| WarningFacts {
        code: code.code(),
        count: warning.count,
        objects: warning.objects.clone(),
        message: warning.message.clone(),
        meaning: code.meaning(),
    };
    city.warnings.iter().map(fact).collect()
}

/// Why nothing of a city is drawn, where these geometries of it are shown; `None`: something is.
pub fn nothing_drawn(city: &CityModel, shown: &[u32]) -> Option<String> {
    let has_triangles = |geometry: &Geometry| geometry.triangles > 0;
    if shown.iter().any(|geometry| has_triangles(&city.geometries[*geometry as usize])) {
        return None;
    }
    let objects = city.objects.len();
    let faulty = city.faces_dropped + city.geometries.iter().map(|geometry| u64::from(geometry.dropped)).sum::<u64>();
    let mut levels: Vec<Lod> = city.geometries.iter().filter(|g| has_triangles(g)).map(|g| g.lod).collect();
    levels.sort_unstable();
    levels.dedup();
    Some(if !levels.is_empty() {
        let levels: Vec<String> = levels.iter().map(Lod::to_string).collect();
        format!("`city.lod` leaves out all levels of detail that there are ({})", levels.join(", "))
    } else if objects == 0 {
        "the files hold no city objects".to_owned()
    } else if faulty > 0 {
        format!("all {faulty} faces are faulty; the warnings of `veduta info` say how")
    } else if city.geometries.is_empty() {
        format!("none of the {objects} city objects has geometry")
    } else {
        format!("the {objects} city objects have points or lines alone, which are not drawn")
    })
}

/// Counts objects by the types on the way from their topmost parent.
fn type_tree(city: &CityModel) -> Vec<TreeLine> {
    let mut tree = Tree::default();
    let mut path = Vec::with_capacity(TREE_DEPTH);
    for object in &city.objects {
        path.clear();
        let mut at = object;
        path.push(at.kind);
        while let (Some(&parent), true) = (at.parents.first(), path.len() < TREE_DEPTH) {
            at = &city.objects[parent as usize];
            path.push(at.kind);
        }
        let node = path.iter().rev().fold(None, |above, kind| Some(tree.child(above, *kind)));
        tree.nodes[node.expect("a path has a type at least")].count += 1;
    }
    let mut lines = Vec::new();
    tree.write(city, &tree.roots, 0, &mut lines);
    lines
}

/// Types below types; nodes are made when first met.
#[derive(Default)]
struct Tree {
    nodes: Vec<TreeNode>,
    roots: Vec<usize>,
    index: FxHashMap<(Option<usize>, StringId), usize>,
}

struct TreeNode {
    kind: StringId,
    count: u64,
    children: Vec<usize>,
}

impl Tree {
    fn child(&mut self, above: Option<usize>, kind: StringId) -> usize {
        if let Some(&node) = self.index.get(&(above, kind)) {
            return node;
        }
        let node = self.nodes.len();
        self.nodes.push(TreeNode { kind, count: 0, children: Vec::new() });
        self.index.insert((above, kind), node);
        match above {
            Some(above) => self.nodes[above].children.push(node),
            None => self.roots.push(node),
        }
        node
    }

    /// Depth first, most first; at most [`TREE_DEPTH`] deep.
    fn write(&self, city: &CityModel, siblings: &[usize], depth: usize, lines: &mut Vec<TreeLine>) {
        let name = |node: usize| city.strings.get(self.nodes[node].kind);
        let mut siblings = siblings.to_vec();
        siblings.sort_by(|&a, &b| self.nodes[b].count.cmp(&self.nodes[a].count).then_with(|| name(a).cmp(name(b))));
        for node in siblings {
            lines.push(TreeLine { depth, kind: name(node).to_owned(), count: self.nodes[node].count });
            self.write(city, &self.nodes[node].children, depth + 1, lines);
        }
    }
}

// --- attributes -------------------------------------------------------------------------------

/// A value as `info --json` has it.
pub fn to_json(city: &CityModel, value: Value) -> serde_json::Value {
    Key::of(value).map_or(serde_json::Value::Null, |key| key.json(city))
}

/// A value as it is counted: 1 and 1.0 are the same, as in JSON readers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Key {
    Boolean(bool),
    Integer(i64),
    Number(u64),
    String(StringId),
    Array(StringId),
    Object(StringId),
}

impl Key {
    fn of(value: Value) -> Option<Self> {
        Some(match value {
            Value::Null => return None,
            Value::Boolean(b) => Self::Boolean(b),
            Value::Integer(i) => Self::Integer(i),
            // Whole numbers up to 2^53 are the same in both types.
            Value::Number(n) if n.fract() == 0.0 && n.abs() < 9_007_199_254_740_992.0 => Self::Integer(n as i64),
            Value::Number(n) => Self::Number(n.to_bits()),
            Value::String(s) => Self::String(s),
            Value::Array(s) => Self::Array(s),
            Value::Object(s) => Self::Object(s),
        })
    }

    fn number(self) -> Option<f64> {
        match self {
            Self::Integer(i) => Some(i as f64),
            Self::Number(bits) => Some(f64::from_bits(bits)),
            _ => None,
        }
    }

    fn text(self) -> Option<StringId> {
        match self {
            Self::String(s) | Self::Array(s) | Self::Object(s) => Some(s),
            _ => None,
        }
    }

    fn json(self, city: &CityModel) -> serde_json::Value {
        match self {
            Self::Boolean(b) => b.into(),
            Self::Integer(i) => i.into(),
            Self::Number(bits) => f64::from_bits(bits).into(),
            Self::String(s) => city.strings.get(s).into(),
            Self::Array(s) | Self::Object(s) => {
                serde_json::from_str(city.strings.get(s)).unwrap_or_else(|_| city.strings.get(s).into())
            }
        }
    }

    /// Booleans, then numbers by size, then texts by bytes.
    fn order(self, other: Self, city: &CityModel) -> std::cmp::Ordering {
        let rank = |key: Self| (key.number().is_some(), key.text().is_some());
        rank(self).1.cmp(&rank(other).1).then(rank(self).0.cmp(&rank(other).0)).then_with(|| match (self, other) {
            (Self::Integer(a), Self::Integer(b)) => a.cmp(&b),
            (Self::Boolean(a), Self::Boolean(b)) => a.cmp(&b),
            _ => match (self.number(), other.number(), self.text(), other.text()) {
                (Some(a), Some(b), _, _) => a.total_cmp(&b),
                (_, _, Some(a), Some(b)) => city.strings.get(a).cmp(city.strings.get(b)),
                _ => std::cmp::Ordering::Equal,
            },
        })
    }
}

/// One attribute while it is counted.
#[derive(Default)]
struct Counted {
    nulls: u64,
    /// Which types occurred, one bit each, see [`type_bit`].
    types: u8,
    values: FxHashMap<Key, u64>,
}

const BOOLEAN: u8 = 1;
const INTEGER: u8 = 2;
const NUMBER: u8 = 4;
const STRING: u8 = 8;
const ARRAY: u8 = 16;
const OBJECT: u8 = 32;

fn type_bit(value: Value) -> u8 {
    match value {
        Value::Null => 0,
        Value::Boolean(_) => BOOLEAN,
        Value::Integer(_) => INTEGER,
        Value::Number(_) => NUMBER,
        Value::String(_) => STRING,
        Value::Array(_) => ARRAY,
        Value::Object(_) => OBJECT,
    }
}

fn attribute_facts(city: &CityModel) -> Vec<(String, AttributeFacts)> {
    let mut order: Vec<StringId> = Vec::new();
    let mut counted: FxHashMap<StringId, Counted> = FxHashMap::default();
    for object in &city.objects {
        let range = object.attributes.start as usize..object.attributes.end as usize;
        for &Attribute { name, value } in &city.attributes[range] {
            let entry = counted.entry(name).or_insert_with(|| {
                order.push(name);
                Counted::default()
            });
            entry.types |= type_bit(value);
            match Key::of(value) {
                None => entry.nulls += 1,
                Some(key) => *entry.values.entry(key).or_default() += 1,
            }
        }
    }
    order.into_iter().map(|name| (city.strings.get(name).to_owned(), finish(city, &counted[&name]))).collect()
}

fn finish(city: &CityModel, counted: &Counted) -> AttributeFacts {
    let texts_are_dates =
        || counted.values.keys().all(|key| key.text().is_some_and(|text| is_date(city.strings.get(text))));
    let kind = match counted.types {
        0 => None,
        BOOLEAN => Some("boolean"),
        INTEGER => Some("integer"),
        types if types & !(INTEGER | NUMBER) == 0 => Some("number"),
        STRING if texts_are_dates() => Some("date"),
        STRING => Some("string"),
        ARRAY => Some("array"),
        OBJECT => Some("object"),
        _ => Some("mixed"),
    };
    let mut values: Vec<(Key, u64)> = counted.values.iter().map(|(key, count)| (*key, *count)).collect();
    let has_range = matches!(kind, Some("integer" | "number" | "date"));
    let end = |largest: bool| {
        let keys = counted.values.keys().copied().filter(|_| has_range);
        let found = if largest { keys.max_by(|a, b| a.order(*b, city)) } else { keys.min_by(|a, b| a.order(*b, city)) };
        found.map(|key| key.json(city))
    };
    let (min, max) = (end(false), end(true));
    let order = |a: &(Key, u64), b: &(Key, u64)| b.1.cmp(&a.1).then_with(|| a.0.order(b.0, city));
    // Ids of 100,000 objects need no full sort for the 64 that are listed.
    if values.len() > LISTED_VALUES {
        values.select_nth_unstable_by(LISTED_VALUES, order);
        values.truncate(LISTED_VALUES);
    }
    values.sort_unstable_by(order);
    AttributeFacts {
        count: counted.values.values().sum(),
        nulls: counted.nulls,
        kind,
        min,
        max,
        values: values.into_iter().map(|(key, count)| (key.json(city), count)).collect(),
        distinct: counted.values.len() as u64,
    }
}

/// Whether `text` is an ISO 8601 calendar date, `2019-05-31`, with or without a time of day after it
/// (`T12:30:00Z`, `T12:30:00.5+02:00`).
fn is_date(text: &str) -> bool {
    let number = |part: &str, digits: usize| {
        (part.len() == digits && part.bytes().all(|b| b.is_ascii_digit())).then(|| part.parse::<u32>().ok()).flatten()
    };
    let (date, time) = match text.split_once(['T', ' ']) {
        Some((date, time)) => (date, Some(time)),
        None => (text, None),
    };
    let mut parts = date.splitn(3, '-');
    let (Some(year), Some(month), Some(day)) = (parts.next(), parts.next(), parts.next()) else { return false };
    let (Some(year), Some(month), Some(day)) = (number(year, 4), number(month, 2), number(day, 2)) else {
        return false;
    };
    let leap = year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
    let days = match month {
        2 => 28 + u32::from(leap),
        4 | 6 | 9 | 11 => 30,
        1..=12 => 31,
        _ => return false,
    };
    let is_time = |time: &str| {
        let clock = time.strip_suffix('Z').unwrap_or(time);
        let (clock, zone) = match clock.rfind(['+', '-']) {
            Some(at) => (&clock[..at], Some(&clock[at + 1..])),
            None => (clock, None),
        };
        let numeric = |part: &str| !part.is_empty() && part.bytes().all(|b| b.is_ascii_digit() || b".:".contains(&b));
        clock.len() >= 5 && clock.as_bytes()[2] == b':' && numeric(clock) && zone.is_none_or(numeric)
    };
    (1..=days).contains(&day) && time.is_none_or(is_time)
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use serde_json::json;

    use super::*;
    use crate::{
        city::{
            model::{CityObject, Geometry, Lod, ObjectClass, Source},
            warning::WarningCode,
        },
        geom::Aabb,
    };

    /// A bare object: id, type, first parent, attributes.
    type Bare<'a> = (&'a str, &'a str, Option<u32>, &'a [(&'a str, serde_json::Value)]);

    fn city(objects: &[Bare<'_>]) -> CityModel {
        let mut city = CityModel::default();
        for (id, kind, parent, attributes) in objects {
            let start = city.attributes.len() as u32;
            for (name, value) in *attributes {
                let name = city.strings.intern(name);
                let value = match value {
                    serde_json::Value::Null => Value::Null,
                    serde_json::Value::Bool(b) => Value::Boolean(*b),
                    serde_json::Value::Number(n) if n.is_i64() => Value::Integer(n.as_i64().unwrap()),
                    serde_json::Value::Number(n) => Value::Number(n.as_f64().unwrap()),
                    serde_json::Value::String(s) => Value::String(city.strings.intern(s)),
                    list @ serde_json::Value::Array(_) => Value::Array(city.strings.intern(&list.to_string())),
                    table => Value::Object(city.strings.intern(&table.to_string())),
                };
                city.attributes.push(Attribute { name, value });
            }
            city.objects.push(CityObject {
                id: (*id).into(),
                kind: city.strings.intern(kind),
                class: ObjectClass::Building,
                parents: parent.iter().copied().collect(),
                children: Vec::new(),
                attributes: start..city.attributes.len() as u32,
                geometries: 0..0,
            });
        }
        city
    }

    fn attribute(values: &[serde_json::Value]) -> AttributeFacts {
        let pairs: Vec<_> = values.iter().map(|v| [("a", v.clone())]).collect();
        let objects: Vec<_> = pairs.iter().map(|p| ("x", "Building", None, p.as_slice())).collect();
        facts(&city(&objects), false).attributes.remove(0).1
    }

    #[test]
    fn nothing_has_facts_too() {
        let json = serde_json::to_value(facts(&CityModel::default(), true)).unwrap();
        let empty = json!({
            "format": "", "version": null, "crs": null, "crs_raw": null, "extent": null,
            "objects": {"total": 0, "by_type": {}, "list": []}, "lods": {}, "attributes": {}, "joins": [], "timetables": [], "time": null,
            "textures": {"declared": 0, "found": 0}, "faces_dropped": 0, "warnings": [],
        });
        assert_eq!(json, empty);
    }

    #[test]
    fn attributes_know_their_type() {
        for (values, kind) in [
            (vec![json!(1), json!(2)], "integer"),
            (vec![json!(1), json!(2.5)], "number"),
            (vec![json!(1.0)], "number"),
            (vec![json!("a"), json!("2001-01-01")], "string"),
            (vec![json!("2001-01-31"), json!("2024-02-29T10:00:00Z")], "date"),
            (vec![json!("2001-02-29")], "string"),
            (vec![json!(true), json!(null)], "boolean"),
            (vec![json!([1, 2])], "array"),
            (vec![json!({"b": 1})], "object"),
            (vec![json!(1), json!("1")], "mixed"),
        ] {
            assert_eq!(attribute(&values).kind, Some(kind), "{values:?}");
        }
        let nothing = attribute(&[json!(null)]);
        assert_eq!((nothing.kind, nothing.count, nothing.nulls), (None, 0, 1));
    }

    #[test]
    fn values_are_most_frequent_first_and_ties_by_value() {
        let facts = attribute(&[json!(10), json!(9), json!(3), json!(3.0), json!(null), json!(-1)]);
        let values = [(json!(3), 2), (json!(-1), 1), (json!(9), 1), (json!(10), 1)];
        assert_eq!(facts.values, values);
        assert_eq!((facts.count, facts.nulls, facts.distinct), (5, 1, 4));
        assert_eq!((facts.min, facts.max), (Some(json!(-1)), Some(json!(10))));
    }

    #[test]
    fn sixty_four_of_many_values_are_listed() {
        let values: Vec<_> = (0..1000).map(|i| json!(format!("v{:04}", i % 500 + i / 900))).collect();
        let facts = attribute(&values);
        assert_eq!(facts.values.len(), 64);
        assert_eq!(facts.distinct, 501);
        let mut all = std::collections::BTreeMap::new();
        for value in &values {
            *all.entry(value.as_str().unwrap()).or_insert(0) += 1;
        }
        let mut expected: Vec<_> = all.into_iter().map(|(v, n)| (json!(v), n)).collect();
        expected.sort_by_key(|(_, n)| std::cmp::Reverse(*n));
        assert_eq!(facts.values, expected[..64]);
    }

    #[test]
    fn types_stand_below_the_types_of_their_parents() {
        let city = city(&[
            ("part", "BuildingPart", Some(1), &[]),
            ("house", "Building", None, &[]),
            ("shed", "Building", None, &[]),
            ("room", "BuildingRoom", Some(0), &[]),
            ("road", "Road", None, &[]),
        ]);
        let facts = facts(&city, true);
        let tree: Vec<_> = facts.tree.iter().map(|l| (l.depth, l.kind.as_str(), l.count)).collect();
        assert_eq!(tree, [(0, "Building", 2), (1, "BuildingPart", 1), (2, "BuildingRoom", 1), (0, "Road", 1)]);
        let list = facts.objects.list.unwrap();
        assert_eq!(list[0].parents, ["house"]);
        assert_eq!(facts.objects.by_type[0], ("Building".to_owned(), 2));
    }

    #[test]
    fn levels_count_objects_once() {
        let mut city = city(&[("a", "Building", None, &[]), ("b", "Building", None, &[])]);
        for (object, lod) in [(0, "1.2"), (0, "2"), (0, "2"), (1, "2")] {
            city.geometries.push(Geometry {
                object,
                lod: Lod::parse(lod).unwrap(),
                solid: true,
                polygons: 5,
                dropped: 1,
                triangles: 10,
                grid: 0,
                tiles: 0..0,
                bounds: Aabb::EMPTY,
            });
        }
        city.objects[0].geometries = 0..3;
        city.objects[1].geometries = 3..4;
        let facts = facts(&city, true);
        let two = LodFacts { objects: 2, polygons: 15, triangles: 30 };
        assert_eq!(facts.lods[1], ("2".to_owned(), two));
        assert_eq!(facts.lods[0].0, "1.2");
        assert_eq!(facts.faces_dropped, 4);
        assert_eq!(facts.objects.list.unwrap()[0].lods, ["1.2", "2"]);
    }

    #[test]
    fn several_files_are_joined() {
        let mut city = CityModel::default();
        for (format, version) in [("CityJSON", "1.0"), ("CityJSON", "2.0"), ("OBJ", ""), ("CityJSON", "1.0")] {
            city.sources.push(Source { path: "x".into(), format, version: version.into() });
        }
        city.extent_as_read = Aabb { min: DVec3::ZERO, max: DVec3::new(1.0, 2.0, 3.5) };
        city.warnings.add(WarningCode::ZeroArea, "a", || "a: face 3".into());
        let facts = facts(&city, false);
        assert_eq!((facts.format.as_str(), facts.version.as_deref()), ("CityJSON+OBJ", Some("1.0+2.0")));
        let json = serde_json::to_value(&facts).unwrap();
        assert_eq!(json["extent"], json!({"min": [0.0, 0.0, 0.0], "max": [1.0, 2.0, 3.5]}));
        assert_eq!(
            json["warnings"],
            json!([{"code": "zero-area", "count": 1, "objects": ["a"], "message": "a: face 3"}])
        );
        assert!(json["objects"].get("list").is_none());
    }
}
