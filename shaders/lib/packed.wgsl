// A linear colour in 32 bits, as neighbourhood filters read and write it: square roots, of red and green to 11 bits
// and of blue to 10. What rounding costs is below 0.09 of a step of the picture's bytes, in blue 0.18, each time. Channels
// above 1 are cut, as the picture cuts them: a filter reads what is shown. Samples of a picture that are brighter than that are scaled
// before (`headroom` in `lib/light.wgsl`), and rounding costs twice as much of each.

const LEVELS = vec3f(2047.0, 2047.0, 1023.0);

fn packed(color: vec3f) -> u32 {
    let level = vec3u(vec3i(LEVELS * sqrt(clamp(color, vec3f(0.0), vec3f(1.0))) + 0.5));
    return level.x | (level.y << 11u) | (level.z << 22u);
}

fn unpacked(bits: u32) -> vec3f {
    // By way of signed integers: a software adapter has an instruction for these.
    let level = vec3i(vec3u(bits, bits >> 11u, bits >> 22u) & vec3u(0x7ffu, 0x7ffu, 0x3ffu));
    let root = vec3f(level) * (1.0 / LEVELS);
    return root * root;
}

// Red, green and blue of four pixels, each level squared: of these a filter takes means, and needs no other scale.
fn four_unpacked(bits: vec4u) -> mat3x4f {
    let red = vec4f(vec4i(bits & vec4u(0x7ffu)));
    let green = vec4f(vec4i((bits >> vec4u(11u)) & vec4u(0x7ffu)));
    let blue = vec4f(vec4i(bits >> vec4u(22u)));
    return mat3x4f(red * red, green * green, blue * blue);
}

fn four_packed(squares: mat3x4f) -> vec4u {
    let red = vec4u(vec4i(sqrt(squares[0]) + 0.5));
    let green = vec4u(vec4i(sqrt(squares[1]) + 0.5));
    let blue = vec4u(vec4i(sqrt(squares[2]) + 0.5));
    return red | (green << vec4u(11u)) | (blue << vec4u(22u));
}
