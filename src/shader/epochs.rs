//! Which moment shows at a place, and which objects are there then: `moment_at` and `exists`, for the passes that draw the city, on both
//! back ends.
//!
//! Time operators act bottom lens first, each on the moment that shows below it (after Tiesel §4.2): `t = o_top(… o_bottom(t_scene))`. An
//! object is there from the first moment of its lifetime up to its last, which is not of it.

use std::{collections::BTreeSet, fmt::Write as _};

use crate::shader::{
    contents::is_held,
    effect::definition::EffectDefinition,
    plan::{Plan, program::Program, step::ClassTest, uber::Uber},
};

/// The texts of the time operators that a program calls.
pub(super) fn operators(program: &Program, handlers: &[EffectDefinition]) -> String {
    let of = |number: u32| {
        let handler = &handlers[number as usize];
        format!("// ==== time operator {}\n\n{}\n\n", handler.name, handler.source.trim_end())
    };
    program.epochs().into_iter().map(of).collect()
}

/// A moment after an operator. What users make of it is brought back into the calendar.
fn applied(handler: &EffectDefinition, words: &str) -> String {
    let parameters =
        if handler.slots() == 0 { String::new() } else { format!(", {}({words})", handler.own("parameters")) };
    let call = format!("{}(moment{parameters})", handler.wgsl_name());
    if handler.is_users { format!("sound({call})") } else { call }
}

/// Where a module asks which moment shows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Asked {
    /// What has `object` and `pixel`, among the parameters.
    pub(super) subject: &'static str,
    /// The parameters of functions.
    pub(super) parameters: &'static str,
    /// What they are called with.
    pub(super) arguments: &'static str,
    /// What names end with.
    pub(super) suffix: &'static str,
}

/// Of fragments.
pub(super) const OF_FRAGMENT: Asked =
    Asked { subject: "fragment", parameters: "fragment: Fragment", arguments: "fragment", suffix: "" };
/// Of fragments of lines.
pub(super) const OF_LINE: Asked = Asked {
    subject: "fragment",
    parameters: "fragment: Fragment, classes: Classes",
    arguments: "fragment, classes",
    suffix: "",
};
/// Of layers.
pub(super) const OF_LAYER: Asked = Asked {
    subject: "point",
    parameters: "point: Point, classes: Classes",
    arguments: "point, classes",
    suffix: "_of_layer",
};

impl Asked {
    fn head(&self, partly: bool) -> String {
        let Self { parameters, suffix, .. } = self;
        let moment = if partly { "scene_instant()" } else { "scene_moment()" };
        format!("fn moment{suffix}_at({parameters}) -> Moment {{\n    var moment = {moment};\n")
    }
}

/// `moment_at` of a plan and what follows from it: `classes` and `interest` are those of a lens of the plan there.
pub(super) fn specialised(
    plan: &Plan,
    handlers: &[EffectDefinition],
    asked: &Asked,
    classes: impl Fn(u32) -> String,
    interest: impl Fn(u32) -> String,
) -> String {
    let subject = asked.subject;
    let mut text = asked.head(plan.partly);
    let words: BTreeSet<u32> = plan.epochs.iter().map(|epoch| epoch.bit / 32).collect();
    for word in words {
        let _ = writeln!(text, "    let may_{word} = lenses_that_may({subject}.object, {word}u);");
        let _ = writeln!(text, "    let surely_{word} = lenses_that_surely_do({subject}.object, {word}u);");
    }
    for steps in plan.epochs.chunk_by(|a, b| a.lens == b.lens) {
        let (lens, word, mask) = (steps[0].lens, steps[0].bit / 32, 1_u32 << (steps[0].bit % 32));
        let is_here = is_held(plan, lens, ClassTest::Inside, subject, &classes, &interest);
        let _ = writeln!(
            text,
            "    if (may_{word} & {mask:#x}u) != 0u && ((surely_{word} & {mask:#x}u) != 0u || {is_here}) {{"
        );
        for step in steps {
            let handler = &handlers[step.handler as usize];
            let _ = writeln!(text, "        moment = {};", applied(handler, &format!("{}u", step.words)));
        }
        text.push_str("    }\n");
    }
    text + "    return moment;\n}\n\n" + &exists(asked, plan.partly, plan.moves)
}

/// The same from the invoker table; `runs` says whether an invoker, `by`, runs there. `handler` of an invoker is the operator's number,
/// `parameters` where its words begin. By the bits of lenses stand where their invokers begin and end.
pub(super) fn uber(uber: &Uber, handlers: &[EffectDefinition], asked: &Asked, runs: &str) -> String {
    let mut text = "fn after(moment: Moment, by: Invoker) -> Moment {\n    switch by.handler {\n".to_owned();
    for &number in &uber.epochs {
        let call = applied(&handlers[number as usize], "by.parameters");
        let _ = writeln!(text, "        case {number}u: {{ return {call}; }}");
    }
    let (subject, head) = (asked.subject, asked.head(uber.partly));
    text.push_str("        default: { return moment; }\n    }\n}\n\n");
    let own = match asked.suffix == OF_LAYER.suffix {
        true => all_bits(subject, runs, uber.partly),
        false => set_bits(subject, runs),
    };
    let _ = write!(text, "{head}{own}    return moment;\n}}\n\n");
    text + &exists(asked, uber.partly, uber.moves)
}

/// The operators of the lenses that may hold some of an object: only those that may act are gone through.
fn set_bits(subject: &str, runs: &str) -> String {
    format!(
        "    for (var word = 0u; word < words_of_lenses(); word++) {{
        var bits = lenses_that_may({subject}.object, word);
        let surely = lenses_that_surely_do({subject}.object, word);
        // Only those that may act are gone through.
        while bits != 0u {{
            let bit = firstTrailingBit(bits);
            bits &= bits - 1u;
            let number = 32u * word + bit;
            var first = 0u;
            var end = 0u;
            if number < table.epochs.y {{
                let of_lens = invokers[table.epochs.x + number];
                first = of_lens.place;
                end = of_lens.call;
            }}
            if first < end {{
                let by = invoker(first);
                if ((surely >> bit) & 1u) == 1u || {runs} {{
                    for (var i = first; i < end; i++) {{
                        moment = after(moment, invoker(i));
                    }}
                }}
            }}
        }}
    }}
"
    )
}

/// The same of all lenses, whether they may hold some of it or not: what shades takes pixels together whose objects differ, and of loops that
/// end here so and there so Mesa 22.3 leaves something else behind.
fn all_bits(subject: &str, runs: &str, partly: bool) -> String {
    let (keep, put_back) = if partly { (KEEP, PUT_BACK) } else { ("", "") };
    format!(
        "    for (var number = 0u; number < table.epochs.y; number++) {{
        let of_lens = invokers[table.epochs.x + number];
        let bit = 1u << (number % 32u);
        let may = (lenses_that_may({subject}.object, number / 32u) & bit) != 0u;
        let surely = (lenses_that_surely_do({subject}.object, number / 32u) & bit) != 0u;
        if of_lens.place < of_lens.call {{
            let by = invoker(of_lens.place);
            let is_here = {runs};
            let acts = may && (surely || is_here);
            for (var i = of_lens.place; i < of_lens.call; i++) {{
{keep}                let then = after(moment, invoker(i));
                moment.hour = select(moment.hour, then.hour, acts);
                moment.micro = select(moment.micro, then.micro, acts);
{put_back}            }}
        }}
    }}
"
    )
}

/// What operators do beside the moment, kept where they do not act.
const KEEP: &str = "                let past = ghost_past;
                let future = ghost_future;
                let any = shows_any;
";
const PUT_BACK: &str = "                if !acts {
                    ghost_past = past;
                    ghost_future = future;
                    shows_any = any;
                }
";

/// `exists`: whether an object is there at a place; of what may be there by halves, `presence`: how much of it. What moves is there where the
/// moment shows for which it is drawn.
fn exists(asked: &Asked, partly: bool, moves: bool) -> String {
    if !partly && asked.suffix == OF_LAYER.suffix {
        // Layers that are there are there wholly, and so is what is shaded.
        return String::new();
    }
    let Asked { subject, parameters, arguments, suffix } = asked;
    let turn = if moves { format!("    let turn = turn_of({subject}.surface);\n") } else { String::new() };
    let (stays, is_its) =
        if moves { ("turn == 0u && ", "(turn == 0u || are_same(at, moment_of_turn(turn))) && ") } else { ("", "") };
    if partly {
        return format!(
            "fn presence{suffix}({parameters}) -> f32 {{
    let lifetime = lifetime_of({subject}.object);
    let undated = is_ghost(lifetime);
{turn}    if {stays}undated {{
        return UNDATED_OPACITY;
    }}
    if {stays}is_always(lifetime) {{
        return 1.0;
    }}
    if !undated && is_never(lifetime) {{
        return 0.0;
    }}
    var sum = 0.0;
    var is_whole = true;
    var most = 0.0;
    let count = combinations();
    for (var i = 0u; i < count; i++) {{
        combination = i;
        let at = moment{suffix}_at({arguments});
        let there = select(share_there(lifetime, at), UNDATED_OPACITY, undated);
        let share = select(0.0, there, {is_its}true);
        sum += share * weight_of_combination();
        is_whole = is_whole && share == 1.0;
        most = max(most, share);
    }}
    if shows_any {{
        return most;
    }}
    return select(min(sum, 1.0), 1.0, is_whole);
}}

"
        );
    }
    format!(
        "fn exists({parameters}) -> bool {{
    let lifetime = lifetime_of({subject}.object);
{turn}    if {stays}is_always(lifetime) {{
        return true;
    }}
    if is_never(lifetime) {{
        return false;
    }}
    let at = moment_at({arguments});
    return {is_its}holds(lifetime, at);
}}

"
    )
}

/// `is_lit_here`: whether what is shaded is to be seen under the sun of the frame.
pub(super) fn is_lit_here(lit: bool) -> &'static str {
    match lit {
        true => "fn is_lit_here(point: Point) -> bool {\n    return is_lit_by_this_sun(point);\n}\n\n",
        false => "fn is_lit_here(point: Point) -> bool {\n    return true;\n}\n\n",
    }
}

/// `comes`: whether what is not there at a place will be there soon, at one of the moments that show.
pub(super) fn comes(asked: &Asked) -> String {
    let Asked { subject, parameters, arguments, suffix } = asked;
    format!(
        "fn comes{suffix}({parameters}) -> bool {{
    let lifetime = lifetime_of({subject}.object);
    var will = false;
    let count = combinations();
    for (var i = 0u; i < count; i++) {{
        combination = i;
        let at = moment{suffix}_at({arguments});
        will = will || will_be(lifetime, at);
    }}
    return will;
}}

"
    )
}
