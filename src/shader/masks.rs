//! Masks: the classes of each pixel written down, for AOVs and statistics.

use std::fmt::Write as _;

use crate::shader::plan::Plan;

/// Where they are written.
pub(super) const BINDING: &str = "// Layers, per 32 lenses: inside, in front, behind.\n\
    @group(2) @binding(4) var class_masks: texture_storage_2d_array<r32uint, write>;\n";

/// A shader that stores may run before the depth test that chooses between surface and background.
pub(super) const ONLY_SHOWN: &str = "    // This may run before the depth test that chooses between surface and background.\n    \
    if (textureLoad(scene_depth, pixel, 0) > 0.0) != (point.surface != NO_SURFACE) {\n        return;\n    }\n";

/// Leaves a pixel that shows a layer to the classes of that layer. `condition` comes before the question: nothing, or a condition
/// with `&& `.
pub(super) fn not_through_layers(condition: &str) -> String {
    format!("    if {condition}is_layer_shown(pixel) {{\n        return;\n    }}\n")
}

/// Writes the classes down, one bit per lens.
pub(super) fn write_classes(plan: &Plan, is_of_surfaces: bool) -> String {
    let mut text = "fn write_classes(pixel: vec2i, point: Point, classes: Classes) {\n".to_owned();
    if plan.masks {
        if is_of_surfaces {
            text.push_str(ONLY_SHOWN);
        }
        if plan.transparency {
            text.push_str(&not_through_layers(""));
        }
        let mut words: Vec<u32> = plan.lenses.iter().map(|l| l.number / 32).collect();
        words.dedup();
        for word in words {
            for (layer, class) in ["INSIDE", "FRONT", "BEHIND"].into_iter().enumerate() {
                let here = plan.lenses.iter().enumerate().filter(|(_, l)| l.number / 32 == word);
                let bits: Vec<String> = here
                    .map(|(i, l)| {
                        format!("select(0u, {:#x}u, (classes.lens_{i} & {class}) != 0u)", 1_u32 << (l.number % 32))
                    })
                    .collect();
                let (layer, value) = (3 * word as usize + layer, bits.join("\n        | "));
                let _ = writeln!(text, "    textureStore(class_masks, pixel, {layer}, vec4u({value}, 0u, 0u, 0u));");
            }
        }
    }
    text.push_str("}\n");
    text
}
