// The volumetric depth test by a sprite that has its own eye: a shown place is looked for in the sprite's own space, and its
// distance along the sprite's axis compared with those of the texel it falls on. Behind that eye and beside its frame nothing is
// in the lens, nor before it or behind it.

struct OwnSprite {
    // From the view space of the picture's eye to that of the sprite's.
    turn: mat3x3f,
    shift: vec3f,
    // Texels per metre across the axis (in perspective at a distance of one), and the texel that the axis goes through.
    scale: vec2f,
    middle: vec2f,
    // The part of the frame that is kept, and between which distances something is.
    low: vec2f,
    high: vec2f,
    nearest: f32,
    farthest: f32,
    is_parallel: bool,
    place: SpritePlace,
}

// The numbers of a region that is tested so.
struct OwnRows {
    first: u32,                 // b.x: number of the first of its rows among the planes
}

fn own_sprite(s: OwnRows) -> OwnSprite {
    let i = s.first;
    let x = planes[i];
    let y = planes[i + 1u];
    let z = planes[i + 2u];
    let projection = planes[i + 3u];
    let part = planes[i + 4u];
    let code = planes[i + 5u];
    let words = planes[i + 6u];
    let reach = planes[i + 7u];
    var place: SpritePlace;
    place.first = u32(words.x) << 16u | u32(words.y);
    place.width = u32(words.z);
    place.layers = u32(words.w);
    place.kind = u32(code.x);
    place.near = code.y;
    place.far = code.z;
    return OwnSprite(mat3x3f(x.xyz, y.xyz, z.xyz), vec3f(x.w, y.w, z.w), projection.xy, projection.zw, part.xy,
                     part.xy + part.zw, reach.x, reach.y, code.w > 0.5, place);
}

fn class_in_own(s: OwnRows, sight: Sight) -> u32 {
    let own = own_sprite(s);
    let p = own.turn * sight.position + own.shift;
    let distance = -p.z;
    let texel = p.xy * own.scale / select(distance, 1.0, own.is_parallel) + own.middle;
    if !(distance > 0.0 && all(texel >= own.low) && all(texel < own.high)) {
        return MISSED;
    }
    let at = min(vec2u(texel - own.low), vec2u(own.high - own.low) - 1u);
    return class_at_texel(own.place, at, distance);
}

// Keeps of a span where a linear function of the way along the ray is 0 or more.
fn kept(span: Span, at_origin: f32, slope: f32) -> Span {
    let t = -at_origin / slope;
    if slope == 0.0 {
        return Span(span.enter, select(span.exit, -FAR_AWAY, at_origin < 0.0));
    }
    return Span(select(span.enter, max(span.enter, t), slope > 0.0), select(span.exit, min(span.exit, t), slope < 0.0));
}

// Where a ray of the picture meets what the sprite's texels hold first and last, going from texel to texel (Amanatides and Woo
// 1987); `is_first_enough`: or where it first does.
fn ends_in_own(own: OwnSprite, ray: Ray, is_first_enough: bool) -> Span {
    let o = own.turn * ray.origin + own.shift;
    let d = own.turn * ray.direction;
    // What a place across the axis is divided by: linear along the ray, as its distance is.
    let w = select(vec2f(-o.z, -d.z), vec2f(1.0, 0.0), own.is_parallel);
    // A border between texels: this much right of it, or below it.
    let at_origin = o.xy * own.scale + own.middle * w.x;
    let slope = d.xy * own.scale + own.middle * w.y;
    var way = Span(select(0.0, -FAR_AWAY, view.orthographic == 1u), FAR_AWAY);
    way = kept(way, -o.z - own.nearest, -d.z);
    way = kept(way, own.farthest + o.z, d.z);
    way = kept(way, at_origin.x - own.low.x * w.x, slope.x - own.low.x * w.y);
    way = kept(way, at_origin.y - own.low.y * w.x, slope.y - own.low.y * w.y);
    way = kept(way, own.high.x * w.x - at_origin.x, own.high.x * w.y - slope.x);
    way = kept(way, own.high.y * w.x - at_origin.y, own.high.y * w.y - slope.y);
    var found = EMPTY_SPAN;
    if !(way.enter < way.exit) {
        return found;
    }
    let code = DepthCode(own.place.kind, own.place.near, own.place.far);
    let format = format_of(code);
    let size = vec2i(own.high - own.low);
    var t = way.enter;
    let begin = (at_origin + t * slope) / (w.x + t * w.y) - own.low;
    var cell = clamp(vec2i(floor(begin)), vec2i(0), size - 1);
    // Texels along the ray only grow, or only fall.
    let growth = slope * w.x - at_origin * w.y;
    let step = vec2i(sign(growth));
    for (var i = 0; i < size.x + size.y; i++) {
        let border = own.low + vec2f(cell) + vec2f(vec2<bool>(step > vec2i(0)));
        let crossing = -(at_origin - border * w.x) / (slope - border * w.y);
        let next = select(vec2f(FAR_AWAY), crossing, step != vec2i(0));
        let until = clamp(min(next.x, next.y), t, way.exit);
        // Along the sprite's axis.
        let from_to = vec2f(-o.z - t * d.z, -o.z - until * d.z);
        let near = min(from_to.x, from_to.y);
        let far = max(from_to.x, from_to.y);
        for (var layer = 0u; layer < own.place.layers; layer++) {
            let number = 2u * ((u32(cell.y) * own.place.width + u32(cell.x)) * own.place.layers + layer);
            let entry_code = sprite_code(own.place, number, format);
            let exit_code = sprite_code(own.place, number + 1u, format);
            if exit_code == nearest_code(code) {
                break;
            }
            let entry = select(distance_of(code, entry_code), -FAR_AWAY, entry_code == nearest_code(code));
            let exit = select(distance_of(code, exit_code), FAR_AWAY, exit_code == farthest_code(code));
            let both = vec2f(max(near, entry), min(far, exit));
            if both.x > both.y {
                continue;
            }
            var ends = vec2f(t, until);
            if abs(d.z) > 1e-6 {
                let of_both = -(both + o.z) / d.z;
                ends = clamp(vec2f(min(of_both.x, of_both.y), max(of_both.x, of_both.y)), vec2f(t), vec2f(until));
            }
            found = Span(select(min(found.enter, ends.x), ends.x, found.enter > found.exit), ends.y);
        }
        if until >= way.exit || (is_first_enough && found.enter <= found.exit) {
            break;
        }
        cell += select(vec2i(0, step.y), vec2i(step.x, 0), next.x <= next.y);
        if any(cell < vec2i(0)) || any(cell >= size) {
            break;
        }
        t = until;
    }
    return found;
}

fn span_in_own(s: OwnRows, ray: Ray) -> Span {
    return ends_in_own(own_sprite(s), ray, false);
}

// Whether the ray of a pixel's centre meets it.
fn covers_own(s: OwnRows, pixel: vec2i) -> bool {
    let span = ends_in_own(own_sprite(s), ray_of_pixel(vec2f(pixel) + 0.5), true);
    return span.enter <= span.exit;
}
