//! Masks: the classes of each pixel written down, for AOVs and statistics.

/// Where they are written.
pub(super) const BINDING: &str = "// Layers, per 32 lenses: inside, in front, behind.\n\
    @group(2) @binding(4) var class_masks: texture_storage_2d_array<r32uint, write>;\n";

/// A shader that stores may run before the depth test that chooses between surface and background.
pub(super) const ONLY_SHOWN: &str = "    // This may run before the depth test that chooses between surface and background.\n    \
    if (textureLoad(scene_depth, pixel, 0) > 0.0) != (point.surface != NO_SURFACE) {\n        return;\n    }\n";

/// What shows a layer has that one's classes. `condition` begins what is asked: nothing, or something with `&& ` behind it.
pub(super) fn not_through_layers(condition: &str) -> String {
    format!("    if {condition}is_layer_shown(pixel) {{\n        return;\n    }}\n")
}
