//! Pictures in bands: rows from edge to edge, drawn and handed on one after the other, so that large pictures need not be held whole.

use crate::{
    city::decode_normal,
    gpu::GpuError,
    lens::Class,
    render::{
        parts::{Part, put},
        renderer::Renderer,
        request::{Aovs, Request},
    },
    scene::Drawn,
    view::View,
};

/// Rows of a picture from edge to edge, row 0 at the top.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Band {
    /// The first of its rows, of the picture's.
    pub first_row: u32,
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// sRGB, straight alpha.
    pub rgba: Vec<[u8; 4]>,
    /// Metres along the view axis, +∞ = nothing.
    pub depth: Option<Vec<f32>>,
    /// Object index + 1, 0 = nothing.
    pub object_id: Option<Vec<u32>>,
    /// Unit, model axes, towards the eye; 0,0,0 = nothing.
    pub normal: Option<Vec<[f32; 3]>>,
    /// One bit per lens, 32 lenses per plane.
    pub lens_mask: Option<Vec<Vec<u32>>>,
}

/// What goes with the pixels of a band while it is drawn.
pub(super) struct DrawnBand {
    pub band: Band,
    /// Class bits as the GPU holds them: planes 3w inside, 3w + 1 in front, 3w + 2 behind; those inside alone where nothing is counted.
    pub classes: Vec<Vec<u32>>,
}

/// How many pixels show each class of a lens.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct ClassCounts {
    of: [u64; 4],
}

impl ClassCounts {
    /// Of one class.
    pub fn of(&self, class: Class) -> u64 {
        self.of[class as usize]
    }
}

impl Band {
    /// Adds the rows below it.
    pub fn append(&mut self, below: Self) {
        if self.rgba.is_empty() {
            *self = below;
            return;
        }
        fn join<T>(above: &mut Option<Vec<T>>, below: Option<Vec<T>>) {
            above.iter_mut().zip(below).for_each(|(above, below)| above.extend(below));
        }
        self.size[1] += below.size[1];
        self.rgba.extend(below.rgba);
        join(&mut self.depth, below.depth);
        join(&mut self.object_id, below.object_id);
        join(&mut self.normal, below.normal);
        for (above, below) in self.lens_mask.iter_mut().flatten().zip(below.lens_mask.into_iter().flatten()) {
            above.extend(below);
        }
    }
}

impl DrawnBand {
    /// An empty one of `size` pixels from `first_row` on, for `lens_count` lenses.
    pub fn new(request: &Request, first_row: u32, size: [u32; 2], lens_count: usize) -> Self {
        let pixels = size[0] as usize * size[1] as usize;
        let Aovs { depth, object_id, normal, lens_mask } = request.aovs;
        let words = lens_count.max(1).div_ceil(32);
        let planes = if request.statistics { 3 * words } else { usize::from(lens_mask) * words };
        let band = Band {
            first_row,
            size,
            rgba: vec![[0; 4]; pixels],
            depth: depth.then(|| vec![f32::INFINITY; pixels]),
            object_id: object_id.then(|| vec![0; pixels]),
            normal: normal.then(|| vec![[0.0; 3]; pixels]),
            lens_mask: None,
        };
        Self { band, classes: vec![vec![0; pixels]; planes] }
    }

    /// Where its pixels stand: how wide it is, and its first row.
    fn place(&self) -> [u32; 2] {
        [self.band.size[0], self.band.first_row]
    }

    /// Reads the picture that the renderer has drawn of a part.
    pub fn read_picture(&mut self, renderer: &Renderer, part: Part) -> Result<(), GpuError> {
        let Some(targets) = renderer.targets() else { return Ok(()) };
        let rgba = renderer.gpu.read_texture(&targets.picture.texture, 0, wgpu::TextureAspect::All)?;
        let place = self.place();
        put(&mut self.band.rgba, place, part, bytemuck::cast_slice::<u8, [u8; 4]>(&rgba));
        Ok(())
    }

    /// Reads what the unjittered sample left in the targets.
    pub fn read_aovs(&mut self, renderer: &Renderer, view: &View, part: Part) -> Result<(), GpuError> {
        let Some(targets) = renderer.targets() else { return Ok(()) };
        let place = self.place();
        if let Some(out) = &mut self.band.depth {
            let stored = renderer.gpu.read_texture(&targets.own_depth.texture, 0, wgpu::TextureAspect::All)?;
            put(out, place, part, &metres(view, bytemuck::cast_slice(&stored)));
        }
        if self.band.object_id.is_none() && self.band.normal.is_none() {
            return Ok(());
        }
        let codes = renderer.gpu.read_texture(&targets.codes.texture, 0, wgpu::TextureAspect::All)?;
        let codes: Vec<[u32; 2]> = match targets.needs.smooth {
            true => bytemuck::cast_slice(&codes).to_vec(),
            false => {
                // Flat faces: the normal stands with the surface.
                let surface = |code: u32| code.checked_sub(1).and_then(|number| renderer.surface(number));
                let normal = |code: u32| surface(code).map_or(0, |s| s.normal);
                bytemuck::cast_slice(&codes).iter().map(|&code: &u32| [code, normal(code)]).collect()
            }
        };
        if let Some(out) = &mut self.band.object_id {
            let ids: Vec<u32> = codes.iter().map(|&[code, _]| renderer.object_id(code)).collect();
            put(out, place, part, &ids);
        }
        if let Some(out) = &mut self.band.normal {
            put(out, place, part, &normals(renderer, view, part, &codes));
        }
        Ok(())
    }

    /// Reads the class bits of all lenses, of which there are `lens_count`.
    pub fn read_masks(&mut self, renderer: &Renderer, lens_count: usize, part: Part) -> Result<(), GpuError> {
        let Some(targets) = renderer.targets() else { return Ok(()) };
        let place = self.place();
        // The GPU holds all three classes, whether or not they were asked for.
        let per_word = self.classes.len() / lens_count.max(1).div_ceil(32);
        for (i, plane) in self.classes.iter_mut().enumerate() {
            let layer = (i / per_word * 3 + i % per_word) as u32;
            let bytes = renderer.gpu.read_texture(&targets.masks.texture, layer, wgpu::TextureAspect::All)?;
            put(plane, place, part, bytemuck::cast_slice::<u8, u32>(&bytes));
        }
        Ok(())
    }

    /// Adds to the counts of each lens that was drawn.
    pub fn count(&self, counts: &mut [ClassCounts]) {
        for (lens, counts) in counts.iter_mut().enumerate() {
            let planes = &self.classes[3 * (lens / 32)..3 * (lens / 32) + 3];
            for ((inside, front), behind) in planes[0].iter().zip(&planes[1]).zip(&planes[2]) {
                let [inside, front, behind] = [inside, front, behind].map(|word| word >> (lens % 32) & 1 == 1);
                let class = match (inside, front, behind) {
                    (true, ..) => Class::Inside,
                    (_, true, false) => Class::Front,
                    (_, false, true) => Class::Behind,
                    _ => Class::Rest,
                };
                counts.of[class as usize] += 1;
            }
        }
    }

    /// The band as it is handed on, with masks of the scene's `lens_count` lenses.
    pub fn finished(self, request: &Request, drawn: &Drawn, lens_count: usize) -> Band {
        let Self { mut band, classes } = self;
        let per_word = if request.statistics { 3 } else { 1 };
        let inside: Vec<Vec<u32>> = classes.into_iter().step_by(per_word).collect();
        band.lens_mask = request.aovs.lens_mask.then(|| match drawn.owners {
            None => inside,
            Some(_) => folded(&inside, drawn, lens_count),
        });
        band
    }
}

/// Bits of the lenses that were drawn, as bits of the scene's lenses.
fn folded(of_drawn: &[Vec<u32>], drawn: &Drawn, lens_count: usize) -> Vec<Vec<u32>> {
    let pixels = of_drawn.first().map_or(0, Vec::len);
    let mut planes = vec![vec![0; pixels]; lens_count.div_ceil(32)];
    for lens in 0..lens_count {
        let whole = drawn.whole(lens as u32) as usize;
        let to = planes[lens / 32].iter_mut().zip(&of_drawn[whole / 32]);
        to.for_each(|(to, from)| *to |= (from >> (whole % 32) & 1) << (lens % 32));
    }
    planes
}

/// Metres along the view axis of stored depths.
fn metres(view: &View, stored: &[f32]) -> Vec<f32> {
    let (near, far) = (view.camera.near_m as f32, view.far_m as f32);
    let of = |&depth: &f32| match depth {
        0.0 => f32::INFINITY,
        depth if view.is_orthographic() => far - depth * (far - near),
        depth => near / depth,
    };
    stored.iter().map(of).collect()
}

/// The normals of a part, by the codes and normals of its pixels.
fn normals(renderer: &Renderer, view: &View, part: Part, codes: &[[u32; 2]]) -> Vec<[f32; 3]> {
    let width = part.drawn.size[0];
    let normal = |(i, &[code, normal]): (usize, &[u32; 2])| {
        if code == 0 {
            return [0.0; 3];
        }
        let n = decode_normal(normal);
        let [x, y] = [i as u32 % width + part.drawn.origin[0], i as u32 / width + part.drawn.origin[1]];
        // As in `lib/point.wgsl`.
        let is_lit_as_before = renderer.surface(code - 1).is_some_and(|s| s.is_lit_as_before());
        let away = !is_lit_as_before && n.dot(view.pixel_ray(x, y).direction) > 0.0;
        (if away { -n } else { n }).as_vec3().to_array()
    };
    codes.iter().enumerate().map(normal).collect()
}
