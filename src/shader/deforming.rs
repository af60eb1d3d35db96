//! Deformations written out: the steps and profiles that a scene calls for, one after the other, with the places of their numbers as
//! constants. Software adapters read a number at a place they know as fast as a register, and any other eight times as slowly.

use std::fmt::Write as _;

use crate::shader::{effect::definition::EffectDefinition, names::one_line, wgsl::token};

/// Fours of numbers before the first deformer, of a deformer, and of a step of it: `lib/deform.wgsl`.
pub const FIRST_DEFORMER: usize = 1;
/// Fours of numbers of a deformer.
pub const DEFORMER_NUMBERS: usize = 11;
/// Fours of numbers of a step before its own: how far apart samples may be.
pub const STEP_HEAD: usize = 1;
/// Fours of numbers of a user's map before its parameters: size and reach; strength and half of how far apart differences are.
pub const MAP_HEAD: usize = 2;

/// Deformations without their numbers: the deformers, bottom first.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct DeformPlan(pub Vec<PlanDeformer>);

/// A deformer without its numbers.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct PlanDeformer {
    /// How strong it is.
    pub control: PlanControl,
    /// Whether that is in a band of heights alone.
    pub has_band: bool,
    /// One after the other.
    pub steps: Vec<PlanStep>,
}

macro_rules! functions {
    ($(#[$doc:meta])* $name:ident { $($(#[$own:meta])* $variant:ident = $function:literal,)* }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum $name {
            $($(#[$own])* $variant,)*
        }

        impl $name {
            /// Its function in `lib/deform.wgsl`.
            fn function(self) -> &'static str {
                match self {
                    $(Self::$variant => $function,)*
                }
            }
        }
    };
}

functions! {
    /// How strong a deformer is over its plane; nothing: everywhere as strong.
    PlanControl {
        /// All of it everywhere.
        Everywhere = "",
        /// A plateau with straight slopes.
        Linear = "linear_plateau",
        /// With smooth ones.
        Smooth = "smooth_plateau",
        /// A round hill.
        Bump = "bump",
        /// A round wall.
        Ring = "ring",
        /// An image.
        Texels = "texels",
    }
}

/// A step of a deformer: a handler of the vertex stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct PlanStep {
    /// Its number among the handlers.
    pub handler: u32,
    /// Which version of it: where its definition stands, which is freed never. Kernels of one that was replaced serve no other.
    version: usize,
    /// Fours of numbers of its parameters.
    slots: u32,
    /// Whether its derivative is made of differences.
    is_map: bool,
    /// Whether it reads tables: a route.
    reads_tables: bool,
}

impl PlanStep {
    /// The step of a handler of these.
    pub fn new(handler: u32, handlers: &[EffectDefinition]) -> Self {
        let definition = &handlers[handler as usize];
        let tokens = token::tokens(&definition.source);
        let reads_tables = tokens.iter().any(|token| &definition.source[token.span.clone()] == "tables");
        let version = std::ptr::from_ref(definition) as usize;
        Self { handler, version, slots: definition.slots(), is_map: !definition.has_derivative, reads_tables }
    }

    /// Fours of its numbers.
    fn numbers(&self) -> usize {
        STEP_HEAD + if self.is_map { MAP_HEAD } else { 0 } + self.slots as usize
    }

    /// What it makes of a place, its numbers from `at` on: the way and its derivative, or the way alone.
    fn call(&self, handlers: &[EffectDefinition], at: usize, place: &str, is_way: bool) -> String {
        let (definition, own) = (&handlers[self.handler as usize], at + STEP_HEAD);
        let name = definition.wgsl_name();
        match (self.is_map, is_way) {
            (true, true) => format!("way_of_{name}({own}u, {place})"),
            (true, false) => format!("jet_of_{name}({own}u, {place})"),
            (false, _) if self.slots == 0 => format!("{name}({place}){}", if is_way { ".way" } else { "" }),
            (false, _) => {
                let parameters = definition.own("parameters");
                format!("{name}({place}, {parameters}({own}u)){}", if is_way { ".way" } else { "" })
            }
        }
    }
}

/// What is made of a user's map: its way, contained, and its derivative by differences. With samples a sixty-fourth of the detail apart,
/// of a wave of four details the error of the derivative is 10⁻⁴ of its largest value, and rounding adds as much.
fn of_map(definition: &EffectDefinition) -> String {
    // No name of the handler's own begins so.
    let name = definition.wgsl_name();
    let (way, jet) = (format!("way_of_{name}"), format!("jet_of_{name}"));
    let parameters = match definition.slots() {
        0 => String::new(),
        _ => format!(", {}(own + 2u)", definition.own("parameters")),
    };
    format!(
        "// Its numbers: the extent of the lens and how far it reaches, metres; its strength, and half of how far apart differences are.\n\
         fn {way}(own: u32, place: vec3f) -> vec3f {{\n    \
         return contained_way({name}(place, numbers[own].xyz{parameters}), numbers[own].w, numbers[own + 1u].x);\n}}\n\n\
         fn {jet}(own: u32, place: vec3f) -> Jet {{\n    \
         let half = numbers[own + 1u].y;\n    \
         var slope = NO_SLOPE;\n    \
         for (var i = 0; i < 3; i++) {{\n        \
         var low = place;\n        var high = place;\n        low[i] -= half;\n        high[i] += half;\n        \
         slope[i] = ({way}(own, high) - {way}(own, low)) / (high[i] - low[i]);\n    }}\n    \
         return Jet({way}(own, place), slope);\n}}\n\n",
    )
}

impl DeformPlan {
    /// Where a deformer's numbers begin, in fours.
    pub fn deformer(i: usize) -> usize {
        FIRST_DEFORMER + DEFORMER_NUMBERS * i
    }

    /// Where those of each step of each deformer begin.
    pub fn steps(&self) -> Vec<Vec<usize>> {
        let mut at = Self::deformer(self.0.len());
        let next = |step: &PlanStep| {
            at += step.numbers();
            at - step.numbers()
        };
        let mut next = next;
        self.0.iter().map(|deformer| deformer.steps.iter().map(&mut next).collect()).collect()
    }

    /// How many fours there are.
    pub fn numbers(&self) -> usize {
        let steps = self.0.iter().flat_map(|deformer| &deformer.steps);
        Self::deformer(self.0.len()) + steps.map(PlanStep::numbers).sum::<usize>()
    }

    /// Whether something is read from tables: texels or routes.
    pub fn has_tables(&self) -> bool {
        let has = |d: &PlanDeformer| d.control == PlanControl::Texels || d.steps.iter().any(|step| step.reads_tables);
        self.0.iter().any(has)
    }

    /// The filling of the hook `deformers` (`lib/deform.wgsl`): how many there are, and `shown_at`.
    pub(super) fn shown(&self, handlers: &[EffectDefinition]) -> String {
        let steps: usize = self.0.iter().map(|deformer| deformer.steps.len()).sum();
        let mut text = format!(
            "const NUMBERS: u32 = {}u;\nconst DEFORMERS: u32 = {}u;\nconst STEPS: u32 = {}u;\n",
            self.numbers(),
            self.0.len(),
            steps.max(1)
        );
        let is_used = |number: usize| self.0.iter().flat_map(|d| &d.steps).any(|step| step.handler as usize == number);
        for (_, definition) in handlers.iter().enumerate().filter(|(number, _)| is_used(*number)) {
            let _ = write!(text, "\n// {}\n{}", one_line(&definition.doc), definition.source);
            if !definition.has_derivative {
                let _ = write!(text, "\n{}", of_map(definition));
            }
        }
        for (i, (deformer, steps)) in self.0.iter().zip(self.steps()).enumerate() {
            let lens = Self::deformer(i);
            let control = match deformer.control {
                PlanControl::Everywhere => "Kappa(1.0, vec3f(0.0))".to_owned(),
                control => format!("kappa_of({lens}u, {}({lens}u, on_plane({lens}u, p)))", control.function()),
            };
            let control = if deformer.has_band { format!("in_band({lens}u, p, {control})") } else { control };
            let _ = write!(text, "\nfn control_{i}(p: vec3f) -> Kappa {{\n    return {control};\n}}\n");
            let _ = write!(text, "\nfn chain_{i}(p: vec3f) -> Jet {{\n    var jet = Jet(vec3f(0.0), NO_SLOPE);\n");
            for (step, at) in deformer.steps.iter().zip(steps) {
                let _ = writeln!(text, "    jet = then(jet, {});", step.call(handlers, at, "p + jet.way", false));
            }
            text.push_str("    return jet;\n}\n");
        }
        text.push_str("\nfn shown_at(cell: vec3i, offset: vec3f, normal: vec3f) -> Shown {\n");
        text.push_str("    var shown = Shown(vec3f(0.0), normal);\n    var p: vec3f;\n");
        for i in 0..self.0.len() {
            let lens = Self::deformer(i);
            let _ = write!(
                text,
                "    p = in_frame({lens}u, cell, offset + shown.way);\n    if is_supported({lens}u, p) {{\n        \
                 shown = moved_on(shown, {lens}u, control_{i}(p), chain_{i}(p));\n    }}\n"
            );
        }
        text.push_str("    return shown;\n}\n");
        text
    }

    /// The filling of the hook `traced` (`pass/refine.wgsl`): how far a place is moved, metres, with all steps noted.
    pub(super) fn traced(&self, handlers: &[EffectDefinition]) -> String {
        let mut text = "// How far a place is moved, metres; only the first step of a deformer is continuous across the border of its \
                        support.\nfn traced(cell: vec3i, offset: vec3f, is_first: bool) -> vec3f {\n    \
                        var way = vec3f(0.0);\n    var moved: vec3f;\n    var p: vec3f;\n    var is_in: bool;\n"
            .to_owned();
        let mut number = 0;
        for (i, (deformer, steps)) in self.0.iter().zip(self.steps()).enumerate() {
            let lens = Self::deformer(i);
            let _ = write!(
                text,
                "    p = in_frame({lens}u, cell, offset + way);\n    is_in = is_supported({lens}u, p);\n    \
                 moved = vec3f(0.0);\n"
            );
            for (k, (step, at)) in deformer.steps.iter().zip(steps).enumerate() {
                let place = if k == 0 { "p" } else { "select(vec3f(NOWHERE), p + moved, is_in)" };
                let call = step.call(handlers, at, "p + moved", true);
                let _ = write!(
                    text,
                    "    note({number}u, {place}, numbers[{at}u].xyz, is_first);\n    if is_in {{\n        \
                     moved += {call};\n    }}\n"
                );
                number += 1;
            }
            let _ = write!(
                text,
                "    if is_in {{\n        way += frame_axes({lens}u) * (control_{i}(p).value * moved);\n    }}\n"
            );
        }
        text.push_str("    return way;\n}\n");
        text
    }
}
