// The one opaque geometry pass: what is there, which way it faces, how far it is.
//
// target 0  r32uint     surface + 1 (0 = nothing); rg32uint where normals are smooth: y = octahedral normal
// target 1  rgba8unorm-srgb  base colour; only in cities that have textures. Alpha: what storeys and windows left of it
// target 2  r32float    interpolated depth; only where the depth AOV is asked for. A face that shares its
//                       plane takes its tested depth from the plane; its AOV must not depend on what else
//                       the city holds, so it is always the face's own.
// target 4  rgba8unorm-srgb  share of its own light; only in cities whose textures say it (3: numbers of regions)
//
// Chunks that a hiding lens may reach have pipelines of their own, whose `cut` discards what is not there (by its own
// depth, before visibility): a discard anywhere costs early depth tests everywhere (decision 3).

override SMOOTH: bool = false;  // whether some faces have a normal per vertex
override FLAT_CITY: bool = false;   // whether those of this city have none, beside a city whose have

struct Vertex {
    @location(0) origin: vec3i,     // whole metres
    @location(1) surface: u32,
    @location(2) position: vec3f,   // from the origin, metres
    @location(3) normal: u32,       // octahedral
}

// Values that every fragment knows. Flat values are those of a triangle's provoking vertex; its other vertices may belong
// to other faces. Each kind of face carries no more than it uses: what is handed over is paid per vertex.
struct Varying {
    @builtin(position) @invariant clip: vec4f,
    @location(0) @interpolate(flat, either) code: u32,
}

fn placed(in: Vertex) -> Varying {
    //@placed
    return Varying(clip_from_relative(city_relative(in.origin, in.position)), city_surface(in.surface) + 1u);
}

struct Full {
    @location(0) code: vec2u,
    @location(1) color: vec4f,
    @location(2) own_depth: f32,
    //@region-member
}

//@handlers

// ---- flat faces

@vertex
fn vertex(in: Vertex) -> Varying {
    return placed(in);
}

@fragment
fn plain(in: Varying) -> @location(0) u32 {
    cut(in.clip.xy, in.clip.z, in.code);
    return in.code;
}

@fragment
fn full(in: Varying) -> Full {
    cut(in.clip.xy, in.clip.z, in.code);
    return Full(vec2u(in.code, 0u), vec4f(surface_at(in.code - 1u).color, 1.0), in.clip.z/*@region*/);
}

// ---- faces in a city where some have a normal per vertex

struct SmoothVarying {
    @builtin(position) @invariant clip: vec4f,
    @location(0) @interpolate(flat, either) code: u32,
    @location(1) normal: vec3f,
}

@vertex
fn vertex_smooth(in: Vertex) -> SmoothVarying {
    let face = placed(in);
    return SmoothVarying(face.clip, face.code, city_direction(decode_normal(in.normal)));
}

// Vertices of a city of flat faces are shared by faces of other directions.
fn normal_code(normal: vec3f, code: u32) -> u32 {
    if FLAT_CITY {
        return surface_at(code - 1u).normal;
    }
    return encode_normal(normal);
}

@fragment
fn smooth_plain(in: SmoothVarying) -> @location(0) vec2u {
    cut(in.clip.xy, in.clip.z, in.code);
    return vec2u(in.code, normal_code(in.normal, in.code));
}

@fragment
fn smooth_full(in: SmoothVarying) -> Full {
    cut(in.clip.xy, in.clip.z, in.code);
    let code = vec2u(in.code, normal_code(in.normal, in.code));
    return Full(code, vec4f(surface_at(in.code - 1u).color, 1.0), in.clip.z/*@region*/);
}

// ---- textured surfaces

@group(3) @binding(0) var image: texture_2d<f32>;
@group(3) @binding(1) var image_sampler: sampler;
override ALPHA_CUTOFF: f32 = 0.0;
override TRANSLUCENT: bool = false; // whether texels let through what is behind, by their opacity

@group(3) @binding(2) var light_image: texture_2d<f32>;
@group(3) @binding(3) var light_sampler: sampler;
override IMAGE_EMITS: bool = false; // whether it says how much light of their own faces have
@group(3) @binding(4) var normal_image: texture_2d<f32>;
@group(3) @binding(5) var normal_sampler: sampler;
override NORMAL_SCALE: f32 = 0.0;   // what the x and y of its normals are multiplied with; 0: there is none

override FACADE: bool = false;      // whether coordinates are those of storeys and windows, and there is no image

// The least cosine of the angle between a normal of an image and the way to the eye that its face looks at.
const LEAST_FACING: f32 = 0.02;

struct TexturedVarying {
    @builtin(position) @invariant clip: vec4f,
    @location(0) @interpolate(flat, either) code: u32,
    @location(1) normal: vec3f,
    @location(2) texcoord: vec2f,
    @location(3) relative: vec3f,   // to the eye, world axes, metres
}

// What images show of a face.
struct Look {
    color: vec3f,               // linear, that of the material in it
    facade: f32,                // how much of it storeys and windows leave
    opacity: f32,               // of the texel of colours
    light: vec3f,               // share of its own light
    normal: u32,                // octahedral; 0 where the picture has none
}

fn look_at(texcoord: vec2f, normal: vec3f, relative: vec3f, code: u32) -> Look {
    if FACADE {
        let share = facade_at(texcoord, fwidth(texcoord));
        let code_of_normal = select(0u, encode_normal(normal), SMOOTH);
        return Look(surface_at(code - 1u).color * share, share, 1.0, vec3f(1.0), code_of_normal);
    }
    let texel = textureSample(image, image_sampler, texcoord);
    var light = vec3f(1.0);
    if IMAGE_EMITS {
        light = textureSample(light_image, light_sampler, texcoord).rgb;
    }
    var seen = normal;
    if NORMAL_SCALE != 0.0 {
        seen = normal_of_image(texcoord, normal, relative);
    }
    return Look(texel.rgb * surface_at(code - 1u).color, 1.0, texel.a, light, select(0u, encode_normal(seen), SMOOTH));
}

// The normal that an image says, in the space that the texture coordinates span on the face (glTF 2.0, section 3.9.3): x along
// u, y against v, z along the face's own. Neighbours in the picture tell how coordinates grow (Schueler, ShaderX 5, 2006).
fn normal_of_image(texcoord: vec2f, normal: vec3f, relative: vec3f) -> vec3f {
    let texel = textureSample(normal_image, normal_sampler, texcoord).xyz;
    let own = (2.0 * texel - 1.0) * vec3f(NORMAL_SCALE, NORMAL_SCALE, 1.0);
    let up = normalize(normal);
    let place_x = dpdx(relative);
    let place_y = dpdy(relative);
    let coordinate_x = dpdx(texcoord);
    let coordinate_y = dpdy(texcoord);
    let turn = sign(coordinate_x.x * coordinate_y.y - coordinate_x.y * coordinate_y.x);
    let along_u = turn * (place_x * coordinate_y.y - place_y * coordinate_x.y);
    let along_v = turn * (place_y * coordinate_x.x - place_x * coordinate_y.x);
    let tangent = along_u - dot(along_u, up) * up;
    let size = length(tangent);
    let x = tangent / size;
    let y = cross(up, x) * select(1.0, -1.0, dot(cross(up, x), along_v) > 0.0);
    let mapped = normalize(own.x * x + own.y * y + own.z * up);
    // What it says is seen from the side that the face is seen from.
    let back = vec3f(0.0, 0.0, 1.0) * view.view_from_world;
    let to_eye = select(-normalize(relative), back, view.orthographic == 1u);
    let side = select(-1.0, 1.0, dot(up, to_eye) >= 0.0) * to_eye;
    let facing = mapped + max(LEAST_FACING - dot(mapped, side), 0.0) * side;
    // Where coordinates do not grow there is no such space.
    return select(normal, facing, size > 0.0 && own.z > 0.0);
}

@vertex
fn vertex_textured(in: Vertex, @location(4) texcoord: vec2f) -> TexturedVarying {
    let face = placed(in);
    let relative = city_relative(in.origin, in.position);
    return TexturedVarying(face.clip, face.code, city_direction(decode_normal(in.normal)), texcoord, relative);
}

struct TexturedFull {
    @location(0) code: vec2u,
    @location(1) color: vec4f,
    @location(2) own_depth: f32,
    //@region-member
    @location(4) light: vec4f,
}

@fragment
fn textured(in: TexturedVarying) -> TexturedFull {
    let look = look_at(in.texcoord, in.normal, in.relative, in.code);
    if look.opacity < ALPHA_CUTOFF {
        discard;
    }
    texel_opacity = select(1.0, look.opacity, TRANSLUCENT);
    cut(in.clip.xy, in.clip.z, in.code);
    let code = vec2u(in.code, look.normal);
    return TexturedFull(code, vec4f(look.color, look.facade), in.clip.z/*@region*/, vec4f(look.light, 1.0));
}

// ---- faces of exactly one plane that overlap (hard case 3)
//
// Every face of the group takes its depth from the group's plane, by the same arithmetic, so their
// depths are equal to the bit and the draw order (their fixed priority) decides in every frame.

struct CoplanarVarying {
    @builtin(position) @invariant clip: vec4f,
    @location(0) @interpolate(flat, either) code: u32,
    @location(1) normal: vec3f,
    @location(2) @interpolate(flat, either) plane: vec3f,   // dot(plane, (pixel, 1)) = depth
    @location(3) texcoord: vec2f,   // where it has images
    @location(4) relative: vec3f,   // to the eye, world axes, metres
}

struct Plane {
    @location(4) normal: vec3f,     // unit
    @location(5) origin: vec3i,     // whole metres
    @location(6) offset: f32,       // normal . (any point of the plane - origin), metres
}

// The depth of a plane is affine in the picture: its slope in x and y, and its value at pixel (0, 0).
// `room`: distance of the plane from the eye along its normal. Not finite where the eye is in the plane.
fn plane_in_picture(normal: vec3f, room: f32) -> vec3f {
    // Both are computed: Mesa's software driver compiles a vertex shader that branches on a uniform anew for every pass that
    // binds one.
    let is_flat = view.orthographic == 1u;
    let step = 1.0 / (normal.z * (view.far - view.near));
    let slope = view.near / room;
    // Depth per unit of the picture plane at distance 1 (orthographic: per metre), and on the view axis.
    let across = select(slope, -step, is_flat) * normal.xy;
    let middle = select(-slope * normal.z, view.far / (view.far - view.near) + step * room, is_flat);
    let per_ndc = across / view.projection.xy;
    let per_pixel = per_ndc * vec2f(2.0, -2.0) / view.size;
    return vec3f(per_pixel, middle + dot(per_ndc, vec2f(-1.0, 1.0) - view.projection.zw));
}

@vertex
fn vertex_coplanar(in: Vertex, plane: Plane) -> CoplanarVarying {
    return coplanar(in, plane);
}

fn coplanar(in: Vertex, plane: Plane) -> CoplanarVarying {
    let face = placed(in);
    let facing = city_direction(plane.normal);
    let room = dot(facing, city_relative(plane.origin, vec3f(0.0))) + city_length(plane.offset);
    let seen = plane_in_picture(view.view_from_world * facing, room);
    var normal = vec3f(0.0);
    if SMOOTH {
        normal = city_direction(decode_normal(in.normal));
    }
    return CoplanarVarying(face.clip, face.code, normal, seen, vec2f(0.0), city_relative(in.origin, in.position));
}

@vertex
fn vertex_coplanar_textured(in: Vertex, plane: Plane, @location(7) texcoord: vec2f) -> CoplanarVarying {
    var face = coplanar(in, plane);
    face.texcoord = texcoord;
    return face;
}

// Where the plane is seen edge on, its depth leaves 0..1 or is no number: the interpolated one will do.
fn depth_on_plane(plane: vec3f, clip: vec4f) -> f32 {
    let depth = dot(plane, vec3f(clip.xy, 1.0));
    return select(clip.z, depth, depth > 0.0 && depth < 1.0);
}

fn coplanar_code(in: CoplanarVarying) -> vec2u {
    if !SMOOTH {
        return vec2u(in.code, 0u);
    }
    return vec2u(in.code, normal_code(in.normal, in.code));
}

struct CoplanarPlain {
    @location(0) code: vec2u,
    @builtin(frag_depth) depth: f32,
}

@fragment
fn coplanar_plain(in: CoplanarVarying) -> CoplanarPlain {
    let depth = depth_on_plane(in.plane, in.clip);
    cut(in.clip.xy, depth, in.code);
    return CoplanarPlain(coplanar_code(in), depth);
}

struct CoplanarFull {
    @location(0) code: vec2u,
    @location(1) color: vec4f,
    @location(2) own_depth: f32,
    //@region-member
    @builtin(frag_depth) depth: f32,
}

@fragment
fn coplanar_full(in: CoplanarVarying) -> CoplanarFull {
    let depth = depth_on_plane(in.plane, in.clip);
    cut(in.clip.xy, depth, in.code);
    let color = vec4f(surface_at(in.code - 1u).color, 1.0);
    // Where corners are drawn elsewhere, the interpolated depth is off, and not what lenses are asked by.
    let own_depth = select(depth, in.clip.z, SNAPPING == 0.0);
    return CoplanarFull(coplanar_code(in), color, own_depth/*@region*/, depth);
}

struct CoplanarTextured {
    @location(0) code: vec2u,
    @location(1) color: vec4f,
    @location(2) own_depth: f32,
    //@region-member
    @location(4) light: vec4f,
    @builtin(frag_depth) depth: f32,
}

@fragment
fn coplanar_textured(in: CoplanarVarying) -> CoplanarTextured {
    let look = look_at(in.texcoord, in.normal, in.relative, in.code);
    if look.opacity < ALPHA_CUTOFF {
        discard;
    }
    texel_opacity = select(1.0, look.opacity, TRANSLUCENT);
    let depth = depth_on_plane(in.plane, in.clip);
    cut(in.clip.xy, depth, in.code);
    let own_depth = select(depth, in.clip.z, SNAPPING == 0.0);
    let code = vec2u(in.code, look.normal);
    return CoplanarTextured(code, vec4f(look.color, look.facade), own_depth/*@region*/, vec4f(look.light, 1.0), depth);
}
