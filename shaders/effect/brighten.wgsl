//! name = "brighten"
//! kind = "post"
//! spec = "K3"
//! doc = "Lifts colours towards white, like a veil of light; contrast falls, hues stay."
//!
//! [[parameter]]
//! name = "amount"
//! type = "number"
//! range = [0, 1]
//! default = 0.4
//! doc = "How far to white: 0 = not at all, 1 = white."

fn effect(color: vec3f, point: Point, p: Parameters) -> vec3f {
    let lab = oklab_from_linear(color);
    let lifted = vec3f(mix(lab.x, 1.0, p.amount), (1.0 - p.amount) * lab.yz);
    return max(linear_from_oklab(lifted), vec3f(0.0));
}
