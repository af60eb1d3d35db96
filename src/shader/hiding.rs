//! Visibility of fragments: `visible` and what it calls (architecture, decision 4), for the geometry pass and the shadow map, on both
//! back ends. A hiding effect says for each fragment, by its own depth, whether it is taken away, an opacity rule whether it
//! is translucent: then it is in the list of its pixel instead, by `is_layer`, and casts no shadow.

use std::fmt::Write as _;

use crate::shader::{
    contents,
    effect::{definition::EffectDefinition, prototype::EffectKind},
    epochs, lens_test,
    library::{FRAGMENT_RUNS, FRAGMENT_RUNS_DITHERED, FRAGMENT_RUNS_EVERYWHERE, SHARE_OF_INVOKER},
    names::one_line,
    plan::{Plan, program::Program, step::Scope, uber::Uber},
    regions,
    table::{self, MOST_SLOTS},
};

/// The eye that a module draws for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Eye {
    /// The picture's.
    Picture,
    /// The picture's, for what is translucent.
    Layers,
    /// The same, in a module that shades fragments where they are drawn.
    Fragments,
    /// The picture's, in a module that follows rays.
    Rays,
    /// The same, for what is translucent.
    RayLayers,
    /// The sun's: of a place that the picture may not show, the regions' numbers alone say where it is.
    Sun,
}

/// `visible` and what it calls. `names` of a plan's lenses become comments.
pub(super) fn source(program: &Program, handlers: &[EffectDefinition], names: &[&str], eye: Eye) -> String {
    if let Program::Specialised(plan @ Plan { regions: Some(regions), .. }) = program {
        return regions::visible(plan, regions, names);
    }
    let slots = match program {
        Program::Specialised(plan) => plan.slots(handlers),
        Program::Uber(_) => MOST_SLOTS,
    };
    let mut text = String::new();
    if slots > 0 {
        let _ = writeln!(text, "@group(2) @binding(2) var<uniform> parameters: array<vec4f, {slots}>;");
    }
    match eye {
        Eye::Picture | Eye::Layers | Eye::Fragments | Eye::Rays | Eye::RayLayers => {
            text.push_str(&lens_test::bindings(program, false));
        }
        Eye::Sun if !program.has().lenses => {}
        Eye::Sun => {
            text.push_str(
                "@group(2) @binding(8) var<storage, read> lens_regions: array<Region>;  // in the main view's space\n\n",
            );
            text.push_str(&program.forms().functions());
        }
    }
    text.push_str(&cities(program, eye));
    text.push('\n');
    for effect in program.effects().into_iter().map(|e| &handlers[e as usize]) {
        // How opaque it is, is asked where it has a place in the order of layers.
        let source = if effect.kind == EffectKind::Opacity { effect.parameters_source() } else { &effect.source };
        let _ = write!(text, "// ==== effect {}\n\n{}\n\n", effect.name, source.trim_end());
    }
    text.push_str(&epochs::operators(program, handlers));
    let is_layers = matches!(eye, Eye::Layers | Eye::Fragments | Eye::RayLayers);
    match program {
        Program::Specialised(plan) => {
            text.push_str("// ==== this scene\n\n");
            specialised(&mut text, plan, handlers, names, is_layers);
        }
        Program::Uber(uber) => uber_source(&mut text, uber, handlers, is_layers),
    }
    text
}

/// Where vertices stand.
fn cities(program: &Program, eye: Eye) -> String {
    match (eye, program.has().has_cities()) {
        (Eye::Picture | Eye::Layers | Eye::Fragments | Eye::Rays | Eye::RayLayers, false) => String::new(),
        // Rays go from city to city.
        (Eye::Rays | Eye::RayLayers, true) => "var<private> city: City;\n".to_owned(),
        (Eye::Picture | Eye::Layers, true) => contents::binding(1, 3, "city"),
        // Group 1 is that of shading.
        (Eye::Fragments, true) => contents::binding(0, 5, "city"),
        (Eye::Sun, false) => relative_to_main_eye("(vec3f(whole - eye.eye_whole) - eye.eye_fraction) + offset"),
        (Eye::Sun, true) => {
            let both = contents::binding(1, 3, "city") + &contents::binding(1, 4, "main_city");
            both + &relative_to_main_eye("placed_by(main_city, whole, offset)")
        }
    }
}

/// Where a place of a city stands, from the eye of the picture.
fn relative_to_main_eye(placed: &str) -> String {
    format!("\nfn relative_to_main_eye(whole: vec3i, offset: vec3f) -> vec3f {{\n    return {placed};\n}}\n")
}

/// `visible`, or `is_layer`, begins with this.
fn head(has_contents: bool, timed: bool, partly: bool, is_layers: bool) -> String {
    let name = if is_layers { "is_layer" } else { "visible" };
    let shown = has_contents.then(|| format!("({})", contents::is_shown("fragment")));
    let presence = if partly { "    let presence = presence(fragment);\n" } else { "" };
    let there = timed.then(|| if partly { "(presence > 0.0)" } else { "exists(fragment)" }.to_owned());
    let asked = shown.into_iter().chain(there).map(|is| format!("    if !{is} {{\n        return false;\n    }}\n"));
    format!("fn {name}(fragment: Fragment) -> bool {{\n{presence}") + &asked.collect::<String>()
}

/// The call of a hiding effect of `fragment`, whose parameters begin at a slot.
pub(super) fn call(handler: &EffectDefinition, first: &str) -> String {
    let own = if handler.slots() == 0 { String::new() } else { format!(", {}({first})", handler.own("parameters")) };
    format!("{}(fragment{own})", handler.wgsl_name())
}

fn specialised(text: &mut String, plan: &Plan, handlers: &[EffectDefinition], names: &[&str], is_layers: bool) {
    let steps = || {
        let kinds = [EffectKind::Hide, EffectKind::Opacity];
        kinds.into_iter().flat_map(|kind| plan.steps_of(kind, handlers))
    };
    let mut lenses: Vec<u32> =
        steps().filter_map(|(step, _)| if let Scope::Lens(lens, _) = step.scope { Some(lens) } else { None }).collect();
    lenses.extend(plan.contents.iter().map(|c| c.lens));
    lenses.extend(plan.epochs.iter().map(|e| e.lens));
    lenses.sort_unstable();
    lenses.dedup();
    for lens in lenses {
        if let Some(name) = names.get(lens as usize) {
            let _ = writeln!(text, "// {}", one_line(name));
        }
        let _ = writeln!(
            text,
            "fn classes_of_lens_{lens}(sight: Sight) -> u32 {{\n    return {};\n}}\n",
            lens_test::classes(plan, lens, "sight")
        );
        if let Some(border) = plan.border_of(lens) {
            let interest = lens_test::interest(plan, lens, &format!("parameters[{}]", border.parameters));
            let _ = writeln!(text, "fn interest_in_lens_{lens}(sight: Sight) -> f32 {{\n    return {interest};\n}}\n");
        }
    }
    let of = |what: &str, lens: u32| format!("{what}_lens_{lens}(sight_of(fragment))");
    let (classes, interest) = (|lens| of("classes_of", lens), |lens| of("interest_in", lens));
    if !plan.contents.is_empty() {
        text.push_str(&contents::specialised(plan, "fragment: Fragment", classes, interest));
    }
    if plan.timed {
        text.push_str(&epochs::specialised(plan, handlers, &epochs::OF_FRAGMENT, classes, interest));
    }
    text.push_str(&head(!plan.contents.is_empty(), plan.timed, plan.partly, is_layers));
    // Behind all that hides: what is not there is not translucent.
    let clear = is_clear(plan.clear_materials, plan.partly);
    let mut material = clear.as_deref().map_or_else(String::new, |clear| clear_material(clear, is_layers));
    for (step, handler) in steps() {
        let first = format!("{}u", step.parameters);
        let is_rule = handler.kind == EffectKind::Opacity;
        if is_rule {
            text.push_str(&std::mem::take(&mut material));
        }
        let acts = if is_rule { handler.acts_on("fragment", &first) } else { Some(call(handler, &first)) };
        let scope = match step.scope {
            Scope::Everywhere => None,
            Scope::Lens(lens, class) => {
                let of = |what: &str| format!("{what}_lens_{lens}(sight_of(fragment))");
                let share = || format!("{}({}, {})", class.share(), of("classes_of"), of("interest_in"));
                Some(match plan.border_of(lens) {
                    Some(_) if is_rule => format!("{} > 0.0", share()),
                    Some(border) if border.dithers => format!("is_dithered({}, fragment.pixel)", share()),
                    _ => format!("{}({})", class.function(), of("classes_of")),
                })
            }
        };
        let conditions: Vec<String> = scope.into_iter().chain(acts).collect();
        let answer = format!("return {};", is_layers && is_rule);
        match conditions.is_empty() {
            true => {
                let _ = writeln!(text, "    {answer}\n}}");
                return;
            }
            false => {
                let _ = writeln!(text, "    if {} {{\n        {answer}\n    }}", conditions.join(" && "));
            }
        }
    }
    let _ = writeln!(text, "{material}    return {};\n}}", !is_layers);
}

/// Whether something is seen through a fragment, whatever lenses do: by its material, or as it is there by halves.
fn is_clear(clear_materials: bool, partly: bool) -> Option<String> {
    let asked = [(clear_materials, "fragment.opacity"), (partly, "presence")];
    let asked: Vec<&str> = asked.into_iter().filter_map(|(is_asked, what)| is_asked.then_some(what)).collect();
    (!asked.is_empty()).then(|| format!("{} < 1.0", asked.join(" * ")))
}

/// What becomes of it then.
fn clear_material(clear: &str, is_layers: bool) -> String {
    format!("    if {clear} {{\n        return {is_layers};\n    }}\n")
}

fn uber_source(text: &mut String, uber: &Uber, handlers: &[EffectDefinition], is_layers: bool) {
    text.push_str(&table::declared());
    match uber.tests.is_empty() {
        true => text.push_str(&FRAGMENT_RUNS_EVERYWHERE.paragraph()),
        false if uber.borders => {
            let tests = &uber.tests;
            let (classes, distances) = (lens_test::class_of(uber), lens_test::distance_to(tests, uber.by_ray));
            text.push_str(
                &(classes + &distances + &SHARE_OF_INVOKER.paragraph() + &FRAGMENT_RUNS_DITHERED.paragraph()),
            );
        }
        false => text.push_str(&(lens_test::class_of(uber) + &FRAGMENT_RUNS.paragraph())),
    }
    text.push_str("fn hides(fragment: Fragment, by: Invoker) -> bool {\n    switch by.handler {\n");
    for &number in &uber.effects {
        let handler = &handlers[number as usize];
        let answer = match handler.kind {
            EffectKind::Opacity => handler.acts_on("fragment", "by.parameters").unwrap_or_else(|| "true".to_owned()),
            _ => call(handler, "by.parameters"),
        };
        let _ = writeln!(text, "        case {number}u: {{ return {answer}; }}");
    }
    text.push_str("        default: { return false; }\n    }\n}\n\n");
    if uber.contents {
        text.push_str(&contents::uber("fragment: Fragment", "runs(by, fragment)"));
    }
    if uber.timed {
        let runs = "runs(by, fragment)";
        text.push_str(&epochs::uber(uber, handlers, &epochs::OF_FRAGMENT, runs));
    }
    text.push_str(&head(uber.contents, uber.timed, uber.partly, is_layers));
    let clear = is_clear(uber.clear_materials, uber.partly);
    match is_layers {
        true => {
            let _ = writeln!(text, "    var is_translucent = {};", clear.as_deref().unwrap_or("false"));
            text.push_str(IS_LAYER);
        }
        false => {
            text.push_str(&clear.map_or_else(String::new, |clear| clear_material(&clear, false)));
            text.push_str(VISIBLE);
        }
    }
}

const VISIBLE: &str = "    let range = table.ranges.xy;
    for (var i = range.x; i < range.y; i++) {
        let by = invoker(i);
        if runs(by, fragment) && hides(fragment, by) {
            return false;
        }
        if i + 1u == range.y {
            break;
        }
    }
    return true;
}
";

/// `by.kind` is 2 for opacity rules. Nothing is returned out of the loop: what that leaves behind, Mesa 22.3 gets wrong.
const IS_LAYER: &str = "    let range = table.ranges.xy;
    var is_hidden = false;
    for (var i = range.x; i < range.y; i++) {
        let by = invoker(i);
        let acts = runs(by, fragment) && hides(fragment, by);
        is_hidden |= acts && by.kind != 2u;
        is_translucent |= acts && by.kind == 2u;
        if i + 1u == range.y {
            break;
        }
    }
    return is_translucent && !is_hidden;
}
";
