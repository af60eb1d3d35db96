//! WGSL text: which files make which module, and the parts that are put together from the scene.
//!
//! No wgpu handle lives here. Entry points stand in `shaders/pass` alone; everything else is importable
//! and free of side effects.

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
    GEOMETRY = "pass/geometry.wgsl";
    SHADOW = "pass/shadow.wgsl";
    SPRITE = "pass/sprite.wgsl";
    LENS_MASK = "pass/lens_mask.wgsl";
    SHADE = "pass/shade.wgsl";
    RESOLVE = "pass/resolve.wgsl";
    BARE = "pass/bare.wgsl";
}

/// Effects that have a WGSL function of their own, by the name they have in scenes; the position is the
/// number the shader knows them by.
pub const EFFECTS: &[Effect] = &[
    Effect { name: "greyscale", surfaces_only: false, source: include_str!("../../shaders/effect/greyscale.wgsl") },
    Effect { name: "sepia", surfaces_only: false, source: include_str!("../../shaders/effect/sepia.wgsl") },
    Effect { name: "thematic", surfaces_only: true, source: include_str!("../../shaders/effect/thematic.wgsl") },
];

/// One effect's WGSL.
#[derive(Clone, Copy, Debug)]
pub struct Effect {
    /// Name in scenes, and of its function.
    pub name: &'static str,
    /// Scene styles colour surfaces; post styles also what is behind the city.
    pub surfaces_only: bool,
    /// Its file.
    pub source: &'static str,
}

/// The number the shader knows an effect by.
pub fn effect_number(name: &str) -> Option<u32> {
    EFFECTS.iter().position(|e| e.name == name).map(|i| i as u32)
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
    /// The volumetric depth test.
    LensMask,
    /// Deferred shading with these effects (numbers, ascending, each once).
    Shade(Vec<u32>),
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
            Self::LensMask => "lens mask".to_owned(),
            Self::Shade(effects) if effects.is_empty() => "shade".to_owned(),
            Self::Shade(effects) => {
                let names: Vec<&str> = effects.iter().map(|&e| EFFECTS[e as usize].name).collect();
                format!("shade ({})", names.join(", "))
            }
            Self::Resolve => "resolve".to_owned(),
            Self::Bare => "bare".to_owned(),
        }
    }

    /// The whole WGSL text.
    pub fn source(&self) -> String {
        let files: &[(&str, &str)] = match self {
            Self::Geometry => &[VIEW, SURFACE, GEOMETRY],
            Self::Shadow => &[VIEW, SURFACE, SHADOW],
            Self::Sprite => &[VIEW, SHAPE, SPRITE],
            Self::LensMask => &[VIEW, LENS_MASK],
            Self::Shade(_) => &[VIEW, SURFACE, COLOR, LIGHT, SHADE],
            Self::Resolve => &[RESOLVE],
            Self::Bare => &[VIEW, SURFACE, BARE],
        };
        let mut text = String::new();
        for (path, source) in files {
            text.push_str(&format!("// ==== {path}\n\n{source}\n"));
        }
        match self {
            Self::Shade(effects) => text.replace("//@apply\n", &apply(effects)),
            _ => text,
        }
    }
}

/// The effects' own functions and the list that calls them.
fn apply(effects: &[u32]) -> String {
    if effects.is_empty() {
        return "fn apply(color: vec3f, point: Point, pixel: vec2i) -> vec3f {\n    return color;\n}\n".to_owned();
    }
    let mut text = String::new();
    let mut cases = String::new();
    for &number in effects {
        let effect = &EFFECTS[number as usize];
        text.push_str(effect.source);
        text.push('\n');
        let call = format!("color = {}(color, point, operation.parameters);", effect.name);
        let guarded = if effect.surfaces_only { format!("if point.surface != NO_SURFACE {{ {call} }}") } else { call };
        cases.push_str(&format!("            case {number}u: {{ {guarded} }}\n"));
    }
    text.push_str(&format!(
        "fn apply(start: vec3f, point: Point, pixel: vec2i) -> vec3f {{
    var color = start;
    for (var i = 0u; i < operations.count; i++) {{
        let operation = operations.list[i];
        if operation.effect == OUTLINE || (!LENSES && operation.lens != CONTEXT) {{
            continue;
        }}
        if !in_class(pixel, operation.lens, operation.class_) {{
            continue;
        }}
        switch operation.effect {{
{cases}            default: {{}}
        }}
    }}
    return color;
}}
"
    ));
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all_modules() -> Vec<Module> {
        let mut modules =
            vec![Module::Geometry, Module::Shadow, Module::Sprite, Module::LensMask, Module::Resolve, Module::Bare];
        for set in 0..1_u32 << EFFECTS.len() {
            modules.push(Module::Shade((0..EFFECTS.len() as u32).filter(|e| set >> e & 1 == 1).collect()));
        }
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
        let source = Module::Shade(vec![0]).source();
        assert!(source.contains("fn greyscale"));
        assert!(!source.contains("fn sepia") && !source.contains("fn thematic"));
    }
}
