//! name = "thematic"
//! kind = "scene"
//! spec = "Trapp §3.5"
//! doc = "Colours objects by an attribute; light changes lightness alone, hue and chroma stay the legend's."
//! objects = "colors"
//!
//! [[parameter]]
//! name = "attribute"
//! type = "text"
//! required = true
//! doc = "Name of the attribute; an object without it takes its parent's."
//!
//! [[parameter]]
//! name = "label"
//! type = "text"
//! without = "the attribute's name"
//! doc = "What the legend calls the attribute."
//!
//! [[parameter]]
//! name = "unit"
//! type = "text"
//! without = "none"
//! doc = "Unit of the attribute, for the legend."
//!
//! [[parameter]]
//! name = "ramp"
//! type = "word"
//! words = ["viridis", "cividis", "purple-orange"]
//! default = "viridis"
//! doc = "Colours of numbers, low to high."
//!
//! [[parameter]]
//! name = "reverse"
//! type = "boolean"
//! default = false
//! doc = "Turns the ramp around."
//!
//! [[parameter]]
//! name = "scale"
//! type = "word"
//! words = ["continuous", "equal", "quantile"]
//! default = "continuous"
//! doc = "Numbers: a smooth ramp, classes of equal width, or classes of equally many objects."
//!
//! [[parameter]]
//! name = "classes"
//! type = "number"
//! range = [2, 12]
//! default = 5
//! unit = "classes"
//! doc = "How many classes."
//!
//! [[parameter]]
//! name = "breaks"
//! type = "numbers"
//! without = "none"
//! unit = "the attribute's"
//! doc = "Own class borders, ascending; a value on a border belongs to the upper class."
//!
//! [[parameter]]
//! name = "min"
//! type = "number"
//! without = "the smallest value"
//! unit = "the attribute's"
//! doc = "Where the ramp begins; lower values take its first colour."
//!
//! [[parameter]]
//! name = "max"
//! type = "number"
//! without = "the largest value"
//! unit = "the attribute's"
//! doc = "Where the ramp ends; higher values take its last colour."
//!
//! [[parameter]]
//! name = "categories"
//! type = "texts"
//! without = "most frequent first"
//! doc = "Treats values as categories, in this order; others are drawn as `other`."
//!
//! [[parameter]]
//! name = "no_data"
//! type = "color"
//! default = "#a8a8a8"
//! doc = "Colour of objects without a value."
//!
//! [[parameter]]
//! name = "threshold"
//! type = "number"
//! without = "none"
//! unit = "the attribute's"
//! doc = "Numbers at or above it take the colour `highlight`."
//!
//! [[parameter]]
//! name = "highlight"
//! type = "color"
//! default = "#d55e00"
//! doc = "Colour of numbers at or above `threshold`."

// The host colours the objects: one sRGB colour each, from `p.first` on.
fn effect(color: vec3f, point: Point, p: Parameters) -> vec3f {
    if point.object == NO_OBJECT {
        return point.shade * vec3f(0.72);
    }
    let code = object_values[p.first + point.object];
    let legend = linear_from_srgb(unpack4x8unorm(code).rgb);
    let lab = oklab_from_linear(legend);
    let lightness = lab.x * mix(0.62, 1.06, clamp(point.shade, 0.0, 1.0));
    return max(linear_from_oklab(vec3f(lightness, lab.yz)), vec3f(0.0));
}
