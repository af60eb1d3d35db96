//! name = "darken"
//! kind = "post"
//! spec = "Trapp §3.5"
//! doc = "Takes lightness away evenly; hues stay, so that what is beside it comes forward: OKLab's lightness and chroma times 1 - amount."
//!
//! [[parameter]]
//! name = "amount"
//! type = "number"
//! range = [0, 1]
//! default = 0.4
//! doc = "Share of the lightness that goes: 0 = none, 1 = black."

fn effect(color: vec3f, point: Point, p: Parameters) -> vec3f {
    // A factor on OKLab's three coordinates is its cube on linear light.
    let keep = 1.0 - p.amount;
    return color * (keep * keep * keep);
}
