// Images of triangles that bent rays meet: of one section of one city, where its triangles are what pixels show.

override SMOOTH: bool = false;      // whether some faces of the picture have a normal per vertex

@group(1) @binding(7) var ray_hits: texture_2d<u32>;        // triangle + 1, city
@group(1) @binding(8) var ray_depth: texture_depth_2d;

@group(3) @binding(0) var image: texture_2d<f32>;
@group(3) @binding(1) var image_sampler: sampler;
@group(3) @binding(2) var light_image: texture_2d<f32>;
@group(3) @binding(3) var light_sampler: sampler;
override IMAGE_EMITS: bool = false; // whether it says how much light of their own faces have

struct Imaged {
    @builtin(position) at: vec4f,
    @location(0) @interpolate(flat, either) section: u32,   // city and section, as `section_of` has them
}

@vertex
fn vertex(@builtin(vertex_index) i: u32, @builtin(instance_index) section: u32) -> Imaged {
    return Imaged(vec4f(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0), section);
}

fn section_of(hit: Hit) -> u32 {
    return (hit.city << 16u) | (ray_words[hit.triangle + 1u].w >> TRIANGLE_SECTION_SHIFT);
}

// The level of an image whose texels are as large as the pixel, whose coordinates go so far to the right and down. Sampling by gradients would ask
// this of four pixels together, which may be on different triangles.
fn level_of(size: vec2f, right: vec2f, below: vec2f) -> f32 {
    return max(0.0, 0.5 * log2(max(dot(right * size, right * size), dot(below * size, below * size))));
}

struct Looks {
    @location(0) color: vec4f,
    @location(1) light: vec4f,
}

@fragment
fn imaged(in: Imaged) -> Looks {
    let pixel = vec2i(in.at.xy);
    let found = textureLoad(ray_hits, pixel, 0).xy;
    let hit = Hit(distance_of_depth(textureLoad(ray_depth, pixel, 0)), max(found.x, 1u) - 1u, found.y, vec2f(0.0));
    if (lenses_over(in.at.xy) & (ray_lenses.followed | ray_lenses.moved)) == 0u || found.x == 0u || section_of(hit) != in.section {
        discard;
    }
    let kind = ray_words[hit.triangle + 1u].w;
    see_object(object_of(hit));
    let rest = rest_of(hit) + select(0u, 1u, (kind & TRIANGLE_SMOOTH) != 0u);
    let corners = texcoords_of(rest);
    let here = texcoord_of(corners, weights_beside(in.at.xy, hit));
    let right = texcoord_of(corners, weights_beside(in.at.xy + vec2f(1.0, 0.0), hit)) - here;
    let below = texcoord_of(corners, weights_beside(in.at.xy + vec2f(0.0, 1.0), hit)) - here;
    let texel = textureSampleLevel(image, image_sampler, here, level_of(vec2f(textureDimensions(image)), right, below));
    var light = vec3f(1.0);
    if IMAGE_EMITS {
        let level = level_of(vec2f(textureDimensions(light_image)), right, below);
        light = textureSampleLevel(light_image, light_sampler, here, level).rgb;
    }
    return Looks(vec4f(texel.rgb * surface_at(code_of(hit) - 1u).color, 1.0), vec4f(light, 1.0));
}
