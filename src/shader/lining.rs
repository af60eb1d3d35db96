//! How lines look: `line_at` and what it calls, for the pass that draws edges, on both back ends.
//!
//! A line belongs to the effect that draws it. Scene styles of lenses above replace it, if a scene style drew it, as they
//! replace the surface it lies on; lines instead of surfaces stay, and those over surfaces. Post styles colour it as they colour surfaces; filters
//! leave it sharp. What is hidden has no lines.

use std::fmt::Write as _;

use crate::shader::{
    contents,
    effect::{definition::EffectDefinition, prototype::EffectKind},
    epochs::{self, OF_LINE},
    invoke::{self, fades},
    lens_test,
    plan::{
        Plan,
        program::Program,
        step::{Scope, Step},
        uber::Uber,
    },
    table::{self, MOST_SLOTS},
    uber,
    writer::Writer,
};

/// Edges in parts, where lenses that bend rays show them.
pub(super) const BENT: &str = "    goes_on = bent_part(&p, &q, i / 4u);\n";

/// Parts of an edge that such lenses bend, as `lib/bent-edges.wgsl` has them.
pub const BENT_PARTS: u32 = 12;

/// `line_at` and what it calls. `names` of a plan's lenses become comments.
pub(super) fn source(program: &Program, handlers: &[EffectDefinition], names: &[&str]) -> String {
    let mut text = match program {
        Program::Specialised(plan) => Writer { plan, handlers, names }.bindings(0, false),
        Program::Uber(_) => {
            let tests = lens_test::bindings(program, false);
            format!("@group(2) @binding(2) var<uniform> parameters: array<vec4f, {MOST_SLOTS}>;\n{tests}\n")
        }
    };
    if program.has().has_cities() {
        text.push_str(&contents::binding(3, 1, "city"));
        text.push('\n');
    }
    text.push_str(&epochs::operators(program, handlers));
    for effect in program.effects().into_iter().map(|e| &handlers[e as usize]) {
        let _ = write!(text, "// ==== effect {}\n\n{}\n\n", effect.name, effect.source.trim_end());
    }
    match program {
        Program::Specialised(plan) => {
            text.push_str("// ==== this scene\n\n");
            let writer = Writer { plan, handlers, names };
            text.push_str(&writer.classes());
            if !plan.contents.is_empty() {
                let (classes, interest) =
                    (|lens| format!("classes.lens_{lens}"), |lens| format!("classes.interest_{lens}"));
                text.push_str(&contents::specialised(plan, OF_LINE.parameters, classes, interest));
            }
            if plan.timed {
                let (classes, interest) =
                    (|lens| format!("classes.lens_{lens}"), |lens| format!("classes.interest_{lens}"));
                text.push_str(&epochs::specialised(plan, handlers, &OF_LINE, classes, interest));
                text.push_str(&if plan.partly { epochs::comes(&OF_LINE) } else { String::new() });
            }
            specialised(&mut text, &writer);
        }
        Program::Uber(uber) => uber_source(&mut text, uber, handlers),
    }
    text
}

/// A line of a city that does not show at its place, or between faces that are both not there.
fn gone(has_contents: bool, timed: bool, partly: bool, coming: &str) -> String {
    let shown = has_contents.then(|| format!("({})", contents::is_shown(OF_LINE.arguments)));
    let there = (timed && !partly).then(|| "(exists(fragment, classes) || exists(other, classes))".to_owned());
    let of = |is: String| format!("    if !{is} {{\n        opacity = 0.0;\n    }}\n");
    let all: String = shown.into_iter().chain(there).map(of).collect();
    let is_coming = format!("    let is_coming = {coming};\n");
    match (partly, coming) {
        (true, _) => all + &is_coming + SHARE_OF_FACES,
        (false, NONE_IS_COMING) => all,
        (false, _) => all + &is_coming + "    if is_coming {\n        opacity = 0.0;\n    }\n",
    }
}

/// Where no effect draws lines of what is not there yet.
const NONE_IS_COMING: &str = "false";

/// Whether a line is of such an effect, by what it asks of each of them.
fn is_coming(asked: impl Iterator<Item = String>) -> String {
    let all: Vec<String> = asked.collect();
    if all.is_empty() { NONE_IS_COMING.to_owned() } else { all.join(" || ") }
}

/// Lines are there as much as the face that is there most. Those of what is not there yet are where no face is: `is_coming` says that they are
/// such.
const SHARE_OF_FACES: &str = "    let share_of_faces = max(presence(fragment, classes), presence(other, classes));
    if !is_coming {
        opacity *= share_of_faces;
    } else if share_of_faces > 0.0 || !(comes(fragment, classes) || comes(other, classes)) {
        opacity = 0.0;
    }
";

fn parameters(handler: &EffectDefinition, first: &str) -> String {
    if handler.slots() == 0 { String::new() } else { format!(", {}({first})", handler.own("parameters")) }
}

/// Whether a hiding takes both faces of an edge (`and`), or one of them (`or`).
fn hides(handler: &EffectDefinition, first: &str, word: &str) -> String {
    let of = |face: &str| format!("{}({face}{})", handler.wgsl_name(), parameters(handler, first));
    format!("({} {word} {})", of("fragment"), of("other"))
}

/// `if a && b {\n body }`; the body alone where there is nothing to ask.
fn branch(conditions: &[String], body: &str) -> String {
    match conditions.is_empty() {
        true => format!("    {body}\n"),
        false => format!("    if {} {{\n        {body}\n    }}\n", conditions.join(" && ")),
    }
}

fn specialised(text: &mut String, writer: &Writer) {
    text.push_str(
        "fn line_at(step: u32, point: Point, fragment: Fragment, other: Fragment, classes: Classes) -> vec4f {\n",
    );
    text.push_str("    var color = vec3f(0.0);\n    var opacity = 0.0;\n");
    let mut hidden = String::new();
    // Scene styles that drew a line so far.
    let mut drawn: Vec<usize> = Vec::new();
    let steps = || writer.plan.steps.iter().map(|s| (s, &writer.handlers[s.effect as usize])).enumerate();
    for (number, (step, handler)) in steps() {
        let share = writer.share(step);
        let is_dithered = match (step.scope, &share) {
            (Scope::Lens(lens, _), Some(_)) => writer.plan.border_of(lens).is_some_and(|b| b.dithers),
            _ => false,
        };
        let scope: Vec<String> = match (step.scope, &share) {
            (Scope::Everywhere, _) => Vec::new(),
            (_, Some(share)) if handler.kind == EffectKind::Hide && is_dithered => {
                vec![format!("is_dithered({share}, fragment.pixel)")]
            }
            (_, Some(share)) if handler.kind != EffectKind::Hide => vec![format!("{share} > 0.0")],
            (Scope::Lens(lens, class), _) => vec![format!("{}(classes.lens_{lens})", class.function())],
        };
        // A line that begins to be hidden or replaced, or to be drawn, is faint.
        let left = share.as_ref().map_or_else(|| "0.0".to_owned(), |share| format!("opacity * (1.0 - {share})"));
        let first = format!("{}u", step.parameters);
        if handler.kind == EffectKind::Scene && !drawn.is_empty() {
            let of: Vec<String> = drawn.iter().map(|d| format!("step == {d}u")).collect();
            let conditions = [&[format!("({})", of.join(" || "))][..], &scope].concat();
            text.push_str(&branch(&conditions, &format!("opacity = {left};")));
        }
        match (handler.kind, handler.lines) {
            (EffectKind::Post, false) => text.push_str(&writer.statement(step, handler)),
            (EffectKind::Hide, false) => {
                hidden.push_str(&branch(&[&scope[..], &[hides(handler, &first, "&&")]].concat(), "opacity = 0.0;"));
            }
            (_, true) => {
                let mut conditions = [&[format!("step == {number}u")][..], &scope].concat();
                match handler.kind {
                    EffectKind::Hide => conditions.push(hides(handler, &first, "||")),
                    EffectKind::Scene => drawn.push(number),
                    // What lies over surfaces stays, whatever they look like.
                    _ => {}
                }
                let color = format!("color = {}({first}).line_color;", handler.own("parameters"));
                let faint = match share.filter(|_| handler.kind != EffectKind::Hide) {
                    Some(share) => format!(" * {share}"),
                    None => String::new(),
                };
                let body = format!("{color}\n        opacity = {}{faint};", weight(step, handler));
                text.push_str(&branch(&conditions, &body));
            }
            _ => {}
        }
    }
    text.push_str(&hidden);
    let coming = steps().filter(|(_, (_, handler))| handler.draws_coming());
    let coming = is_coming(coming.map(|(number, _)| format!("step == {number}u")));
    let Plan { contents, timed, partly, .. } = writer.plan;
    text.push_str(&gone(!contents.is_empty(), *timed, *partly, &coming));
    text.push_str("    return vec4f(color, opacity);\n}\n");
}

fn weight(step: &Step, handler: &EffectDefinition) -> String {
    step.weight(handler).map_or_else(|| "1.0".to_owned(), |slot| format!("parameters[{slot}].x"))
}

fn uber_source(text: &mut String, uber: &Uber, handlers: &[EffectDefinition]) {
    text.push_str(&table::declared());
    text.push_str(&uber::classes(uber));
    text.push_str(&invoke::invoke(uber, "style", &[EffectKind::Post], handlers));
    let own = |word: &str, type_name: &str, of: &dyn Fn(&EffectDefinition) -> Option<String>| {
        let mut text = format!("fn {word} {{\n    switch by.handler {{\n");
        for &number in &uber.effects {
            if let Some(value) = of(&handlers[number as usize]) {
                let _ = writeln!(text, "        case {number}u: {{ return {value}; }}");
            }
        }
        let _ = write!(text, "        default: {{ return {type_name}; }}\n    }}\n}}\n\n");
        text
    };
    text.push_str(&own("hides(fragment: Fragment, by: Invoker) -> bool", "false", &|h| {
        (h.kind == EffectKind::Hide).then(|| format!("{}(fragment{})", h.wgsl_name(), parameters(h, "by.parameters")))
    }));
    text.push_str(&own("line_color(by: Invoker) -> vec3f", "vec3f(0.0)", &|h| {
        h.lines.then(|| format!("{}(by.parameters).line_color", h.own("parameters")))
    }));
    let has_posts = uber.effects.iter().any(|&e| handlers[e as usize].kind == EffectKind::Post);
    let share = invoke::share_argument(uber);
    let styled = if has_posts { format!("color = invoke_style(color, point, by{share});") } else { String::new() };
    let coming = uber.effects.iter().filter(|&&number| handlers[number as usize].draws_coming());
    let coming = is_coming(coming.map(|number| format!("drawing.handler == {number}u")));
    text.push_str(&line_at(&styled, &gone(uber.contents, uber.timed, uber.partly, &coming)));
    let runs = if fades(uber) { "is_there(by, fragment, classes)" } else { "runs(by, classes)" };
    if uber.contents {
        text.push_str(&contents::uber(OF_LINE.parameters, runs));
    }
    if uber.timed {
        text.push_str(&epochs::uber(uber, handlers, &OF_LINE, runs));
        text.push_str(&if uber.partly { epochs::comes(&OF_LINE) } else { String::new() });
    }
    text.push_str(&if fades(uber) { [LINE_SHARE_FADED, IS_THERE].concat() } else { LINE_SHARE.to_owned() });
    text.push_str(LINE_KINDS);
}

/// How a line looks. `styled`: what post styles do; `gone`: what a city does that does not show there.
///
/// `by.kind` says what an invoker is to lines: as `render::operations` writes it. No round ends early: what pixels that go different
/// ways leave behind then, Mesa 22.3 gets wrong.
fn line_at(styled: &str, gone: &str) -> String {
    format!(
        "fn line_at(step: u32, point: Point, fragment: Fragment, other: Fragment, classes: Classes) -> vec4f {{
    var color = vec3f(0.0);
    var opacity = 0.0;
    var is_hidden = false;
    let range = table.ranges.zw;
    let drawing = invoker(range.x + step);
    for (var i = range.x; i < range.y; i++) {{
        let by = invoker(i);
        let share = line_share(by, fragment, classes);
        let is_meant = share > 0.0;
        if is_meant && by.kind == POST {{
            {styled}
        }}
        if is_meant && (by.kind == SCENE || by.kind == SCENE_WITH_LINES) && drawing.kind == SCENE_WITH_LINES {{
            opacity = select(opacity * (1.0 - share), 0.0, by.border == 0u);
        }}
        is_hidden |= is_meant && by.kind == HIDE && hides(fragment, by) && hides(other, by);
        let draws = by.kind == SCENE_WITH_LINES || by.kind == POST_WITH_LINES || (by.kind == HIDE_WITH_LINES && (hides(fragment, by) || hides(other, by)));
        if is_meant && draws && i == range.x + step {{
            color = line_color(by);
            opacity = select(parameters[by.weight].x, 1.0, by.blend == 0u) * share;
        }}
        if i + 1u == range.y {{
            break;
        }}
    }}
{gone}    return vec4f(color, select(opacity, 0.0, is_hidden));
}}

"
    )
}

/// How much of an invoker a line has.
const LINE_SHARE: &str = "fn line_share(by: Invoker, fragment: Fragment, classes: Classes) -> f32 {
    return select(0.0, 1.0, runs(by, classes));
}

";

/// The same where lenses fade: what hides is there or not.
const LINE_SHARE_FADED: &str = "fn line_share(by: Invoker, fragment: Fragment, classes: Classes) -> f32 {
    if by.kind == HIDE || by.kind == HIDE_WITH_LINES {
        return select(0.0, 1.0, is_there(by, fragment, classes));
    }
    return share_at(by, classes);
}

";

/// Whether something is there that cannot be had by halves, where lenses fade.
const IS_THERE: &str = "fn is_there(by: Invoker, fragment: Fragment, classes: Classes) -> bool {
    if by.border != 0u && parameters[by.border - 1u].z > 0.5 {
        return is_dithered(share_at(by, classes), fragment.pixel);
    }
    return runs(by, classes);
}

";

const LINE_KINDS: &str = "const POST: u32 = 0u;
const SCENE: u32 = 1u;
const SCENE_WITH_LINES: u32 = 2u;
const HIDE: u32 = 3u;
const HIDE_WITH_LINES: u32 = 4u;
const POST_WITH_LINES: u32 = 5u;
";
