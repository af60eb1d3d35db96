// Fields (volumes) that stand in the city: values on regular grids, as what their ramps make of them. What a ray meets of them is summed between
// the layers of its pixel, nearest first (Wang et al., section 4; Max 1995). Twin: `veduta::field::march`.
//
// A ramp says how much light a metre takes away (extinction) and in which colour it gives that back. A cell of the walk takes that of its middle for
// all of it: fields that do not change are exact. Cells end at the layers of the pixel, at the ends of a field, and where a ray bends.

struct Field {
    to_x: vec4f,                // rows: from places in view space, metres, to samples along the axes of its grid
    to_y: vec4f,
    to_z: vec4f,
    low: vec3f,                 // where it begins and ends, in samples
    mode: u32,                  // FIELD_*
    high: vec3f,
    flags: u32,
    last: vec3f,                // of its samples
    first_slice: u32,           // in the texture
    scale: f32,                 // from texels to places on its ramp, 0..1
    shift: f32,
    level: f32,                 // of its surface, a place on its ramp
    steepest: f32,              // of its gradients, places on the ramp per metre
    thickness: f32,             // over which a thing of one layer takes light away, metres
    first_brick: u32,           // its first slice of bricks
    ramp: u32,                  // its first entry of the ramps
    object: u32,                // its number among objects, for lenses that mean objects
    begin_hour: i32,            // the moments from which and up to which it is there
    begin_micro: u32,
    end_hour: i32,
    end_micro: u32,
}

struct FieldTable {
    count: u32,
    is_jittered: u32,
    step: f32,                  // metres
    reserved: f32,
    each: array<Field, 4>,
    ramps: array<vec4f, 1024>,  // colour, linear; extinction, 1 / metres
}

@group(3) @binding(4) var<uniform> fields: FieldTable;
@group(3) @binding(5) var field_texels: texture_3d<f32>;
@group(3) @binding(6) var field_bricks: texture_3d<u32>;   // 1 where something of a brick is seen

// What there is among the fields of a picture: a software adapter goes through both sides of every branch.
override FIELDS_WALKED: bool = true;        // some are no surfaces, and not one layer
override FIELDS_SURFACES: bool = true;
override FIELDS_PROJECTED: bool = true;
override FIELDS_LIT: bool = true;
override FIELDS_SHADOWED: bool = true;
override FIELDS_LABELS: bool = true;
override FIELDS_NUMBERS: bool = true;       // some are no labels
override FIELDS_STEEP: bool = true;

const FIELD_DIRECT: u32 = 0u;
const FIELD_ABSORBS: u32 = 1u;      // takes light away and gives none
const FIELD_SURFACE: u32 = 2u;
const FIELD_PROJECTED: u32 = 3u;    // from here on: one layer
const FIELD_MAXIMUM: u32 = 3u;
const FIELD_MINIMUM: u32 = 4u;
const FIELD_MEAN: u32 = 5u;

const FIELD_LIT: u32 = 1u;
const FIELD_SHADOWED: u32 = 2u;
const FIELD_LABELS: u32 = 4u;       // numbers of things that are seen, from 1, not to be mixed; 0: nothing
const FIELD_STEEP: u32 = 8u;        // seen as far as it changes
const FIELD_SLICE: u32 = 16u;       // its surface is a plane across its first axis; the next two bits: across its second, its third
const FIELD_SLICES: u32 = 112u;
const FIELD_KEPT: u32 = 128u;       // lenses take nothing of it away

const RAMP_ENTRIES: f32 = 256.0;
const BRICK: f32 = 8.0;
// Texels below are no values: those without one are 1e11 times as far.
const NO_VALUE: f32 = -1e27;
// Less light let through than this is not seen.
const LEAST_THROUGH: f32 = 5.9604645e-8;

// Up to where fields are laid already, D.
var<private> fields_until: f32;
// Of each that is one layer: where it is, D; the place on its ramp; 1 until it is laid.
var<private> projected: array<vec3f, 4>;

fn texel_of_field(number: u32, at: vec3i) -> f32 {
    return textureLoad(field_texels, at + vec3i(0, 0, i32(fields.each[number].first_slice)), 0).x;
}

fn ramp_entry(number: u32, entry: i32) -> vec4f {
    return fields.ramps[fields.each[number].ramp + u32(entry)];
}

fn on_ramp(number: u32, value: f32) -> vec4f {
    let at = clamp(value, 0.0, 1.0) * (RAMP_ENTRIES - 1.0);
    let low = min(floor(at), RAMP_ENTRIES - 2.0);
    let share = at - low;
    let a = ramp_entry(number, i32(low));
    let b = ramp_entry(number, i32(low) + 1);
    let extinction = a.w * (1.0 - share) + b.w * share;
    return select(vec4f(a.rgb * (1.0 - share) + b.rgb * share, extinction), vec4f(0.0), value < NO_VALUE);
}

// The eight samples around a place, and how much each has of it.
struct FieldCorners {
    low: vec3i,
    high: vec3i,
    share: vec3f,
}

fn corners_of_field(number: u32, place: vec3f) -> FieldCorners {
    let last = fields.each[number].last;
    let at = clamp(place, vec3f(0.0), last);
    let low = min(floor(at), max(last - 1.0, vec3f(0.0)));
    return FieldCorners(vec3i(low), vec3i(min(low + 1.0, last)), at - low);
}

// The place on the ramp between samples, linearly; of labels how much of what is seen stands there.
fn value_of_field(number: u32, place: vec3f) -> f32 {
    let near = corners_of_field(number, place);
    let low = near.low;
    let high = near.high;
    var below = vec4f(texel_of_field(number, low), texel_of_field(number, vec3i(high.x, low.yz)),
                      texel_of_field(number, vec3i(low.x, high.y, low.z)), texel_of_field(number, vec3i(high.xy, low.z)));
    var above = vec4f(texel_of_field(number, vec3i(low.xy, high.z)), texel_of_field(number, vec3i(high.x, low.y, high.z)),
                      texel_of_field(number, vec3i(low.x, high.yz)), texel_of_field(number, high));
    let is_label = FIELDS_LABELS && (!FIELDS_NUMBERS || (fields.each[number].flags & FIELD_LABELS) != 0u);
    if FIELDS_LABELS && is_label {
        below = select(vec4f(0.0), vec4f(1.0), below > vec4f(0.0));
        above = select(vec4f(0.0), vec4f(1.0), above > vec4f(0.0));
    }
    let four = below * (1.0 - near.share.z) + above * near.share.z;
    let two = four.xy * (1.0 - near.share.y) + four.zw * near.share.y;
    let raw = two.x * (1.0 - near.share.x) + two.y * near.share.x;
    let value = select(raw * fields.each[number].scale + fields.each[number].shift, raw, is_label);
    return select(value, 2.0 * NO_VALUE, raw < NO_VALUE);
}

// Colour and extinction of labels: mixed after the ramp, as numbers of things have nothing between them.
fn label_of_field(number: u32, place: vec3f) -> vec4f {
    let near = corners_of_field(number, place);
    var sum = vec4f(0.0);
    for (var i = 0u; i < 8u; i++) {
        let is_high = vec3<bool>((i & 1u) != 0u, (i & 2u) != 0u, (i & 4u) != 0u);
        let weights = select(1.0 - near.share, near.share, is_high);
        let texel = texel_of_field(number, select(near.low, near.high, is_high));
        let value = texel * fields.each[number].scale + fields.each[number].shift;
        let own = ramp_entry(number, i32(clamp(round(value * (RAMP_ENTRIES - 1.0)), 0.0, RAMP_ENTRIES - 1.0)));
        let weight = weights.x * weights.y * weights.z * own.w;
        sum += vec4f(weight * own.rgb, weight);
        if i == 7u {
            break;
        }
    }
    return vec4f(sum.rgb / max(sum.w, 1e-30), sum.w);
}

// How it changes from place to place, view space, per metre: by the corners of a tetrahedron around, exact where it changes evenly. Whether labels are there
// has steps, which a wider one smooths.
fn gradient_of_field(number: u32, place: vec3f) -> vec3f {
    let middle = value_of_field(number, place);
    let reach = select(0.5, 1.5, (fields.each[number].flags & FIELD_LABELS) != 0u);
    var sum = vec3f(0.0);
    for (var i = 0u; i < 4u; i++) {
        let odd = vec2f(f32(i & 1u), f32(i >> 1u));
        let corner = vec3f(1.0 - 2.0 * odd.x, 1.0 - 2.0 * odd.y, (1.0 - 2.0 * odd.x) * (1.0 - 2.0 * odd.y));
        let value = value_of_field(number, place + reach * corner);
        sum += corner * (select(value, middle, value < NO_VALUE) - middle);
        if i == 3u {
            break;
        }
    }
    let field = fields.each[number];
    return (0.25 / reach) * (sum.x * field.to_x.xyz + sum.y * field.to_y.xyz + sum.z * field.to_z.xyz);
}

// A ray through a field, in samples: the place at distance D is start + D * along.
struct FieldRay {
    start: vec3f,
    along: vec3f,
    span: vec2f,                // from which D to which it is inside; nowhere if the second is not larger
}

fn ray_in_field(number: u32, ray: Ray, from_distance: f32, until: f32) -> FieldRay {
    let field = fields.each[number];
    let origin = vec4f(ray.origin, 1.0);
    let start = vec3f(dot(field.to_x, origin), dot(field.to_y, origin), dot(field.to_z, origin));
    let along = vec3f(dot(field.to_x.xyz, ray.direction), dot(field.to_y.xyz, ray.direction), dot(field.to_z.xyz, ray.direction));
    var span = vec2f(from_distance, until);
    for (var i = 0; i < 3; i++) {
        let a = (field.low[i] - start[i]) / along[i];
        let b = (field.high[i] - start[i]) / along[i];
        let is_beside = start[i] < field.low[i] || start[i] > field.high[i];
        let own = select(vec2f(min(a, b), max(a, b)), select(vec2f(-FAR_AWAY, FAR_AWAY), vec2f(0.0, -1.0), is_beside), along[i] == 0.0);
        span = vec2f(max(span.x, own.x), min(span.y, own.y));
        if i == 2 {
            break;
        }
    }
    return FieldRay(start, along, span);
}

// Up to which D nothing of a field is seen from one on; that itself where something may be.
fn empty_until(number: u32, way: FieldRay, at: f32) -> f32 {
    let brick = floor((way.start + at * way.along) / BRICK);
    let last = floor(max(fields.each[number].last - 1.0, vec3f(0.0)) / BRICK);
    let held = vec3i(clamp(brick, vec3f(0.0), last)) + vec3i(0, 0, i32(fields.each[number].first_brick));
    let ends = (select(brick, brick + 1.0, way.along > vec3f(0.0)) * BRICK - way.start) / way.along;
    let end = min(min(select(ends.x, FAR_AWAY, way.along.x == 0.0), select(ends.y, FAR_AWAY, way.along.y == 0.0)),
                  select(ends.z, FAR_AWAY, way.along.z == 0.0));
    return select(at, max(end, at), textureLoad(field_bricks, held, 0).x == 0u);
}

// 1 - exp(-x) of x >= 0, right to 2^-22: the built-in exp need not be.
fn absorbed(x: f32) -> f32 {
    let turns = floor(min(x, 80.0) * 1.44269504 + 0.5);
    let rest = (turns * 0.693359375 - min(x, 80.0)) - turns * 2.12194440e-4;
    // exp(rest) - 1 of |rest| <= 0.35 (Taylor).
    let less = rest * (1.0 + rest * (0.5 + rest * (0.16666667 + rest * (0.041666667 + rest * (0.0083333333 + rest * 0.0013888889)))));
    // 2^-turns, exactly.
    let scale = bitcast<f32>((127u - u32(turns)) << 23u);
    return select(1.0 - (1.0 + less) * scale, -less, turns == 0.0);
}

// How a field looks at a place: colour as it is seen; and what of it lenses leave, 0..1.
fn look_of_field(number: u32, pixel: vec2i, ray: Ray, distance: f32, place: vec3f, value: f32, color: vec3f, gradient: vec3f, part: u32) -> vec4f {
    var point = nowhere(pixel);
    let seen = ray.origin + distance * ray.direction;
    let steepness = length(gradient);
    let flags = fields.each[number].flags;
    point.depth = depth_of_distance(distance);
    point.distance = distance;
    point.relative = seen * view.view_from_world;
    point.base = color;
    point.natural = color;
    point.value = select(clamp(value, 0.0, 1.0), -1.0, (flags & FIELD_LABELS) != 0u);
    let across = select(gradient, -gradient, dot(gradient, ray.direction) > 0.0);
    point.normal = select(-normalize(ray.direction), across / steepness, steepness > 1e-20) * view.view_from_world;
    if FIELDS_LIT && (flags & FIELD_LIT) != 0u && steepness > 1e-20 {
        point.lit = true;
        sky_arriving = light.sky_weight;
        if !SKY_SHADOWS {
            sky_arriving = 1.0;
        }
        point.sun = 1.0;
        if FIELDS_SHADOWED && (flags & FIELD_SHADOWED) != 0u {
            point.sun = sun_share(point.relative, point.normal, point.normal);
            see_sky(point.relative, point.normal, point.normal);
        }
        point.arriving = irradiance(point.normal, point.sun);
        point.shade = luminance(point.arriving);
    }
    let height = f32(view.eye_whole.z) + view.eye_fraction.z + point.relative.z;
    let fragment = Fragment(pixel, point.depth, seen, height, NO_SURFACE, NO_OBJECT, PART_OTHER, point.normal, ray, view.orthographic == 1u,
                            0u, dither(pixel, view.sample_index), 0.0, 1.0);
    let classes = classes_at(sight_at(pixel, ray, point.depth, fields.each[number].object), part);
    let kept = select(kept_of_field(fragment, point, classes), 1.0, (flags & FIELD_KEPT) != 0u);
    return vec4f(shade(&point, classes), kept * presence_of_field(number, point, classes));
}

// Lays a layer over what lies behind it.
fn lay_layer(laid: ptr<function, vec4f>, color: vec3f, opacity: f32) {
    let through = (*laid).w;
    *laid = vec4f((*laid).rgb + (through * opacity) * color, through * (1.0 - opacity));
}

// A cell of the walk.
struct FieldCell {
    ray: Ray,
    low: f32,                   // D
    high: f32,
    metres: f32,                // along the ray for one of D
}

// What a field has in a cell, of which it is in all: colour times extinction, and that, 1 / metres.
fn light_of_cell(number: u32, way: FieldRay, cell: FieldCell, pixel: vec2i, part: u32) -> vec4f {
    let distance = 0.5 * (cell.low + cell.high);
    let place = way.start + distance * way.along;
    let flags = fields.each[number].flags;
    var own = vec4f(0.0);
    var value = 0.0;
    if FIELDS_LABELS && (flags & FIELD_LABELS) != 0u {
        own = label_of_field(number, place);
    } else if FIELDS_NUMBERS {
        value = value_of_field(number, place);
        own = on_ramp(number, value);
    }
    if own.w <= 0.0 {
        return vec4f(0.0);
    }
    var gradient = vec3f(0.0);
    if (FIELDS_LIT || FIELDS_STEEP) && (flags & (FIELD_LIT | FIELD_STEEP)) != 0u {
        gradient = gradient_of_field(number, place);
    }
    if FIELDS_STEEP && (flags & FIELD_STEEP) != 0u {
        own.w *= min(length(gradient) / fields.each[number].steepest, 1.0);
    }
    let look = look_of_field(number, pixel, cell.ray, distance, place, value, own.rgb, gradient, part);
    let extinction = own.w * look.w;
    return vec4f(select(look.rgb, vec3f(0.0), fields.each[number].mode == FIELD_ABSORBS) * extinction, extinction);
}

// What a surface is the level of.
fn level_of_field(number: u32, place: vec3f) -> f32 {
    let across = (fields.each[number].flags & FIELD_SLICES) / FIELD_SLICE;
    if across == 0u {
        return value_of_field(number, place);
    }
    return select(select(place.z, place.y, across == 2u), place.x, across == 1u);
}

// Where in a cell the surface of a field is, D: at its ends it has these values, one of them below the level.
fn surface_in_cell(number: u32, way: FieldRay, cell: FieldCell, values: vec2f) -> f32 {
    let level = fields.each[number].level;
    var low = cell.low;
    var high = cell.high;
    // By halves, and where a straight line would be.
    var ends = values;
    for (var i = 0; i < 6; i++) {
        let middle = 0.5 * (low + high);
        let value = level_of_field(number, way.start + middle * way.along);
        let is_after = (value < level) == (ends.x < level);
        low = select(low, middle, is_after);
        high = select(middle, high, is_after);
        ends = select(vec2f(ends.x, value), vec2f(value, ends.y), is_after);
        if i == 5 {
            break;
        }
    }
    return low + (high - low) * clamp((level - ends.x) / (ends.y - ends.x), 0.0, 1.0);
}

fn lay_surface(number: u32, way: FieldRay, ray: Ray, distance: f32, pixel: vec2i, part: u32, laid: ptr<function, vec4f>) {
    let place = way.start + distance * way.along;
    let flags = fields.each[number].flags;
    var value = fields.each[number].level;
    if (flags & FIELD_SLICES) != 0u {
        value = value_of_field(number, place);
    }
    var own = on_ramp(number, value);
    if FIELDS_LABELS && (flags & FIELD_LABELS) != 0u {
        own = label_of_field(number, place);
    }
    var gradient = vec3f(0.0);
    if FIELDS_LIT && (flags & FIELD_LIT) != 0u && (flags & FIELD_SLICES) == 0u {
        gradient = gradient_of_field(number, place);
    }
    let look = look_of_field(number, pixel, ray, distance, place, value, own.rgb, gradient, part);
    lay_layer(laid, look.rgb, absorbed(own.w * fields.each[number].thickness) * look.w);
}

// Lays what gives and takes light in a cell.
fn lay_light(ways: ptr<function, array<FieldRay, 4>>, cell: FieldCell, pixel: vec2i, part: u32, laid: ptr<function, vec4f>) {
    var sum = vec4f(0.0);
    for (var i = 0u; i < fields.count; i++) {
        let way = (*ways)[i];
        let low = max(cell.low, way.span.x);
        let high = min(cell.high, way.span.y);
        if low < high && fields.each[i].mode < FIELD_SURFACE {
            let own = FieldCell(cell.ray, low, high, cell.metres);
            sum += light_of_cell(i, way, own, pixel, part) * ((high - low) * cell.metres);
        }
    }
    if sum.w > 0.0 {
        lay_layer(laid, sum.rgb / sum.w, absorbed(sum.w));
    }
}

// The shortest way that a walk goes on: far away, steps may be less than f32 tells apart.
fn least_way(at: f32, step: f32) -> f32 {
    return max(1e-3 * step, 2.3841858e-7 * at);
}

// Where the next cell of the walk ends, beyond where it begins.
fn end_of_cell(at: f32, step: f32, offset: f32) -> f32 {
    let end = (floor(at / step - offset) + 1.0 + offset) * step;
    let least = least_way(at, step);
    return max(select(end, end + step, end - at < least), at + least);
}

fn offset_of_cells(pixel: vec2i) -> f32 {
    return select(0.0, dither(pixel, view.sample_index), fields.is_jittered == 1u);
}

// The surface that a walk has come to.
struct FieldHit {
    number: u32,                // of its field; none: 4
    share: f32,                 // of the cell, about
    low: f32,                   // D; where the cell ends
    high: f32,
    values: vec2f,              // there
}

// The fields along a piece of a ray, those of one layer left out. Surfaces end the walk, and are looked for and laid outside of it: on adapters that take
// many pixels at a time all of them wait for what one of them does in it.
fn walk_fields(pixel: vec2i, ray: Ray, from_distance: f32, until: f32, part: u32, laid: ptr<function, vec4f>) {
    let metres = length(ray.direction);
    let step = fields.step / metres;
    let offset = offset_of_cells(pixel);
    var ways: array<FieldRay, 4>;
    // Of surfaces: the value at the end of the last cell, and where that is.
    var before: array<vec2f, 4>;
    for (var i = 0u; i < fields.count; i++) {
        ways[i] = ray_in_field(i, ray, from_distance, until);
        before[i] = vec2f(0.0, -FAR_AWAY);
    }
    var at = from_distance;
    while at < until && (*laid).w >= LEAST_THROUGH {
        var hit = FieldHit(4u, 2.0, 0.0, 0.0, vec2f(0.0));
        while at < until && hit.number == 4u && (*laid).w >= LEAST_THROUGH {
            var next = until;
            var is_any = false;
            for (var i = 0u; i < fields.count; i++) {
                let span = ways[i].span;
                let is_walked = fields.each[i].mode < FIELD_PROJECTED && at < span.y;
                if is_walked && at < span.x {
                    next = min(next, span.x);
                }
                if is_walked && at >= span.x {
                    let empty = empty_until(i, ways[i], at);
                    is_any |= empty <= at;
                    next = min(next, max(empty, at + least_way(at, step)));
                }
            }
            if !is_any {
                at = next;
                continue;
            }
            let end = min(end_of_cell(at, step, offset), until);
            for (var i = 0u; FIELDS_SURFACES && i < fields.count; i++) {
                let low = max(at, ways[i].span.x);
                let high = min(end, ways[i].span.y);
                if fields.each[i].mode != FIELD_SURFACE || low >= high {
                    continue;
                }
                var a = before[i].x;
                if before[i].y != low {
                    a = level_of_field(i, ways[i].start + low * ways[i].along);
                }
                let b = level_of_field(i, ways[i].start + high * ways[i].along);
                let level = fields.each[i].level;
                let share = (level - a) / (b - a);
                let is_met = (a < level) != (b < level) && min(a, b) >= NO_VALUE;
                if is_met && share < hit.share {
                    hit = FieldHit(i, share, low, high, vec2f(a, b));
                }
                before[i] = select(vec2f(b, high), vec2f(a, low), is_met);
            }
            if hit.number == 4u {
                if FIELDS_WALKED {
                    lay_light(&ways, FieldCell(ray, at, end, metres), pixel, part, laid);
                }
                at = end;
            }
        }
        if FIELDS_SURFACES && hit.number < 4u {
            let way = ways[hit.number];
            let distance = surface_in_cell(hit.number, way, FieldCell(ray, hit.low, hit.high, metres), hit.values);
            if FIELDS_WALKED {
                lay_light(&ways, FieldCell(ray, at, distance, metres), pixel, part, laid);
            }
            lay_surface(hit.number, way, ray, distance, pixel, part, laid);
            // On the other side of it.
            let began = at;
            at = max(distance, at);
            before[hit.number] = vec2f(hit.values.y, at);
            // Of the others those that the cell has, too, are still to come, and those that it has not are not, however their values round here.
            for (var i = 0u; i < fields.count; i++) {
                if i != hit.number && fields.each[i].mode == FIELD_SURFACE && before[i].y >= began {
                    let value = level_of_field(i, ways[i].start + at * ways[i].along);
                    let level = fields.each[i].level;
                    before[i] = vec2f(select(before[i].x, value, (value < level) == (before[i].x < level)), at);
                }
            }
        }
    }
}

// The fields up to a distance, from where they are laid already.
fn lay_fields(pixel: vec2i, middle: vec2f, until: f32, part: u32, laid: ptr<function, vec4f>) {
    // Fields are no objects.
    see_object(NO_OBJECT);
    while fields_until < until && (*laid).w >= LEAST_THROUGH {
        var next = min(until, line_ends(middle, fields_until));
        var nearest = 4u;
        for (var i = 0u; FIELDS_PROJECTED && i < fields.count; i++) {
            if projected[i].z > 0.0 && projected[i].x < next {
                nearest = i;
                next = projected[i].x;
            }
        }
        next = max(next, fields_until);
        see_pixel(middle, 0.5 * (fields_until + min(next, 2.0 * fields_until + 1e6)));
        let ray = ray_of_pixel(middle);
        walk_fields(pixel, ray, fields_until, next, part, laid);
        if FIELDS_PROJECTED && nearest < 4u {
            lay_projected(nearest, pixel, middle, part, laid);
        }
        fields_until = next;
    }
}

// A field that is one layer.
fn lay_projected(number: u32, pixel: vec2i, middle: vec2f, part: u32, laid: ptr<function, vec4f>) {
    let distance = projected[number].x;
    let value = projected[number].y;
    projected[number].z = 0.0;
    see_pixel(middle, distance);
    let ray = ray_of_pixel(middle);
    let way = ray_in_field(number, ray, 0.0, FAR_AWAY);
    let place = way.start + distance * way.along;
    let own = on_ramp(number, value);
    let look = look_of_field(number, pixel, ray, distance, place, value, own.rgb, vec3f(0.0), part);
    lay_layer(laid, look.rgb, absorbed(own.w * fields.each[number].thickness) * look.w);
}

// Finds where those stand that are one layer: their largest or smallest value before what is opaque, or the middle of what is met of them.
fn begin_fields(pixel: vec2i, middle: vec2f, part: u32) {
    fields_until = view.near;
    see_object(NO_OBJECT);
    let depth = textureLoad(scene_depth, pixel, 0);
    let opaque = select(FAR_AWAY, distance_of_depth(depth), depth > 0.0);
    for (var i = 0u; FIELDS_PROJECTED && i < fields.count; i++) {
        projected[i] = vec3f(0.0);
        if fields.each[i].mode >= FIELD_PROJECTED {
            projected[i] = found_of_field(i, pixel, middle, opaque, part);
        }
    }
}

fn found_of_field(number: u32, pixel: vec2i, middle: vec2f, opaque: f32, part: u32) -> vec3f {
    let mode = fields.each[number].mode;
    let offset = offset_of_cells(pixel);
    var best = vec2f(0.0);
    var is_any = false;
    var sum = vec3f(0.0);       // of values, of distances, each times a length; and that, metres
    var last = view.near;       // where the last cell begins of which something is seen
    var at = view.near;
    var rounds = 0u;
    while at < opaque && rounds < 32u {
        let ends = min(opaque, line_ends(middle, at));
        see_pixel(middle, 0.5 * (at + min(ends, 2.0 * at + 1e6)));
        let ray = ray_of_pixel(middle);
        let metres = length(ray.direction);
        let step = fields.step / metres;
        let way = ray_in_field(number, ray, at, ends);
        var from_distance = way.span.x;
        while from_distance < way.span.y {
            let until = min(end_of_cell(from_distance, step, offset), way.span.y);
            let distance = 0.5 * (from_distance + until);
            let value = value_of_field(number, way.start + distance * way.along);
            let is_better = select(value > best.y, value < best.y, mode == FIELD_MINIMUM) || !is_any;
            if value >= NO_VALUE && is_seen_of_field(number, pixel, ray, distance, part) {
                best = select(best, vec2f(distance, value), is_better);
                is_any = true;
                last = from_distance;
                sum += vec3f(value, distance, 1.0) * ((until - from_distance) * metres);
            }
            from_distance = until;
        }
        at = ends;
        rounds++;
    }
    let mean = sum.xy / max(sum.z, 1e-30);
    let found = select(best, mean.yx, mode == FIELD_MEAN);
    // The middle of a cell may be its end, in f32: it is before what is opaque.
    return vec3f(select(found.x, last, found.x >= opaque), found.y, select(0.0, 1.0, is_any));
}

// Whether lenses leave anything of a field at a place.
fn is_seen_of_field(number: u32, pixel: vec2i, ray: Ray, distance: f32, part: u32) -> bool {
    if !LENSES_CUT_FIELDS {
        return true;
    }
    return look_of_field(number, pixel, ray, distance, vec3f(0.0), 0.0, vec3f(0.0), vec3f(0.0), part).w > 0.0;
}

// The classes of what is opaque, or of the background, where no layer of the city is the shown surface.
fn write_classes_of_opaque(pixel: vec2i, middle: vec2f, depth: f32, part: u32) {
    let is_any = depth > 0.0;
    see_object(surface_shown(max(textureLoad(codes, pixel, 0).x, 1u) - 1u).object);
    see_pixel(middle, select(FAR_AWAY, distance_of_depth(depth), is_any));
    let ray = ray_of_pixel(middle);
    if is_any {
        let point = point_at(pixel, ray, depth);
        write_classes(pixel, point, classes_at(sight_of_point(point, ray), part));
    } else {
        write_classes(pixel, nowhere(pixel), classes_at(sight_at(pixel, ray, 0.0, NO_OBJECT), part));
    }
}
