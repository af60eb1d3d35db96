// The body between planes.

struct Convex {
    first: u32,                 // b.x: number of its first plane
    count: u32,                 // b.y: how many there are
}

fn convex_holds(s: Convex, sight: Sight) -> bool {
    var is_below = true;
    for (var i = s.first; i < s.first + s.count; i++) {
        let slack = ON_FACE * max(abs(sight.distance), abs(planes[i].w)) + sight.off;
        is_below = is_below && dot(planes[i].xyz, sight.position) <= planes[i].w + slack;
        // Here, not at the beginning: a software adapter goes through a whole round to find that there is none.
        if i + 1u == s.first + s.count {
            break;
        }
    }
    return is_below;
}

fn span_of_convex(ray: Ray, s: Convex) -> Span {
    var span = Span(-FAR_AWAY, FAR_AWAY);
    for (var i = s.first; i < s.first + s.count; i++) {
        let plane = planes[i];
        let slope = dot(plane.xyz, ray.direction);
        let room = plane.w - dot(plane.xyz, ray.origin);
        if abs(slope) < 8.271806e-25 {
            if room < 0.0 {
                return EMPTY_SPAN;
            }
        } else if slope > 0.0 {
            span.exit = min(span.exit, room / slope);
        } else {
            span.enter = max(span.enter, room / slope);
        }
    }
    return span;
}

// Whoever asks for it makes a solid of the hull.
fn distance_to_convex(s: Convex, sight: Sight, border: vec4f) -> f32 {
    return FAR_AWAY;
}
