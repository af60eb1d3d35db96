//! name = "transfer"
//! kind = "material"
//! spec = "Wang §4"
//! doc = "Gives volumes other colours by their values: another transfer function inside of the lens. Surfaces stay as they are."
//!
//! [[parameter]]
//! name = "colors"
//! type = "colors"
//! default = ["#0d0887", "#9c179e", "#ed7953", "#f0f921"]
//! doc = "Colours from the lowest value to the highest."
//!
//! [[parameter]]
//! name = "low"
//! type = "number"
//! range = [0, 1]
//! default = 0
//! doc = "Where the first colour is: a share of the range of the volume's own transfer."
//!
//! [[parameter]]
//! name = "high"
//! type = "number"
//! range = [0, 1]
//! default = 1
//! doc = "Where the last colour is, likewise."

fn effect(material: Material, point: Point, p: Parameters) -> Material {
    var own = material;
    let share = clamp((point.value - p.low) / max(p.high - p.low, 1e-6), 0.0, 1.0);
    own.base = select(material.base, color_on_ramp(p.colors, share), point.value >= 0.0);
    return own;
}
