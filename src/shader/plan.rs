//! What a scene asks of the shading pass, and the WGSL that says it.
//!
//! A [`Plan`] names effects, lenses and classes, never positions or parameters: those stand in uniforms, so a lens
//! that moves or a slider that is dragged compiles nothing. Equal plans share a pipeline.

use std::fmt::Write as _;

use crate::shader::effect::{EffectDefinition, EffectKind};

/// `vec4f` that an outline's parameters take: colour and opacity; width in pixels.
pub const OUTLINE_SLOTS: u32 = 2;

/// Lenses and effects of one part of the picture, bottom lens first (L6).
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Plan {
    /// Lenses that may be seen there.
    pub lenses: Vec<PlanLens>,
    /// What is done, in order.
    pub steps: Vec<Step>,
    /// Whether every pixel's classes are written down, for AOVs and statistics.
    pub masks: bool,
}

/// A lens of a plan.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct PlanLens {
    /// Its bit in the masks.
    pub number: u32,
    /// How many of the frame's volumes are its own; they follow those of the lenses before it.
    pub volumes: u32,
    /// Place of its outline's parameters, where it shows one.
    pub outline: Option<u32>,
}

/// One use of an effect.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Step {
    /// Index into [`crate::shader::effects`].
    pub effect: u32,
    /// Where it acts.
    pub scope: Scope,
    /// Its first `vec4f` of the parameters.
    pub parameters: u32,
}

/// Where an effect acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Scope {
    /// All of the picture.
    Everywhere,
    /// One class of a lens (L4): index into [`Plan::lenses`].
    Lens(u32, ClassTest),
}

/// A class of L4, as `lib/lens.wgsl` tests it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ClassTest {
    /// D_F ≤ D < D_B.
    Inside,
    /// D < D_F.
    Front,
    /// D ≥ D_B.
    Behind,
    /// The ray misses the lens, or D is between two of its volumes.
    Rest,
}

impl ClassTest {
    fn function(self) -> &'static str {
        match self {
            Self::Inside => "is_inside",
            Self::Front => "is_in_front",
            Self::Behind => "is_behind",
            Self::Rest => "is_rest",
        }
    }
}

impl Plan {
    /// The numbers of all effects in it, ascending, each once.
    pub fn effects(&self) -> Vec<u32> {
        let mut all: Vec<u32> = self.steps.iter().map(|s| s.effect).collect();
        all.sort_unstable();
        all.dedup();
        all
    }

    /// Whether some lens shows its silhouette.
    pub fn has_outlines(&self) -> bool {
        self.lenses.iter().any(|l| l.outline.is_some())
    }

    /// Volumes of all its lenses.
    pub fn volumes(&self) -> u32 {
        self.lenses.iter().map(|l| l.volumes).sum()
    }

    /// How many `vec4f` of the parameters it reads.
    fn parameters(&self, effects: &[EffectDefinition]) -> u32 {
        let of_steps = self.steps.iter().map(|s| s.parameters + effects[s.effect as usize].slots());
        let of_lines = self.lenses.iter().filter_map(|l| l.outline.map(|first| first + OUTLINE_SLOTS));
        of_steps.chain(of_lines).max().unwrap_or(0)
    }

    /// The effects' own functions, and `apply`, which calls them.
    pub fn source(&self, effects: &[EffectDefinition]) -> String {
        let mut text = String::new();
        let count = self.parameters(effects);
        if count > 0 {
            let _ = writeln!(text, "@group(2) @binding(2) var<uniform> parameters: array<vec4f, {count}>;");
        }
        if self.volumes() > 0 {
            let count = self.volumes();
            let _ = writeln!(text, "@group(2) @binding(3) var<uniform> volumes: array<LensVolume, {count}>;");
        }
        if self.masks {
            let _ = writeln!(
                text,
                "@group(2) @binding(4) var class_masks: texture_storage_2d_array<r32uint, write>; // per 32 lenses: \
                 inside, in front, behind"
            );
        }
        for effect in self.effects() {
            let EffectDefinition { name, source, .. } = &effects[effect as usize];
            let _ = write!(text, "\n// ==== effect {name}\n\n{source}");
        }
        if self.has_outlines() {
            text.push_str(&self.coverage());
        }
        text.push_str("\nfn apply(start: vec4f, point: Point, pixel: vec2i) -> vec4f {\n    var color = start.rgb;\n");
        let mut first = 0;
        // This part of the picture is the bounds of all volumes: where there is one, they are its own.
        let test = if self.volumes() == 1 { "class_within" } else { "class_in" };
        for (i, lens) in self.lenses.iter().enumerate() {
            let volumes: Vec<String> =
                (first..first + lens.volumes).map(|v| format!("{test}(volumes[{v}], pixel, point.depth)")).collect();
            first += lens.volumes;
            let _ = writeln!(text, "    let lens_{i} = {};", volumes.join(" | "));
        }
        for step in &self.steps {
            let effect = &effects[step.effect as usize];
            let mut tests = Vec::new();
            if let Scope::Lens(lens, class) = step.scope {
                tests.push(format!("{}(lens_{lens})", class.function()));
            }
            if effect.kind == EffectKind::Scene {
                tests.push("point.surface != NO_SURFACE".to_owned());
            }
            let name = effect.wgsl_name();
            let own = match effect.slots() {
                0 => String::new(),
                _ => format!(", {name}_parameters({}u)", step.parameters),
            };
            let call = match effect.is_users {
                false => format!("color = {name}(color, point{own});"),
                true => format!("color = contained({name}(color, point{own}));"),
            };
            let _ = match tests.is_empty() {
                true => writeln!(text, "    {call}"),
                false => writeln!(text, "    if {} {{\n        {call}\n    }}", tests.join(" && ")),
            };
        }
        if self.masks {
            text.push_str(&self.masks());
        }
        text.push_str("    var paint = vec4f(color, start.a);\n");
        for (i, lens) in self.lenses.iter().enumerate() {
            if let Some(line) = lens.outline {
                let _ = writeln!(
                    text,
                    "    paint = outlined(paint, {i}u, pixel, parameters[{line}], parameters[{}]);",
                    line + 1
                );
            }
        }
        text.push_str("    return paint;\n}\n");
        text
    }

    /// Which lens covers a pixel, for `lib/outline.wgsl`.
    fn coverage(&self) -> String {
        let mut text = "\nfn lens_covers(lens: u32, pixel: vec2i) -> bool {\n    switch lens {\n".to_owned();
        let mut first = 0;
        for (i, lens) in self.lenses.iter().enumerate() {
            let volumes: Vec<String> =
                (first..first + lens.volumes).map(|v| format!("covers(volumes[{v}], pixel)")).collect();
            first += lens.volumes;
            let _ = writeln!(text, "        case {i}u: {{ return {}; }}", volumes.join(" || "));
        }
        text.push_str("        default: { return false; }\n    }\n}\n");
        text
    }

    /// Writes the classes down, one bit per lens.
    fn masks(&self) -> String {
        // A shader that stores may run before the depth test that chooses between surface and background.
        let mut text =
            "    if (textureLoad(scene_depth, pixel, 0) > 0.0) == (point.surface != NO_SURFACE) {\n".to_owned();
        let mut words: Vec<u32> = self.lenses.iter().map(|l| l.number / 32).collect();
        words.dedup();
        for word in words {
            for (layer, class) in ["INSIDE", "FRONT", "BEHIND"].into_iter().enumerate() {
                let bits: Vec<String> = self
                    .lenses
                    .iter()
                    .enumerate()
                    .filter(|(_, l)| l.number / 32 == word)
                    .map(|(i, l)| format!("select(0u, {:#x}u, (lens_{i} & {class}) != 0u)", 1_u32 << (l.number % 32)))
                    .collect();
                let value = bits.join(" | ");
                let layer = 3 * word as usize + layer;
                let _ =
                    writeln!(text, "        textureStore(class_masks, pixel, {layer}, vec4u({value}, 0u, 0u, 0u));");
            }
        }
        text.push_str("    }\n");
        text
    }
}
