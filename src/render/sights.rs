//! Where in the picture points of interest are, for effects that cut what stands before them.

use crate::{
    lens::Lens,
    render::{
        displayed::{Stand, Stands},
        occlusion::Occlusion,
        placement::Eye,
    },
    scene::Scene,
    shader::{PerObject, effect::find},
};

/// Of each lens of a scene, as its effects read it: how many rectangles, then the bits of the six numbers of each
/// ([`Eye::rectangle`]). None of lenses that have no such effect.
pub(super) fn sights(scene: &Scene, stands: &Stands, eye: &Eye, occlusion: &mut Occlusion) -> Vec<Vec<u32>> {
    let of_lens = |lens: &Lens| {
        if !asks(lens) {
            return vec![0];
        }
        let names = lens.occluders().map_or(&[][..], |of| &of.pois);
        let Stand { city, pois } = stands.of_lens(lens);
        let places = names.iter().filter_map(|name| pois.iter().find(|poi| poi.name == *name));
        let boxes = places.map(|poi| occlusion.box_of(&poi.place, city)).filter(|bounds| !bounds.is_empty());
        let all: Vec<[f32; 6]> = boxes.map(|bounds| eye.rectangle(&bounds)).collect();
        std::iter::once(all.len() as u32).chain(all.concat().into_iter().map(f32::to_bits)).collect()
    };
    scene.lenses.iter().map(of_lens).collect()
}

fn asks(lens: &Lens) -> bool {
    let is_one = |effect: &str| find(effect).is_some_and(|e| e.objects == Some(PerObject::Sights));
    lens.enabled && lens.uses().any(|used| is_one(&used.effect))
}
