//! The cities of a frame: the scene's own, what deformations make of it, and the contents of lenses.

use glam::DVec3;

use crate::{
    geom::Aabb,
    render::{
        cells::Details,
        city::{Chunk, Section},
        city_facts::{CityFacts, ContentFacts, SectionFacts},
        city_on_gpu::{CityOnGpu, SectionImages},
        contents::{Contents, PlacedCity},
        cut::Cut,
        deformed::Deformed,
        operations::Operations,
        standing::World,
    },
    view::View,
};

/// The cities that a frame draws.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cities<'a> {
    /// The scene's own.
    pub own: &'a CityOnGpu,
    /// What deformations make of it, and of contents.
    pub deformed: &'a [Deformed],
    /// Those of lenses.
    pub contents: &'a Contents,
}

/// A section of a city that a frame draws.
#[derive(Clone, Copy, Debug)]
pub(super) struct DrawnSection<'a> {
    pub city: &'a CityOnGpu,
    pub section: &'a Section,
    pub image: Option<&'a SectionImages>,
    /// Where they stand.
    pub chunks: &'a [Chunk],
    /// The content's number; `None`: the scene's own.
    pub content: Option<u32>,
    /// Offset of its `City`.
    pub offset: u32,
    /// Whether it throws shadows.
    pub has_shadow: bool,
    /// Which layer of their planes its faces are in, where they overlap others; the lowest is 0.
    pub layer: u32,
    /// In which detail its cells are drawn, if it is the scene's own.
    pub details: &'a Details,
}

impl DrawnSection<'_> {
    /// What pipelines need to know of it.
    pub fn facts(&self) -> SectionFacts {
        SectionFacts::new(self.section, self.city.buffers.smooth)
    }

    /// Whether a chunk of it may show something.
    pub fn shows(&self, chunk: &Chunk, cut: Option<&Cut>, view: &View) -> bool {
        match self.content {
            None => self.details.show(chunk),
            // What moves is there by itself.
            Some(0) => true,
            Some(number) => cut.is_some_and(|cut| cut.hiding.shows(number, &chunk.bounds, view)),
        }
    }
}

impl<'a> Cities<'a> {
    /// All that the GPU holds.
    pub fn all(&self) -> impl Iterator<Item = &'a CityOnGpu> + use<'a> {
        let moved = self.deformed.iter().filter(|deformed| *deformed.world() != World::OWN);
        self.own_ones().chain(self.contents.others()).chain(moved.map(|deformed| &deformed.city))
    }

    /// What deformations make of a city where it stands; `None`: they leave it alone.
    pub fn deformed(&self, world: &World) -> Option<&'a Deformed> {
        self.deformed.iter().find(|deformed| deformed.world() == world)
    }

    /// The scene's own, and what deformations make of it.
    pub fn own_ones(&self) -> impl Iterator<Item = &'a CityOnGpu> + use<'a> {
        std::iter::once(self.own).chain(self.deformed(&World::OWN).map(|deformed| &deformed.city))
    }

    /// The box around all of them, metres: plain ground around them too.
    pub fn reach(&self) -> Aabb {
        self.all().fold(Aabb::EMPTY, |all, c| all.union(c.buffers.reach))
    }

    /// Their uniforms `City`, for an eye; nothing where no program of the scene may show contents.
    pub fn uniforms(&self, eye: DVec3, operations: &Operations) -> Vec<u8> {
        match operations.may_show_contents() {
            true => self.contents.uniforms(eye, !self.deformed.is_empty()),
            false => Vec::new(),
        }
    }

    /// The table of surfaces of all of them.
    pub fn surfaces(&self) -> &'a wgpu::TextureView {
        self.contents.surfaces.as_ref().unwrap_or(&self.own.buffers.surfaces)
    }

    /// What the plan of a frame asks of them.
    pub fn facts(&self) -> CityFacts<'a> {
        let sections_of = |city: &CityOnGpu| -> Vec<SectionFacts> {
            let is_smooth = city.buffers.smooth;
            city.buffers.sections.iter().map(|s| SectionFacts::new(s, is_smooth)).collect()
        };
        let content = |placed: PlacedCity<'a>| ContentFacts {
            number: placed.number,
            chunks: match self.deformed(placed.world) {
                None => chunks_of(placed.city, placed.chunks).collect(),
                Some(deformed) => {
                    chunks_of(placed.city, &deformed.left).chain(chunks_of(&deformed.city, &[])).collect()
                }
            },
        };
        let own = &self.own.buffers;
        let contents: Vec<ContentFacts> = self.contents.placed(self.own).map(content).collect();
        // Copies stand where no city does.
        let placed = contents.iter().flat_map(|content| &content.chunks).copied().flatten();
        CityFacts {
            bounds: own.bounds,
            reach: own.reach,
            fade: own.fade,
            all: placed.fold(self.reach(), |all, chunk| all.union(chunk.bounds)),
            moved: self.deformed(&World::OWN).map_or(Aabb::EMPTY, |deformed| deformed.city.buffers.bounds),
            chunks: chunks_of(self.own, &[]).collect(),
            cells: &own.cells,
            has_blocks: own.has_blocks,
            has_edges: self.own.edges.is_some(),
            emits: self.all().any(|city| city.buffers.emits),
            texels_emit: self.all().any(|city| city.buffers.texels_emit),
            has_smooth: self.all().any(|city| city.buffers.smooth),
            sections: self.all().flat_map(sections_of).collect(),
            own_sections: self.own_ones().flat_map(sections_of).collect(),
            contents,
        }
    }

    /// What is drawn where this is hidden and shown, in these details.
    pub fn drawn_sections(&self, details: &'a Details, cut: Option<&Cut>) -> Vec<DrawnSection<'a>> {
        let mut drawn = Vec::new();
        let own = |city, chunks| {
            let own = Drawn { city, chunks, content: None, offset: 0, has_shadow: true, details };
            own.sections()
        };
        match self.deformed(&World::OWN) {
            None => drawn.extend(own(self.own, &[])),
            Some(deformed) => {
                drawn.extend(own(self.own, &deformed.left));
                drawn.extend(own(&deformed.city, &[]));
            }
        }
        let is_asked =
            |number| number == 0 || cut.is_some_and(|cut| cut.plan.contents.iter().any(|c| c.city == number));
        for placed in self.contents.placed(self.own).filter(|placed| is_asked(placed.number)) {
            let PlacedCity { city, number, has_shadow, chunks, offsets: [at_rest, moved], .. } = placed;
            let content = |city, chunks, offset| {
                Drawn { city, chunks, content: Some(number), offset, has_shadow, details }.sections()
            };
            match self.deformed(placed.world) {
                None => drawn.extend(content(city, chunks, at_rest)),
                Some(deformed) => {
                    drawn.extend(content(city, &deformed.left, at_rest));
                    drawn.extend(content(&deformed.city, &[], moved));
                }
            }
        }
        drawn
    }
}

/// The chunks of each section, where they stand.
fn chunks_of<'a>(city: &'a CityOnGpu, placed: &'a [Vec<Chunk>]) -> impl Iterator<Item = &'a [Chunk]> {
    let sections = city.buffers.sections.iter().enumerate();
    sections.map(|(i, section)| placed.get(i).unwrap_or(&section.chunks).as_slice())
}

/// A city that a frame draws.
struct Drawn<'a> {
    city: &'a CityOnGpu,
    /// Those of its sections, where they are not where they are.
    chunks: &'a [Vec<Chunk>],
    content: Option<u32>,
    offset: u32,
    has_shadow: bool,
    details: &'a Details,
}

impl<'a> Drawn<'a> {
    fn sections(&self) -> Vec<DrawnSection<'a>> {
        let Self { city, chunks, content, offset, has_shadow, details } = *self;
        let sections = city.buffers.sections.iter().zip(&city.images).enumerate();
        let drawn = sections.map(|(i, (section, image))| {
            let chunks = chunks.get(i).unwrap_or(&section.chunks);
            let (layer, has_shadow) = (section.layer, has_shadow && section.has_shadow);
            DrawnSection { city, section, image: image.as_ref(), chunks, content, offset, has_shadow, layer, details }
        });
        drawn.collect()
    }
}
