//! Two states of a city compared: `--compare`.

use std::path::PathBuf;

use serde::Serialize;

use super::{Arguments, spec};
use crate::{
    city::{
        CityModel,
        compare::{
            AttributeCounts, CompareError, Compared, Comparison, Counts, Key, MatchedBy, RepeatedKey, Side, State,
        },
        crs::Frames,
        facts::{as_map, to_json},
        measured::OfObject,
    },
    cli::{
        arguments::GlobalArguments,
        failure::{Failure, Outcome},
        load, output, report,
        terminal::Paint,
    },
    lens::nearest::did_you_mean,
};

/// Values of the key that are named.
const NAMED: usize = 8;

/// What became of a city.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CompareFacts {
    /// The earlier state.
    pub before: StateFacts,
    /// The later state.
    pub after: StateFacts,
    /// The attribute that objects were matched by; `None`: their ids.
    pub key: Option<String>,
    /// How far corners may be apart along each axis and be the same, metres.
    pub tolerance_m: [f64; 3],
    /// All objects, each for itself.
    pub objects: Counts,
    /// Objects without parents, each with all below it.
    pub roots: Counts,
    /// All objects by type, in the later state where they are in it; those of most objects first.
    #[serde(serialize_with = "as_map")]
    pub by_type: Vec<(String, Counts)>,
    /// How objects that are in both states were found.
    pub matched: MatchedFacts,
    /// Objects in both states whose type differs.
    pub types_changed: u64,
    /// Attributes whose values differ, most first.
    #[serde(serialize_with = "as_map")]
    pub attributes: Vec<(String, AttributeCounts)>,
    /// Values of the key that several objects of one state have.
    pub repeated_keys: u64,
    /// The first of them.
    pub first_repeated_keys: Vec<RepeatedKey>,
    /// Volumes of objects without parents.
    pub volume_m3: VolumeFacts,
    /// Each object that is not the same in both states; only when asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub list: Option<Vec<ListedChange>>,
}

/// A state of a city.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StateFacts {
    /// Its files.
    pub files: Vec<PathBuf>,
    /// Its reference system.
    pub crs: Option<String>,
    /// Its city objects.
    pub objects: u64,
}

/// Objects that are in both states, by how they were found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct MatchedFacts {
    /// By equal ids.
    pub id: u64,
    /// By equal values of the key.
    pub key: u64,
    /// One names the other as its predecessor or successor.
    pub version: u64,
    /// As parts of what was matched by key or as versions.
    pub part: u64,
}

/// Volumes of objects without parents, with all below them, cubic metres; `None` where none of them is closed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct VolumeFacts {
    /// Of those in the earlier state alone.
    pub removed: Option<f64>,
    /// Of those in the later state alone.
    pub added: Option<f64>,
    /// Of those whose geometry differs and that are closed in both, in the earlier state.
    pub changed_before: Option<f64>,
    /// The same in the later state.
    pub changed_after: Option<f64>,
}

/// An object that is not the same in both states.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ListedChange {
    /// Its id, in the later state where it is in it.
    pub id: String,
    /// Its type.
    #[serde(rename = "type")]
    pub kind: String,
    /// `added`, `removed`, `changed`.
    pub state: &'static str,
    /// Its id in the earlier state, where it is another one.
    pub id_before: Option<String>,
    /// Its type in the earlier state, where it is another one.
    pub type_before: Option<String>,
    /// How it was found in the other state.
    pub matched_by: Option<MatchedBy>,
    /// Whether its own faces differ.
    pub geometry: bool,
    /// Attributes that differ, each with its earlier and its later value.
    #[serde(serialize_with = "as_map")]
    pub attributes: Vec<(String, [serde_json::Value; 2])>,
    /// Whether something below it was added, removed or changed that adds to what differs.
    pub parts: bool,
}

/// Loads both states and says what became of the first.
pub fn run(arguments: &Arguments, global: &GlobalArguments) -> Outcome {
    let [old, new] = &arguments.files[..] else {
        let count = arguments.files.len();
        return Err(Failure::usage(format!(
            "info --compare: two states would be right, the earlier one first, each a file, a folder or a scene (.toml); {count} given"
        )));
    };
    if [old, new].iter().all(|file| file.as_os_str() == "-") {
        return Err(Failure::usage("info --compare: one of both states can come from stdin; the other needs a FILE"));
    }
    let (old_spec, new_spec) =
        (spec(std::slice::from_ref(old), arguments, global)?, spec(std::slice::from_ref(new), arguments, global)?);
    let (before, _) = load::load_city(&old_spec, Frames::default(), global)?;
    let (after, _) = load::load_city(&new_spec, before.frames, global)?;
    let key = arguments.key.clone().map_or(Key::Id, Key::Attribute);
    let comparison = Comparison::new(&before, &after, &key).map_err(|error| {
        let name = |side: Side| if side == Side::Before { old } else { new }.display().to_string();
        Failure::failed(message(&error, name, [&before, &after]))
    })?;
    let facts = CompareFacts::new(&before, &after, &comparison, arguments);
    if arguments.json {
        let answer = serde_json::json!({ "compare": facts });
        return output::print(&(serde_json::to_string_pretty(&answer).map_err(Failure::failed)? + "\n"));
    }
    output::print(&report::compare_text(&facts, Paint::for_stdout()))
}

/// An error in words: the files, what is wrong, what would be right.
fn message(error: &CompareError, name: impl Fn(Side) -> String, cities: [&CityModel; 2]) -> String {
    let (old, new) = (name(Side::Before), name(Side::After));
    match error {
        CompareError::References { before, after } => format!(
            "{new}: its reference system is {after}, that of {old} is {before}; two states in one reference system would be right"
        ),
        CompareError::Frames => format!("{new}: cannot be compared with {old}: {error}"),
        CompareError::NoKey { attribute, side } => {
            let city = if *side == Side::Before { cities[0] } else { cities[1] };
            let attributes = (0..city.objects.len() as u32).flat_map(|object| city.attributes_of(object));
            let mut names: Vec<_> = attributes.map(|attribute| attribute.name).collect();
            names.sort_unstable();
            names.dedup();
            let hint = did_you_mean(attribute, names.iter().map(|name| city.strings.get(*name)));
            format!("{}: --key: {error}{hint}", name(*side))
        }
    }
}

impl CompareFacts {
    /// The facts of a comparison; the arguments say what is asked for.
    pub fn new(before: &CityModel, after: &CityModel, comparison: &Comparison, arguments: &Arguments) -> Self {
        let mut matched = MatchedFacts::default();
        for by in comparison.after.iter().filter_map(|compared| compared.by) {
            *match by {
                MatchedBy::Id => &mut matched.id,
                MatchedBy::Key => &mut matched.key,
                MatchedBy::Version => &mut matched.version,
                MatchedBy::Part => &mut matched.part,
            } += 1;
        }
        let repeated = &comparison.repeated_keys;
        Self {
            before: StateFacts::new(before),
            after: StateFacts::new(after),
            key: arguments.key.clone(),
            // Without the dust of its computation: to a tenth of a micrometre.
            tolerance_m: comparison.tolerance.to_array().map(|metres| (metres * 1e7).round() / 1e7),
            objects: comparison.objects,
            roots: comparison.roots,
            by_type: by_type(before, after, comparison),
            matched,
            types_changed: comparison.types_changed,
            attributes: comparison.attributes.clone(),
            repeated_keys: repeated.len() as u64,
            first_repeated_keys: repeated.iter().take(NAMED).cloned().collect(),
            volume_m3: VolumeFacts::new(before, after, comparison),
            list: arguments.list.then(|| list(before, after, comparison)),
        }
    }
}

impl StateFacts {
    fn new(city: &CityModel) -> Self {
        Self {
            files: city.sources.iter().map(|source| source.path.clone()).collect(),
            crs: city.crs.clone(),
            objects: city.objects.len() as u64,
        }
    }
}

impl VolumeFacts {
    fn new(before: &CityModel, after: &CityModel, comparison: &Comparison) -> Self {
        let mut this = Self::default();
        let [olds, news] = [before, after].map(|city| city.measured_of_objects(OfObject::Volume));
        let add = |sum: &mut Option<f64>, volume: f64| {
            if volume.is_finite() {
                *sum = Some(sum.unwrap_or(0.0) + volume);
            }
        };
        let roots = |city: &CityModel| -> Vec<usize> {
            (0..city.objects.len()).filter(|object| city.objects[*object].parents.is_empty()).collect()
        };
        for object in roots(before) {
            if comparison.before[object].state == State::Removed {
                add(&mut this.removed, olds[object]);
            }
        }
        for object in roots(after) {
            let Compared { counterpart, state, .. } = comparison.after[object];
            match (state, counterpart) {
                (State::Added, _) => add(&mut this.added, news[object]),
                (State::Changed { geometry: true, .. }, Some(old)) => {
                    let (old, new) = (olds[old as usize], news[object]);
                    if old.is_finite() && new.is_finite() {
                        add(&mut this.changed_before, old);
                        add(&mut this.changed_after, new);
                    }
                }
                _ => {}
            }
        }
        this
    }
}

/// Counts of all objects by type, most objects first, then by name.
fn by_type(before: &CityModel, after: &CityModel, comparison: &Comparison) -> Vec<(String, Counts)> {
    let mut counts: std::collections::BTreeMap<&str, Counts> = std::collections::BTreeMap::new();
    let removed = comparison.before.iter().zip(&before.objects).filter(|(compared, _)| compared.counterpart.is_none());
    let removed = removed.map(|(compared, object)| (compared, before.strings.get(object.kind)));
    let others = comparison.after.iter().zip(&after.objects);
    let others = others.map(|(compared, object)| (compared, after.strings.get(object.kind)));
    removed.chain(others).for_each(|(compared, kind)| counts.entry(kind).or_default().add(compared.own));
    let total = |counts: &Counts| counts.added + counts.removed + counts.changed + counts.unchanged;
    let mut list: Vec<(String, Counts)> = counts.into_iter().map(|(kind, counts)| (kind.to_owned(), counts)).collect();
    list.sort_by_key(|(_, counts)| std::cmp::Reverse(total(counts)));
    list
}

/// Each object that is not the same: what went, in the order of the earlier state, then the others in that of the later one.
fn list(before: &CityModel, after: &CityModel, comparison: &Comparison) -> Vec<ListedChange> {
    let plain = |city: &CityModel, object: usize, state: &'static str| ListedChange {
        id: city.objects[object].id.to_string(),
        kind: city.strings.get(city.objects[object].kind).to_owned(),
        state,
        id_before: None,
        type_before: None,
        matched_by: None,
        geometry: false,
        attributes: Vec::new(),
        parts: false,
    };
    let removed = (0..before.objects.len()).filter(|object| comparison.before[*object].own == State::Removed);
    let mut list: Vec<ListedChange> = removed.map(|object| plain(before, object, "removed")).collect();
    let mut numbers = vec![usize::MAX; after.objects.len()];
    for (object, compared) in comparison.after.iter().enumerate() {
        let Some(old) = compared.counterpart.map(|old| &before.objects[old as usize]) else {
            list.push(plain(after, object, "added"));
            continue;
        };
        if compared.state == State::Unchanged {
            continue;
        }
        numbers[object] = list.len();
        let new = plain(after, object, "changed");
        let (id, kind) = (old.id.to_string(), before.strings.get(old.kind).to_owned());
        list.push(ListedChange {
            id_before: (id != new.id).then_some(id),
            type_before: (kind != new.kind).then_some(kind),
            matched_by: compared.by,
            geometry: matches!(compared.own, State::Changed { geometry: true, .. }),
            parts: compared.own != compared.state,
            ..new
        });
    }
    comparison.each_change(before, after, &mut |object, change| {
        let values = [to_json(before, change.before), to_json(after, change.after)];
        if let Some(listed) = list.get_mut(numbers[object as usize]) {
            listed.attributes.push((change.name.to_owned(), values));
        }
    });
    list
}
