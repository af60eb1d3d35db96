//! Which geometries are shown: the default rule for levels of detail.

use std::sync::Arc;

use crate::city::model::{CityModel, Lod};

/// Objects of a city that are shown.
#[derive(Clone, Debug)]
pub struct ShownObjects {
    /// The city.
    pub model: Arc<CityModel>,
    /// The objects, by index, ascending.
    pub objects: Vec<u32>,
}

/// Geometries to show, as sorted indices into [`CityModel::geometries`].
///
/// Per root object the finest LoD that any of its geometry-bearing descendants (itself included) has, not finer than
/// `cap`; each object shows its own finest LoD that is not finer than that; a parent's geometry is hidden where a
/// descendant shows some. As the root's LoD is the finest of its family, each object's own finest is never finer:
/// what is left to do is the cap and the hiding: a whole is hidden where one of its parts (`BuildingPart` and the like) shows some;
/// installations, rooms, furniture and whatever else belongs to it stand beside it. Geometry without a level of detail passes any cap and is shown where
/// its object has no other; it is hidden by levels only: nested meshes of glTF stand beside each other.
pub fn shown_geometries(model: &CityModel, cap: Option<Lod>) -> Vec<u32> {
    let own: Vec<Option<Lod>> = (0..model.objects.len()).map(|object| finest(model, object, cap)).collect();
    let covered = covered_by_parts(model, |object| own[object].is_some());
    let covered_by_levels = covered_by_parts(model, |object| own[object].is_some_and(|lod| lod != Lod::NONE));
    let mut shown = Vec::new();
    for (i, (object, lod)) in model.objects.iter().zip(&own).enumerate() {
        let hidden = if *lod == Some(Lod::NONE) { &covered_by_levels } else { &covered };
        if hidden[i] {
            continue;
        }
        let fits = |i: &u32| Some(model.geometries[*i as usize].lod) == *lod;
        shown.extend(object.geometries.clone().filter(fits));
    }
    shown.sort_unstable();
    shown
}

/// The finest LoD of an object's own drawable geometry, not finer than `cap`.
fn finest(model: &CityModel, object: usize, cap: Option<Lod>) -> Option<Lod> {
    let geometries = &model.geometries[as_range(&model.objects[object].geometries)];
    let allowed = |lod: &Lod| *lod == Lod::NONE || cap.is_none_or(|cap| *lod <= cap);
    let lods = geometries.iter().filter(|g| g.triangles > 0).map(|g| g.lod).filter(allowed);
    lods.max_by_key(|lod| (*lod != Lod::NONE, *lod))
}

/// Per object, whether a part of it, or a part of a part, is one that covers. Walks up from each such part; a whole already marked has
/// marked those it is part of, so every link is followed once.
fn covered_by_parts(model: &CityModel, covers: impl Fn(usize) -> bool) -> Vec<bool> {
    let kind = |object: usize| model.strings.get(model.objects[object].kind);
    let is_part = |object: usize| kind(object).ends_with("Part");
    let mut covered = vec![false; model.objects.len()];
    let mut open: Vec<u32> = Vec::new();
    for object in (0..model.objects.len()).filter(|o| covers(*o) && is_part(*o)) {
        open.extend(&model.objects[object].parents);
        while let Some(whole) = open.pop().map(|whole| whole as usize) {
            // Members of a group are no parts of it.
            if kind(whole) == "CityObjectGroup" || std::mem::replace(&mut covered[whole], true) {
                continue;
            }
            if is_part(whole) {
                open.extend(&model.objects[whole].parents);
            }
        }
    }
    covered
}

fn as_range(range: &std::ops::Range<u32>) -> std::ops::Range<usize> {
    range.start as usize..range.end as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        city::model::{CityObject, Geometry, ObjectClass},
        geom::Aabb,
    };

    /// A model of buildings and their parts, given as (parents, lods).
    fn model(objects: &[(&[u32], &[&str])]) -> CityModel {
        let kind = |parents: &[u32]| if parents.is_empty() { "Building" } else { "BuildingPart" };
        model_of(&objects.iter().map(|(parents, lods)| (kind(parents), *parents, *lods)).collect::<Vec<_>>())
    }

    /// A model of objects given as (kind, parents, lods).
    fn model_of(objects: &[(&str, &[u32], &[&str])]) -> CityModel {
        let mut model = CityModel::default();
        for (object, (kind, parents, lods)) in objects.iter().enumerate() {
            let kind = model.strings.intern(kind);
            let start = model.geometries.len() as u32;
            for lod in *lods {
                model.geometries.push(Geometry {
                    object: object as u32,
                    lod: Lod::parse(lod).unwrap_or(Lod::NONE),
                    solid: false,
                    polygons: 1,
                    triangles: 1,
                    dropped: 0,
                    grid: 0,
                    tiles: 0..0,
                    bounds: Aabb::EMPTY,
                });
            }
            model.objects.push(CityObject {
                id: object.to_string().into(),
                kind,
                class: ObjectClass::Building,
                parents: parents.to_vec(),
                children: Vec::new(),
                attributes: 0..0,
                geometries: start..model.geometries.len() as u32,
            });
        }
        model
    }

    /// The geometries that are shown, as (object, lod).
    fn shown(objects: &[(&[u32], &[&str])], cap: Option<&str>) -> Vec<(u32, String)> {
        let model = model(objects);
        let cap = cap.map(|c| Lod::parse(c).unwrap());
        let list = shown_geometries(&model, cap);
        assert!(list.is_sorted());
        list.iter().map(|g| &model.geometries[*g as usize]).map(|g| (g.object, g.lod.to_string())).collect()
    }

    fn pairs(list: &[(u32, &str)]) -> Vec<(u32, String)> {
        list.iter().map(|(o, l)| (*o, (*l).to_owned())).collect()
    }

    #[test]
    fn the_finest_of_each_object() {
        assert_eq!(shown(&[(&[], &["0", "1.2", "2.2", "1.3"])], None), pairs(&[(0, "2.2")]));
        assert_eq!(shown(&[(&[], &["0", "1.2", "2.2", "1.3"])], Some("1.3")), pairs(&[(0, "1.3")]));
        assert_eq!(shown(&[(&[], &["2.2"])], Some("1.3")), []);
        assert_eq!(shown(&[(&[], &["1"]), (&[], &["2"])], None), pairs(&[(0, "1"), (1, "2")]));
    }

    #[test]
    fn a_footprint_gives_way_to_its_parts() {
        // 3DBAG: the building has LoD 0, its part the rest.
        let family: &[(&[u32], &[&str])] = &[(&[], &["0"]), (&[0], &["1.2", "2.2"])];
        assert_eq!(shown(family, None), pairs(&[(1, "2.2")]));
        assert_eq!(shown(family, Some("1.2")), pairs(&[(1, "1.2")]));
        assert_eq!(shown(family, Some("0")), pairs(&[(0, "0")]), "under this cap only the footprint is left");
    }

    #[test]
    fn what_is_no_part_stands_beside_what_it_belongs_to() {
        let shown = |objects: &[(&str, &[u32], &[&str])]| -> Vec<u32> {
            let model = model_of(objects);
            shown_geometries(&model, None).iter().map(|g| model.geometries[*g as usize].object).collect()
        };
        for kind in [
            "BuildingInstallation",
            "BuildingRoom",
            "BuildingFurniture",
            "BuildingStorey",
            "BuildingUnit",
            "BuildingConstructiveElement",
            "+Chimney",
            "BridgeInstallation",
            "TunnelHollowSpace",
        ] {
            assert_eq!(shown(&[("Building", &[], &["2"]), (kind, &[0], &["2"])]), [0, 1], "{kind}");
            // Below a part, too, and as a part's whole.
            let below: &[(&str, &[u32], &[&str])] =
                &[("Building", &[], &["1"]), ("BuildingPart", &[0], &["2"]), (kind, &[1], &["2"])];
            assert_eq!(shown(below), [1, 2], "{kind}");
            let between: &[(&str, &[u32], &[&str])] =
                &[("Building", &[], &["2"]), (kind, &[0], &[]), ("BuildingPart", &[1], &["2"])];
            assert_eq!(shown(between), [0, 2], "{kind}");
        }
        for (whole, part) in [("Bridge", "BridgePart"), ("Tunnel", "TunnelPart"), ("+Mill", "+MillPart")] {
            assert_eq!(shown(&[(whole, &[], &["2"]), (part, &[0], &["2"])]), [1], "{part}");
            let in_part: &[(&str, &[u32], &[&str])] = &[(whole, &[], &["2"]), (part, &[0], &[]), (part, &[1], &["2"])];
            assert_eq!(shown(in_part), [2], "{part}");
        }
        let group: &[(&str, &[u32], &[&str])] =
            &[("Building", &[], &[]), ("BuildingPart", &[0, 2], &["2"]), ("CityObjectGroup", &[], &["2"])];
        assert_eq!(shown(group), [1, 2]);
    }

    #[test]
    fn parts_of_different_detail_stay_together() {
        let family: &[(&[u32], &[&str])] = &[(&[], &["2"]), (&[0], &["1"]), (&[0], &["1", "2"])];
        assert_eq!(shown(family, None), pairs(&[(1, "1"), (2, "2")]));
    }

    #[test]
    fn grandchildren_and_second_parents_count() {
        let family: &[(&[u32], &[&str])] =
            &[(&[], &["1"]), (&[0], &[]), (&[1], &["2"]), (&[], &["1"]), (&[1, 3], &["2"])];
        assert_eq!(shown(family, None), pairs(&[(2, "2"), (4, "2")]));
    }

    #[test]
    fn meshes_without_levels_do_not_hide_each_other() {
        let nested: &[(&[u32], &[&str])] = &[(&[], &["none"]), (&[0], &["none"])];
        assert_eq!(shown(nested, None), pairs(&[(0, "none"), (1, "none")]));
        let detailed: &[(&[u32], &[&str])] = &[(&[], &["none"]), (&[0], &["none"]), (&[1], &["2"])];
        assert_eq!(shown(detailed, None), pairs(&[(2, "2")]));
    }

    #[test]
    fn two_shapes_of_one_level_are_both_shown() {
        assert_eq!(shown(&[(&[], &["2", "2"])], None), pairs(&[(0, "2"), (0, "2")]));
    }

    #[test]
    fn shapes_without_level_yield_to_those_with_one() {
        assert_eq!(shown(&[(&[], &["none", "1"]), (&[], &["none"])], Some("1")), pairs(&[(0, "1"), (1, "none")]));
    }

    #[test]
    fn what_is_not_drawn_hides_nothing() {
        let mut model = model(&[(&[], &["1"]), (&[0], &["2"])]);
        model.geometries[1].triangles = 0;
        assert_eq!(shown_geometries(&model, None), [0]);
    }
}
