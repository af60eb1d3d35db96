// Titles, captions and legends over the finished picture (architecture, decision 13): panels with round corners, and
// lines of text whose coverage was made pixel by pixel on the host. One instance per item, drawn in order; colours are
// linear, the result is premultiplied.

struct Frame {
    // Width, height of the target, pixels.
    size: vec2f,
}

struct FurnitureItem {
    // Left, top and right, bottom; pixels of the target.
    @location(0) low: vec2f,
    @location(1) high: vec2f,
    // Linear colour and alpha.
    @location(2) color: vec4f,
    // The same for what surrounds letters.
    @location(3) halo: vec4f,
    // Of a panel's corners, pixels.
    @location(4) radius: f32,
    // Over how many pixels a panel's border fades: 1 is a clean one, more a shadow.
    @location(5) softness: f32,
    // Where a text's coverage begins and how long a row of it is; 0: this is a panel.
    @location(6) first_texel: u32,
    @location(7) row_texels: u32,
}

struct Shown {
    @builtin(position) at: vec4f,
    @location(0) @interpolate(flat) low: vec2f,
    @location(1) @interpolate(flat) high: vec2f,
    @location(2) @interpolate(flat) color: vec4f,
    @location(3) @interpolate(flat) halo: vec4f,
    @location(4) @interpolate(flat) radius: f32,
    @location(5) @interpolate(flat) softness: f32,
    @location(6) @interpolate(flat) texels: vec2u,
}

@group(0) @binding(0) var<uniform> frame: Frame;
// Two texels per word: letter and halo of the first, then of the second, a byte each.
@group(0) @binding(1) var<storage, read> coverage: array<u32>;

@vertex
fn vertex(@builtin(vertex_index) i: u32, item: FurnitureItem) -> Shown {
    // Two triangles; a panel's border may fade outside of it.
    let corner = vec2f(f32(i == 1u || i == 2u || i == 4u), f32(i == 2u || i == 4u || i == 5u));
    let margin = select(0.0, 0.5 * item.softness + 0.5, item.row_texels == 0u);
    let at = mix(item.low - margin, item.high + margin, corner);
    let clip = vec2f(2.0, -2.0) * at / frame.size + vec2f(-1.0, 1.0);
    let texels = vec2u(item.first_texel, item.row_texels);
    return Shown(vec4f(clip, 0.0, 1.0), item.low, item.high, item.color, item.halo, item.radius, item.softness, texels);
}

// How much of a pixel a panel covers, by its distance from the border.
fn panel(at: vec2f, low: vec2f, high: vec2f, radius: f32, softness: f32) -> f32 {
    let half = 0.5 * (high - low);
    let corner = min(radius, min(half.x, half.y));
    let beyond = abs(at - 0.5 * (low + high)) - half + corner;
    let distance = length(max(beyond, vec2f(0.0))) + min(max(beyond.x, beyond.y), 0.0) - corner;
    let share = clamp(0.5 - distance / softness, 0.0, 1.0);
    // A shadow ends without an edge.
    return select(share, share * share * (3.0 - 2.0 * share), softness > 1.0);
}

@fragment
fn fragment(shown: Shown) -> @location(0) vec4f {
    if shown.texels.y == 0u {
        let alpha = shown.color.a * panel(shown.at.xy, shown.low, shown.high, shown.radius, shown.softness);
        return vec4f(shown.color.rgb * alpha, alpha);
    }
    let place = vec2u(shown.at.xy - shown.low);
    let texel = shown.texels.x + place.y * shown.texels.y + place.x;
    let both = unpack4x8unorm(coverage[texel >> 1u] >> (16u * (texel & 1u)));
    let letter = shown.color.a * both.x;
    let halo = shown.halo.a * both.y * (1.0 - letter);
    return vec4f(shown.color.rgb * letter + shown.halo.rgb * halo, letter + halo);
}
