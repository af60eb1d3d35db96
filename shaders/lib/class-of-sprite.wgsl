// Classes of a fragment in the picture: from the sprites, as in shading, so that hiding and shading agree at every pixel.

fn class_of(volume: u32, fragment: Fragment) -> u32 {
    return class_in(volumes[volume], fragment.pixel, fragment.depth);
}
