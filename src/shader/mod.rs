//! WGSL text: which files make which module, and the parts that are put together from the scene.
//!
//! No wgpu handle lives here. Entry points stand in `shaders/pass` alone; everything else is importable
//! and free of side effects.

pub mod effect;
pub mod effect_file;
mod plan;
pub mod wgsl;

pub use effect::{EffectDefinition, effects};
pub use plan::{ClassTest, Plan, PlanLens, Scope, Step};

macro_rules! files {
    ($($name:ident = $path:literal;)*) => {
        $(const $name: (&str, &str) = ($path, include_str!(concat!("../../shaders/", $path)));)*
    };
}

files! {
    VIEW = "lib/view.wgsl";
    SURFACE = "lib/surface.wgsl";
    COLOR = "lib/color.wgsl";
    SHAPE = "lib/shape.wgsl";
    LIGHT = "lib/light.wgsl";
    LENS = "lib/lens.wgsl";
    OUTLINE = "lib/outline.wgsl";
    GEOMETRY = "pass/geometry.wgsl";
    SHADOW = "pass/shadow.wgsl";
    SPRITE = "pass/sprite.wgsl";
    SHADE = "pass/shade.wgsl";
    RESOLVE = "pass/resolve.wgsl";
    BARE = "pass/bare.wgsl";
}

/// A module of the frame.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Module {
    /// The opaque geometry pass.
    Geometry,
    /// Depth from the sun.
    Shadow,
    /// The two stages of a volumetric depth sprite.
    Sprite,
    /// Deferred shading, and what the lenses make of it.
    Shade(Plan),
    /// The mean of samples.
    Resolve,
    /// The bare lit draw that benchmarks compare with.
    Bare,
}

impl Module {
    /// A name for people and statistics.
    pub fn name(&self) -> String {
        match self {
            Self::Geometry => "geometry".to_owned(),
            Self::Shadow => "shadow".to_owned(),
            Self::Sprite => "sprite".to_owned(),
            Self::Shade(plan) => {
                let names: Vec<&str> = plan.effects().iter().map(|&e| effects()[e as usize].name.as_str()).collect();
                let names = if names.is_empty() { String::new() } else { format!(" ({})", names.join(", ")) };
                let lenses = if plan.lenses.is_empty() { "" } else { " lenses" };
                format!("shade{names}{lenses}")
            }
            Self::Resolve => "resolve".to_owned(),
            Self::Bare => "bare".to_owned(),
        }
    }

    /// The whole WGSL text.
    pub fn source(&self) -> String {
        self.source_with(effects())
    }

    /// The whole WGSL text, where a plan's numbers count these effects.
    pub fn source_with(&self, effects: &[EffectDefinition]) -> String {
        let files: &[(&str, &str)] = match self {
            Self::Geometry => &[VIEW, SURFACE, GEOMETRY],
            Self::Shadow => &[VIEW, SURFACE, SHADOW],
            Self::Sprite => &[VIEW, SHAPE, SPRITE],
            Self::Shade(plan) if plan.has_outlines() => &[VIEW, SURFACE, COLOR, LIGHT, LENS, OUTLINE, SHADE],
            Self::Shade(plan) if !plan.lenses.is_empty() => &[VIEW, SURFACE, COLOR, LIGHT, LENS, SHADE],
            Self::Shade(_) => &[VIEW, SURFACE, COLOR, LIGHT, SHADE],
            Self::Resolve => &[RESOLVE],
            Self::Bare => &[VIEW, SURFACE, BARE],
        };
        let mut text = String::new();
        for (path, source) in files {
            text.push_str(&format!("// ==== {path}\n\n{source}\n"));
        }
        match self {
            Self::Shade(plan) => text.replace("//@apply\n", &plan.source(effects)),
            _ => text,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every effect everywhere, and two lenses with every pair of effects and classes.
    fn plans() -> Vec<Plan> {
        let effects = 0..effects().len() as u32;
        let step = |effect, scope, parameters| Step { effect, scope, parameters };
        let mut plans = vec![Plan::default()];
        plans.extend(effects.clone().map(|e| Plan { steps: vec![step(e, Scope::Everywhere, 0)], ..Plan::default() }));
        for (a, b) in effects.clone().flat_map(|a| effects.clone().map(move |b| (a, b))) {
            for class in [ClassTest::Inside, ClassTest::Front, ClassTest::Behind, ClassTest::Rest] {
                for masks in [false, true] {
                    let lens = |number, volumes, outline| PlanLens { number, volumes, outline };
                    plans.push(Plan {
                        lenses: vec![lens(0, 1, None), lens(40, 2, masks.then_some(3))],
                        steps: vec![
                            step(a, Scope::Everywhere, 0),
                            step(a, Scope::Lens(0, class), 1),
                            step(b, Scope::Lens(1, class), 2),
                        ],
                        masks,
                    });
                }
            }
        }
        plans
    }

    fn all_modules() -> Vec<Module> {
        let mut modules = vec![Module::Geometry, Module::Shadow, Module::Sprite, Module::Resolve, Module::Bare];
        modules.extend(plans().into_iter().map(Module::Shade));
        modules
    }

    #[test]
    fn every_module_is_valid_wgsl() {
        for module in all_modules() {
            let source = module.source();
            let parsed = match wgpu::naga::front::wgsl::parse_str(&source) {
                Ok(parsed) => parsed,
                Err(error) => panic!("{}: {}", module.name(), error.emit_to_string(&source)),
            };
            let mut validator = wgpu::naga::valid::Validator::new(
                wgpu::naga::valid::ValidationFlags::all(),
                wgpu::naga::valid::Capabilities::default() | wgpu::naga::valid::Capabilities::SHADER_FLOAT16_IN_FLOAT32,
            );
            if let Err(error) = validator.validate(&parsed) {
                panic!("{}: {}", module.name(), error.emit_to_string(&source));
            }
        }
    }

    #[test]
    fn an_effect_nobody_uses_is_not_in_the_text() {
        let greyscale = effect::number_of("greyscale").expect("there is one");
        let steps = vec![Step { effect: greyscale, scope: Scope::Everywhere, parameters: 0 }];
        let source = Module::Shade(Plan { steps, ..Plan::default() }).source();
        assert!(source.contains("fn greyscale"));
        assert!(!source.contains("fn sepia") && !source.contains("fn thematic"));
        assert!(!source.contains("var sprites"), "a lens that is not there is in the shader");
    }
}
