// How far a place is from the closed forms, metres, negative inside; of what is nowhere FAR_AWAY. Twin:
// `veduta::geom::Volume::signed_distance`. `border`: as `lib/border.wgsl` has it, for flat lenses.

fn distance_to_box(p: vec3f, half: vec3f) -> f32 {
    let q = abs(p) - half;
    return length(max(q, vec3f(0.0))) + min(max(q.x, max(q.y, q.z)), 0.0);
}

fn distance_to_cylinder(along: f32, away: f32, radius: f32, half: f32) -> f32 {
    let q = vec2f(away - radius, abs(along) - half);
    return length(max(q, vec2f(0.0))) + min(max(q.x, q.y), 0.0);
}

// The nearest point x has x_i = e_i^2 y_i / (t + e_i^2) with t the largest root of sum (e_i y_i / (t + e_i^2))^2 = 1, counted from
// -min e_i^2 (Eberly). Newton's steps come from the left and never go past it: the sum is convex and falls.
fn distance_to_ellipsoid(p: vec3f, radii: vec3f) -> f32 {
    let scale = max(radii.x, max(radii.y, radii.z));
    let e = radii / scale;
    let y = max(abs(p) / scale, vec3f(1e-6) * e);
    let least = min(e.x, min(e.y, e.z));
    let above = (e - least) * (e + least);
    let ey = e * y;
    // Each term alone is at most 1 there.
    var s = max(max(ey.x - above.x, ey.y - above.y), ey.z - above.z);
    s = max(s, 1e-12);
    for (var i = 0; i < 12; i++) {
        let q = ey / (s + above);
        let left = dot(q, q) - 1.0;
        let fall = 2.0 * dot(q * q, 1.0 / (s + above));
        s += max(left, 0.0) / fall;
    }
    let nearest = e * ey / (s + above);
    let apart = length(y - nearest) * scale;
    let inside = p / radii;
    return select(apart, -apart, dot(inside, inside) <= 1.0);
}

fn distance_to_segment(p: vec2f, a: vec2f, b: vec2f) -> f32 {
    let along = b - a;
    return length(p - a - clamp(dot(p - a, along) / max(dot(along, along), 1e-30), 0.0, 1.0) * along);
}

// `p`: away from the axis, along it.
fn distance_to_frustum(p: vec2f, s: Shape) -> f32 {
    let bottom = vec2f(max(s.size_x - s.size_y * s.size_z, 0.0), -s.size_z);
    let top = vec2f(max(s.size_x + s.size_y * s.size_z, 0.0), s.size_z);
    let side = normalize(top - bottom);
    let up = p - bottom;
    let within = max(up.x * side.y - up.y * side.x, abs(p.y) - s.size_z);
    let beyond = min(distance_to_segment(p, bottom, top),
                     min(distance_to_segment(p, vec2f(0.0, bottom.y), bottom), distance_to_segment(p, vec2f(0.0, top.y), top)));
    return select(beyond, within, within <= 0.0);
}

fn distance_to_sides(first: u32, count: u32, p: vec2f) -> f32 {
    var least = FAR_AWAY;
    for (var i = first; i < first + count; i++) {
        least = min(least, distance_to_segment(p, planes[i].xy, planes[i].zw));
    }
    return select(least, -least, is_in_polygon(first, count, p));
}

// In the figure's plane, across its outline; what is before the plane is outside altogether. In pixels: those of the plane.
fn distance_to_flat(s: Shape, sight: Sight, border: vec4f) -> f32 {
    let a = sight.ray.origin + sight.ray.direction;
    let w = dot(s.axis_z, a);
    let at = clamp(vec2f(dot(s.axis_x, a), dot(s.axis_y, a)) / w, vec2f(-1e15), vec2f(1e15));
    let enter = clamp(dot(s.center, a) / w, -FAR_AWAY, FAR_AWAY);
    let is_behind_plane = w > 1e-20 && sight.distance >= enter && (sight.is_parallel || (enter > 0.0 && sight.distance > 0.0));
    var across = length(at) - s.size_x;
    if s.size_z == POLYGON {
        across = distance_to_sides(u32(s.size_x), u32(s.size_y), at);
    } else if s.size_z == RECTANGLE {
        across = distance_to_box(vec3f(at, 0.0), vec3f(s.size_x, s.size_y, 1e30));
    }
    let further = select(sight.distance / enter, 1.0, border.y < 0.5 || sight.is_parallel);
    return select(FAR_AWAY, across * further, is_behind_plane);
}

// Of a closed form.
fn distance_to_shape(s: Shape, kind: u32, sight: Sight, border: vec4f) -> f32 {
    if kind == FLAT {
        return distance_to_flat(s, sight, border);
    }
    let o = select(sight.position, vec3f(0.0), sight.distance >= FAR_AWAY) - s.center;
    let along = dot(o, s.axis_z);
    let away = length(o - along * s.axis_z);
    var distance = FAR_AWAY;
    switch kind {
        case SPHERE: { distance = length(o) - s.size_x; }
        case BOX: {
            distance = distance_to_box(vec3f(dot(o, s.axis_x), dot(o, s.axis_y), along), vec3f(s.size_x, s.size_y, s.size_z));
        }
        case CYLINDER: { distance = distance_to_cylinder(along, away, s.size_x, s.size_z); }
        case ELLIPSOID: {
            // Its axes are as long as one over its radii.
            let radii = 1.0 / vec3f(length(s.axis_x), length(s.axis_y), length(s.axis_z));
            distance = distance_to_ellipsoid(in_ellipsoid(s, o) * radii, radii);
        }
        case FRUSTUM: { distance = distance_to_frustum(vec2f(away, along), s); }
        default: {}
    }
    return select(distance, FAR_AWAY, sight.distance >= FAR_AWAY);
}
