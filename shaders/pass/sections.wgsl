// Sections: where a lens takes part of a closed body away, or shows part of one, its own surface closes what is left.
//
// Volume by volume, three draws, each in a pass of its own: draws of one pass do not wait for what others store.
//   ends    where each pixel's ray leaves the volume (or enters it), by its own lens test
//   count   every face of a closed shell that lies beyond that end and whose object is there behind it and not before: one that
//           looks away counts 1, one that looks at the eye takes 1 away. What is left is the number of shells that the end lies
//           in, in any order of faces, and as each brings its object with it, where it is one shell, whose
//   fill    where it lies in one, and nothing shown is nearer, the end is what is shown
//
// It stands so little behind the volume that every lens test has it outside.

struct SectionStage {
    center: vec3f,              // of a ball around the volume, view space, metres
    radius: f32,
    color: vec3f,               // linear
    volume: u32,                // its number among the frame's
    leaves: u32,                // 1: where rays leave it; 0: where they enter it
    turn: u32,                  // how many such ends come before the one that is asked for
    has_forms: u32,             // whether all leaves of a combination have closed forms
}

// The end of a ray, and the sum of the faces beyond it.
struct SectionPixel {
    end: u32,                   // D in metres (0: there is none) without its last bits, which say how far beside it to ask
    faces: atomic<u32>,         // 6 bits: how many shells; the others: the sum of their objects
}

// Storage: Mesa's software driver compiles shaders anew for values of uniforms that they branch on.
@group(3) @binding(0) var<storage, read> stage: SectionStage;
@group(3) @binding(1) var<storage, read_write> section_pixels: array<SectionPixel>;

const SHELL_BITS: u32 = 6u;
// How far behind the volume the section stands, and how far before its end something is called hidden: of the distance from
// the eye, and up to 2^SECTION_DOUBLINGS times as much where the ray goes along a face, which holds a little more than itself
// (ON_FACE).
const SECTION_BESIDE: f32 = 4e-6;
const SECTION_DOUBLINGS: u32 = 10u;
const DOUBLING_BITS: u32 = 15u;
// Steps in which the ends of what has no closed form are looked for, from where a ray enters it first to where it leaves it
// last: gaps and parts that are thinner than one of these may be missed. Halvings after that: to the last bit.
const SECTION_STEPS: u32 = 96u;
const SECTION_HALVINGS: u32 = 26u;

//@handlers

fn index_of(pixel: vec2i) -> u32 {
    return u32(pixel.y) * u32(view.size.x) + u32(pixel.x);
}

fn place_at(ray: Ray, distance: f32) -> vec3f {
    return ray.origin + distance * ray.direction;
}

struct SectionEnd {
    distance: f32,              // D, metres; 0: there is none
    room: f32,                  // how far beside it all lens tests agree, metres
}

fn end_of_bits(ray: Ray, bits: u32) -> SectionEnd {
    let distance = bitcast<f32>(bits & ~DOUBLING_BITS);
    let room = SECTION_BESIDE * max(distance, length(place_at(ray, distance)));
    return SectionEnd(distance, room * f32(1u << (bits & DOUBLING_BITS)));
}

fn end_at(ray: Ray, pixel: vec2i) -> SectionEnd {
    return end_of_bits(ray, section_pixels[index_of(pixel)].end);
}

fn end_of_span(span: Span) -> f32 {
    let end = select(span.enter, span.exit, stage.leaves == 1u);
    return select(0.0, end, span.enter <= span.exit && stage.turn == 0u);
}

fn sight_along(ray: Ray, pixel: vec2i, distance: f32) -> Sight {
    return Sight(pixel, depth_of_distance(distance), ray, distance, place_at(ray, distance), view.orthographic == 1u,
                 NO_OBJECT, 0.0);
}

// Of a volume without closed form; `whole`: from its first entry to its last exit, as its sprite knows them.
fn end_by_steps(ray: Ray, pixel: vec2i, whole: Span) -> f32 {
    let span = meet(span_of_ball(ray, stage.center, stage.radius), whole);
    let room = (span.exit - span.enter) / 64.0 + SECTION_BESIDE * abs(span.exit);
    let first = max(span.enter - room, 0.0);
    let stride = (span.exit + room - first) / f32(SECTION_STEPS);
    let leaves = stage.leaves == 1u;
    var was = holds_volume(stage.volume, sight_along(ray, pixel, first));
    var turn = 0u;
    var low = 0.0;
    for (var i = 1u; i <= SECTION_STEPS; i += 1u) {
        let at = first + f32(i) * stride;
        let now = holds_volume(stage.volume, sight_along(ray, pixel, at));
        let is_end = was != now && was == leaves;
        low = select(low, at - stride, is_end && turn == stage.turn);
        turn += select(0u, 1u, is_end);
        was = now;
    }
    var high = low + stride;
    for (var i = 0u; i < SECTION_HALVINGS; i += 1u) {
        let middle = 0.5 * (low + high);
        let is_before = holds_volume(stage.volume, sight_along(ray, pixel, middle)) == leaves;
        low = select(low, middle, is_before);
        high = select(middle, high, is_before);
    }
    return select(0.0, high, span.enter <= span.exit && span.exit > 0.0 && turn > stage.turn);
}

// ---- ends

@vertex
fn vertex_everywhere(@builtin(vertex_index) corner: u32) -> @builtin(position) vec4f {
    return vec4f(f32(corner & 1u) * 4.0 - 1.0, f32(corner >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn ends(@builtin(position) at: vec4f) {
    let pixel = vec2i(at.xy);
    let ray = ray_of_pixel(at.xy);
    let bits = bitcast<u32>(max(end_of(ray, pixel), 0.0)) & ~DOUBLING_BITS;
    let leaves = stage.leaves == 1u;
    var found = 0u;
    for (var i = 0u; i <= SECTION_DOUBLINGS && bits != 0u && found == 0u; i += 1u) {
        let end = end_of_bits(ray, bits | i);
        let was = holds_volume(stage.volume, sight_along(ray, pixel, end.distance - end.room));
        let is_held = holds_volume(stage.volume, sight_along(ray, pixel, end.distance + end.room));
        found = select(0u, bits | i, was == leaves && is_held != leaves);
    }
    section_pixels[index_of(pixel)].end = found;
    atomicStore(&section_pixels[index_of(pixel)].faces, 0u);
}

// ---- count

struct Vertex {
    @location(0) origin: vec3i,     // whole metres
    @location(1) surface: u32,
    @location(2) position: vec3f,   // from the origin, metres
    @location(3) normal: u32,       // octahedral
}

struct Face {
    @builtin(position) @invariant clip: vec4f,
    @location(0) @interpolate(flat, either) surface: u32,
}

@vertex
fn vertex(in: Vertex) -> Face {
    return Face(clip_from_relative(city_relative(in.origin, in.position)), city_surface(in.surface));
}

// The inside of a surface's object at D, as something that may be hidden; terrain stays terrain.
fn inside_of(surface: Surface, number: u32, ray: Ray, pixel: vec2i, distance: f32) -> Fragment {
    let position = place_at(ray, distance);
    let up = view.view_from_world[2];
    let height = f32(view.eye_whole.z) + view.eye_fraction.z + dot(up, position);
    let part = select(PART_SECTION, PART_TERRAIN, part_of(surface) == PART_TERRAIN);
    return Fragment(pixel, depth_of_distance(distance), position, height, number, surface.object, part,
                    -normalize(ray.direction) * view.view_from_world, ray, view.orthographic == 1u, city_number(),
                    dither(pixel, view.sample_index), 0.0, 1.0);
}

@fragment
fn count(in: Face, @builtin(front_facing) is_front: bool) {
    let pixel = vec2i(in.clip.xy);
    let surface = surface_at(in.surface);
    let ray = ray_of_pixel(in.clip.xy);
    let end = end_at(ray, pixel);
    let behind = end.distance + end.room;
    if end.distance <= 0.0 || (surface.flags & SURFACE_CLOSED) == 0u || in.clip.z >= depth_of_distance(behind) {
        return;
    }
    if visible(inside_of(surface, in.surface, ray, pixel, end.distance - end.room)) {
        return;
    }
    if !visible(inside_of(surface, in.surface, ray, pixel, behind)) {
        return;
    }
    let is_entry = is_front != ((surface.flags & SURFACE_INWARD) != 0u);
    let one = (surface.object << SHELL_BITS) | 1u;
    atomicAdd(&section_pixels[index_of(pixel)].faces, select(one, 0u - one, is_entry));
}

// ---- fill

struct Filled {
    @location(0) code: vec2u,
    @location(1) color: vec4f,
    @location(2) own_depth: f32,
    @builtin(frag_depth) depth: f32,
}

// From a pixel's end to that of the pixel beside it on either side, view space: of the two the one that goes less far in depth.
fn along(at: vec2f, step: vec2i) -> vec3f {
    let pixel = vec2i(at);
    let ray = ray_of_pixel(at);
    let own = end_at(ray, pixel).distance;
    var best = vec3f(0.0);
    var least = FAR_AWAY;
    for (var side = -1; side <= 1; side += 2) {
        let beside = pixel + side * step;
        let is_there = all(beside >= vec2i(0)) && all(beside < vec2i(view.size));
        let ray_beside = ray_of_pixel(at + vec2f(side * step));
        let end = end_at(ray_beside, clamp(beside, vec2i(0), vec2i(view.size) - 1)).distance;
        let nearer = is_there && end > 0.0 && abs(end - own) < least;
        let way = f32(side) * (place_at(ray_beside, end) - place_at(ray, own));
        best = select(best, way, nearer);
        least = select(least, abs(end - own), nearer);
    }
    return best;
}

@fragment
fn fill(@builtin(position) at: vec4f) -> Filled {
    let pixel = vec2i(at.xy);
    let ray = ray_of_pixel(at.xy);
    let end = end_at(ray, pixel);
    let faces = atomicLoad(&section_pixels[index_of(pixel)].faces);
    let shells = faces & ((1u << SHELL_BITS) - 1u);
    if end.distance <= 0.0 || shells == 0u {
        discard;
    }
    let object = select(SECTION_OBJECT, faces >> SHELL_BITS, shells == 1u);
    // Where both neighbours are missing, as if it faced the eye.
    let across = cross(along(at.xy, vec2i(1, 0)), along(at.xy, vec2i(0, 1)));
    let is_known = dot(across, across) > 0.0;
    let facing = select(-ray.direction, select(across, -across, dot(across, ray.direction) > 0.0), is_known);
    let depth = depth_of_distance(end.distance + end.room);
    let normal = encode_normal(normalize(facing) * view.view_from_world);
    return Filled(vec2u((SECTION | object) + 1u, normal), vec4f(stage.color, 1.0), depth, depth);
}
