//! A plan written out, as a person would write it for this one scene: what the parts of the specialised back end share.

use std::fmt::Write as _;

use crate::shader::{
    effect::{
        definition::EffectDefinition,
        prototype::{EffectKind, Mode, Stage},
    },
    epochs::{self, OF_LAYER},
    lens_test, masks,
    names::one_line,
    plan::{
        Plan,
        program::Program,
        step::{Scope, Step},
    },
};
use crate::time::Moment;

/// A plan while it is written out.
pub(super) struct Writer<'a> {
    /// The plan.
    pub(super) plan: &'a Plan,
    /// The handlers that its numbers count.
    pub(super) handlers: &'a [EffectDefinition],
    /// Names of its lenses, which become comments.
    pub(super) names: &'a [&'a str],
}

impl Writer<'_> {
    /// The uniforms that are read, as [`lens_test::bindings`]; other parts of the module read so many `vec4f` of the parameters.
    pub(super) fn bindings(&self, others_slots: u32, carried: bool) -> String {
        let mut text = String::new();
        let slots = self.plan.slots(self.handlers);
        if slots > 0 {
            let slots = slots.max(others_slots);
            text.push_str(&lens_test::uniform(2, "parameters", &format!("array<vec4f, {slots}>"), carried));
        }
        text.push_str(&lens_test::bindings(&Program::Specialised(self.plan.clone()), carried));
        if self.plan.masks {
            text.push_str(masks::BINDING);
        }
        text.push('\n');
        text
    }

    /// The handlers that may run, once each: the plan's, and those of the program that it calls for.
    pub(super) fn used(&self) -> impl Iterator<Item = &EffectDefinition> {
        let own = self.plan.effects();
        let shades = |h: &&EffectDefinition| h.kind.prototype().stage >= Stage::Visibility;
        let is_used = move |(i, h): &(usize, &EffectDefinition)| match h.mode {
            Mode::Local => own.contains(&(*i as u32)) && h.kind != EffectKind::Filter,
            Mode::Optional => self.needs_optional(h.kind),
            Mode::Global => self.plan.haze && self.needs_optional(EffectKind::Scene),
            Mode::Ignore => false,
        };
        self.handlers.iter().enumerate().filter(is_used).map(|(_, h)| h).filter(shades)
    }

    /// Whether some surface gets its result from a prototype's optional handler.
    fn needs_optional(&self, kind: EffectKind) -> bool {
        // Styles of surfaces leave fields as they are.
        (self.plan.fields && kind == EffectKind::Scene)
            || !self.plan.steps_of(kind, self.handlers).any(|(s, h)| s.scope == Scope::Everywhere && s.replaces(h))
    }

    fn comment(&self, lens: usize) -> String {
        self.names.get(lens).map_or_else(String::new, |name| format!("  // {}", one_line(name)))
    }

    /// Which classes of which lens a pixel is in.
    pub(super) fn classes(&self) -> String {
        let mut text = "struct Classes {\n".to_owned();
        let lenses = &self.plan.lenses;
        if lenses.is_empty() {
            text.push_str("    none: u32,\n");
        }
        for i in 0..lenses.len() {
            let _ = writeln!(text, "    lens_{i}: u32,{}", self.comment(i));
            if self.plan.border_of(i as u32).is_some() {
                let _ = writeln!(text, "    interest_{i}: f32,");
            }
        }
        text.push_str("}\n\nfn classes_at(sight: Sight, part: u32) -> Classes {\n    var classes: Classes;\n");
        for i in 0..lenses.len() {
            let _ = writeln!(text, "    classes.lens_{i} = {};", lens_test::classes(self.plan, i as u32, "sight"));
            if let Some(border) = self.plan.border_of(i as u32) {
                let interest = lens_test::interest(self.plan, i as u32, &format!("parameters[{}]", border.parameters));
                let _ = writeln!(text, "    classes.interest_{i} = {interest};");
            }
        }
        text.push_str("    return classes;\n}\n\n");
        text
    }

    /// The call of a handler, laid over `subject` as the step says.
    fn call(&self, step: &Step, handler: &EffectDefinition, subject: &str, point: &str) -> String {
        let name = handler.wgsl_name();
        let own = match handler.slots() {
            0 => String::new(),
            _ => format!(", {}({}u)", handler.own("parameters"), step.parameters),
        };
        let mut call = match handler.kind {
            EffectKind::Filter => format!("filtered_at({}u, {point})", step.image(handler)),
            _ => format!("{name}({subject}, {point}{own})"),
        };
        let is_material = handler.kind == EffectKind::Material;
        if handler.is_users && handler.kind != EffectKind::Filter {
            let contained = if is_material { "contained_material" } else { "contained" };
            call = format!("{contained}({call})");
        }
        if handler.kind == EffectKind::Scene {
            call = format!("before_sky({call}, {point})");
        }
        let as_is = as_is(handler.kind);
        call = format!("{as_is}({call})");
        if handler.kind == EffectKind::Scene && self.has(EffectKind::Material) {
            call = format!("{as_is}({call} + {point}.highlight)");
        }
        let Some((blend, weight)) = step.blend.zip(step.weight(handler)) else { return call };
        let weight = format!("parameters[{weight}].x");
        match is_material {
            true => format!("{as_is}(blended_material({}u, {subject}, {call}, {weight}))", blend.number()),
            false => format!("{as_is}(weighed({subject}, blend_{}({subject}, {call}), {weight}))", blend.word()),
        }
    }

    /// `if condition { subject = call; }`.
    pub(super) fn statement(&self, step: &Step, handler: &EffectDefinition) -> String {
        let subject = match handler.kind {
            EffectKind::Material => "material",
            EffectKind::Light => "(*point).arriving",
            _ => "color",
        };
        let point = if handler.kind.is_before_color() { "*point" } else { "point" };
        let value = self.call(step, handler, subject, point);
        let mut conditions = Vec::new();
        if handler.kind == EffectKind::Scene {
            conditions.push("point.surface != NO_SURFACE".to_owned());
        }
        if handler.kind == EffectKind::Material && self.plan.fields && handler.name != OF_FIELDS {
            conditions.push("(*point).surface != NO_SURFACE".to_owned());
        }
        if let Some(share) = self.share(step) {
            let laid = match handler.kind {
                EffectKind::Material => format!("material_as_is(blended_material(1u, {subject}, {value}, share))"),
                _ => format!("as_is(weighed({subject}, {value}, share))"),
            };
            conditions.insert(0, "share > 0.0".to_owned());
            let conditions = conditions.join(" && ");
            return format!(
                "    {{\n        let share = {share};\n        if {conditions} {{\n            {subject} = {laid};\n        }}\n    }}\n"
            );
        }
        if let Scope::Lens(lens, class) = step.scope {
            conditions.insert(0, format!("{}(classes.lens_{lens})", class.function()));
        }
        let line = format!("{subject} = {value}");
        match conditions.is_empty() {
            true => format!("    {line};\n"),
            false => format!("    if {} {{\n        {line};\n    }}\n", conditions.join(" && ")),
        }
    }

    /// How much of a step a place has, of a lens that fades.
    pub(super) fn share(&self, step: &Step) -> Option<String> {
        let Scope::Lens(lens, class) = step.scope else { return None };
        self.plan.border_of(lens)?;
        Some(format!("{}(classes.lens_{lens}, classes.interest_{lens})", class.share()))
    }

    fn has(&self, kind: EffectKind) -> bool {
        self.plan.steps_of(kind, self.handlers).next().is_some()
    }

    fn statements(&self, kind: EffectKind) -> String {
        self.plan.steps_of(kind, self.handlers).map(|(step, handler)| self.statement(step, handler)).collect()
    }

    /// From the surface to its colour: material, light, the standard style and air, then the styles. `suffix` of its name and of that of
    /// `styled`.
    pub(super) fn shade(&self, suffix: &str) -> String {
        let mut text = format!("fn shade{suffix}(point: ptr<function, Point>, classes: Classes) -> vec3f {{\n");
        text.push_str(if self.plan.varies { moment_here(self.plan.partly) } else { "" });
        if self.has(EffectKind::Material) {
            text.push_str(MATERIAL_BEGINS);
            text.push_str(&self.statements(EffectKind::Material));
            text.push_str(MATERIAL_ENDS);
        }
        if self.has(EffectKind::Light) {
            text.push_str("    (*point).arriving = as_is((*point).arriving);\n");
            text.push_str(&self.statements(EffectKind::Light));
            text.push_str("    (*point).shade = luminance((*point).arriving);\n");
        }
        let highlights = self.has(EffectKind::Material);
        if highlights {
            text.push_str(HIGHLIGHTED);
        }
        text.push_str("    var color = vec3f(0.0);\n");
        let own = |kind, mode| self.handlers.iter().find(move |h| h.kind == kind && h.mode == mode);
        if let Some(standard) =
            own(EffectKind::Scene, Mode::Optional).filter(|_| self.needs_optional(EffectKind::Scene))
        {
            let plus = if highlights { " + (*point).highlight" } else { "" };
            let _ = writeln!(text, "    color = {}(color, *point){plus};", standard.wgsl_name());
            if let Some(air) = own(EffectKind::Air, Mode::Global).filter(|_| self.plan.haze) {
                let _ = writeln!(text, "    color = {}(color, *point);", air.wgsl_name());
            }
            text.push_str("    color = before_sky(color, *point);\n");
        }
        text.push_str(if highlights { HIGHLIGHT_LEFT } else { "" });
        let _ = writeln!(text, "    return styled{suffix}(color, *point, classes);\n}}\n");
        text
    }

    /// Which moment shows at a layer, or at what is shaded, and how much of it is there.
    pub(super) fn moments(&self) -> String {
        let (classes, interest) = (|lens| format!("classes.lens_{lens}"), |lens| format!("classes.interest_{lens}"));
        let operators = epochs::operators(&Program::Specialised(self.plan.clone()), self.handlers);
        operators + &epochs::specialised(self.plan, self.handlers, &OF_LAYER, classes, interest)
    }

    /// How much of a translucent layer is seen, for `pass/composite.wgsl`.
    pub(super) fn opacity(&self) -> String {
        // Where looks change over time, shading has it already.
        let mut text = if self.plan.partly && !self.plan.varies { self.moments() } else { String::new() };
        text.push_str("fn opacity_at(point: Point, classes: Classes) -> f32 {\n    var opacity = 1.0;\n");
        for (step, handler) in self.plan.steps_of(EffectKind::Opacity, self.handlers) {
            let first = format!("{}u", step.parameters);
            let own = match handler.slots() {
                0 => String::new(),
                _ => format!(", {}({first})", handler.own("parameters")),
            };
            let value = format!("number_as_is(contained_opacity({}(opacity, point{own})))", handler.wgsl_name());
            let (scope, value) = match (step.scope, self.share(step)) {
                (Scope::Everywhere, _) => (None, value),
                (_, Some(share)) => (None, format!("number_as_is(mix(opacity, {value}, {share}))")),
                (Scope::Lens(lens, class), None) => (Some(format!("{}(classes.lens_{lens})", class.function())), value),
            };
            let conditions: Vec<String> = scope.into_iter().chain(handler.acts_on("point", &first)).collect();
            let _ = match conditions.is_empty() {
                true => writeln!(text, "    opacity = {value};"),
                false => writeln!(text, "    if {} {{\n        opacity = {value};\n    }}", conditions.join(" && ")),
            };
        }
        text.push_str(&opacity_end(self.plan.clear_materials, self.plan.partly));
        text
    }

    /// How much lenses leave of a field at a place: what hides takes it away, and opacity rules thin it out as they do surfaces.
    pub(super) fn kept(&self) -> String {
        let is_cut = self.has(EffectKind::Hide) || self.has(EffectKind::Opacity) || self.plan.varies;
        let mut text = presence_of_field(self.plan.varies, self.plan.partly) + &kept_head(is_cut);
        for (step, handler) in self.plan.steps_of(EffectKind::Hide, self.handlers) {
            let own = match handler.slots() {
                0 => String::new(),
                _ => format!(", {}({}u)", handler.own("parameters"), step.parameters),
            };
            let share = match (step.scope, self.share(step)) {
                (Scope::Everywhere, _) => "1.0".to_owned(),
                (_, Some(share)) => share,
                (Scope::Lens(lens, class), None) => {
                    format!("select(0.0, 1.0, {}(classes.lens_{lens}))", class.function())
                }
            };
            let _ = writeln!(
                text,
                "    if {}(fragment{own}) {{\n        kept *= 1.0 - {share};\n    }}",
                handler.wgsl_name()
            );
        }
        text + KEPT_END
    }

    /// Scene styles and post styles, in lens order: what replaces the colour leaves nothing of the styles below.
    pub(super) fn styled(&self, suffix: &str) -> String {
        let is_style = |(_, h): &(&Step, &EffectDefinition)| h.kind.is_style();
        let all = self.plan.steps.iter().map(|s| (s, &self.handlers[s.effect as usize])).filter(is_style);
        let lines: String = all.map(|(step, handler)| self.statement(step, handler)).collect();
        let head = format!("fn styled{suffix}(start: vec3f, point: Point, classes: Classes) -> vec3f {{\n");
        match lines.is_empty() {
            true => format!("{head}    return start;\n}}\n\n"),
            false => format!("{head}    var color = as_is(start);\n{lines}    return color;\n}}\n\n"),
        }
    }
}

/// The material that acts on fields; others are of surfaces.
pub(super) const OF_FIELDS: &str = "transfer";

/// `presence_of_field`: how much of a field is there at the moment that shows at a place of it.
pub(super) fn presence_of_field(varies: bool, partly: bool) -> String {
    let head = "fn presence_of_field(number: u32, point: Point, classes: Classes) -> f32 {\n";
    if !varies {
        return format!("{head}    return 1.0;\n}}\n\n");
    }
    let own = "    let begin = Moment(fields.each[number].begin_hour, fields.each[number].begin_micro);
    let end = Moment(fields.each[number].end_hour, fields.each[number].end_micro);
    let lifetime = Lifetime(begin, end);
";
    // Where no moment is, the first of several is there.
    let there = "select(0.0, 1.0, holds(lifetime, in_time(moment_of_layer_at(point, classes))))";
    let first = Moment::FIRST.words();
    let [hour, micro] = [first[0].cast_signed().to_string(), first[1].to_string()];
    let in_time = format!(
        "fn in_time(at: Moment) -> Moment {{\n    if at.hour == TIMELESS_HOUR {{\n        return Moment({hour}, {micro}u);\n    }}\n    return at;\n}}\n\n"
    );
    let head = in_time + head;
    match partly {
        false => format!("{head}{own}    return {there};\n}}\n\n"),
        true => format!(
            "{head}{own}    var sum = 0.0;
    let count = combinations();
    for (var i = 0u; i < count; i++) {{
        combination = i;
        sum += {there} * weight_of_combination();
    }}
    return sum;\n}}\n\n"
        ),
    }
}

/// The beginning of `kept_of_field`. `is_cut`: whether anything may take some of a field away.
pub(super) fn kept_head(is_cut: bool) -> String {
    format!(
        "const LENSES_CUT_FIELDS: bool = {is_cut};\n\nfn kept_of_field(fragment: Fragment, point: Point, classes: Classes) -> f32 {{\n    var kept = 1.0;\n"
    )
}

/// Its end.
pub(super) const KEPT_END: &str = "    return kept * opacity_at(point, classes);\n}\n";

/// Says at which moment what is shaded is seen.
pub(super) fn moment_here(partly: bool) -> &'static str {
    match partly {
        // Of several moments the first.
        true => "    combination = 0u;\n    moment_here = moment_of_layer_at(*point, classes);\n",
        false => "    moment_here = moment_of_layer_at(*point, classes);\n",
    }
}

/// The end of `opacity_at`: of what is translucent itself, or there by halves, a lens shows that share.
pub(super) fn opacity_end(has_clear_materials: bool, partly: bool) -> String {
    let material = if has_clear_materials { " * point.opacity" } else { "" };
    let presence = if partly { " * presence_of_layer(point, classes)" } else { "" };
    format!("    return opacity{material}{presence};\n}}\n")
}

/// How material effects begin and end, and what they leave of light that does not come out of a colour.
pub(super) const MATERIAL_BEGINS: &str = "    let own_light = (*point).emission;
    var material = Material(as_is((*point).base), own_light, vec3f(0.0), 32.0);
";
pub(super) const MATERIAL_ENDS: &str = "    (*point).base = material.base;
    (*point).emission = vec3f(0.0);
";
pub(super) const HIGHLIGHTED: &str = "    (*point).highlight = as_is(highlights(material, *point));
";
/// A scene style has a colour of its own, to which what effects added belongs, but not the light that the city's materials have.
pub(super) const HIGHLIGHT_LEFT: &str = "    (*point).highlight = max((*point).highlight - own_light, vec3f(0.0));
";

/// What keeps compilers from putting the answer of a handler of this kind together with what follows (`lib/point.wgsl`).
pub(super) fn as_is(kind: EffectKind) -> &'static str {
    match kind {
        EffectKind::Material => "material_as_is",
        EffectKind::Opacity => "number_as_is",
        _ => "as_is",
    }
}
