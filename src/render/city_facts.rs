//! What the plan of a frame asks of the cities that are there: plain data.

use glam::DVec3;

use crate::{
    city::ground::Fade,
    geom::Aabb,
    render::{
        cells::{CellFigures, Detail, Details, triangles_in},
        city::{Chunk, Section, SectionKind, Texels, Translucency},
        frame::FrameInput,
        hiding::{Reach, reaches_of},
        sun_eye::{MapSize, SunEye},
    },
    view::{Frustum, View},
};

/// A section, as far as pipelines go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SectionFacts {
    pub kind: SectionKind,
    /// Whether its city has normals per vertex.
    pub is_smooth: bool,
    /// Whether its corners can be read by each other.
    pub is_read: bool,
}

impl SectionFacts {
    /// Those of a section of a city.
    pub fn new(section: &Section, is_smooth: bool) -> Self {
        Self { kind: section.kind, is_smooth, is_read: section.is_read() }
    }
}

/// Where the chunks of a content are.
#[derive(Clone, Debug)]
pub(super) struct ContentFacts<'a> {
    pub number: u32,
    pub chunks: Vec<&'a [Chunk]>,
}

/// The cities that are there.
#[derive(Clone, Debug)]
pub(super) struct CityFacts<'a> {
    /// Box around the scene's own, and around all of them, metres.
    pub bounds: Aabb,
    pub all: Aabb,
    /// Box around the scene's own and the plain ground around it, metres, and how that fades, where there is one.
    pub reach: Aabb,
    pub fade: Option<Fade>,
    /// Box around what deformations move, metres.
    pub moved: Aabb,
    /// Of the scene's own: chunks by section, cells, whether it has block models, whether its edges are there.
    pub chunks: Vec<&'a [Chunk]>,
    pub cells: &'a [CellFigures],
    pub has_blocks: bool,
    pub has_edges: bool,
    /// Whether some city has normals per vertex.
    pub has_smooth: bool,
    /// Whether something has light of its own, and whether texels say how much of it.
    pub emits: bool,
    pub texels_emit: bool,
    /// Sections of all of them, and those of the scene's own and of what is moved of it.
    pub sections: Vec<SectionFacts>,
    pub own_sections: Vec<SectionFacts>,
    pub contents: Vec<ContentFacts<'a>>,
}

impl CityFacts<'_> {
    /// Whether some section has a texture.
    pub fn is_textured(&self) -> bool {
        self.sections.iter().any(|s| s.kind.images().is_some())
    }

    /// Whether some walls have storeys and windows.
    pub fn has_facades(&self) -> bool {
        self.sections.iter().any(|s| s.kind.images().is_some_and(|images| images.facade))
    }

    /// Whether the material of something is translucent, in view or not.
    pub fn has_clear_materials(&self) -> bool {
        let own = self.chunks.iter().copied().flatten();
        let placed = self.contents.iter().flat_map(|content| &content.chunks).copied().flatten();
        own.chain(placed).any(|chunk| chunk.translucency != Translucency::None)
    }

    /// Whether some texture is.
    pub fn has_clear_textures(&self) -> bool {
        let mut images = self.sections.iter().filter_map(|s| s.kind.images());
        images.any(|images| images.texels == Texels::Translucent)
    }

    /// Whether the material of something in a view may be. What is moved may be anywhere.
    pub fn shows_clear_materials(&self, view: &View) -> bool {
        let frustum = view.frustum(1.0);
        let own = self.chunks.iter().copied().flatten();
        let placed = self.contents.iter().flat_map(|content| &content.chunks).copied().flatten();
        let is_seen = |chunk: &Chunk| frustum.meets(&chunk.bounds) || !self.moved.is_empty();
        own.chain(placed).any(|chunk| chunk.translucency != Translucency::None && is_seen(chunk))
    }

    /// The detail of each cell in a frame. What draws lines needs edges, which only the model itself has.
    pub fn details(&self, input: &FrameInput) -> Details {
        let Some(most) = input.most_triangles else { return Details::default() };
        if !self.has_blocks || input.operations.draws_lines() {
            return Details::default();
        }
        let left = most.saturating_sub(self.terrain_in(&input.view.frustum(1.0))).max(most / 4);
        Details::new(self.cells, &input.view, left)
    }

    /// Triangles of terrain in a frustum.
    fn terrain_in(&self, frustum: &Frustum) -> u64 {
        let chunks = self.chunks.iter().copied().flatten();
        let terrain = chunks.filter(|chunk| chunk.has_terrain() && frustum.meets(&chunk.bounds));
        terrain.map(|chunk| u64::from(triangles_in(&chunk.range))).sum()
    }

    /// The eye of a light from `direction`, for a map of such a size. `contents`: what contents show in a frustum, and in all.
    pub fn light_eye(
        &self,
        view: &View,
        direction: DVec3,
        size: &MapSize,
        contents: impl Fn(&Frustum) -> (Vec<Aabb>, Aabb),
    ) -> Option<SunEye> {
        let frustum = view.frustum(1.0);
        let chunks = self.chunks.iter().copied().flatten();
        let is_seen = |c: &&Chunk| !c.is_around && c.details & Detail::Full.bit() != 0 && frustum.meets(&c.bounds);
        let mut seen: Vec<Aabb> = chunks.filter(is_seen).map(|c| c.bounds).collect();
        let (of_contents, all) = contents(&frustum);
        seen.extend(of_contents);
        seen.extend(Some(self.moved).filter(|bounds| frustum.meets(bounds)));
        let casters = self.bounds.union(all).union(self.moved);
        SunEye::new(view, direction, &seen, &casters, size)
    }

    /// Boxes around what contents show that a frustum meets, and one around all that they show, metres.
    pub fn content_bounds(&self, input: &FrameInput, frustum: &Frustum) -> (Vec<Aabb>, Aabb) {
        let (mut seen, mut all) = (Vec::new(), Aabb::EMPTY);
        for content in &self.contents {
            let uses = input.operations.contents.iter().filter(|c| c.city == content.number);
            let reaches = uses.flat_map(|c| reaches_of(Some(c.lens), c.class, input.volumes, &input.view));
            // What moves is in no lens.
            let moves = (content.number == 0).then_some(Reach::Everywhere);
            let room = reaches.chain(moves).fold(Aabb::EMPTY, |all, reach| all.union(reach.bounds()));
            for chunk in content.chunks.iter().copied().flatten().filter(|chunk| !chunk.is_around) {
                let bounds = chunk.bounds;
                let part = Aabb { min: bounds.min.max(room.min), max: bounds.max.min(room.max) };
                if part.is_empty() {
                    continue;
                }
                all = all.union(part);
                if frustum.meets(&part) {
                    seen.push(part);
                }
            }
        }
        (seen, all)
    }
}
