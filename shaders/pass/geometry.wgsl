// The one opaque geometry pass: what is there, which way it faces, how far it is.
//
// target 0  r32uint     surface + 1 (0 = nothing); rg32uint where normals are smooth: y = octahedral normal
// target 1  rgba8unorm-srgb  base colour; only in cities that have textures
// target 2  r32float    interpolated depth; only where the depth AOV is asked for. A face that shares its
//                       plane takes its tested depth from the plane; its AOV must not depend on what else
//                       the city holds, so it is always the face's own.

override SMOOTH: bool = false;  // whether some faces have a normal per vertex

struct Varying {
    @builtin(position) clip: vec4f,
    @location(0) @interpolate(flat, either) code: u32,
    @location(1) normal: vec3f,
    @location(2) texcoord: vec2f,
    @location(3) @interpolate(flat, either) plane: vec4f,
}

fn placed(position: vec3f, surface: u32) -> Varying {
    var out: Varying;
    out.clip = clip_from_relative(relative_to_eye(surfaces[surface].origin, position));
    out.code = surface + 1u;
    return out;
}

@vertex
fn vertex(@location(0) position: vec3f, @location(2) surface: u32) -> Varying {
    return placed(position, surface);
}

// Normals are interpolated: a pipeline of its own, since a flat city has no use for them.
@vertex
fn vertex_smooth(@location(0) position: vec3f, @location(1) normal: u32, @location(2) surface: u32) -> Varying {
    var out = placed(position, surface);
    out.normal = decode_normal(normal);
    return out;
}

fn code_of(in: Varying) -> vec2u {
    if SMOOTH {
        return vec2u(in.code, encode_normal(in.normal));
    }
    return vec2u(in.code, 0u);
}

@fragment
fn plain(in: Varying) -> @location(0) vec2u {
    return code_of(in);
}

struct Full {
    @location(0) code: vec2u,
    @location(1) color: vec4f,
    @location(2) own_depth: f32,
}

@fragment
fn full(in: Varying) -> Full {
    return Full(code_of(in), vec4f(natural_color(in.code - 1u), 1.0), in.clip.z);
}

// ---- textured surfaces

@group(2) @binding(0) var image: texture_2d<f32>;
@group(2) @binding(1) var image_sampler: sampler;
override ALPHA_CUTOFF: f32 = 0.0;

@vertex
fn vertex_textured(@location(0) position: vec3f, @location(1) normal: u32, @location(2) surface: u32,
                   @location(3) texcoord: vec2f) -> Varying {
    var out = placed(position, surface);
    if SMOOTH {
        out.normal = decode_normal(normal);
    }
    out.texcoord = texcoord;
    return out;
}

@fragment
fn textured(in: Varying) -> Full {
    let texel = textureSample(image, image_sampler, in.texcoord);
    if texel.a < ALPHA_CUTOFF {
        discard;
    }
    return Full(code_of(in), vec4f(texel.rgb * natural_color(in.code - 1u), 1.0), in.clip.z);
}

// ---- faces of exactly one plane that overlap (hard case 3)
//
// Every face of the group takes its depth from the group's plane, by the same arithmetic, so their
// depths are equal to the bit and the draw order (their fixed priority) decides in every frame.

struct Plane {
    normal: vec3f,              // unit
    reserved: f32,
    origin: vec3i,              // whole metres
    offset: f32,                // normal . (any point of the plane - origin), metres
}

@group(1) @binding(1) var<storage, read> shared_planes: array<Plane>;

@vertex
fn vertex_coplanar(@location(0) position: vec3f, @location(1) normal: u32, @location(2) surface: u32,
                   @location(4) plane_index: u32) -> Varying {
    var out = placed(position, surface);
    if SMOOTH {
        out.normal = decode_normal(normal);
    }
    let plane = shared_planes[plane_index];
    let distance = dot(plane.normal, relative_to_eye(plane.origin, vec3f(0.0))) + plane.offset;
    out.plane = vec4f(view.view_from_world * plane.normal, distance);
    return out;
}

fn depth_on_plane(in: Varying) -> f32 {
    let ray = ray_of_pixel(in.clip.xy);
    let slope = dot(in.plane.xyz, ray.direction);
    let room = in.plane.w - dot(in.plane.xyz, ray.origin);
    // The eye is in the plane, or the plane is seen edge on: the interpolated depth will do.
    if abs(room) < 1e-4 || abs(slope) < 1e-6 {
        return in.clip.z;
    }
    let distance = room / slope;
    if distance <= view.near {
        return in.clip.z;
    }
    return depth_of_distance(distance);
}

struct CoplanarPlain {
    @location(0) code: vec2u,
    @builtin(frag_depth) depth: f32,
}

@fragment
fn plain_coplanar(in: Varying) -> CoplanarPlain {
    return CoplanarPlain(code_of(in), depth_on_plane(in));
}

struct CoplanarFull {
    @location(0) code: vec2u,
    @location(1) color: vec4f,
    @location(2) own_depth: f32,
    @builtin(frag_depth) depth: f32,
}

@fragment
fn full_coplanar(in: Varying) -> CoplanarFull {
    return CoplanarFull(code_of(in), vec4f(natural_color(in.code - 1u), 1.0), in.clip.z, depth_on_plane(in));
}
