// Where no field stands in the city: between the layers of a pixel is nothing.
fn begin_fields(pixel: vec2i, middle: vec2f, part: u32) {}

fn write_classes_of_opaque(pixel: vec2i, middle: vec2f, depth: f32, part: u32) {}

fn lay_fields(pixel: vec2i, middle: vec2f, until: f32, part: u32, laid: ptr<function, vec4f>) {}
