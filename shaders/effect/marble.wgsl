//! name = "marble"
//! kind = "material"
//! spec = "Tiesel §3"
//! doc = "Polished marble: clouds and veins that run through the whole block, and sharp highlights of the sun."
//!
//! [[parameter]]
//! name = "scale"
//! type = "number"
//! range = [0.5, 100]
//! default = 8
//! unit = "metres"
//! doc = "From one large vein to the next, roughly. What is finer than a pixel fades."
//!
//! [[parameter]]
//! name = "color"
//! type = "color"
//! default = "#dcd8d0"
//! doc = "Colour of the stone."
//!
//! [[parameter]]
//! name = "vein"
//! type = "color"
//! default = "#56616d"
//! doc = "Colour of the veins."
//!
//! [[parameter]]
//! name = "polish"
//! type = "number"
//! range = [0, 2]
//! default = 0.6
//! doc = "How strong the highlights are."
//!
//! [[parameter]]
//! name = "shininess"
//! type = "number"
//! range = [1, 512]
//! default = 48
//! doc = "Exponent of the highlights: the larger, the smaller and sharper."

fn effect(material: Material, point: Point, p: Parameters) -> Material {
    let pixel = metres_per_pixel(point) / (p.scale * max(abs(dot(point.normal, normalize(point.relative))), 0.2));
    // The stone flowed before it set: its veins, once flat sheets, are bent by a noise, a finer and a yet finer one.
    let block = place_of(point, p.scale);
    let large = wool(block, 1u, pixel);
    let half = finer(shifted(block, 0.35 * large.wxy));
    let small = wool(half, 2u, 2.0 * pixel);
    let quarter = finer(half);
    let fine = wool(quarter, 3u, 4.0 * pixel);
    let flow = large + 0.45 * small + 0.18 * fine;
    // Each set of veins comes and goes.
    let main = 0.15 + 0.85 * smoothstep(-0.3, 0.5, large.w);
    let second = 0.7 * smoothstep(-0.1, 0.6, large.z + 0.4 * small.z);
    let third = 0.35 * smoothstep(-0.3, 0.4, small.x);
    let hair = 0.3 * smoothstep(-0.1, 0.6, fine.x - 0.4 * small.z);
    let veins = main * vein(block, vec3f(1.0, 1.0, -1.0), 0.5 * flow.x, 0.05 + 0.04 * small.w, pixel)
        + second * vein(block, vec3f(-1.0, 2.0, 1.0), 0.6 * flow.y, 0.04, pixel)
        + third * vein(half, vec3f(2.0, -1.0, 1.0), 0.5 * fine.w + 0.6 * small.y, 0.04, 2.0 * pixel)
        + hair * vein(quarter, vec3f(1.0, 2.0, -2.0), 1.1 * fine.z + 0.5 * small.w, 0.03, 4.0 * pixel);
    let cloud = smoothstep(-0.5, 0.9, flow.w);
    var changed = material;
    changed.base = mix(p.color, p.vein, min(0.3 * cloud + veins, 1.0));
    // Veins are softer than the stone and take less of a polish.
    changed.specular = vec3f(p.polish * (1.0 - 0.5 * min(veins, 1.0)));
    changed.shininess = p.shininess;
    return changed;
}

// A place in a lattice of cubes: which cube, exactly, and where in it, 0..1. The lattice does not move with the eye.
struct Place {
    cube: vec3i,
    at: vec3f,
}

// With cubes of `size` metres (to the millimetre). The eye's whole metres are divided as integers.
fn place_of(point: Point, size: f32) -> Place {
    let step = max(i32(round(size * 1000.0)), 1);
    let rest = (view.eye_whole % step) * 1000;
    let cube = view.eye_whole / step * 1000 + rest / step;
    let metres = vec3f(rest % step) * 0.001 + view.eye_fraction + point.relative;
    return shifted(Place(cube, vec3f(0.0)), metres / (0.001 * f32(step)));
}

fn shifted(place: Place, by: vec3f) -> Place {
    let at = place.at + by;
    return Place(place.cube + vec3i(floor(at)), fract(at));
}

// The same place among cubes half as large.
fn finer(place: Place) -> Place {
    return shifted(Place(2 * place.cube, vec3f(0.0)), 2.0 * place.at);
}

// How much of a pixel one set of veins covers: sheets one after the other along `across`, whole numbers so that they go
// on from cube to cube, each pushed by `bend` of the way to the next. Width and pixel in cubes.
fn vein(place: Place, across: vec3f, bend: f32, width: f32, pixel: f32) -> f32 {
    let from_middle = abs(fract(dot(place.at, across) + bend) - 0.5) / length(across);
    let wide = width + pixel;
    // A dark middle in a wide, pale seam.
    let seam = max(1.0 - 0.3 * from_middle / wide, 0.0);
    let share = 0.65 * (1.0 - smoothstep(0.0, wide, from_middle)) + 0.35 * seam * seam * seam;
    let mean = 1.2 * width * length(across);
    return mix((width / wide) * share, mean, smoothstep(0.15, 0.5, pixel));
}

// Four smooth noises, -1..1, from numbers at the corners of a cube; 0, their mean, where cubes are as small as pixels.
fn wool(place: Place, seed: u32, pixel: f32) -> vec4f {
    let t = place.at * place.at * place.at * (place.at * (place.at * 6.0 - 15.0) + 10.0);
    var sum = vec4f(0.0);
    for (var i = 0; i < 8; i++) {
        let corner = vec3i(i & 1, (i >> 1) & 1, i >> 2);
        let w = select(1.0 - t, t, corner == vec3i(1));
        sum += (w.x * w.y * w.z) * number_of(place.cube + corner, seed);
    }
    return sum * (1.0 - smoothstep(0.3, 0.8, pixel));
}

// Four numbers -1..1 that belong to a corner of the lattice. Mixing of integers is exact, and the same on every GPU.
fn number_of(corner: vec3i, seed: u32) -> vec4f {
    let c = vec3u(corner);
    var h = (c.x * 0x8da6b343u) ^ (c.y * 0xd8163841u) ^ (c.z * 0xcb1ab31fu) ^ (seed * 0x9e3779b9u);
    h = (h ^ (h >> 16u)) * 0x7feb352du;
    h = (h ^ (h >> 15u)) * 0x846ca68bu;
    h = h ^ (h >> 16u);
    return unpack4x8snorm(h);
}
