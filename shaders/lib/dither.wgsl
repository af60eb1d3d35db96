// Ordered dithering: a threshold per pixel and sample. What has a share of a place is there where its share is greater.
// Twin: `veduta::lens::dither`.
//
// Interleaved gradient noise (Jimenez 2014), in integers: all passes and adapters have the same bits, so that what is there in one
// pass and what stands for it in another are exact complements. From sample to sample it goes on by the golden ratio.

// `pixel`: of the target. The threshold is that of the picture's pixel, whatever part of it is drawn. In the open interval 0..1.
fn dither(pixel: vec2i, sample: u32) -> f32 {
    let at = vec2u(pixel) + vec2u(view.first_pixel & 0xffffu, view.first_pixel >> 16u);
    // Fractions of 2^32: the weights 0.06711056 and 0.00583715, then 52.9829189, then 0.618034.
    let slope = at.x * 288237660u + at.y * 25070368u;
    let noise = slope * 52u + (slope >> 16u) * 64417u;
    let threshold = noise + sample * 2654435769u;
    // Odd multiples of 2^-24: exact, and never 0 or 1.
    return f32((threshold >> 8u) | 1u) * 0x1p-24;
}
