// What pixels in lenses that move corners show: the city's triangles, cut into smaller ones, whose corners are where the lenses show them; the sides
// between them are straight.

override SMOOTH: bool = false;      // whether some faces of the picture have a normal per vertex

// The parts of a triangle that is cut so many times along each side lie in rows, the first at its first corner.
struct Moved {
    @builtin(position) @invariant clip: vec4f,
    @location(0) @interpolate(flat, either) hit: vec2u,     // where the triangle's words begin, and its city
    @location(1) weights: vec2f,                            // of its second and third corner
    @location(2) is_shown: f32,                             // less than 1 where a corner is shown nowhere
}

fn clip_of(p: vec3f) -> vec4f {
    let distance = -p.z;
    let is_flat = view.orthographic == 1u;
    let w = select(distance, 1.0, is_flat);
    let z = select(view.near, (view.far - distance) / (view.far - view.near), is_flat);
    return vec4f(p.xy * view.projection.xy + view.projection.zw * w, z, w);
}

// A corner in view space.
fn corner_in_view(city: u32, words: vec4u) -> vec3f {
    let own = ray_cities.all[city];
    let relative = (vec3f(vec3i(words.xyz) - own.eye) - own.eye_fraction) * own.from_view_x.w;
    return view.view_from_world * (mat3x3f(own.world_x.xyz, own.world_y.xyz, own.world_z.xyz) * relative);
}

// `piece`: where the triangle's words begin, its city, and how often each side is cut.
@vertex
fn vertex_moved(@builtin(vertex_index) index: u32, @location(0) piece: vec3u) -> Moved {
    let part = index / 3u;
    let row = u32(sqrt(f32(part) + 0.5));
    let along = part - row * row;
    let is_down = (along & 1u) == 1u;
    // Corners of the part: a row, and a place in it.
    let k = index % 3u;
    let down = select(select(vec2u(row + 1u, along / 2u + 1u), vec2u(row, along / 2u + 1u), k == 2u), vec2u(row, along / 2u), k == 0u);
    let up = select(vec2u(row + 1u, along / 2u + k - 1u), vec2u(row, along / 2u), k == 0u);
    let at = vec2f(select(up, down, is_down)) / f32(piece.z);
    let weights = vec2f(at.x - at.y, at.y);
    let a = corner_in_view(piece.y, ray_words[piece.x]);
    let b = corner_in_view(piece.y, ray_words[piece.x + 1u]);
    let c = corner_in_view(piece.y, ray_words[piece.x + 2u]);
    let p = a + weights.x * (b - a) + weights.y * (c - a);
    see_object(NO_OBJECT);
    let shown = displayed(p);
    let is_shown = shown.z < 0.0 || shown.z == p.z;
    let clip = select(vec4f(0.0, 0.0, 0.0, 1.0), clip_of(shown), is_shown);
    return Moved(clip, piece.xy, weights, select(0.0, 1.0, is_shown));
}

// Whether a pixel shows what lenses that move corners make of the city, and no lens that finds it otherwise.
fn is_moved(pixel: vec2f) -> bool {
    let over = lenses_over(pixel);
    return (over & ray_lenses.moved) != 0u && (over & (ray_lenses.followed | ray_lenses.warped)) == 0u;
}

@fragment
fn moved(in: Moved) -> Followed {
    if !is_moved(in.clip.xy) || in.is_shown < 0.9999 || in.clip.z <= 0.0 {
        discard;
    }
    let at = in.clip.xy;
    var hit = Hit(distance_of_depth(in.clip.z), in.hit.x, in.hit.y, in.weights);
    see_object(NO_OBJECT);
    let line = bent_ray(across_of_pixel(at), hit.t);
    let kind = ray_words[hit.triangle + 1u].w;
    // How far it is, its own plane says, not the corners around.
    let met = plane_met(hit, line);
    hit.t = select(hit.t, met.z, met.z > 0.5 * hit.t && met.z < 2.0 * hit.t);
    hit.weights = select(hit.weights, met.xy, hit.t == met.z);
    begin_city(hit.city);
    seen_ray = line;
    seen_pixel = at;
    asked_pixel = at;
    if !is_there(line, at, hit) {
        discard;
    }
    let look = look_of(at, hit);
    // Of faces of one plane the last is the nearest by the least that there is.
    let layer = select(0u, (kind >> TRIANGLE_LAYER_SHIFT) & TRIANGLE_LAYERS, (kind & TRIANGLE_IN_PLANE) != 0u);
    let depth = depth_of_distance(hit.t);
    return Followed(vec2u(code_of(hit), look.normal), vec4f(look.color, look.facade), depth, vec2u(hit.triangle + 1u, hit.city),
                    bitcast<f32>(bitcast<u32>(depth) + layer));
}

// Nothing, where they will be.
@vertex
fn vertex(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
    return vec4f(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn cleared(@builtin(position) place: vec4f) -> Followed {
    if !is_moved(place.xy) {
        discard;
    }
    var nothing: Followed;
    return nothing;
}
