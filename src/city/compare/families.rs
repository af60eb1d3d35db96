//! Changes of parts are changes of wholes: rolled up along parents.

use crate::city::{
    compare::{matching::Matching, state::Differences},
    model::{CityModel, NONE},
};

/// Both states as one graph: a node for each object that is in both, for each that went and for each that came.
pub(super) struct Families<'a> {
    before: &'a CityModel,
    after: &'a CityModel,
    matching: &'a Matching,
    /// By object of the earlier state, its node; pairs come first.
    of_before: Vec<u32>,
    of_after: Vec<u32>,
    nodes: usize,
}

impl<'a> Families<'a> {
    pub fn new(before: &'a CityModel, after: &'a CityModel, matching: &'a Matching) -> Self {
        let mut nodes = matching.pairs.len() as u32;
        let mut numbered = |pairs: &[u32]| -> Vec<u32> {
            let mut node = |pair: u32| {
                nodes += u32::from(pair == NONE);
                if pair == NONE { nodes - 1 } else { pair }
            };
            pairs.iter().map(|pair| node(*pair)).collect()
        };
        let of_before = numbered(&matching.of_before);
        let of_after = numbered(&matching.of_after);
        Self { before, after, matching, of_before, of_after, nodes: nodes as usize }
    }

    /// Of each pair, what differs in it and below it; `own` is what differs in itself.
    pub fn rolled_up(&self, own: &[Differences]) -> Vec<Differences> {
        let mut found = vec![Differences::default(); self.nodes];
        found[..own.len()].copy_from_slice(own);
        self.note_parts(&mut found);
        let ups = self.parents();
        let mut open: Vec<u32> = (0..self.nodes as u32).filter(|node| !found[*node as usize].is_none()).collect();
        // What is found at a node only grows, twice at most: each is passed on as often.
        while let Some(node) = open.pop() {
            for up in &ups[node as usize] {
                let all = found[*up as usize].and(found[node as usize]);
                if all != found[*up as usize] {
                    found[*up as usize] = all;
                    open.push(*up);
                }
            }
        }
        found.truncate(own.len());
        found
    }

    /// What parts add to a family that came, went, or belong to another one now.
    fn note_parts(&self, found: &mut [Differences]) {
        let sides = [(self.before, &self.of_before), (self.after, &self.of_after)];
        for (model, nodes) in sides {
            for (object, node) in model.objects.iter().zip(nodes) {
                if *node as usize >= self.matching.pairs.len() {
                    found[*node as usize] = Differences::of_part(!object.geometries.is_empty());
                }
            }
        }
        for (number, pair) in self.matching.pairs.iter().enumerate() {
            let children = |model: &CityModel, object: u32, nodes: &[u32]| {
                let children = model.objects[object as usize].children.iter().map(|child| nodes[*child as usize]);
                let mut pairs: Vec<u32> =
                    children.filter(|node| (*node as usize) < self.matching.pairs.len()).collect();
                pairs.sort_unstable();
                pairs.dedup();
                pairs
            };
            let old = children(self.before, pair.before, &self.of_before);
            let new = children(self.after, pair.after, &self.of_after);
            if old == new {
                continue;
            }
            let moved = old.iter().filter(|node| new.binary_search(node).is_err());
            let moved = moved.chain(new.iter().filter(|node| old.binary_search(node).is_err()));
            for node in moved {
                let part = self.matching.pairs[*node as usize];
                let bounds = self.before.family_bounds(part.before).union(self.after.family_bounds(part.after));
                found[number] = found[number].and(Differences::of_part(!bounds.is_empty()));
            }
        }
    }

    /// The nodes of the parents of each node, in either state.
    fn parents(&self) -> Vec<Vec<u32>> {
        let mut ups = vec![Vec::new(); self.nodes];
        let sides = [(self.before, &self.of_before), (self.after, &self.of_after)];
        for (model, nodes) in sides {
            for (object, node) in model.objects.iter().zip(nodes) {
                let own = &mut ups[*node as usize];
                own.extend(object.parents.iter().map(|parent| nodes[*parent as usize]));
                own.sort_unstable();
                own.dedup();
            }
        }
        ups
    }
}
