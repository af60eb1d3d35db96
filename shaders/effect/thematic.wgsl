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
//! words = ["viridis", "cividis", "batlow", "lipari", "lajolla", "acton", "devon", "blues", "greens", "reds", "blue-purple",
//!     "yellow-blue", "vik", "roma", "broc", "purple-orange", "red-blue", "brown-teal", "purple-green", "roma-o", "bam-o", "vik-o",
//!     "okabe-ito", "tol-bright", "tol-muted", "dark2", "paired"]
//! without = "viridis for numbers, roma-o for directions, okabe-ito for texts"
//! doc = "Colours, low to high, or one for each category."
//!
//! [[parameter]]
//! name = "colors"
//! type = "colors"
//! without = "the ramp's"
//! doc = "Own colours in place of a ramp's, low to high: one for each class where there are as many, else places along them; or one for each category."
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
//! words = ["continuous", "equal", "quantile", "natural", "deviation"]
//! default = "continuous"
//! doc = "Numbers: a smooth ramp; classes of equal width, or of equally many objects; natural breaks (Fisher, Jenks); or standard deviations from the mean."
//!
//! [[parameter]]
//! name = "classes"
//! type = "number"
//! range = [2, 12]
//! default = 5
//! unit = "classes"
//! doc = "How many classes; fewer where there are fewer values. Where own colours are given and this is not, as many as these."
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
//!
//! [[parameter]]
//! name = "relief"
//! type = "number"
//! range = [0, 4]
//! default = 1
//! doc = "How much light moves lightness: 0 not at all, 1 as far as no class is taken for another; beyond that classes may be."
//!
//! [[parameter]]
//! name = "counts"
//! type = "boolean"
//! default = false
//! doc = "Whether the legend says how many objects each class has."
//!
//! [[parameter]]
//! name = "histogram"
//! type = "boolean"
//! default = false
//! doc = "Whether the legend of a smooth ramp shows how many objects there are along it."

const OF_OBJECTS = 0u;
const OF_SLOPES = 1u;
const STEPS = 1440u;            // of slopes and directions; the colour of no value comes after them
const LEVEL = 0.017452406;      // sine of the slope below which a face looks in no direction

// Which step the slope or the direction of a face is.
fn step_of_face(what: u32, number: u32) -> u32 {
    if is_section(number) {
        return STEPS;
    }
    let normal = decode_normal(surface_at(number).normal);
    let level = length(normal.xy);
    let slope = degrees(atan2(level, abs(normal.z))) * (1.0 / 90.0);
    let around = degrees(atan2(normal.x, normal.y)) * (1.0 / 360.0);
    let share = select(around - floor(around), slope, what == OF_SLOPES);
    let step = min(u32(share * f32(STEPS)), STEPS - 1u);
    return select(step, STEPS, what != OF_SLOPES && level < LEVEL);
}

const OF_FACES = 3u;
const HALVINGS = 24;            // of the faces of an object: more than there are of a city

// The colour of a face in the table that begins there.
fn color_of_face(first: u32, object: u32, number: u32) -> u32 {
    if is_section(number) {
        return object_values[first + 1u];
    }
    let normal = surface_at(number).normal;
    let faces = first + object_values[first];
    let end = object_values[first + 3u + object];
    var low = object_values[first + 2u + object];
    var high = end;
    for (var i = 0; i < HALVINGS; i++) {
        let middle = (low + high) / 2u;
        let is_above = low < high && object_values[faces + 2u * middle] < normal;
        low = select(low, middle + 1u, is_above);
        high = select(middle, high, is_above || low >= high);
    }
    if low < end && object_values[faces + 2u * low] == normal {
        return object_values[faces + 2u * low + 1u];
    }
    return object_values[first + 1u];
}

// The host says from `p.first` on what light does, what is coloured, and the colours, sRGB: of objects, or of steps.
fn effect(color: vec3f, point: Point, p: Parameters) -> vec3f {
    if point.object == NO_OBJECT {
        return point.shade * vec3f(0.72);
    }
    let what = object_values[p.first + 1u];
    var code = 0u;
    switch what {
        case OF_OBJECTS: {
            code = value_then(p.first, object_values[p.first + 2u + point.object]);
        }
        case OF_FACES: {
            code = color_of_face(p.first + 2u, point.object, point.surface);
        }
        default: {
            code = object_values[p.first + 2u + step_of_face(what, point.surface)];
        }
    }
    let legend = linear_from_srgb(unpack4x8unorm(code).rgb);
    return shown_under_light(legend, bitcast<f32>(object_values[p.first]), point.shade);
}
