//! Semantic surfaces: which polygon is a roof, and what is known about it.

use crate::city::{
    build::ModelBuilder,
    cityjson::{
        geometry::{GeometryRead, Semantic},
        nested::Token,
    },
    model::{NONE, StringId},
    warning::WarningCode,
};

/// A polygon's semantics: its type and its detail, or `NONE` in both.
pub type Meaning = (StringId, u32);

/// No semantics.
pub const NOTHING: Meaning = (StringId(NONE), NONE);

/// The semantics of each polygon of a geometry whose rings lie at `depth`.
pub fn of_polygons(geometry: &GeometryRead, depth: usize, builder: &mut ModelBuilder, object: &str) -> Vec<Meaning> {
    let mut out = vec![NOTHING; geometry.boundaries.ends[depth - 1].len()];
    let Some(values) = geometry.semantic_values.as_ref().filter(|_| !geometry.semantics.is_empty()) else {
        return out;
    };
    let mut chosen = vec![NONE; out.len()];
    let mut bad = 0_u64;
    let wrong = values.for_each(&geometry.boundaries.ends[..depth - 1], |polygon, tokens| match tokens {
        [Token::Index(index)] if (*index as usize) < geometry.semantics.len() => chosen[polygon] = *index,
        [Token::Null] | [Token::Open, Token::Null, Token::Close] => {}
        _ => bad += 1,
    });
    if bad > 0 {
        builder.model.warnings.add(WarningCode::SemanticsMismatch, object, || {
            format!(
                "object {object}: {bad} polygons name a semantic surface past the list of {}",
                geometry.semantics.len()
            )
        });
    }
    if wrong > 0 {
        builder.model.warnings.add(WarningCode::SemanticsMismatch, object, || {
            format!("object {object}: {wrong} places in semantics.values do not match the boundaries; their polygons have none")
        });
    }
    let details = add_details(&geometry.semantics, builder, object);
    for (meaning, index) in out.iter_mut().zip(chosen).filter(|(_, index)| *index != NONE) {
        *meaning = (geometry.semantics[index as usize].kind, details[index as usize]);
    }
    out
}

/// Adds the surfaces that have more than a type to the model; returns the detail of each, or `NONE`.
fn add_details(semantics: &[Semantic], builder: &mut ModelBuilder, object: &str) -> Vec<u32> {
    let parents = parents(semantics);
    let mut needs = semantics.iter().map(|s| !s.attributes.is_empty()).collect::<Vec<_>>();
    for (child, parent) in parents.iter().enumerate() {
        if let Some(parent) = parent {
            needs[child] = true;
            needs[*parent as usize] = true;
        }
    }
    let details: Vec<u32> = semantics
        .iter()
        .zip(&needs)
        .map(|(s, needed)| if *needed { builder.add_detail(&s.attributes, NONE) } else { NONE })
        .collect();
    let (parents, cut) = without_cycles(parents);
    for (child, parent) in parents.iter().enumerate() {
        if let Some(parent) = parent {
            builder.model.details[details[child] as usize].parent = details[*parent as usize];
        }
    }
    if cut > 0 {
        builder.model.warnings.add(WarningCode::SemanticsMismatch, object, || {
            format!("object {object}: a semantic surface is its own ancestor; that link is dropped")
        });
    }
    details
}

/// The parent of each surface, from both directions of the link.
fn parents(semantics: &[Semantic]) -> Vec<Option<u32>> {
    let exists = |i: &u32| (*i as usize) < semantics.len();
    let mut parents: Vec<Option<u32>> = semantics.iter().map(|s| s.parent.filter(exists)).collect();
    for (i, semantic) in semantics.iter().enumerate() {
        for child in semantic.children.iter().filter(|c| exists(c)) {
            parents[*child as usize].get_or_insert(i as u32);
        }
    }
    parents
}

/// Drops the links that close a cycle; returns how many.
fn without_cycles(mut parents: Vec<Option<u32>>) -> (Vec<Option<u32>>, u32) {
    // 0 = not seen, else the number of the walk that came by first.
    let mut seen_in = vec![0_u32; parents.len()];
    let mut cut = 0;
    for start in 0..parents.len() {
        let walk = start as u32 + 1;
        let mut at = start;
        while seen_in[at] == 0 {
            seen_in[at] = walk;
            let Some(parent) = parents[at] else { break };
            if seen_in[parent as usize] == walk {
                parents[at] = None;
                cut += 1;
                break;
            }
            at = parent as usize;
        }
    }
    (parents, cut)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_closing_link_of_a_cycle_goes() {
        let (parents, cut) = without_cycles(vec![Some(1), Some(2), Some(0), Some(0), None, Some(5)]);
        assert_eq!(cut, 2);
        assert_eq!(parents, [Some(1), Some(2), None, Some(0), None, None]);
    }
}
