// The depth sprite of one volume that has a closed form: a layer is enough.

// Which kind of shape this pipeline is for.
override KIND: u32 = SPHERE;

fn store_texel(at: vec2u, code: DepthCode, format: u32) {
    keep(at.y * stage.width + at.x, codes_of(code, span_of_shape(ray_of_texel(at), stage.shape, KIND)), format);
}
