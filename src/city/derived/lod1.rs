//! `lod1`: an object as its own block model, its geometry of level of detail 1 (1.0 to 1.3, the finest of these); where it has
//! none, as the prism over its footprint.

use super::{bodies, prism, source::Source};

use crate::city::{
    derived::form::{Derive, Derived, Form},
    model::{CityModel, Lod},
    shown::shown_geometries,
};

/// Levels that are block models, tenths.
const BLOCKS: std::ops::Range<u16> = 10..20;

pub(super) fn derived(model: &CityModel, shown: &[u32], how: &Derive) -> Derived {
    let mut source = Source::new(model, shown, how.parts);
    let is_block = |&number: &u32| BLOCKS.contains(&tenths(model.geometries[number as usize].lod));
    let coarse = shown_geometries(model, Some(Lod { tenths: (BLOCKS.end - 1) as _ }));
    let mut blocks = Source::new(model, &coarse.into_iter().filter(is_block).collect::<Vec<_>>(), how.parts);
    // Units are by object, ascending, in both.
    blocks.units.retain(|unit| source.units.binary_search_by_key(&unit.object, |u| u.object).is_ok());
    source.units.retain(|unit| blocks.units.binary_search_by_key(&unit.object, |u| u.object).is_err());
    let instead = source.units.len() as u32;
    let made = bodies::derived(&source, &Form::Prism, prism::body, Some(&blocks));
    Derived { instead: instead - made.unchanged, ..made }
}

fn tenths(lod: Lod) -> u16 {
    lod.tenths.into()
}
