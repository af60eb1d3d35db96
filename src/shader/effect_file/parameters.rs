//! Parameters of an effect in WGSL.

use crate::shader::{
    effect::{
        definition::EffectDefinition,
        parameter::{ParameterDefinition, ParameterKind},
        prototype::EffectKind,
    },
    wgsl::token::identifier,
};

/// `PARAMETER_WORD` and its number, of all parameters that take words.
pub(super) fn word_constants(effect: &EffectDefinition) -> impl Iterator<Item = (String, usize)> {
    let of = |p: &ParameterDefinition| {
        let words = if let ParameterKind::Word(words) = &p.kind { words.clone() } else { Vec::new() };
        let parameter = p.name.to_uppercase();
        let name = move |word: &str| format!("{parameter}_{}", identifier(&word.to_uppercase()));
        words.into_iter().enumerate().map(move |(i, word)| (name(&word), i)).collect::<Vec<_>>()
    };
    effect.shader_parameters().flat_map(move |(p, ..)| of(p)).collect::<Vec<_>>().into_iter()
}

/// The struct of an effect's parameters, and the function that reads it.
pub(super) fn parameters_source(effect: &EffectDefinition) -> String {
    let mut fields: Vec<(String, &str, usize)> =
        effect.shader_parameters().map(|(p, type_name, floats)| (p.name.clone(), type_name, floats)).collect();
    if effect.objects.is_some() {
        fields.push(("first".to_owned(), "u32", 1));
    }
    if fields.is_empty() {
        return String::new();
    }
    let type_name = effect.own("Parameters");
    let mut text = format!("struct {type_name} {{\n");
    for (name, type_name, _) in &fields {
        text.push_str(&format!("    {name}: {type_name},\n"));
    }
    text.push_str("}\n\n");
    for (name, number) in word_constants(effect) {
        text.push_str(&format!("const {} = {number}u;\n", effect.own(&name)));
    }
    text.push_str(&format!("fn {}(first: u32) -> {type_name} {{\n", effect.own("parameters")));
    let array = effect.kind.prototype().parameters;
    let has_words = effect.kind == EffectKind::Epoch;
    if !has_words {
        for slot in 0..effect.slots() {
            text.push_str(&format!("    let s{slot} = {array}[first + {slot}u];\n"));
        }
    }
    let next = std::cell::Cell::new(0);
    let word = || {
        next.set(next.get() + 1);
        format!("{array}[first + {}u]", next.get() - 1)
    };
    let int = || format!("bitcast<i32>({})", word());
    let float = || {
        if has_words {
            return format!("bitcast<f32>({})", word());
        }
        next.set(next.get() + 1);
        format!("s{}.{}", (next.get() - 1) / 4, ["x", "y", "z", "w"][(next.get() - 1) % 4])
    };
    let values: Vec<String> = fields
        .iter()
        .map(|(_, type_name, _)| match *type_name {
            "bool" => format!("{} != 0.0", float()),
            "u32" => format!("u32({})", float()),
            "vec3f" => format!("vec3f({}, {}, {})", float(), float(), float()),
            "Moment" => format!("Moment({}, {})", int(), word()),
            "Unit" => format!("Unit({}, {}, {})", int(), word(), word()),
            "Duration" => format!("Duration({}, {}, {})", int(), int(), word()),
            "Instants" => format!("Instants({}, {}, {})", word(), word(), word()),
            _ => float(),
        })
        .collect();
    text.push_str(&format!("    return {type_name}({});\n}}\n\n", values.join(", ")));
    text
}
