//! Room for none, one, nearly all and all translucent fragments.

use crate::{
    measure::topics::gpu::{
        check::{Check, Findings},
        looks::{transparency, with_number},
        numbers::Numbers,
        panes::{SIZE, of_context, panes, stacks, studio_of},
    },
    render::{frame::Backend, picture::RenderError},
};

/// See the module.
pub const CHECK: Check = Check {
    name: "room for layers",
    case: "15",
    property: "with too little room for translucent fragments the picture is the same, drawn in bands, and what does not fit is \
               counted",
    oracle: "the layers of each pixel, each drawn alone",
    unit: "answers",
    least: 6,
    run,
};

fn run(found: &mut Findings) -> Result<(), RenderError> {
    let all = panes(9, &mut Numbers(3));
    let mut studio = studio_of(&all)?;
    let scene = of_context(vec![with_number("transparent", "opacity", 0.3)]);
    let whole = transparency(&mut studio, &scene, SIZE, Backend::Specialised)?;
    let drawn = studio.renderer.layer_figures();
    let stacks = stacks(&mut studio, &all)?;
    let fragments: u64 = stacks.iter().map(|stack| stack.len() as u64).sum();
    found.ask((drawn.nodes, drawn.excess) == (fragments, 0), || format!("{drawn:?}, {fragments} fragments there are"));
    for (room, has_excess) in [(fragments, false), (fragments - 1, false), (9, false), (1, true), (0, true)] {
        studio.renderer.settings.most_layers = Some(room);
        let banded = transparency(&mut studio, &scene, SIZE, Backend::Specialised)?;
        let figures = studio.renderer.layer_figures();
        // With room for one, each pixel's others are missing; without any, all are.
        let over = |stack: &usize| (*stack as u64).saturating_sub(room);
        let missing: u64 = if has_excess { stacks.iter().map(Vec::len).map(|n| over(&n)).sum() } else { 0 };
        found.ask((figures.nodes, figures.excess) == (fragments, missing), || {
            format!("room for {room}: {figures:?}, not {fragments} and {missing}")
        });
        found.ask(has_excess || banded == whole, || format!("room for {room}: another picture"));
    }
    Ok(())
}
