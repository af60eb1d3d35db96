//! name = "edges"
//! kind = "post"
//! spec = "Trapp §3.5"
//! doc = "Lines where objects, faces or depths meet, as one would draw them (Saito and Takahashi 1990): full where depth steps or bends by 1.2 % from pixel to pixel, none at 0.4 %; full where faces turn by 37 degrees, none at 20. The nearer side has the line. They are weaker where a line is wider than 1.8 m, a quarter from 7.2 m on. Translucent layers have none: `feature-lines` draws theirs."
//!
//! [[parameter]]
//! name = "color"
//! type = "color"
//! default = "#1d1d1b"
//! doc = "Colour of the lines."
//!
//! [[parameter]]
//! name = "strength"
//! type = "number"
//! range = [0, 1]
//! default = 0.85
//! doc = "How dark they are."
//!
//! [[parameter]]
//! name = "creases"
//! type = "number"
//! range = [0, 1]
//! default = 0.6
//! doc = "How dark lines between faces of one object are, as a share of the others."
//!
//! [[parameter]]
//! name = "width"
//! type = "number"
//! range = [0, 8]
//! default = 0.75
//! unit = "points"
//! doc = "How wide they are: whole pixels, at most 64, on average over several samples so wide; what is less than one is fainter."

const GOLDEN_SHARE: f32 = 0.618034;
// As far as tiles of a large figure know what lies beside them.
const MOST_REACH: i32 = 64;

fn effect(color: vec3f, point: Point, p: Parameters) -> vec3f {
    if point.surface == NO_SURFACE {
        return color;
    }
    // What lies beside a translucent layer is not known: what is opaque there is another surface.
    let own = beside(point, vec2i(0));
    if own.surface != point.surface || own.depth != point.depth {
        return color;
    }
    // Widths between whole pixels are had by some samples and not by others.
    let reach = clamp(i32(floor(p.width + fract(0.5 + GOLDEN_SHARE * f32(view.sample_index)))), 1, MOST_REACH);
    var line = max(across(point, vec2i(reach, 0), p.creases), across(point, vec2i(0, reach), p.creases));
    if reach > 1 {
        let aslant = i32(round(0.7071 * f32(reach)));
        line = max(line, across(point, vec2i(aslant, aslant), p.creases));
        line = max(line, across(point, vec2i(aslant, -aslant), p.creases));
        // What is narrower than a line.
        let near = reach / 2;
        line = max(line, max(across(point, vec2i(near, 0), p.creases), across(point, vec2i(0, near), p.creases)));
    }
    // Lines of far things would be all there is.
    let fade = clamp(1.8 / (max(p.width, 1.0) * metres_per_pixel(point)), 0.25, 1.0);
    return mix(color, p.color, line * min(p.width, 1.0) * p.strength * fade * not_faded(point));
}

// The line between the two neighbours on either side.
fn across(point: Point, step: vec2i, creases: f32) -> f32 {
    let before = beside(point, -step);
    let after = beside(point, step);
    // Stored depth is affine in the picture of a plane: what is left is a step or a bend. The nearer side has the line.
    let bend = (2.0 * point.depth - before.depth - after.depth) / point.depth;
    let gap = smoothstep(0.004, 0.012, bend);
    let is_other = (before.object != point.object && before.depth < point.depth)
        || (after.object != point.object && after.depth <= point.depth);
    let turn = 1.0 - min(dot(before.normal, point.normal), dot(after.normal, point.normal));
    let crease = creases * smoothstep(0.06, 0.2, turn);
    return max(max(gap, crease), select(0.0, 1.0, is_other));
}
