// The depth sprite of one volume that has a closed form: a layer is enough. `span_of_stage` knows the form.

fn store_texel(at: vec2u, code: DepthCode, format: u32) {
    keep(at.y * stage.width + at.x, codes_of(code, span_of_stage(ray_of_texel(at))), format);
}
