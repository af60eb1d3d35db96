//! name = "overlay"
//! kind = "post"
//! spec = "Trapp §3.5, Tiesel §3"
//! doc = "Lays a colour over the picture."
//!
//! [[parameter]]
//! name = "color"
//! type = "color"
//! default = "#d55e00"
//! doc = "The colour."
//!
//! [[parameter]]
//! name = "opacity"
//! type = "number"
//! range = [0, 1]
//! default = 0.45
//! doc = "How much of it."
//!
//! [[parameter]]
//! name = "mode"
//! type = "word"
//! words = ["alpha", "multiply", "screen", "overlay"]
//! default = "alpha"
//! doc = "How it is laid over: as paint, as a filter (darker), as light (lighter), or one or the other by whether what is below is darker than middle grey (0.214 of the light)."

fn effect(color: vec3f, point: Point, p: Parameters) -> vec3f {
    return mix(color, blended(clamp(color, vec3f(0.0), vec3f(1.0)), p), p.opacity);
}

fn blended(below: vec3f, p: Parameters) -> vec3f {
    let multiplied = below * p.color;
    let screened = below + p.color - multiplied;
    if p.mode == MODE_MULTIPLY {
        return multiplied;
    }
    if p.mode == MODE_SCREEN {
        return screened;
    }
    if p.mode == MODE_OVERLAY {
        // Middle grey to the eye is 0.214 of the light.
        return select(min(2.0 * screened, vec3f(1.0)), 2.0 * multiplied, below < vec3f(0.214));
    }
    return p.color;
}
