//! Which object of a later state of a city is which of an earlier one.

use std::borrow::Cow;

use rustc_hash::FxHashMap;

use crate::city::{
    compare::state::{CompareError, Key, MatchedBy, RepeatedKey, Side},
    model::{CityModel, NONE, StringId, Value},
};

/// Attributes that name the objects that stood in the place of one before it.
const EARLIER: [&str; 2] = ["predecessor", "predecessors"];
/// Attributes that name those that stand there after it.
const LATER: [&str; 2] = ["successor", "successors"];

/// An object that is in both states.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Pair {
    pub before: u32,
    pub after: u32,
    pub by: MatchedBy,
}

/// All objects that are in both states.
#[derive(Debug, Default)]
pub(super) struct Matching {
    pub pairs: Vec<Pair>,
    /// By object of the earlier state the number of its pair, or [`NONE`].
    pub of_before: Vec<u32>,
    /// By object of the later state.
    pub of_after: Vec<u32>,
    /// Values of the key that several objects of one state have, by value.
    pub repeated: Vec<RepeatedKey>,
}

/// The values of the key of both states, by object.
struct Values<'a> {
    before: Vec<Option<Cow<'a, str>>>,
    after: Vec<Option<Cow<'a, str>>>,
}

impl Matching {
    /// Matches by the key, then by id, then by what names its predecessor or successor, then parts of what was matched so.
    pub fn new(before: &CityModel, after: &CityModel, key: &Key) -> Result<Self, CompareError> {
        let values = match key {
            Key::Id => Values { before: vec![None; before.objects.len()], after: vec![None; after.objects.len()] },
            Key::Attribute(name) => {
                Values { before: values(before, name, Side::Before)?, after: values(after, name, Side::After)? }
            }
        };
        let mut this = Self {
            of_before: vec![NONE; before.objects.len()],
            of_after: vec![NONE; after.objects.len()],
            ..Self::default()
        };
        this.by_key(&values);
        this.by_id(before, after, &values);
        this.by_version(before, after);
        this.by_parents(before, after, &values);
        Ok(this)
    }

    fn add(&mut self, before: u32, after: u32, by: MatchedBy) {
        let number = self.pairs.len() as u32;
        self.of_before[before as usize] = number;
        self.of_after[after as usize] = number;
        self.pairs.push(Pair { before, after, by });
    }

    fn are_open(&self, before: u32, after: u32) -> bool {
        self.of_before[before as usize] == NONE && self.of_after[after as usize] == NONE
    }

    /// Matches values that one object of each state has; notes those that more have.
    fn by_key(&mut self, values: &Values) {
        /// How many objects of a state have a value, and the first.
        #[derive(Clone, Copy, Default)]
        struct Owners {
            count: u32,
            first: u32,
        }
        let mut owners: FxHashMap<&str, [Owners; 2]> = FxHashMap::default();
        for (side, of_side) in [&values.before, &values.after].into_iter().enumerate() {
            for (object, value) in of_side.iter().enumerate() {
                let Some(value) = value else { continue };
                let own = &mut owners.entry(value).or_default()[side];
                own.first = if own.count == 0 { object as u32 } else { own.first };
                own.count += 1;
            }
        }
        let has_several = |(_, [a, b]): &(&&str, &[Owners; 2])| a.count > 1 || b.count > 1;
        let repeated = |(value, [a, b]): (&&str, &[Owners; 2])| RepeatedKey {
            value: (*value).to_owned(),
            before: a.count,
            after: b.count,
        };
        self.repeated = owners.iter().filter(has_several).map(repeated).collect();
        self.repeated.sort_unstable();
        for (object, value) in values.before.iter().enumerate() {
            let Some([a, b]) = value.as_ref().and_then(|value| owners.get(&**value)) else { continue };
            if a.count == 1 && b.count == 1 {
                self.add(object as u32, b.first, MatchedBy::Key);
            }
        }
    }

    /// Matches equal ids, where no values of the key say that these are two objects.
    fn by_id(&mut self, before: &CityModel, after: &CityModel, values: &Values) {
        for (object, old) in (0..).zip(&before.objects) {
            let Some(new) = after.find_object(&old.id).filter(|new| self.are_open(object, *new)) else { continue };
            let are_others = match (&values.before[object as usize], &values.after[new as usize]) {
                (Some(a), Some(b)) => a != b,
                _ => false,
            };
            if !are_others {
                self.add(object, new, MatchedBy::Id);
            }
        }
    }

    /// Matches what is left where one object names the other, whichever state it is in; of several in the order of their ids.
    fn by_version(&mut self, before: &CityModel, after: &CityModel) {
        /// The ids of what came first and what came later, and their numbers in the earlier and in the later state.
        type Named<'a> = (&'a str, &'a str, u32, u32);
        let mut found: Vec<Named> = Vec::new();
        let sides = [(before, &self.of_before, after), (after, &self.of_after, before)];
        for (side, (model, matched, other)) in sides.into_iter().enumerate() {
            for (names, is_earlier) in [(EARLIER, true), (LATER, false)] {
                let names = names.map(|name| model.strings.find(name));
                let open = (0..model.objects.len() as u32).filter(|object| matched[*object as usize] == NONE);
                for object in open.filter(|_| names.iter().any(Option::is_some)) {
                    let attributes = model.attributes_of(object).iter();
                    let ids = attributes.filter(|a| names.contains(&Some(a.name))).flat_map(|a| ids_in(model, a.value));
                    for named in ids.filter_map(|id| other.find_object(&id)) {
                        let (own, of_other) = (&*model.objects[object as usize].id, &*other.objects[named as usize].id);
                        let [first, second] = if is_earlier { [of_other, own] } else { [own, of_other] };
                        let [before, after] = if side == 0 { [object, named] } else { [named, object] };
                        found.push((first, second, before, after));
                    }
                }
            }
        }
        found.sort_unstable();
        for (_, _, before, after) in found {
            if self.are_open(before, after) {
                self.add(before, after, MatchedBy::Version);
            }
        }
    }

    /// Matches parts whose ids say nothing: in their order, where both parents have as many of a type left.
    fn by_parents(&mut self, before: &CityModel, after: &CityModel, values: &Values) {
        let mut at = 0;
        while let Some(&Pair { before: old, after: new, by }) = self.pairs.get(at) {
            at += 1;
            if by == MatchedBy::Id {
                continue;
            }
            let old = left(before, old, &self.of_before, &values.before);
            let mut new: FxHashMap<&str, Vec<u32>> =
                left(after, new, &self.of_after, &values.after).into_iter().collect();
            for (kind, olds) in old {
                let news = new.remove(kind).filter(|news| news.len() == olds.len()).unwrap_or_default();
                olds.into_iter().zip(news).for_each(|(a, b)| self.add(a, b, MatchedBy::Part));
            }
        }
    }
}

/// Children of an object that are not matched and have no value of the key, by type, in order.
fn left<'a>(
    model: &'a CityModel,
    object: u32,
    matched: &[u32],
    values: &[Option<Cow<'_, str>>],
) -> Vec<(&'a str, Vec<u32>)> {
    let children = model.objects[object as usize].children.iter().copied();
    let mut open: Vec<u32> =
        children.filter(|child| matched[*child as usize] == NONE && values[*child as usize].is_none()).collect();
    open.sort_unstable();
    open.dedup();
    let mut by_kind: Vec<(StringId, Vec<u32>)> = Vec::new();
    for child in open {
        let kind = model.objects[child as usize].kind;
        match by_kind.iter_mut().find(|(known, _)| *known == kind) {
            Some((_, list)) => list.push(child),
            None => by_kind.push((kind, vec![child])),
        }
    }
    by_kind.into_iter().map(|(kind, list)| (model.strings.get(kind), list)).collect()
}

/// Of each object the value of the key.
fn values<'a>(model: &'a CityModel, name: &str, side: Side) -> Result<Vec<Option<Cow<'a, str>>>, CompareError> {
    let id = model.strings.find(name);
    let of = |object: u32| {
        let own = model.attributes_of(object).iter().find(|attribute| Some(attribute.name) == id)?;
        let text: Cow<'a, str> = match own.value {
            Value::String(text) => model.strings.get(text).trim().into(),
            Value::Integer(number) => number.to_string().into(),
            Value::Number(number) => number.to_string().into(),
            Value::Null | Value::Boolean(_) | Value::Array(_) | Value::Object(_) => return None,
        };
        (!text.is_empty()).then_some(text)
    };
    let values: Vec<_> = (0..model.objects.len() as u32).map(of).collect();
    match values.is_empty() || values.iter().any(Option::is_some) {
        true => Ok(values),
        false => Err(CompareError::NoKey { attribute: name.to_owned(), side }),
    }
}

/// The ids that a value names: a text, or a list of texts.
fn ids_in(model: &CityModel, value: Value) -> Vec<Cow<'_, str>> {
    match value {
        Value::String(id) => vec![model.strings.get(id).into()],
        Value::Array(json) => {
            let list: Vec<serde_json::Value> = serde_json::from_str(model.strings.get(json)).unwrap_or_default();
            list.iter().filter_map(|id| Some(id.as_str()?.to_owned().into())).collect()
        }
        _ => Vec::new(),
    }
}
