//! Sprites that have an eye of their own, made from shapes or read from files. They do not depend on the picture's eye:
//! they are kept between frames, and made again only when what they are made of changes.

use std::sync::Arc;

use glam::DVec3;

use crate::{
    geom::Aabb,
    lens::{
        LensSprite, SpriteSpace, SpriteVolume,
        sprite::{DepthCode, Mapping},
    },
    render::{
        bake::BakeRequest,
        eye::PictureTile,
        frame::FrameInput,
        layout,
        solids::SolidTable,
        sprite_grid::SpriteGrid,
        stored::{KeptSprite, SpriteRoom, Stored, code_of},
        volume::LensVolume,
    },
    shader::LensTest,
    view::{CameraError, View},
};

/// Those of a frame, in the order of its volumes.
#[derive(Debug, Default)]
pub(super) struct OwnSprites {
    list: Vec<OwnSprite>,
    /// Grows with every one that is made.
    changes: u32,
}

#[derive(Debug)]
struct OwnSprite {
    /// Which of the frame's volumes, and its lens.
    volume: usize,
    lens: u32,
    from: Source,
    space: SpriteSpace,
    /// The part of its frame that is kept, texels.
    bounds: PictureTile,
    stored: Stored,
    /// Between which distances something may be in it, metres.
    reach: [f64; 2],
    /// Which change made it last.
    change: u32,
    is_made: bool,
}

/// What a sprite is made of.
#[derive(Debug)]
enum Source {
    /// The shapes of its lens.
    Shapes(Box<Shapes>),
    /// What a file holds.
    File(Arc<SpriteVolume>),
}

/// The shapes of a lens as the GPU reads them, seen by an eye.
#[derive(Debug)]
struct Shapes {
    view: View,
    region: layout::Region,
    planes: Vec<[f32; 4]>,
    solids: Option<Arc<SolidTable>>,
}

impl Source {
    fn is(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::File(a), Self::File(b)) => Arc::ptr_eq(a, b),
            (Self::Shapes(a), Self::Shapes(b)) => {
                let are_solids_same = match (&a.solids, &b.solids) {
                    (Some(a), Some(b)) => Arc::ptr_eq(a, b),
                    (a, b) => a.is_none() && b.is_none(),
                };
                // Bytes: NaN is equal to itself there.
                a.view == b.view
                    && bytemuck::bytes_of(&a.region) == bytemuck::bytes_of(&b.region)
                    && bytemuck::cast_slice::<_, u8>(&a.planes) == bytemuck::cast_slice::<_, u8>(&b.planes)
                    && are_solids_same
            }
            _ => false,
        }
    }
}

/// The view from the own eye of a sprite; `city`: box around what is drawn.
fn own_view(volume: &LensVolume, sprite: &LensSprite, city: &Aabb) -> Result<Option<View>, CameraError> {
    let (Some(own), Some(size)) = (sprite.own, sprite.own_size()) else { return Ok(None) };
    let shapes = volume.region.bounds();
    let all = if volume.region.is_bounded() { city.union(shapes) } else { *city };
    View::new(own.camera, size, &all).map(Some)
}

/// The part of the frame that the shapes of a lens may be seen in, texels.
fn part_of(volume: &LensVolume, view: &View) -> PictureTile {
    let whole = PictureTile::whole(view.size);
    let alone = LensVolume::plain(volume.lens, volume.region.clone());
    let part = alone.seen_part(view, whole).map(|part| part.rectangle());
    part.unwrap_or(PictureTile { origin: [0; 2], size: [0; 2] })
}

/// Between which distances from its own eye the sprite of a bounded volume may hold something, metres: a code stands for any
/// distance as near as its step.
fn reach_of(volume: &LensVolume, view: &View, code: &DepthCode) -> [f64; 2] {
    if !volume.region.is_bounded() {
        return [1e-3 * view.camera.near_m, 1e30];
    }
    let depths = volume.region.bounds().corners().map(|corner: DVec3| view.depth(corner));
    let low = depths.into_iter().fold(f64::INFINITY, f64::min);
    let high = depths.into_iter().fold(f64::NEG_INFINITY, f64::max).max(code.near_m);
    let step = |d: f64| code.quantum_m(d.clamp(code.near_m, code.far_m.min(high.max(low))));
    let (low, high) = ((low - 2.0 * step(low)).max(1e-3 * code.near_m), high + 2.0 * step(high));
    // Texels that are clamped to the near plane reach from it.
    [low.min(code.near_m), high]
}

/// Box around all that a volume's test may find in it, metres: what its own eye sees of it, to a texel and a step.
pub(super) fn bounds(volume: &LensVolume) -> Result<Aabb, CameraError> {
    let bounds = volume.region.bounds();
    let asked = volume.sprite.as_ref().filter(|_| volume.has_own_eye() && volume.region.is_bounded());
    let Some(sprite) = asked.filter(|_| !volume.region.is_empty()) else { return Ok(bounds) };
    let Some(view) = own_view(volume, sprite, &Aabb::EMPTY)? else { return Ok(bounds) };
    let part = part_of(volume, &view);
    if part.is_empty() {
        return Ok(bounds);
    }
    let code = code_of(sprite, volume, &view, &Aabb::EMPTY);
    Ok(SpriteSpace::of(&view).bounds(part.origin, part.size, reach_of(volume, &view, &code)))
}

/// How a file's distances are stored again: as they were, or as its lens says. Clip planes that are not given are where it begins
/// and ends.
fn code_of_file(sprite: &SpriteVolume, asked: Option<&LensSprite>) -> DepthCode {
    let Some(asked) = asked else { return sprite.code };
    let finite = |end: usize| {
        let ends = sprite.ends.iter().map(move |ends| f64::from(ends[end])).filter(|d| *d > 0.0 && d.is_finite());
        ends.fold([f64::INFINITY, 0.0], |[low, high], d| [low.min(d), high.max(d)])
    };
    let ([first, _], [first_exit, last]) = (finite(0), finite(1));
    let begins = first.min(first_exit);
    let near_m = asked.near_m.unwrap_or(if begins.is_finite() { begins } else { sprite.code.near_m });
    let far_m = asked.far_m.unwrap_or(last).max(near_m * (1.0 + 1e-3));
    let far_m = if asked.mapping == Mapping::InverseW { f64::INFINITY } else { far_m };
    DepthCode { mapping: asked.mapping, near_m, far_m, format: asked.format }
}

/// The words of a file's sprite.
fn words_of(sprite: &SpriteVolume, stored: &Stored) -> Vec<u32> {
    let code = &stored.code;
    let mut words = vec![0_u32; stored.words(sprite.kept) as usize];
    let (bits, row) = (code.format.bits(), stored.width(sprite.kept[0]));
    let per_word = 32 / bits;
    for (texel, ends) in sprite.ends.chunks(sprite.layers as usize).enumerate() {
        let [x, y] = [texel as u32 % sprite.kept[0], texel as u32 / sprite.kept[0]];
        let mut own: Vec<[f32; 2]> = ends.iter().copied().take_while(|ends| ends[1] > 0.0).collect();
        if let (Some(first), Some(last), true) = (own.first(), own.last(), own.len() > stored.layers as usize) {
            own = vec![[first[0], last[1]]];
        }
        for layer in 0..stored.layers {
            let codes = own.get(layer as usize).map_or([code.farthest(), code.nearest()], |&[entry, exit]| {
                let entry = if entry > 0.0 { code.code_of_stored(entry) } else { code.nearest() };
                [entry, if exit.is_finite() { code.code_of_stored(exit) } else { code.farthest() }]
            });
            for (end, code) in (0..).zip(codes) {
                let number = 2 * ((y * row + x) * stored.layers + layer) + end;
                words[(number / per_word) as usize] |= code << (bits * (number % per_word));
            }
        }
    }
    words
}

impl OwnSprite {
    fn new(index: usize, input: &FrameInput, city: &Aabb) -> Option<Self> {
        let volume = &input.volumes[index];
        let stored = |code, layers| Stored { code, layers, first: 0, first_list: 0, excess: 0 };
        let of = |from, space, bounds, stored, reach| Self {
            volume: index,
            lens: volume.lens,
            from,
            space,
            bounds,
            stored,
            reach,
            change: 0,
            is_made: false,
        };
        if let Some(saved) = volume.region.saved() {
            let sprite = &saved.sprite;
            let code = code_of_file(sprite, volume.sprite.as_ref());
            let is_aggregate = volume.sprite.is_some_and(|asked| asked.aggregate);
            let layers = if is_aggregate { 1 } else { sprite.layers };
            let bounds = PictureTile { origin: sprite.origin, size: sprite.kept };
            let [near, far] = sprite.depths()?;
            let reach = [near.max(1e-6), far.min(1e30)];
            return Some(of(Source::File(sprite.clone()), saved.space, bounds, stored(code, layers), reach));
        }
        let sprite = volume.sprite.as_ref()?;
        let view = own_view(volume, sprite, city).ok()??;
        let code = code_of(sprite, volume, &view, city);
        let mut planes = Vec::new();
        let region = match volume.region.is_form() {
            true => volume.region.rows(&view, &mut planes),
            false => volume.region.combined_rows(&view, &mut planes),
        };
        let has_solids = volume.region.has_solids();
        let solids = has_solids.then(|| input.solids.clone());
        let from = Source::Shapes(Box::new(Shapes { view, region, planes, solids }));
        let reach = reach_of(volume, &view, &code);
        let layers = sprite.layers_of(&volume.region);
        Some(of(from, SpriteSpace::of(&view), part_of(volume, &view), stored(code, layers), reach))
    }

    /// Whether its rays with more intervals than layers are counted.
    fn counts(&self, input: &FrameInput) -> bool {
        let volume = &input.volumes[self.volume];
        let is_aggregate = volume.sprite.is_some_and(|asked| asked.aggregate);
        matches!(self.from, Source::Shapes(_)) && !volume.region.is_form() && !is_aggregate
    }
}

impl OwnSprites {
    /// Finds out what a frame needs, and what of that is there; `city`: box around what is drawn.
    pub fn plan(&mut self, input: &FrameInput, city: &Aabb) {
        let asked = (0..input.volumes.len()).filter(|&i| input.volumes[i].has_own_eye());
        let mut list: Vec<OwnSprite> = asked.filter_map(|i| OwnSprite::new(i, input, city)).collect();
        let mut first = 0;
        for (i, one) in list.iter_mut().enumerate() {
            one.stored.first = u32::try_from(first).unwrap_or(u32::MAX);
            // Its place among the counts stays as long as the sprites before it do.
            one.stored.excess = if one.counts(input) { 1 + i as u32 } else { 0 };
            first += one.stored.words(one.bounds.size);
        }
        let is_kept = |before: &OwnSprite, now: &OwnSprite| {
            let same = (before.space, before.bounds, before.stored) == (now.space, now.bounds, now.stored);
            same && before.lens == now.lens && before.from.is(&now.from)
        };
        for (before, now) in self.list.iter().zip(&mut list) {
            now.change = before.change;
            now.is_made = before.is_made && is_kept(before, now);
        }
        self.list = list;
    }

    /// Words that they take among those of all sprites, and how many there are.
    pub fn room(&self) -> SpriteRoom {
        let words = self.list.iter().map(|one| one.stored.words(one.bounds.size)).sum();
        SpriteRoom { words, counts: self.list.len() as u32 }
    }

    /// Whether some of them count rays with more intervals than layers.
    pub fn counts(&self) -> bool {
        self.list.iter().any(|one| one.stored.excess > 0)
    }

    /// What was made is lost.
    pub fn forget(&mut self) {
        self.list.iter_mut().for_each(|one| one.is_made = false);
    }

    /// Those of shapes that have to be made for these volumes, whose lists of crossings follow `lists` others.
    pub fn to_make<'a>(
        &self,
        input: &FrameInput<'a>,
        is_needed: impl Fn(usize) -> bool,
        mut lists: u64,
    ) -> Vec<BakeRequest<'a>> {
        let mut all = Vec::new();
        for one in self.list.iter().filter(|one| !one.is_made && !one.bounds.is_empty() && is_needed(one.volume)) {
            let Source::Shapes(shapes) = &one.from else { continue };
            let mut stored = one.stored;
            let region = &input.volumes[one.volume].region;
            if !region.is_form() {
                stored.first_list = u32::try_from(lists).unwrap_or(u32::MAX);
                lists += u64::from(stored.width(one.bounds.size[0])) * u64::from(one.bounds.size[1]);
            }
            let (grid, bounds) = (SpriteGrid::own(one.space.size), one.bounds);
            all.push(BakeRequest { lens: one.lens, region, grid, bounds, stored, own: Some(shapes.view) });
        }
        all
    }

    /// Notes that those for these volumes are made in this frame; the words of files, each with where they begin.
    pub fn note_made(&mut self, is_needed: impl Fn(usize) -> bool) -> Vec<(u32, Vec<u32>)> {
        let mut words = Vec::new();
        for one in self.list.iter_mut().filter(|one| !one.is_made && is_needed(one.volume)) {
            self.changes += 1;
            (one.change, one.is_made) = (self.changes, true);
            if let Source::File(sprite) = &one.from {
                words.push((one.stored.first, words_of(sprite, &one.stored)));
            }
        }
        words
    }

    /// The region of a volume that is tested by one, as a shader reads it that draws for this eye: its rows stand among the planes.
    pub fn rows(&self, volume: usize, view: &View, planes: &mut Vec<[f32; 4]>) -> layout::Region {
        let region = layout::Region {
            test: LensTest::OwnSprite.number(),
            b: [planes.len() as f32, 0.0, 0.0, 0.0],
            ..layout::Region::default()
        };
        let Some(one) = self.list.iter().find(|one| one.volume == volume) else {
            // It holds nothing: no texel is kept.
            planes.extend([[0.0; 4]; 8]);
            return region;
        };
        let own_from_world = one.space.basis.view_from_world();
        let turn = (own_from_world * view.basis.view_from_world().transpose()).as_mat3();
        let shift = (own_from_world * (view.camera.eye - one.space.eye)).as_vec3();
        let [scale, middle] = one.space.projection().map(|v| v.as_vec2());
        let (kind, near, far) = one.stored.numbers();
        let PictureTile { origin, size } = one.bounds;
        let (layers, first) = (one.stored.layers, one.stored.first);
        let flag = f32::from(u8::from(one.space.is_orthographic));
        let reach = one.reach.map(|d| d as f32);
        planes.extend([
            turn.x_axis.extend(shift.x).to_array(),
            turn.y_axis.extend(shift.y).to_array(),
            turn.z_axis.extend(shift.z).to_array(),
            [scale.x, scale.y, middle.x, middle.y],
            [origin[0] as f32, origin[1] as f32, size[0] as f32, size[1] as f32],
            [kind as f32, near, far, flag],
            // A number of 32 bits is two that an f32 holds exactly.
            [(first >> 16) as f32, (first & 0xffff) as f32, one.stored.width(size[0]) as f32, layers as f32],
            // What was made anew is another sprite, in the same place.
            [reach[0], reach[1], (one.change & 0xff_ffff) as f32, 0.0],
        ]);
        region
    }

    /// Those that are there, for reading back.
    pub fn kept(&self) -> Vec<KeptSprite> {
        let kept = |one: &OwnSprite| KeptSprite {
            lens: one.lens,
            space: one.space,
            bounds: one.bounds,
            stored: one.stored,
            is_own: true,
        };
        self.list.iter().filter(|one| one.is_made).map(kept).collect()
    }

    /// The places among the counts of those that are made.
    pub fn counts_of<'a>(requests: &'a [BakeRequest<'a>]) -> impl Iterator<Item = u32> {
        requests.iter().filter(|one| one.own.is_some() && one.stored.excess > 0).map(|one| one.stored.excess)
    }
}
