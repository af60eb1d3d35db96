// Titles, captions and legends over the finished picture (architecture, decision 13): panels with round corners, and
// lines of text whose coverage was made pixel by pixel on the host. One instance per item, drawn in order; colours are
// linear, the result is premultiplied. Overlays and their context lines are furniture too: pictures, texel by texel,
// and strips of triangles.

struct Frame {
    // Width, height of the target, pixels.
    size: vec2f,
}

struct FurnitureItem {
    // Left, top and right, bottom; pixels of the target.
    @location(0) low: vec2f,
    @location(1) high: vec2f,
    // Linear colour and alpha. A board has its own numbers in this and the next three.
    @location(2) color: vec4f,
    // The same for what surrounds letters; of a panel and of a picture y says whether it is an ellipse.
    @location(3) halo: vec4f,
    // Of a panel's corners, pixels.
    @location(4) radius: f32,
    // Over how many pixels a panel's border fades: 1 is a clean one, more a shadow.
    @location(5) softness: f32,
    // Where a text's coverage begins and how long a row of it is; 0: this is a panel.
    @location(6) first_texel: u32,
    @location(7) row_texels: u32,
    // What of it is drawn: left, top, right, bottom; whole pixels of the target.
    @location(8) part: vec4f,
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
    // Two triangles.
    let corner = vec2f(f32(i == 1u || i == 2u || i == 4u), f32(i == 2u || i == 4u || i == 5u));
    let at = mix(item.part.xy, item.part.zw, corner);
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
        let as_panel = panel(shown.at.xy, shown.low, shown.high, shown.radius, shown.softness);
        let as_ellipse = ellipse(shown.at.xy, shown.low, shown.high, shown.softness);
        let alpha = shown.color.a * select(as_panel, as_ellipse, shown.halo.y > 0.5);
        return vec4f(shown.color.rgb * alpha, alpha);
    }
    let place = vec2u(shown.at.xy - shown.low);
    let texel = shown.texels.x + place.y * shown.texels.y + place.x;
    let both = unpack4x8unorm(coverage[texel >> 1u] >> (16u * (texel & 1u)));
    let letter = shown.color.a * both.x;
    let halo = shown.halo.a * both.y * (1.0 - letter);
    return vec4f(shown.color.rgb * letter + shown.halo.rgb * halo, letter + halo);
}

// A panel where nothing of its border fades, and nothing shines through: without blending.
@fragment
fn solid(shown: Shown) -> @location(0) vec4f {
    return vec4f(shown.color.rgb, 1.0);
}

// The picture of an overlay, at its size; straight alpha. Without pictures: the skin of a context line.
@group(1) @binding(0) var picture: texture_2d<f32>;
// What of it is seen, stretched over it: the mean of its colours, times its alpha.
@group(1) @binding(1) var mask: texture_2d<f32>;
@group(1) @binding(2) var linear_sampler: sampler;

// How much of a pixel an ellipse covers that fills a rectangle, by the first-order distance from its border.
fn ellipse(at: vec2f, low: vec2f, high: vec2f, softness: f32) -> f32 {
    let half = max(0.5 * (high - low), vec2f(0.5));
    let unit = (at - 0.5 * (low + high)) / half;
    let steepness = max(length(unit / half), 1e-6);
    let distance = 0.5 * (dot(unit, unit) - 1.0) / steepness;
    let share = clamp(0.5 - distance / softness, 0.0, 1.0);
    return select(share, share * share * (3.0 - 2.0 * share), softness > 1.0);
}

// Taps on each side of a pixel of what is not shown texel by texel: towards the border of a fisheye, and on a tilted
// board, many texels share one.
const TAPS: i32 = 4;

// The place of a tap, from the middle of its pixel.
fn tap_offset(tap: i32) -> vec2f {
    return (vec2f(f32(tap % TAPS), f32(tap / TAPS)) + 0.5) / f32(TAPS) - 0.5;
}

// What a fisheye shows at a place, of a picture that is 1 + d times as large as it; the middle is as much larger, the border stays where it is:
// shares of the way to the corners, of an ellipse to its rim (view::local::unfisheye).
fn fisheye(inside: vec2f, size: vec2f, d: f32, is_ellipse: bool) -> vec4f {
    let reach = 0.5 * size * select(1.4142135, 1.0, is_ellipse);
    var sum = vec4f(0.0);
    for (var tap = 0; tap < TAPS * TAPS; tap++) {
        let shown = (inside + tap_offset(tap) - 0.5 * size) / reach;
        let place = shown / (1.0 + d * (1.0 - min(length(shown), 1.0)));
        let uv = 0.5 + place * reach / size;
        sum += textureSampleLevel(picture, linear_sampler, uv, 0.0);
    }
    return sum / f32(TAPS * TAPS);
}

// An overlay's picture. Its item has its opacity as alpha; its halo says whether left and right are exchanged, whether it is an ellipse, and
// by how much more than once a fisheye magnifies its middle. A soft border lies inside of its rectangle.
@fragment
fn picture_fragment(shown: Shown) -> @location(0) vec4f {
    let size = shown.high - shown.low;
    let inside = shown.at.xy - shown.low;
    let across = select(inside.x, size.x - inside.x, shown.halo.x > 0.5);
    let place = vec2i(floor(vec2f(across, inside.y)));
    let least = vec2i(textureDimensions(picture)) - 1;
    var color = textureLoad(picture, clamp(place, vec2i(0), least), 0);
    if shown.halo.z > 0.0 {
        color = fisheye(vec2f(across, inside.y), size, shown.halo.z, shown.halo.y > 0.5);
    }
    let seen = textureSampleLevel(mask, linear_sampler, inside / size, 0.0);
    let inset = select(0.0, 0.5 * shown.softness, shown.softness > 1.0);
    let low = shown.low + inset;
    let high = shown.high - inset;
    let as_panel = panel(shown.at.xy, low, high, shown.radius, shown.softness);
    let as_ellipse = ellipse(shown.at.xy, low, high, shown.softness);
    let share = select(as_panel, as_ellipse, shown.halo.y > 0.5);
    let alpha = shown.color.a * share * color.a * seen.a * dot(seen.rgb, vec3f(1.0 / 3.0));
    return vec4f(color.rgb * alpha, alpha);
}

// The same where nothing of its border fades, and nothing shines through: without blending.
@fragment
fn opaque_picture(shown: Shown) -> @location(0) vec4f {
    let inside = shown.at.xy - shown.low;
    let across = select(inside.x, shown.high.x - shown.low.x - inside.x, shown.halo.x > 0.5);
    let place = vec2i(floor(vec2f(across, inside.y)));
    return vec4f(textureLoad(picture, clamp(place, vec2i(0), vec2i(textureDimensions(picture)) - 1), 0).rgb, 1.0);
}

// A board in the scene: its picture, here premultiplied, mapped projectively. The rows by which a place of the
// target, from `low`, becomes (u w, v w, w) are its colour without the alpha, its halo without the last, and that with
// radius and softness; w is positive before the eye.
@fragment
fn board(shown: Shown) -> @location(0) vec4f {
    let rows = mat3x3f(shown.color.rgb, shown.halo.xyz, vec3f(shown.halo.w, shown.radius, shown.softness));
    var sum = vec4f(0.0);
    for (var tap = 0; tap < TAPS * TAPS; tap++) {
        let place = vec3f(shown.at.xy - shown.low + tap_offset(tap), 1.0) * rows;
        let uv = place.xy / place.z;
        let is_on = place.z > 0.0 && all(uv >= vec2f(0.0)) && all(uv <= vec2f(1.0));
        sum += select(vec4f(0.0), textureSampleLevel(picture, linear_sampler, uv, 0.0), is_on);
    }
    return sum / f32(TAPS * TAPS);
}

// A corner of a strip: a context line is a strip along its way, a pixel wider on both sides than what is seen.
struct StripVertex {
    // Pixels of the target.
    @location(0) at: vec2f,
    // How far from the way, to the left of it, and half the width there; pixels.
    @location(1) across: f32,
    @location(2) half_width: f32,
    // How far along the way, and how long it is; pixels.
    @location(3) along: f32,
    @location(4) length: f32,
    // Half the widths at both ends, pixels.
    @location(5) ends: vec2f,
    // Linear colour and alpha.
    @location(6) color: vec4f,
    // What it fades towards: a point, pixels of the target, and the radii within which nothing and beyond which all is seen.
    @location(7) fade: vec4f,
}

struct StripShown {
    @builtin(position) at: vec4f,
    @location(0) across: f32,
    @location(1) half_width: f32,
    @location(2) along: f32,
    @location(3) @interpolate(flat) length: f32,
    @location(4) @interpolate(flat) ends: vec2f,
    @location(5) @interpolate(flat) color: vec4f,
    @location(6) @interpolate(flat) fade: vec4f,
}

@vertex
fn strip_vertex(corner: StripVertex) -> StripShown {
    let clip = vec2f(2.0, -2.0) * corner.at / frame.size + vec2f(-1.0, 1.0);
    let c = corner;
    return StripShown(vec4f(clip, 0.0, 1.0), c.across, c.half_width, c.along, c.length, c.ends, c.color, c.fade);
}

// How much of a strip is seen at this distance from what it fades towards: 0 ≤ e ≤ r, t²(3 - 2t).
fn faded(distance: f32, inner: f32, outer: f32) -> f32 {
    let beyond = select(0.0, 1.0, distance > outer);
    let t = select(beyond, clamp((distance - inner) / max(outer - inner, 1e-6), 0.0, 1.0), outer > inner);
    return t * t * (3.0 - 2.0 * t);
}

fn strip_alpha(shown: StripShown) -> f32 {
    // A strip thinner than a pixel is a fainter one of a pixel.
    let half_width = max(shown.half_width, 0.5);
    let thin = min(shown.half_width / 0.5, 1.0);
    let sides = clamp(half_width - abs(shown.across) + 0.5, 0.0, 1.0) * thin;
    let ends = clamp(shown.along + 0.5, 0.0, 1.0) * clamp(shown.length - shown.along + 0.5, 0.0, 1.0);
    let seen = faded(length(shown.at.xy - shown.fade.xy), shown.fade.z, shown.fade.w);
    return shown.color.a * sides * ends * select(seen, 1.0, shown.fade.w <= 0.0);
}

@fragment
fn strip(shown: StripShown) -> @location(0) vec4f {
    let alpha = strip_alpha(shown);
    return vec4f(shown.color.rgb * alpha, alpha);
}

// With a skin: a picture whose corners are those of the strip, mapped projectively (u·w and v·w over w, w by the end width), so
// that it does not shear where the strip gets narrower. Its colour is the strip's times that of the skin.
@fragment
fn strip_skin(shown: StripShown) -> @location(0) vec4f {
    let t = clamp(shown.along / max(shown.length, 1e-6), 0.0, 1.0);
    let w = mix(shown.ends.x, shown.ends.y, t);
    let u = t * shown.ends.y / max(w, 1e-6);
    let v = 0.5 - 0.5 * clamp(shown.across / max(shown.half_width, 1e-6), -1.0, 1.0);
    let texel = textureSampleLevel(picture, linear_sampler, vec2f(u, v), 0.0);
    let alpha = strip_alpha(shown) * texel.a;
    return vec4f(shown.color.rgb * texel.rgb * alpha, alpha);
}
