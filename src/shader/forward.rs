//! Translucent fragments shaded where they are drawn: the modules of methods that know no order of layers (O7), put together from
//! what shades a pixel, what tells which fragments are translucent, and what draws the city.

use crate::shader::{
    CHANCE, DITHER, FORWARD, FRAGMENT, GEOMETRY, Module, NOTES, NOTHING_CUT, TAIL, TRANSLUCENT, carried,
    effect::EffectDefinition, hiding, lens_files, names_of, plan::Program, specialised, uber, wgsl,
};

/// What becomes of a fragment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ForwardKind {
    /// It is added to the layer that all behind the slots are, or all.
    Tail,
    /// It is there or not by chance; whether its depth is that of its plane.
    Chance(bool),
}

/// Such a module.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Forward {
    /// What becomes of a fragment.
    pub kind: ForwardKind,
    /// What is translucent.
    pub hidden: Program,
    /// What the lenses make of it.
    pub shading: Program,
}

/// Its depth test comes after the shader, and writes.
const WHAT_IS_BEHIND: &str = "    //@behind-plane\n";
const END: &str = "    //@end\n";

impl Forward {
    /// A name for people and statistics.
    pub fn name(&self) -> String {
        let uber = if matches!(self.shading, Program::Uber(_)) { " uber" } else { "" };
        let kind = if self.kind == ForwardKind::Tail { "weighted" } else { "stochastic" };
        format!("{kind}{uber} ({})", names_of(&self.shading))
    }

    pub(super) fn source(&self, handlers: &[EffectDefinition], lenses: &[&str]) -> String {
        let kind: &[_] = if self.kind == ForwardKind::Tail { &[NOTES, TAIL] } else { &[CHANCE] };
        let of_files = |files: &[(&str, &str)]| -> String {
            files.iter().map(|(path, source)| format!("// ==== {path}\n\n{source}\n")).collect()
        };
        let shading = Module::files_of_shade(&self.shading, handlers);
        let own = carried::nothing();
        let (of_scene, opacity) = match &self.shading {
            Program::Specialised(plan) => {
                (specialised::source(plan, handlers, lenses, false), specialised::opacity(plan, handlers))
            }
            Program::Uber(uber) => (uber::source(uber, handlers), uber::opacity(uber, handlers)),
        };
        let first = of_files(&[&shading[..], &[FORWARD], kind].concat())
            .replace("//@carried\n", &own.members)
            .replace("//@handlers\n", &(own.functions + &of_scene + &opacity))
            // What the triangle carries is made where it is read.
            .replace(
                "@vertex\nfn vertex(@location(0) at: vec2f, @builtin(instance_index) part: u32) -> Corner {",
                "fn corner_of(at: vec2f, part: u32) -> Corner {",
            )
            .replace(specialised::ONLY_SHOWN, "");
        // As many parameters as the longer list reads.
        let slots = |program: &Program| match program {
            Program::Specialised(plan) => plan.slots(handlers),
            Program::Uber(_) => uber::MOST_SLOTS,
        };
        let (few, most) = (slots(&self.shading), slots(&self.shading).max(slots(&self.hidden)));
        let parameters = |count: u32| format!("parameters: array<vec4f, {count}>;");
        let first = first.replace(&parameters(few), &parameters(most));
        let of_hiding = lens_files(&self.hidden).into_iter().filter(|file| !shading.contains(file));
        let mut files: Vec<_> =
            of_hiding.chain([FRAGMENT, super::city_file(&self.hidden), GEOMETRY, TRANSLUCENT]).collect();
        // A fragment knows the threshold of its pixel.
        if !shading.contains(&DITHER) && !files.contains(&DITHER) {
            files.push(DITHER);
        }
        let hidden = hiding::source(&self.hidden, handlers, lenses, hiding::Eye::Layers) + NOTHING_CUT;
        let mut other = of_files(&files)
            .replace("//@handlers\n", &hidden)
            // Fragments have a view of their own.
            .replace(
                "fn placed(in: Vertex) -> Varying {\n",
                "fn placed(in: Vertex) -> Varying {\n    view = view_uniform;\n",
            )
            .replace(
                "@group(1) @binding(3) var<uniform> city: City;",
                "@group(0) @binding(5) var<uniform> city: City;",
            );
        let is_tail = self.kind == ForwardKind::Tail;
        // Nothing is stored, so it does not matter when depth is tested. What is opaque is read where shading reads it.
        other = other
            .replace(" //@early", "")
            .replace("    //@behind\n", "")
            .replace("@group(0) @binding(3) var opaque_depth: texture_depth_2d;\n", "")
            .replace("opaque_depth", "scene_depth");
        if let (false, Some(start), Some(end)) = (is_tail, other.find(WHAT_IS_BEHIND), other.find(END)) {
            other.replace_range(start..end, "");
        }
        let text = wgsl::merged(&first, &other);
        match self.kind {
            ForwardKind::Chance(true) => text
                .replace("//@depth\n", "    @builtin(frag_depth) depth: f32,\n")
                .replace("    //@set\n", "    laid.depth = depth;\n"),
            _ => text.replace("//@depth\n", "").replace("    //@set\n", ""),
        }
    }
}
