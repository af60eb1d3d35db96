// Colours of translucent fragments in 32 bits: where textures of the picture let something through, with the opacity of the texel.
// Square roots then have 8 bits a channel, as the targets of what is opaque have.

override BLENDED: bool = false;     // whether some do

// Words of a fragment node, and which of them are its normal, its colour and its share of light, where it has these.
fn words_of_node() -> u32 {
    return light_word() + select(0u, 1u, TEXELS_EMIT);
}

fn normal_word() -> u32 {
    return 3u;
}

fn color_word() -> u32 {
    return 3u + select(0u, 1u, SMOOTH);
}

fn light_word() -> u32 {
    return color_word() + select(0u, 1u, TEXTURED);
}

fn packed_texel(color: vec3f) -> u32 {
    if BLENDED {
        return pack4x8unorm(vec4f(sqrt(clamp(color, vec3f(0.0), vec3f(1.0))), texel_opacity));
    }
    return packed(color);
}

// Linear colour and opacity.
fn unpacked_texel(bits: u32) -> vec4f {
    if BLENDED {
        let root = unpack4x8unorm(bits);
        return vec4f(root.rgb * root.rgb, root.a);
    }
    return vec4f(unpacked(bits), 1.0);
}
