//! Deformations written out: the steps and profiles that a scene calls for, one after the other, with the places of their numbers as
//! constants. Software adapters read a number at a place they know as fast as a register, and any other eight times as slowly.

use std::fmt::Write as _;

/// Fours of numbers before the first deformer, of a deformer, and of a step of it: `lib/deform.wgsl`.
pub const FIRST_DEFORMER: usize = 1;
/// Fours of numbers of a deformer.
pub const DEFORMER_NUMBERS: usize = 11;
/// Fours of numbers of a step: how far apart samples may be, and three of its own.
pub const STEP_NUMBERS: usize = 4;

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

functions! {
    /// A step of a deformer.
    PlanStep {
        /// Moves.
        Translate = "translated",
        /// Stretches.
        Scale = "scaled",
        /// The higher, the further aside.
        Shear = "sheared",
        /// Gets narrower upwards.
        Taper = "tapered",
        /// Turns upwards.
        Twist = "twisted",
        /// Bends along y.
        Bend = "bent",
        /// Opens a street.
        Open = "opened",
    }
}

impl DeformPlan {
    /// Where a deformer's numbers begin, in fours.
    pub fn deformer(i: usize) -> usize {
        FIRST_DEFORMER + DEFORMER_NUMBERS * i
    }

    /// Where those of each step of each deformer begin.
    pub fn steps(&self) -> Vec<Vec<usize>> {
        let mut at = Self::deformer(self.0.len());
        let next = |_: &PlanStep| {
            at += STEP_NUMBERS;
            at - STEP_NUMBERS
        };
        let mut next = next;
        self.0.iter().map(|deformer| deformer.steps.iter().map(&mut next).collect()).collect()
    }

    /// How many fours there are.
    pub fn numbers(&self) -> usize {
        let steps: usize = self.0.iter().map(|deformer| deformer.steps.len()).sum();
        Self::deformer(self.0.len()) + STEP_NUMBERS * steps
    }

    /// Whether something is read from tables: texels or routes.
    pub fn has_tables(&self) -> bool {
        let has = |d: &PlanDeformer| d.control == PlanControl::Texels || d.steps.contains(&PlanStep::Open);
        self.0.iter().any(has)
    }

    /// The filling of the hook `deformers` (`lib/deform.wgsl`): how many there are, and `shown_at`.
    pub(super) fn shown(&self) -> String {
        let steps: usize = self.0.iter().map(|deformer| deformer.steps.len()).sum();
        let mut text = format!(
            "const NUMBERS: u32 = {}u;\nconst DEFORMERS: u32 = {}u;\nconst STEPS: u32 = {}u;\n",
            self.numbers(),
            self.0.len(),
            steps.max(1)
        );
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
                let _ = writeln!(text, "    jet = then(jet, {}({}u, p + jet.way));", step.function(), at + 1);
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
    pub(super) fn traced(&self) -> String {
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
                let own = at + 1;
                let _ = write!(
                    text,
                    "    note({number}u, {place}, numbers[{at}u].xyz, is_first);\n    if is_in {{\n        \
                     moved += {}({own}u, p + moved).way;\n    }}\n",
                    step.function()
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
