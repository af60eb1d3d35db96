//! name = "brighten"
//! kind = "post"
//! spec = "Trapp §3.5"
//! doc = "Lifts colours towards white, like a veil of light; contrast falls, hues stay: a straight way in OKLab."
//!
//! [[parameter]]
//! name = "amount"
//! type = "number"
//! range = [0, 1]
//! default = 0.4
//! doc = "How far to white: 0 = not at all, 1 = white."

fn effect(color: vec3f, point: Point, p: Parameters) -> vec3f {
    // In OKLab towards white, whose roots are 1.
    return max(linear_from_roots(mix(cone_roots(color), vec3f(1.0), p.amount)), vec3f(0.0));
}
