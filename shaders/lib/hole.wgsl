// Holes of textures in what the sun sees: where texel and material together let more through than they may.

@group(3) @binding(0) var image: texture_2d<f32>;
@group(3) @binding(1) var image_sampler: sampler;
override LEAST: f32 = 0.5;          // opacity below which there is nothing

fn is_hole(surface: Surface, texcoord: vec2f) -> bool {
    return textureSample(image, image_sampler, texcoord).a * opacity_of(surface) < LEAST;
}
