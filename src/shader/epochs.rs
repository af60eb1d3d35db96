//! Which moment shows at a place, and which objects are there then: `moment_at` and `exists`, for the passes that draw the city, on both
//! back ends.
//!
//! Time operators act bottom lens first, each on the moment that shows below it (after Tiesel §4.2): `t = o_top(… o_bottom(t_scene))`. An
//! object is there from the first moment of its lifetime up to its last, which is not of it.

use std::fmt::Write as _;

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
    for steps in plan.epochs.chunk_by(|a, b| a.lens == b.lens) {
        let lens = steps[0].lens;
        let is_here = is_held(plan, lens, ClassTest::Inside, &classes, &interest);
        let _ = writeln!(text, "    if may_hold(fragment.object, {}u) && {is_here} {{", steps[0].bit);
        for step in steps {
            let handler = &handlers[step.handler as usize];
            let _ = writeln!(text, "        moment = {};", applied(handler, &format!("{}u", step.words)));
        }
        text.push_str("    }\n");
    }
    text + "    return moment;\n}\n\n" + &exists(place, arguments)
}

/// The same from the invoker table; `runs` says whether an invoker, `by`, runs there. `handler` of an invoker is the operator's number,
/// `parameters` where its words begin.
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
    for (var i = table.epochs.x; i < table.epochs.y; i++) {{
        // Of an invoker that does not act no more is read.
        if may_hold(fragment.object, invokers[i].slots & 65535u) {{
            let by = invoker(i);
            if {runs} {{
                moment = after(moment, by);
            }}
        }}
        if i + 1u == table.epochs.y {{
            break;
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
