//! Which moment shows at a place, and which objects are there then: `moment_at` and `exists`, for the passes that draw the city, on both
//! back ends.
//!
//! Time operators act bottom lens first, each on the moment that shows below it (after Tiesel §4.2): `t = o_top(… o_bottom(t_scene))`. An
//! object is there from the first moment of its lifetime up to its last, which is not of it.

use std::{collections::BTreeSet, fmt::Write as _};

use crate::shader::{
    contents::is_held,
    effect::definition::EffectDefinition,
    plan::{Plan, program::Program, step::ClassTest},
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

/// `moment_at` of a plan and what follows from it: `place` are the parameters, `argument` the fragment among them with what else there is,
/// `classes` and `interest` those of a lens of the plan there.
pub(super) fn specialised(
    plan: &Plan,
    handlers: &[EffectDefinition],
    place: &str,
    arguments: &str,
    classes: impl Fn(u32) -> String,
    interest: impl Fn(u32) -> String,
) -> String {
    let mut text = format!("fn moment_at({place}) -> Moment {{\n    var moment = scene_moment();\n");
    let words: BTreeSet<u32> = plan.epochs.iter().map(|epoch| epoch.bit / 32).collect();
    for word in words {
        let _ = writeln!(text, "    let may_{word} = lenses_that_may(fragment.object, {word}u);");
        let _ = writeln!(text, "    let surely_{word} = lenses_that_surely_do(fragment.object, {word}u);");
    }
    for steps in plan.epochs.chunk_by(|a, b| a.lens == b.lens) {
        let (lens, word, mask) = (steps[0].lens, steps[0].bit / 32, 1_u32 << (steps[0].bit % 32));
        let is_here = is_held(plan, lens, ClassTest::Inside, &classes, &interest);
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
    text + "    return moment;\n}\n\n" + &exists(place, arguments)
}

/// The same from the invoker table; `runs` says whether an invoker, `by`, runs there. `handler` of an invoker is the operator's number,
/// `parameters` where its words begin. By the bits of lenses stand where their invokers begin and end.
pub(super) fn uber(numbers: &[u32], handlers: &[EffectDefinition], place: &str, arguments: &str, runs: &str) -> String {
    let mut text = "fn after(moment: Moment, by: Invoker) -> Moment {\n    switch by.handler {\n".to_owned();
    for &number in numbers {
        let call = applied(&handlers[number as usize], "by.parameters");
        let _ = writeln!(text, "        case {number}u: {{ return {call}; }}");
    }
    let _ = write!(
        text,
        "        default: {{ return moment; }}
    }}
}}

fn moment_at({place}) -> Moment {{
    var moment = scene_moment();
    for (var word = 0u; word < words_of_lenses(); word++) {{
        var bits = lenses_that_may(fragment.object, word);
        let surely = lenses_that_surely_do(fragment.object, word);
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
    return moment;
}}

"
    );
    text + &exists(place, arguments)
}

fn exists(place: &str, arguments: &str) -> String {
    format!(
        "fn exists({place}) -> bool {{
    let lifetime = lifetime_of(fragment.object);
    if is_always(lifetime) {{
        return true;
    }}
    if is_never(lifetime) {{
        return false;
    }}
    return holds(lifetime, moment_at({arguments}));
}}

"
    )
}
