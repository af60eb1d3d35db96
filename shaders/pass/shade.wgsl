// Deferred shading of the shown surface, and what the lenses make of it.
//
// The effects of the context and of lenses stand in `shade` and `styled`, which are put together from the scene: by the
// specialised back end, which writes out what is asked for and nothing else, or by the uber back end, which reads
// it from a table. Moving a lens or turning a parameter changes uniforms only.

override SUMMED: bool = false;      // weighted by coverage, to be summed over samples

@group(0) @binding(0) var<uniform> view_uniform: View;
@group(1) @binding(3) var<uniform> light_uniform: Light;

// Values of uniforms are carried to fragments with the triangle, flat: in a fragment the software adapter reads each
// number of a uniform lane by lane, thirty instructions long, and what is flat it has at hand. These are what libraries,
// effects and handlers read; `take` fills them.
var<private> view: View;
var<private> light: Light;

struct Corner {
    @builtin(position) @invariant clip: vec4f,
    @location(0) @interpolate(flat, either) part: vec4u,        // of the picture: the context's, or the lenses'; view's words
    @location(1) @interpolate(flat, either) view_x: vec4f,      // columns of view_from_world; near
    @location(2) @interpolate(flat, either) view_y: vec4f,      // far
    @location(3) @interpolate(flat, either) view_z: vec4f,      // haze
    @location(4) @interpolate(flat, either) across: vec4f,
    @location(5) @interpolate(flat, either) sun: vec4f,         // shadow_depth_step
    @location(6) @interpolate(flat, either) to_sun: vec4f,      // shadow_scale
    @location(7) @interpolate(flat, either) sky: vec4f,         // scene_radius
    @location(8) @interpolate(flat, either) ground: vec4f,      // width of the target
    @location(9) @interpolate(flat, either) zenith: vec4f,      // its height
    @location(10) @interpolate(flat, either) horizon: vec4f,    // shadow_levels
    @location(11) @interpolate(flat, either) shadow_x: vec4f,   // rows of sun_from_relative
    @location(12) @interpolate(flat, either) shadow_y: vec4f,
    @location(13) @interpolate(flat, either) shadow_z: vec4f,
//@carried
}

// At depth 0, and exactly there: the depth test chooses between surface and background.
@vertex
fn vertex(@location(0) at: vec2f, @builtin(instance_index) part: u32) -> Corner {
    let v = view_uniform;
    let l = light_uniform;
    let shadow = transpose(l.sun_from_relative);
    var corner: Corner;
    corner.clip = vec4f(at, 0.0, 1.0);
    corner.part = vec4u(part, v.orthographic, v.sample_index, v.first_pixel);
    corner.view_x = vec4f(v.view_from_world[0], v.near);
    corner.view_y = vec4f(v.view_from_world[1], v.far);
    corner.view_z = vec4f(v.view_from_world[2], v.haze);
    corner.across = v.across_from_pixel;
    corner.sun = vec4f(l.sun, l.shadow_depth_step);
    corner.to_sun = vec4f(l.to_sun, l.shadow_scale);
    corner.sky = vec4f(l.sky, l.scene_radius);
    corner.ground = vec4f(l.ground, v.size.x);
    corner.zenith = vec4f(l.zenith, v.size.y);
    corner.horizon = vec4f(l.horizon, l.shadow_levels);
    corner.shadow_x = shadow[0];
    corner.shadow_y = shadow[1];
    corner.shadow_z = shadow[2];
    carry(&corner);
    return corner;
}

// Values that are not carried are seldom read.
fn take(in: Corner) {
    view.view_from_world = mat3x3f(in.view_x.xyz, in.view_y.xyz, in.view_z.xyz);
    view.projection = view_uniform.projection;
    view.across_from_pixel = in.across;
    view.near = in.view_x.w;
    view.far = in.view_y.w;
    view.orthographic = in.part.y;
    view.sample_index = in.part.z;
    view.first_pixel = in.part.w;
    view.eye_whole = view_uniform.eye_whole;
    view.eye_fraction = view_uniform.eye_fraction;
    view.size = vec2f(in.ground.w, in.zenith.w);
    view.haze = in.view_z.w;
    light.to_sun = in.to_sun.xyz;
    light.shadow_scale = in.to_sun.w;
    light.shadow_levels = in.horizon.w;
    light.sun = in.sun.xyz;
    light.shadow_depth_step = in.sun.w;
    light.sky = in.sky.xyz;
    light.ground = in.ground.xyz;
    light.sun_from_relative = transpose(mat4x4f(in.shadow_x, in.shadow_y, in.shadow_z, vec4f(0.0, 0.0, 0.0, 1.0)));
    light.zenith = in.zenith.xyz;
    light.horizon = in.horizon.xyz;
    light.scene_radius = in.sky.w;
    if GROUND_FADES {
        light.fade = light_uniform.fade;
        light.fade_width = light_uniform.fade_width;
    }
    if SKY_SHADOWS {
        light.to_sky = light_uniform.to_sky;
        light.sky_scale = light_uniform.sky_scale;
        light.sky_depth_step = light_uniform.sky_depth_step;
        light.sky_levels = light_uniform.sky_levels;
        light.sky_weight = light_uniform.sky_weight;
        light.sky_spread = light_uniform.sky_spread;
        light.sky_from_relative = light_uniform.sky_from_relative;
    }
    take_own(in);
}

//@handlers

// Whether the frame's sun is that of what is shaded.
var<private> is_kept: bool = true;

fn finished(paint: vec4f, point: Point, pixel: vec2i, classes: Classes) -> vec4f {
    let seen = outlines(gridded(paint, pixel), pixel, classes);
    write_classes(pixel, point, classes);
    is_kept = is_lit_here(point);
    if SUMMED {
        return vec4f(seen.rgb * seen.a, seen.a);
    }
    return seen;
}

// Where something stands: the stored depth is not 0. The depth test chooses, so that neither shader runs in vain.
@fragment
fn surface(in: Corner) -> @location(0) vec4f {
    take(in);
    let pixel = vec2i(in.clip.xy);
    let paint = paint_of_surface(pixel, in.clip.xy, textureLoad(scene_depth, pixel, 0), in.part.x);
    if !is_kept {
        discard;
    }
    return paint;
}

// Where nothing stands: the stored depth is its clear value, 0.
@fragment
fn background(in: Corner) -> @location(0) vec4f {
    take(in);
    let paint = paint_of_background(vec2i(in.clip.xy), in.clip.xy, in.part.x);
    if !is_kept {
        discard;
    }
    return paint;
}

// Pixels as a neighbourhood filter reads them: colours times opacity, and of a transparent picture opacity.
struct Unfiltered {
    @location(0) color: vec4u,
    @location(1) opacity: vec4u,
}

// Four pixels that lie side by side are one of its texels, whatever stands there.
@fragment
fn unfiltered(in: Corner) -> Unfiltered {
    take(in);
    let first = vec2i(in.clip.xy) * vec2i(4, 1);
    var four: Unfiltered;
    for (var i = 0; i < 4; i++) {
        let pixel = first + vec2i(i, 0);
        let middle = vec2f(pixel) + 0.5;
        // Asked of the codes: many plans need no depth.
        var paint = paint_of_background(pixel, middle, in.part.x);
        if textureLoad(codes, pixel, 0).x != 0u {
            paint = paint_of_surface(pixel, middle, textureLoad(scene_depth, pixel, 0), in.part.x);
        }
        four.color = vec4u(four.color.yzw, packed(paint.rgb * (paint.a / headroom())));
        four.opacity = vec4u(four.opacity.yzw, packed(vec3f(paint.a)));
        // Here, not at the beginning: a software adapter goes through a whole round to find that there is none.
        if i == 3 {
            break;
        }
    }
    return four;
}

fn paint_of_surface(pixel: vec2i, middle: vec2f, depth: f32, part: u32) -> vec4f {
    see_object(surface_shown(textureLoad(codes, pixel, 0).x - 1u).object);
    see_pixel(middle, distance_of_depth(depth));
    let ray = ray_of_pixel(middle);
    var point = point_at(pixel, ray, depth);
    let classes = classes_at(sight_of_point(point, ray), part);
    let color = shade(&point, classes);
    return finished(vec4f(color, select(1.0, not_faded(point), BACKGROUND == NOTHING)), point, pixel, classes);
}

fn paint_of_background(pixel: vec2i, middle: vec2f, part: u32) -> vec4f {
    see_object(NO_OBJECT);
    see_pixel(middle, FAR_AWAY);
    let ray = ray_of_pixel(middle);
    let paint = vec4f(behind_city(ray.direction * view.view_from_world), select(1.0, 0.0, BACKGROUND == NOTHING));
    let point = nowhere(pixel);
    let classes = classes_at(sight_at(pixel, ray, 0.0, NO_OBJECT), part);
    return finished(vec4f(styled(paint.rgb, point, classes), paint.a), point, pixel, classes);
}
