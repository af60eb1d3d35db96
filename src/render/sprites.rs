//! Where the depth sprites of the lens volumes in view stand: pages of one texture array.

/// Where a sprite stands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Place {
    /// Which page.
    pub page: u32,
    /// Its first texel there.
    pub origin: [u32; 2],
}

/// Pages of equal size, and a place for every sprite.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Pages {
    /// Width and height of a page, texels; multiples of [`STEP`].
    pub size: [u32; 2],
    /// How many pages there are.
    pub count: u32,
    /// One per sprite, in their order.
    pub places: Vec<Place>,
}

/// Pages grow in steps of so many texels, so that a lens that moves does not have them made anew in every frame.
const STEP: u32 = 64;
/// Pages are about this large, where no sprite is larger.
const SIDE: u32 = 2048;

/// Puts sprites of these sizes (texels) side by side in rows, and rows below each other.
pub fn arrange(sizes: &[[u32; 2]]) -> Pages {
    let widest = sizes.iter().map(|s| s[0]).max().unwrap_or(0);
    let tallest = sizes.iter().map(|s| s[1]).max().unwrap_or(0);
    let limit = [widest.max(SIDE), tallest.max(SIDE)];
    let mut places = Vec::with_capacity(sizes.len());
    let (mut page, mut at, mut row, mut used) = (0, [0, 0], 0, [0, 0]);
    for &[w, h] in sizes {
        if at[0] + w > limit[0] {
            at = [0, at[1] + row];
            row = 0;
        }
        if at[1] + h > limit[1] {
            (page, at, row) = (page + 1, [0, 0], 0);
        }
        places.push(Place { page, origin: at });
        used = [used[0].max(at[0] + w), used[1].max(at[1] + h)];
        (at[0], row) = (at[0] + w, row.max(h));
    }
    Pages { size: used.map(|s: u32| s.next_multiple_of(STEP)), count: page + 1, places }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sprites_lie_within_their_page_and_apart() {
        let many: Vec<[u32; 2]> = (0..200_u32).map(|i| [40 + i * 37 % 900, 30 + i * 53 % 700]).collect();
        for sizes in [vec![], vec![[5, 7]], vec![[5000, 3], [2, 4000]], many] {
            let pages = arrange(&sizes);
            let rects: Vec<_> = pages.places.iter().zip(&sizes).map(|(p, s)| (p.page, p.origin, *s)).collect();
            for (i, &(page, [x, y], [w, h])) in rects.iter().enumerate() {
                assert!(page < pages.count && x + w <= pages.size[0] && y + h <= pages.size[1]);
                for &(other, [a, b], [c, d]) in &rects[..i] {
                    let apart = page != other || x >= a + c || a >= x + w || y >= b + d || b >= y + h;
                    assert!(apart, "sprite {i} lies on another");
                }
            }
        }
    }

    #[test]
    fn a_lens_that_moves_a_little_keeps_its_page() {
        assert_eq!(arrange(&[[300, 280]]).size, arrange(&[[310, 299]]).size);
    }
}
