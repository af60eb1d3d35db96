//! Case 15: room for translucent fragments of 0, 1, exactly enough - 1 and exactly enough. Oracle: the number of layers of each pixel.

use veduta::render::{
    frame::Backend,
    layers::LayerFigures,
    picture::{Aovs, Request},
};

use crate::panes::*;

#[test]
fn what_has_no_room_is_drawn_in_bands_or_counted() {
    let mut random = Random(3);
    let all = panes(9, &mut random);
    let mut studio = studio_of(&all);
    let scene = of_context(vec![rule("transparent", &[("opacity", 0.3)], None, false)]);
    let whole = transparency(&mut studio, &scene, Backend::Specialised, SIZE);
    let figures = studio.renderer.layer_figures();
    let stacks = stacks(&mut studio, &all);
    let nodes: u64 = stacks.iter().map(|s| s.len() as u64).sum();
    assert_eq!(figures, LayerFigures { nodes, bands: 1, excess: 0 });
    let mut at = |capacity: u64| {
        studio.renderer.settings.most_layers = Some(capacity);
        (transparency(&mut studio, &scene, Backend::Specialised, SIZE), studio.renderer.layer_figures())
    };
    assert_eq!(at(nodes), (whole.clone(), LayerFigures { nodes, bands: 1, excess: 0 }));
    assert_eq!(at(nodes - 1), (whole.clone(), LayerFigures { nodes, bands: 2, excess: 0 }));
    let (found, figures) = at(9);
    assert_eq!((&found, figures.nodes, figures.excess), (&whole, nodes, 0), "as many as a pixel has");
    assert!(figures.bands > 100);
    // One node for each pixel: the others are missing, and counted.
    let (found, figures) = at(1);
    let excess: u64 = stacks.iter().map(|s| (s.len() as u64).saturating_sub(1)).sum();
    assert_eq!((figures.nodes, figures.excess), (nodes, excess));
    for (found, stack) in found.iter().zip(&stacks) {
        let laid = if stack.is_empty() { 1.0 } else { 0.7 };
        assert!((found[3] - laid).abs() < 1e-6, "{found:?}");
    }
    let (found, figures) = at(0);
    assert_eq!(figures, LayerFigures { nodes, bands: 1, excess: nodes });
    assert!(found.iter().all(|v| *v == [0.0, 0.0, 0.0, 1.0]));
    let told = Request { size: SIZE, statistics: true, aovs: Aovs::default(), ..request(Backend::Specialised) };
    let picture = studio.render(&scene, &told).expect("a picture");
    let layers = picture.statistics.frame.layers.expect("there are some");
    assert_eq!((layers.fragments, layers.missing), (nodes, nodes));
    let warning = &picture.statistics.warnings[0];
    assert_eq!((&warning["code"], &warning["count"]), (&"layer-room".into(), &nodes.into()));
}
