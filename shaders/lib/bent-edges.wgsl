// Where lenses that bend rays show the places of edges.

// Parts of an edge that lenses bend: each is drawn straight.
const EDGE_PARTS: u32 = 12u;

// A place of the picture at which a plane shows what lies at D, as without it `across` has it: the inverse of what it does to rays, by itself.
fn shown_by_plane(lens: u32, across: vec2f, distance: f32) -> vec2f {
    let own = ray_lens(lens);
    let share = rim_share(lens, across);
    if distance <= own.distance || share >= 1.0 || own.outline == OUTLINE_FIELD || !acts(lens) {
        return across;
    }
    let e = select(1.0 / own.distance, 0.0, view.orthographic == 1u);
    let z = min(distance, own.until) - own.distance;
    // Of the radius r its core takes this part: r (1 - (1-k) taken) is where it is without it, k rising over the border.
    let taken = z * own.power / (1.0 + z * e);
    let core = 1.0 - own.border;
    var radius = share / (1.0 - taken);
    if radius > core && own.border > 0.0 {
        let a = taken / own.border;
        let b = 1.0 - taken - a * core;
        radius = select((sqrt(max(b * b + 4.0 * a * share, 0.0)) - b) / (2.0 * a), share / b, abs(a) < 1e-6);
    }
    let scale = select(1.0 / (1.0 - taken), radius / share, share > 1e-6);
    return own.center + min(radius / max(share, 1e-6), scale) * (across - own.center);
}

// Where the ray of a place of the picture is at D, as without lenses the picture has it.
fn seen_by_planes(across: vec2f, distance: f32) -> vec2f {
    let ray = bent_by_planes(across, distance);
    let at = ray.origin.xy + distance * ray.direction.xy;
    return select(at / distance, at, view.orthographic == 1u);
}

// The place of the picture at which planes show it.
fn shown_by_planes(across: vec2f, distance: f32) -> vec2f {
    var found = across;
    for (var i = 0u; i < RAY_PLANES; i++) {
        found = shown_by_plane(RAY_IMAGES + i, found, distance);
    }
    // Several bend what others have bent; and a field knows no radius.
    var rounds = select(0u, 12u, RAY_PLANES > 1u);
    for (var i = 0u; i < RAY_PLANES; i++) {
        rounds = max(rounds, select(0u, 40u, ray_lens(RAY_IMAGES + i).outline == OUTLINE_FIELD));
    }
    for (var i = 0u; i < rounds; i++) {
        found += across - seen_by_planes(found, distance);
    }
    return found;
}

// The place of the lens at which a sampling-rate lens shows one of the picture.
fn shown_by_sampling(lens: u32, across: vec2f) -> vec2f {
    let share = rim_share(lens, across);
    if share >= 1.0 || share < 1e-6 {
        return across;
    }
    var low = 0.0;
    var high = 1.0;
    for (var i = 0; i < 20; i++) {
        let middle = 0.5 * (low + high);
        if middle * sampled_scale(lens, middle) < share {
            low = middle;
        } else {
            high = middle;
        }
    }
    let center = ray_lens(lens).center;
    return center + 0.5 * (low + high) / share * (across - center);
}

// The place of the picture at which a fisheye shows a place, and how far it is; beyond its rim: z < 0.
fn shown_by_fisheye(lens: u32, p: vec3f) -> vec3f {
    let own = ray_lens(lens);
    let middle = select(own.center, vec2f(0.0), view.orthographic == 1u);
    let forward = normalize(vec3f(middle, -1.0));
    let right = normalize(vec3f(-forward.z, 0.0, forward.x));
    let up = cross(right, forward);
    let distance = length(p);
    let aside = vec2f(dot(p, right), dot(p, up));
    let size = length(aside);
    let turn = atan2(size, dot(p, forward));
    let is_angular = own.kind == RAY_ANGULAR;
    let share = select(sin(turn) / sin(own.angle), turn / own.angle, is_angular);
    let is_in = share < 1.0 && (is_angular || dot(p, forward) >= 0.0);
    let way = select(vec2f(0.0), aside / size, size > 0.0);
    return vec3f(own.center + own.radius * share * way, select(-1.0, distance, is_in));
}

// Where it is looked for first along each axis of the square around the lens, and how often it is looked for nearer.
const OWN_STARTS: i32 = 5;
const OWN_ROUNDS: i32 = 10;
// How near it is found: of a radian, or of the radius of a lens of parallel rays.
const OWN_NEAR_ENOUGH: f32 = 1e-3;

// What a lens of a user's handler shows at a place of it, as a direction; with parallel rays as a place of the picture, in radii.
fn own_shown(lens: u32, across: vec2f) -> vec3f {
    let seen = own_seen(lens, across);
    let flat = vec3f((seen.xy / seen.z - ray_lens(lens).center) / ray_lens(lens).radius, 0.0);
    return select(normalize(vec3f(seen.xy, -seen.z)), flat, view.orthographic == 1u);
}

// The place of the picture at which a lens of a user's handler shows a place of view space, and how far that is along its ray; z < 0: at none that
// is found. Its inverse nobody says: from the nearest of some places on it is looked for by differences (Gauss and Newton).
fn shown_by_own(lens: u32, p: vec3f) -> vec3f {
    let own = ray_lens(lens);
    let is_flat = view.orthographic == 1u;
    let wanted = select(normalize(p), vec3f((p.xy - own.center) / own.radius, 0.0), is_flat);
    var at = select(own.center, p.xy / -p.z, p.z < 0.0);
    at = select(at, p.xy, is_flat);
    var away = select(FAR_AWAY, length(own_shown(lens, at) - wanted), rim_share(lens, at) < 1.0);
    for (var i = 0; i < OWN_STARTS * OWN_STARTS; i++) {
        let place = vec2f(f32(i % OWN_STARTS), f32(i / OWN_STARTS)) * (2.0 / f32(OWN_STARTS - 1)) - 1.0;
        let start = own.center + 0.9 * own.radius * place;
        let off = length(own_shown(lens, start) - wanted);
        let is_nearer = off < away && rim_share(lens, start) < 1.0;
        away = select(away, off, is_nearer);
        at = select(at, start, is_nearer);
    }
    let step = 1e-3 * own.radius;
    for (var i = 0; i < OWN_ROUNDS && away > 0.01 * OWN_NEAR_ENOUGH; i++) {
        let off = own_shown(lens, at) - wanted;
        let x = (own_shown(lens, at + vec2f(step, 0.0)) - wanted - off) / step;
        let y = (own_shown(lens, at + vec2f(0.0, step)) - wanted - off) / step;
        let both = mat2x2f(dot(x, x), dot(x, y), dot(x, y), dot(y, y));
        let turned = vec2f(dot(x, off), dot(y, off));
        let determinant = determinant(both);
        let by = vec2f(both[1][1] * turned.x - both[0][1] * turned.y, both[0][0] * turned.y - both[0][1] * turned.x) / determinant;
        // No farther than the lens at once.
        let way = by * min(1.0, own.radius / max(length(by), 1e-30));
        let next = select(at, at - way, determinant > 1e-20);
        let now = length(own_shown(lens, next) - wanted);
        at = select(at, next, now < away);
        away = min(away, now);
    }
    let is_in = away < OWN_NEAR_ENOUGH && rim_share(lens, at) < 1.0;
    let is_place = is_place_of_picture(own_seen(lens, at)) & (p.z < 0.0);
    return vec3f(at, select(-1.0, select(length(p), -p.z, is_place | is_flat), is_in));
}

// Where a place would be, in view space, if no lens bent the ray that shows it.
fn displayed(p: vec3f) -> vec3f {
    let is_flat = view.orthographic == 1u;
    let distance = -p.z;
    var shown = p;
    if distance > 0.0 {
        let across = shown_by_planes(p.xy / select(distance, 1.0, is_flat), distance);
        shown = vec3f(across * select(distance, 1.0, is_flat), p.z);
    }
    for (var k = 0u; k < RAY_IMAGES; k++) {
        // The lowest first.
        let lens = RAY_IMAGES - 1u - k;
        let is_sampled = ray_lens(lens).kind == RAY_SAMPLED;
        let scale = select(max(-shown.z, view.near), 1.0, is_flat);
        let is_within = shown.z < 0.0 && rim_share(lens, shown.xy / scale) < 1.0;
        let is_own = HAS_OWN_RAYS & (ray_lens(lens).kind == RAY_OWN);
        var at = vec3f(0.0);
        if is_own {
            at = shown_by_own(lens, shown);
        } else {
            at = shown_by_fisheye(lens, p);
        }
        if !acts(lens) {
            continue;
        }
        if is_sampled && is_within {
            shown = vec3f(shown_by_sampling(lens, shown.xy / scale) * scale, shown.z);
        } else if !is_sampled && at.z >= 0.0 {
            shown = vec3f(at.xy * select(at.z, 1.0, is_flat), -at.z);
        } else if !is_sampled && is_within {
            // It shows something else there.
            shown = vec3f(0.0, 0.0, 1.0);
        }
    }
    return shown;
}

// Whether what is between two places may be in a lens.
fn may_be_bent(p: vec3f, q: vec3f) -> bool {
    let is_flat = view.orthographic == 1u;
    let is_before = (p.z >= -view.near) | (q.z >= -view.near);
    if is_before & !is_flat {
        return true;
    }
    let a = p.xy / select(-p.z, 1.0, is_flat);
    let b = q.xy / select(-q.z, 1.0, is_flat);
    var may = false;
    for (var lens = 0u; lens < RAY_IMAGES + RAY_PLANES; lens++) {
        let own = ray_lens(lens);
        let along = b - a;
        let t = clamp(dot(own.center - a, along) / max(dot(along, along), 1e-30), 0.0, 1.0);
        may |= length(a + t * along - own.center) < 1.42 * own.radius || own.kind >= RAY_ANGULAR;
    }
    return may;
}

// The ends of a part of an edge where they are shown; in one part what no lens bends. Whether the edge goes on beyond its start, and its end.
fn bent_part(p: ptr<function, vec3f>, q: ptr<function, vec3f>, part: u32) -> vec2<bool> {
    if !may_be_bent(*p, *q) {
        if part > 0u {
            *q = *p;
        }
        return vec2<bool>(false);
    }
    let a = *p;
    let b = *q;
    *p = displayed(mix(a, b, f32(part) / f32(EDGE_PARTS)));
    *q = displayed(mix(a, b, f32(part + 1u) / f32(EDGE_PARTS)));
    return vec2<bool>(part > 0u, part + 1u < EDGE_PARTS);
}
