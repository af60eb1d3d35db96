// Deferred shading of the shown surface, and what the lenses make of it.
//
// What the scene's context and lenses do stands in `shade` and `styled`, which are put together from the scene: by the
// specialised back end, which writes out what is asked for and nothing else (U3), or by the uber back end, which reads
// it from a table. Moving a lens or turning a parameter changes uniforms only.

override SUMMED: bool = false;      // weighted by coverage, to be summed over samples

struct Corner {
    @builtin(position) @invariant clip: vec4f,
    @location(0) @interpolate(flat, either) part: u32,      // of the picture: the context's, or the lenses'
}

// At depth 0, and exactly there: the depth test chooses between surface and background.
@vertex
fn vertex(@builtin(vertex_index) i: u32, @builtin(instance_index) part: u32) -> Corner {
    return Corner(vec4f(f32(i32(i & 1u) * 4 - 1), f32(i32(i >> 1u) * 4 - 1), 0.0, 1.0), part);
}

//@handlers

fn finished(paint: vec4f, point: Point, pixel: vec2i, classes: Classes) -> vec4f {
    let seen = outlines(paint, pixel, classes);
    write_classes(pixel, point, classes);
    if SUMMED {
        return vec4f(seen.rgb * seen.a, seen.a);
    }
    return seen;
}

// Where something stands: the stored depth is not 0. The depth test chooses, so that neither shader runs in vain.
@fragment
fn surface(in: Corner) -> @location(0) vec4f {
    return paint_of_surface(in);
}

// Where nothing stands: the stored depth is its clear value, 0.
@fragment
fn background(in: Corner) -> @location(0) vec4f {
    return paint_of_background(in);
}

// What a neighbourhood filter reads: colours times opacity, and of a transparent picture opacity.
struct Unfiltered {
    @location(0) color: u32,
    @location(1) opacity: u32,
}

fn unfiltered(paint: vec4f) -> Unfiltered {
    return Unfiltered(packed(paint.rgb * paint.a), packed(vec3f(paint.a)));
}

@fragment
fn surface_unfiltered(in: Corner) -> Unfiltered {
    return unfiltered(paint_of_surface(in));
}

@fragment
fn background_unfiltered(in: Corner) -> Unfiltered {
    return unfiltered(paint_of_background(in));
}

fn paint_of_surface(in: Corner) -> vec4f {
    let pixel = vec2i(in.clip.xy);
    let ray = ray_of_pixel(in.clip.xy);
    var point = point_at(pixel, ray, textureLoad(scene_depth, pixel, 0));
    let classes = classes_at(sight_at(pixel, ray, point.depth), in.part);
    return finished(vec4f(shade(&point, classes), 1.0), point, pixel, classes);
}

fn paint_of_background(in: Corner) -> vec4f {
    let pixel = vec2i(in.clip.xy);
    let ray = ray_of_pixel(in.clip.xy);
    var paint = vec4f(0.0);
    if BACKGROUND == SKY {
        paint = vec4f(sky_color(ray.direction * view.view_from_world), 1.0);
    } else if BACKGROUND == ONE_COLOR {
        paint = vec4f(light.zenith, 1.0);
    }
    let point = nowhere(pixel);
    let classes = classes_at(sight_at(pixel, ray, 0.0), in.part);
    return finished(vec4f(styled(paint.rgb, point, classes), paint.a), point, pixel, classes);
}
