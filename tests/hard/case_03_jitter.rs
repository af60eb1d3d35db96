//! Case 3, drawn: in 1,000 sub-pixel jitters of the camera the same object wins wherever two lie in one plane.
//! Oracle: the winner is known by the rule (docs of `city::coplanar`), the place by the hand-made files.

use glam::DVec3;
use veduta::{lens::Lens, view::Camera};

use crate::studio;

const SIZE: [u32; 2] = [40, 30];

/// Objects seen in the middle half of the picture over 1,000 jitters, with how often; as translucent layers, of which the nearest is the
/// shown surface, or as they are.
fn winners(file: &str, eye: DVec3, target: DVec3, in_layers: bool) -> std::collections::BTreeMap<u32, usize> {
    let mut studio = studio::studio(&[studio::citydata(file)]);
    let mut seen = std::collections::BTreeMap::new();
    for i in 0..1000 {
        // Irrational steps: no two frames see the plane from the same place.
        let t = f64::from(i);
        let jitter = 1e-3 * DVec3::new((t * 0.618_034).fract(), (t * 0.754_878).fract(), (t * 0.569_840).fract());
        let camera = Camera::looking(eye + jitter, target + jitter, 0.05);
        let mut scene = studio::scene(camera, Vec::<Lens>::new());
        scene.style.effects =
            in_layers.then(|| studio::with_numbers("transparent", &[("opacity", 0.9)])).into_iter().collect();
        let drawn = studio::picture(&mut studio, &scene, SIZE);
        let ids = drawn.object_id.expect("ids");
        for y in 8..22 {
            for x in 10..30 {
                *seen.entry(ids[y * SIZE[0] as usize + x]).or_default() += 1;
            }
        }
    }
    seen
}

#[test]
fn what_stands_on_a_roof_is_seen_on_it_in_every_frame() {
    let model = studio::studio(&[studio::citydata("roof-on-roof.city.json")]).model;
    let bounds = |i: usize| model.geometries[i].bounds;
    // The second object lies on part of the first one's roof.
    let middle = bounds(1).center().with_z(bounds(0).max.z);
    for in_layers in [false, true] {
        let seen = winners("roof-on-roof.city.json", middle + DVec3::new(13.0, -29.0, 41.0), middle, in_layers);
        assert_eq!(seen.len(), 1, "objects (index + 1) seen, and how often: {seen:?}, as layers: {in_layers}");
        assert_eq!(seen.keys().next(), Some(&2), "what stands on the roof");
    }
}
