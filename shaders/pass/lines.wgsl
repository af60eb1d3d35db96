// Edges of the city as lines, where a lens draws them.
//
// A fragment of a line has classes by its own depth, not by that of the surface behind it, and goes through the styles
// of the lenses above the one that draws it.

struct LineStage {
    width: f32,                 // pixels
    step: u32,                  // place of the effect that draws among all
    drawn: u32,                 // LINES_*
    reserved: u32,
}

const LINES_FLAT: u32 = 1u;         // also edges between faces that go on flat
const LINES_FRONT: u32 = 2u;        // only of faces that look at the eye, and silhouettes
const LINES_FADE: u32 = 4u;         // weaker where they are wide in the city
const LINES_NO_TERRAIN: u32 = 8u;

fn draws(what: u32) -> bool {
    return (stage.drawn & what) != 0u;
}

@group(1) @binding(3) var<uniform> light: Light;
@group(3) @binding(0) var<uniform> stage: LineStage;

struct Line {
    @builtin(position) @invariant clip: vec4f,
    @location(0) line: vec3f,
    @location(1) @interpolate(flat, either) ends: vec4f,
    @location(2) @interpolate(flat, either) face_a: vec4f,
    @location(3) @interpolate(flat, either) face_b: vec4f,
    @location(4) @interpolate(flat, either) along: vec4f,
    @location(5) @interpolate(flat, either) surfaces: vec2u,    // of the edge's faces
}

@vertex
fn vertex(edge: Edge, @builtin(vertex_index) i: u32) -> Line {
    see_object(surface_at(city_surface(edge_surface(edge))).object);
    let made = edge_vertex(edge, i, stage.width);
    var is_drawn = edge_class(edge) != EDGE_FLAT || draws(LINES_FLAT);
    if draws(LINES_FRONT) && edge_class(edge) != EDGE_BORDER {
        let to_eye = select(-city_relative(edge.origin, edge.start), vec3f(0.0, 0.0, 1.0) * view.view_from_world, view.orthographic == 1u);
        let a = dot(city_direction(decode_normal(edge.normal_a)), to_eye) > 0.0;
        let b = dot(city_direction(decode_normal(edge.normal_b)), to_eye) > 0.0;
        is_drawn = a != b || (a && is_drawn);
    }
    let clip = select(vec4f(2.0, 2.0, 0.5, 1.0), made.clip, is_drawn);
    return Line(clip, made.line, made.ends, made.face_a, made.face_b, made.along, vec2u(city_surface(edge_surface(edge)), city_surface(edge.other)));
}

//@handlers

struct Pixel {
    @location(0) color: vec4f,
    @builtin(frag_depth) depth: f32,
}

@fragment
fn fragment(in: Line) -> Pixel {
    let pixel = vec2i(in.clip.xy);
    let depth = edge_own_depth(in.line, in.ends);
    see_object(surface_at(in.surfaces.x).object);
    see_pixel(in.clip.xy, distance_of_depth(depth));
    let ray = ray_of_pixel(in.clip.xy);
    let position = ray.origin + distance_of_depth(depth) * ray.direction;
    let surface = surface_at(in.surfaces.x);
    var point = nowhere(pixel);
    point.depth = depth;
    point.distance = distance_of_depth(depth);
    point.relative = position * view.view_from_world;
    point.normal = decode_normal(surface.normal);
    point.surface = in.surfaces.x;
    point.object = surface.object;
    point.natural = surface.color;
    point.base = surface.color;
    let height = f32(view.eye_whole.z) + view.eye_fraction.z + point.relative.z;
    let fragment = Fragment(pixel, depth, position, height, in.surfaces.x, surface.object, part_of(surface), point.normal, ray,
                            view.orthographic == 1u, city_number(), dither(pixel, view.sample_index),
                            off_face(distance_of_depth(depth)), opacity_of(surface));
    // The same place, on the other face: a line stays as long as one of its faces does.
    let beyond = surface_at(in.surfaces.y);
    var other = fragment;
    other.surface = in.surfaces.y;
    other.object = beyond.object;
    other.part = part_of(beyond);
    other.normal = decode_normal(beyond.normal);
    let seen = line_at(stage.step, point, fragment, other, classes_at(sight_at(pixel, ray, depth, surface.object), 1u));
    let is_terrain = fragment.part == PART_TERRAIN && other.part == PART_TERRAIN;
    let wide = max(stage.width, 1.0) * metres_per_pixel(point);
    let fade = select(1.0, clamp(0.9 / wide, 0.33, 1.0), draws(LINES_FADE));
    let opacity = seen.a * fade * edge_coverage(in.line, stage.width) * select(1.0, 0.0, is_terrain && draws(LINES_NO_TERRAIN));
    return Pixel(vec4f(seen.rgb * opacity, opacity), edge_depth(in.line, in.ends, in.face_a, in.face_b, in.along));
}
