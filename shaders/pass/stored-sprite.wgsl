// The volumetric depth sprite of a lens (Trapp §3.1): per texel where its ray enters and leaves, as codes. The ends of the
// volumes that have a closed form are worked out here, so both of the source's stages, nearest and then farthest, are one.

struct StoredStage {
    view: View,
    region: Region,
    // Target pixels per sprite texel: a coarser sprite takes the ray of its own texel's centre.
    pixels_per_texel: vec2f,
    // Of the part of the sprite that is kept (the lens' screen bounds), texels.
    origin: vec2f,
    // That part, texels; rows of 8-bit sprites have an even number, so that each word has one maker.
    width: u32,
    height: u32,
    layers: u32,
    // Its first word.
    first: u32,
    // Its depth code.
    kind: u32,
    near: f32,
    far: f32,
    // Where the lists of crossings of its texels begin.
    first_list: u32,
    // Which of the counts is that of its rays that have more intervals than layers; 0: it is not counted.
    excess: u32,
}

@group(2) @binding(0) var<uniform> stage: StoredStage;
@group(2) @binding(1) var<storage, read_write> sprites: array<u32>;

// The eye of the sprite.
var<private> view: View;

// Entry and exit of a span.
fn codes_of(c: DepthCode, span: Span) -> vec2u {
    // Perspective rays start at the eye: what lies behind it is not seen, and no entry. Nothing is seen before the near plane.
    let is_missed = span.enter > span.exit || (view.orthographic == 0u && span.exit <= 0.0);
    let entry = select(code_of(c, span.enter), nearest_code(c), span.enter <= view.near);
    let exit = select(code_of(c, span.exit), farthest_code(c), span.exit >= NO_END);
    return select(vec2u(entry, exit), vec2u(farthest_code(c), nearest_code(c)), is_missed);
}

// Of 8-bit sprites, the first half of a word whose second is still to come.
var<private> half_word: u32;

// Keeps a layer, the next after the last one kept.
fn keep(layer: u32, codes: vec2u, format: u32) {
    switch format {
        case UNORM8: {
            let both = codes.x | codes.y << 8u;
            if layer % 2u == 1u {
                sprites[stage.first + layer / 2u] = half_word | both << 16u;
            }
            half_word = both;
        }
        case UNORM16, FLOAT16: { sprites[stage.first + layer] = codes.x | codes.y << 16u; }
        default: {
            sprites[stage.first + 2u * layer] = codes.x;
            sprites[stage.first + 2u * layer + 1u] = codes.y;
        }
    }
}

@compute @workgroup_size(8, 8)
fn store(@builtin(global_invocation_id) id: vec3u) {
    view = stage.view;
    let code = DepthCode(stage.kind, stage.near, stage.far);
    let format = format_of(code);
    let together = select(1u, 2u, format == UNORM8);
    for (var i = 0u; i < together; i++) {
        let at = vec2u(together * id.x + i, id.y);
        if at.x < stage.width && at.y < stage.height {
            store_texel(at, code, format);
        }
    }
}

fn ray_of_texel(at: vec2u) -> Ray {
    return ray_of_pixel((vec2f(at) + 0.5 + stage.origin) * stage.pixels_per_texel);
}
