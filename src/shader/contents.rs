//! Which of the cities of a picture show at a place: `shown_cities` and what it calls, for the passes that draw
//! them, on both back ends. Every fragment is asked by its own depth, before visibility.
//!
//! Bottom lens first, each that holds the place changes what shows there, as its clip says. A city is a bit; bit 0 is the
//! scene's own.

use std::fmt::Write as _;

use crate::shader::plan::{
    Plan,
    content::{Clip, PlanContent},
    step::ClassTest,
};

/// The uniform that says which city is drawn.
pub(super) fn binding(group: u32, binding: u32, name: &str) -> String {
    format!("@group({group}) @binding({binding}) var<uniform> {name}: City;\n")
}

/// `shown_cities` of a plan: `place` are its parameters, `classes` and `interest` those of a lens of the plan there.
pub(super) fn specialised(
    plan: &Plan,
    place: &str,
    classes: impl Fn(u32) -> String,
    interest: impl Fn(u32) -> String,
) -> String {
    let mut text = format!("fn shown_cities({place}) -> u32 {{\n    var shown = 1u;\n");
    // The contents that lenses below show: asked for where contents are not to meet.
    let is_asked = |i: usize| plan.contents[i + 1..].iter().any(|c| c.clip == Clip::Discard);
    if plan.contents.iter().any(|c| c.clip == Clip::Discard) {
        text.push_str("    var below = 0u;\n");
    }
    for (i, content) in plan.contents.iter().enumerate() {
        let PlanContent { lens, class, city, clip, keeps_terrain } = *content;
        let own = format!("{:#x}u", 1_u32 << city);
        let terrain = if keeps_terrain { " && fragment.part != PART_TERRAIN" } else { "" };
        let is_there = is_held(plan, lens, class, "fragment", &classes, &interest);
        let _ = writeln!(text, "    if {is_there}{terrain} {{");
        let _ = match clip {
            Clip::Order => writeln!(text, "        shown = {own};"),
            Clip::Merge => writeln!(text, "        shown |= {own};"),
            Clip::Discard => writeln!(text, "        shown = select(0u, {own}, (below & ~{own}) == 0u);"),
        };
        if is_asked(i) {
            let _ = writeln!(text, "        below |= {own};");
        }
        text.push_str("    }\n");
    }
    text + "    return shown;\n}\n\n"
}

/// Whether a place is of a class of a lens, as a condition: of one with a soft border that dithers, by chance. `subject`: what has its `pixel`.
pub(super) fn is_held(
    plan: &Plan,
    lens: u32,
    class: ClassTest,
    subject: &str,
    classes: &impl Fn(u32) -> String,
    interest: &impl Fn(u32) -> String,
) -> String {
    match plan.border_of(lens).filter(|b| b.dithers) {
        Some(_) => format!("is_dithered({}({}, {}), {subject}.pixel)", class.share(), classes(lens), interest(lens)),
        None => format!("{}({})", class.function(), classes(lens)),
    }
}

/// The same from the invoker table; `runs` says whether an invoker, `by`, runs there. `handler` of an invoker is the city's number,
/// `kind` that of the clip, `weight` 1 where terrain stays.
pub(super) fn uber(place: &str, runs: &str) -> String {
    format!(
        "fn shown_cities({place}) -> u32 {{
    var shown = 1u;
    var below = 0u;
    for (var i = table.tiles.y; i < table.tiles.z; i++) {{
        let by = invoker(i);
        if (by.weight == 0u || fragment.part != PART_TERRAIN) && {runs} {{
            let own = 1u << by.handler;
            switch by.kind {{
                case 0u: {{ shown = own; }}
                case 1u: {{ shown |= own; }}
                default: {{ shown = select(0u, own, (below & ~own) == 0u); }}
            }}
            below |= own;
        }}
        if i + 1u == table.tiles.z {{
            break;
        }}
    }}
    return shown;
}}

"
    )
}

/// Whether what is drawn shows at a place, with these arguments of `shown_cities`: what a fragment is asked first.
pub(super) fn is_shown(place: &str) -> String {
    format!("(shown_cities({place}) >> fragment.city & 1u) == 1u")
}
