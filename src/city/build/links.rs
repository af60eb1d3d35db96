//! Ids made unique, parents and children resolved; linear in the number of objects and links.

use rustc_hash::{FxHashMap, FxHashSet};

use super::KeptObject;
use crate::city::warning::{WarningCode, Warnings};

/// Ids unique over the whole city: the first keeps its own, later ones become `ID#2`, `ID#3`, ...
pub(super) fn unique_ids(objects: &[KeptObject], warnings: &mut Warnings) -> Vec<Box<str>> {
    let mut own: FxHashSet<&str> = FxHashSet::default();
    own.reserve(objects.len());
    let mut made: FxHashSet<Box<str>> = FxHashSet::default();
    let mut repeats: FxHashMap<&str, u32> = FxHashMap::default();
    objects
        .iter()
        .map(|object| {
            let mut id = object.id.clone();
            while own.contains(&*id) || made.contains(&id) {
                let number = repeats.entry(&object.id).or_insert(1);
                *number += 1;
                id = format!("{}#{number}", object.id).into();
            }
            if id == object.id {
                own.insert(&object.id);
            } else {
                warnings.add(WarningCode::DuplicateId, &id, || {
                    format!("the id {:?} is used before; this object is called {id:?}", object.id)
                });
                made.insert(id.clone());
            }
            id
        })
        .collect()
}

/// Parents and children of every object, by index.
#[derive(Debug, Default)]
pub(super) struct Links {
    pub(super) parents: Vec<Vec<u32>>,
    pub(super) children: Vec<Vec<u32>>,
}

/// Resolves links by id within each file (`file_starts`: first object of each). A link given on one side only is given
/// to both; a link to nowhere and a link that closes a cycle are dropped.
pub(super) fn resolve(objects: &[KeptObject], ids: &[Box<str>], file_starts: &[u32], warnings: &mut Warnings) -> Links {
    let mut links = Links { parents: vec![Vec::new(); objects.len()], children: vec![Vec::new(); objects.len()] };
    let mut ends: Vec<usize> = file_starts.iter().skip(1).map(|&start| start as usize).collect();
    ends.push(objects.len());
    let mut start = 0;
    for end in ends {
        resolve_file(&objects[start..end], &ids[start..end], start as u32, &mut links, warnings);
        start = end;
    }
    cut_cycles(ids, &mut links, warnings);
    links
}

fn resolve_file(objects: &[KeptObject], ids: &[Box<str>], base: u32, links: &mut Links, warnings: &mut Warnings) {
    if objects.iter().all(|object| object.parents.is_empty() && object.children.is_empty()) {
        return;
    }
    let mut by_id: FxHashMap<&str, u32> = FxHashMap::default();
    for (i, object) in objects.iter().enumerate() {
        by_id.entry(&object.id).or_insert(base + i as u32);
    }
    let mut seen: [FxHashSet<(u32, u32)>; 2] = Default::default();
    for (i, object) in objects.iter().enumerate() {
        let own = base + i as u32;
        let mut find = |other: &String, what: &str| {
            let found = by_id.get(other.as_str()).copied();
            if found.is_none() {
                warnings.add(WarningCode::DanglingLink, &ids[i], || {
                    format!("object {:?} names {other:?} as its {what}, which is not in the file", ids[i])
                });
            }
            found
        };
        for parent in object.parents.iter().filter_map(|id| find(id, "parent")) {
            if seen[0].insert((parent, own)) {
                links.parents[own as usize].push(parent);
            }
        }
        for child in object.children.iter().filter_map(|id| find(id, "child")) {
            if seen[1].insert((own, child)) {
                links.children[own as usize].push(child);
            }
        }
    }
    // What one side left out, in object order.
    for i in base..base + objects.len() as u32 {
        for k in 0..links.children[i as usize].len() {
            let child = links.children[i as usize][k];
            if seen[0].insert((i, child)) {
                links.parents[child as usize].push(i);
            }
        }
        for k in 0..links.parents[i as usize].len() {
            let parent = links.parents[i as usize][k];
            if seen[1].insert((parent, i)) {
                links.children[parent as usize].push(i);
            }
        }
    }
}

/// Drops every link that leads from an object back to itself, walking up from each object in turn (no recursion: chains
/// may be a million long).
fn cut_cycles(ids: &[Box<str>], links: &mut Links, warnings: &mut Warnings) {
    #[derive(Clone, Copy, PartialEq)]
    enum State {
        New,
        OnPath,
        Done,
    }
    let mut state = vec![State::New; links.parents.len()];
    let mut cut: FxHashSet<(u32, u32)> = FxHashSet::default();
    let mut path: Vec<(u32, usize)> = Vec::new();
    for first in 0..links.parents.len() as u32 {
        if state[first as usize] != State::New {
            continue;
        }
        state[first as usize] = State::OnPath;
        path.push((first, 0));
        while let Some((object, next)) = path.last_mut() {
            let object = *object;
            let Some(&parent) = links.parents[object as usize].get(*next) else {
                state[object as usize] = State::Done;
                path.pop();
                continue;
            };
            *next += 1;
            match state[parent as usize] {
                State::New => {
                    state[parent as usize] = State::OnPath;
                    path.push((parent, 0));
                }
                State::OnPath => {
                    cut.insert((parent, object));
                    warnings.add(WarningCode::CyclicParents, &ids[object as usize], || {
                        let (object, parent) = (&ids[object as usize], &ids[parent as usize]);
                        format!("object {object:?} has the parent {parent:?}, which descends from it; link dropped")
                    });
                }
                State::Done => {}
            }
        }
    }
    if !cut.is_empty() {
        for object in 0..links.parents.len() as u32 {
            links.parents[object as usize].retain(|&parent| !cut.contains(&(parent, object)));
            links.children[object as usize].retain(|&child| !cut.contains(&(object, child)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn object(id: &str, parents: &[&str], children: &[&str]) -> KeptObject {
        let own = |ids: &[&str]| ids.iter().map(|&s| s.to_owned()).collect();
        KeptObject {
            id: id.into(),
            parents: own(parents),
            children: own(children),
            kind: 0,
            class: crate::city::model::ObjectClass::Other,
            attributes: 0..0,
        }
    }

    fn linked(objects: &[KeptObject], file_starts: &[u32]) -> (Vec<Box<str>>, Links, Warnings) {
        let mut warnings = Warnings::default();
        let ids = unique_ids(objects, &mut warnings);
        let links = resolve(objects, &ids, file_starts, &mut warnings);
        (ids, links, warnings)
    }

    #[test]
    fn repeated_ids_are_numbered() {
        let objects = ["a", "a", "a#2", "a", "b"].map(|id| object(id, &[], &[]));
        let (ids, _, warnings) = linked(&objects, &[0]);
        assert_eq!(ids.iter().map(|id| &**id).collect::<Vec<_>>(), ["a", "a#2", "a#2#2", "a#3", "b"]);
        assert_eq!(warnings.count(WarningCode::DuplicateId), 3);
    }

    #[test]
    fn links_are_symmetric_and_stay_in_their_file() {
        let objects = [
            object("a", &[], &["b", "c"]),
            object("b", &[], &[]),
            object("c", &["a"], &[]),
            object("d", &["a", "nowhere"], &[]),
            // The second file repeats the ids.
            object("a", &[], &[]),
            object("e", &["a"], &["b"]),
        ];
        let (_, links, warnings) = linked(&objects, &[0, 4]);
        assert_eq!(links.children[0], [1, 2, 3]);
        assert_eq!(links.parents[1], [0]);
        assert_eq!(links.parents[3], [0]);
        assert_eq!(links.parents[5], [4]);
        assert_eq!(links.children[4], [5]);
        assert_eq!(warnings.count(WarningCode::DanglingLink), 2);
    }

    #[test]
    fn cycles_are_cut_once() {
        let objects =
            [object("a", &["b"], &[]), object("b", &["c"], &[]), object("c", &["a"], &[]), object("d", &["d"], &[])];
        let (_, links, warnings) = linked(&objects, &[0]);
        assert_eq!(links.parents, [vec![1], vec![2], vec![], vec![]]);
        assert_eq!(links.children, [vec![], vec![0], vec![1], vec![]]);
        assert_eq!(warnings.count(WarningCode::CyclicParents), 2);
    }

    #[test]
    fn a_chain_of_a_hundred_thousand_is_walked_without_recursion() {
        let objects: Vec<_> = (0..100_000).map(|i| object(&i.to_string(), &[&(i + 1).to_string()], &[])).collect();
        let (_, links, warnings) = linked(&objects, &[0]);
        assert_eq!(warnings.count(WarningCode::DanglingLink), 1);
        assert_eq!(links.parents[99_998], [99_999]);
    }
}
