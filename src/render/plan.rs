//! The plan of a frame: plain data, worked out once from what a frame is drawn from, the cities that are there and what stayed from
//! before. All passes read it, and nothing works out again what it says.

use glam::{DVec2, DVec3};

use crate::{
    city::ground::Fade,
    render::{
        bake::{self, BakeRequest},
        bent,
        cells::Details,
        city_facts::{CityFacts, SectionFacts},
        cut::{Cuts, Lit},
        empty_lenses::{empty_lenses, idle_lenses},
        eye::view_uniform,
        frame::{Backend, FrameInput},
        layout,
        lens_numbers::LensNumbers,
        light::{self, LightSample},
        own_sprites::OwnSprites,
        picture_parts::PictureParts,
        plans::Plans,
        programs::{Made, Programs},
        section_rounds,
        seen::{Seen, seen_volumes},
        settings::Settings,
        sun_eye::{MapSize, SunEye},
    },
    scene::{BaseStyle, Technique},
    view::Frustum,
};

/// The sine of the angle from the horizon from which on a view counts as straight up or down: a fortieth of a degree from it.
const UPRIGHT: f64 = 1.0 - 1e-7;

/// How wide texels of maps may be, pixels, in pictures of several samples: each draws the maps anew, and finer ones take time for nothing.
/// What many points of the sky see is blurred anyway: two pixels add nothing to its error, three do.
const SUN_TEXEL_PX: f64 = 1.0;
const SKY_TEXEL_PX: f64 = 2.0;

/// What a frame depends on of the adapter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Adapter {
    /// Whether it is a program.
    pub is_software: bool,
    /// Whether it can test depth before the shader runs.
    pub tests_depth_early: bool,
    /// Whether triangles hold their depth where they are seen edge on.
    pub holds_depth: bool,
}

/// What stayed from the frame before.
pub(super) struct Stayed<'a> {
    /// Sprites that have eyes of their own.
    pub own_sprites: &'a mut OwnSprites,
    /// How much room there is for sprites, and for what is counted of them, bytes.
    pub sprite_bytes: u64,
    pub count_bytes: u64,
}

/// The plan of a frame.
pub(super) struct FramePlan<'a> {
    /// What the frame is drawn from.
    pub input: &'a FrameInput<'a>,
    pub settings: Settings,
    pub adapter: Adapter,
    /// In which detail the city is shown.
    pub details: Details,
    /// Whether some of what is shown has a base colour, and a normal per vertex.
    pub colored: bool,
    pub smooth: bool,
    /// Whether some walls have storeys and windows.
    pub facades: bool,
    /// Whether materials of it are translucent, in view or not; and whether textures are.
    pub clear_materials: bool,
    pub blended: bool,
    /// Whether something has light of its own.
    pub emits: bool,
    /// Whether texels say how much of it.
    pub texels_emit: bool,
    /// Whether the edges of the city are there.
    pub has_edges: bool,
    /// Sections of all cities, and of the scene's own.
    pub sections: Vec<SectionFacts>,
    pub own_sections: Vec<SectionFacts>,
    /// Half the diagonal of the city in plan, metres.
    pub radius: f64,
    /// How the plain ground fades, where there is one.
    pub fade: Option<Fade>,
    /// The volumes of lenses that the picture may show, and their numbers.
    pub seen: Seen,
    pub numbers: LensNumbers,
    /// From where the sample's light comes.
    pub light: LightSample,
    /// The eye of the sun, where there are shadows, and that of the sky's point, where it is hidden from parts of the city.
    pub sun: Option<SunEye>,
    pub sky: Option<SunEye>,
    /// What shaders do.
    pub plans: Plans,
    /// What is hidden.
    pub cuts: Cuts,
    /// Whether the scene asks for sections, in view or not.
    pub has_sections: bool,
    /// Depth sprites that have to be made.
    pub requests: Vec<BakeRequest<'a>>,
    /// Room for the sprites, and for what is counted of them, bytes.
    pub sprite_bytes: u64,
    pub count_bytes: u64,
    /// Words of sprites that come from files, each with where they begin.
    pub file_words: Vec<(u32, Vec<u32>)>,
    pub own_sprites: &'a OwnSprites,
    /// Where the picture is drawn.
    pub parts: PictureParts,
}

impl<'a> FramePlan<'a> {
    /// Whether triangles of a section hold their depth where they are seen edge on: parallel rays, and an eye straight above or below, see
    /// whole families of faces like that.
    pub fn holds_depth(&self, section: &SectionFacts) -> bool {
        let view = &self.input.view;
        let is_upright = view.basis.forward.z.abs() > UPRIGHT;
        self.adapter.holds_depth && section.is_read && (view.is_orthographic() || is_upright)
    }

    /// The plan of a frame.
    pub fn new(
        input: &'a FrameInput<'a>,
        facts: &CityFacts,
        adapter: Adapter,
        settings: Settings,
        stayed: Stayed<'a>,
    ) -> Self {
        let Stayed { own_sprites, .. } = stayed;
        own_sprites.plan(input, &facts.all);
        let empty = empty_lenses(input, facts);
        let seen = seen_volumes(input, &facts.all, own_sprites.room(), &idle_lenses(&empty, input));
        let of_contents = |frustum: &Frustum| facts.content_bounds(input, frustum);
        let map = |direction: DVec3, towards: DVec3, texel_px: f64| {
            let size = MapSize { most: settings.shadow_size, texel_px, towards };
            facts.light_eye(&input.view, direction, &size, of_contents)
        };
        let (middle, texel_px) = (light::to_sun(&input.sun), if input.is_summed() { SUN_TEXEL_PX } else { 0.0 });
        let has_sun = light::casts_shadows(&input.sun);
        let is_near =
            input.is_summed() && has_sun && map(middle, middle, texel_px).is_some_and(|eye| eye.levels.len() > 1);
        let light = LightSample::new(&input.sun, input.sample, input.samples, is_near);
        let sun = has_sun.then(|| map(light.to_sun, middle, texel_px)).flatten();
        let sky = light.sky.and_then(|sky| map(sky.to, DVec3::Z, SKY_TEXEL_PX));
        let lit = match (&sun, &sky) {
            // One program for all samples.
            (_, Some(_)) => Lit::FromEverywhere,
            (Some(sun), None) => Lit::From(sun.widest()),
            (None, None) => Lit::Unshaded,
        };
        let plans = Plans::new(input, &seen.volumes, &empty, facts.shows_clear_materials(&input.view));
        let is_seen = |lens| seen.volumes.iter().any(|v| v.lens == lens);
        let cuts = Cuts::new(input, is_seen, &empty, lit, plans.hiding.clone());
        let sprite_bytes = 4 * seen.words;
        let counts = 1 + u64::from(own_sprites.room().counts) + seen.volumes.len() as u64;
        let count_bytes = if seen.lists > 0 || own_sprites.counts() { 4 * counts } else { 0 };
        if sprite_bytes > stayed.sprite_bytes || count_bytes > stayed.count_bytes {
            // There is other room then, with nothing in it.
            own_sprites.forget();
        }
        let is_needed = |volume: usize| {
            let lens = input.volumes[volume].lens;
            let is_hiding = cuts.sun.as_ref().is_some_and(|cut| cut.hiding.lenses.contains(&lens));
            is_hiding || seen.volumes.iter().any(|v| v.index == volume)
        };
        let mut requests = bake::of_picture(&seen.volumes, input);
        requests.extend(own_sprites.to_make(input, is_needed, seen.lists));
        let file_words = own_sprites.note_made(is_needed);
        let own_sprites: &OwnSprites = own_sprites;
        let has_sections = section_rounds::are_asked_for(input);
        let bent = bent::bound(input.rays, &input.view, input.tile);
        Self {
            settings,
            adapter,
            details: facts.details(input),
            colored: has_sections || facts.is_textured(),
            facades: facts.has_facades(),
            // Sections have normals of their own.
            smooth: has_sections || facts.has_smooth,
            clear_materials: facts.has_clear_materials(),
            blended: facts.has_clear_textures(),
            emits: facts.emits,
            texels_emit: facts.texels_emit,
            has_edges: facts.has_edges,
            sections: facts.sections.clone(),
            own_sections: facts.own_sections.clone(),
            radius: light::radius_of(&if facts.bounds.is_empty() { input.fields.bounds() } else { facts.bounds }),
            fade: facts.fade,
            numbers: LensNumbers::new(input, &seen.volumes, &requests, own_sprites),
            parts: PictureParts::new(&seen.volumes, &plans.looked_at, bent, &plans.filters, input.tile.size),
            light,
            sun,
            sky,
            plans,
            cuts,
            has_sections,
            requests,
            sprite_bytes,
            count_bytes,
            file_words,
            own_sprites,
            seen,
            input,
        }
    }

    /// Whether the picture tells how much of the sky its places see.
    pub fn has_screen_occlusion(&self) -> bool {
        let input = self.input;
        input.screen_occlusion && input.samples == 1 && light::hides_sky(&input.sun)
    }

    /// Whether lenses may be seen.
    pub fn has_lenses(&self) -> bool {
        !self.seen.volumes.is_empty()
    }

    /// Whether everything is drawn in clay.
    pub fn is_clay(&self) -> bool {
        self.input.base == BaseStyle::Clay
    }

    /// Whether base colours come from a target.
    pub fn is_textured(&self) -> bool {
        self.colored && !self.is_clay()
    }

    /// Whether lists of lenses are narrowed to what each tile shows: of what is opaque, by the uber back end.
    pub fn narrows(&self) -> bool {
        let is_uber = self.input.technique == Technique::Accumulate && self.input.rays.is_empty();
        self.settings.narrows_lists && is_uber && self.plans.looks_at_many() && self.plans.layering.is_none()
    }

    /// The view of the picture, as shaders read it.
    pub fn view_uniform(&self) -> layout::View {
        let input = self.input;
        let jitter = crate::view::jitter_px(input.sample);
        let jitter = if input.is_summed() { jitter } else { DVec2::ZERO };
        view_uniform(&input.view, input.tile, jitter, input.sample, input.haze_per_radius() / self.radius)
    }

    /// The programs of the back end. `are_ready`: whether the pipelines of these programs are there, which the adaptive one asks.
    pub fn programs(&self, are_ready: impl FnOnce(&Programs) -> bool) -> Programs {
        let made =
            Made { has_shadows: self.sun.is_some() || self.sky.is_some(), clear_materials: self.clear_materials };
        let specialised = || Programs::specialised(&self.plans, &self.cuts);
        let uber = || Programs::uber(self.input, &self.plans, &self.cuts, made);
        match self.input.backend {
            // Those kept for reference are written out.
            _ if self.input.technique != Technique::Accumulate => specialised(),
            // What is written out for so many compiles for minutes.
            Backend::Specialised | Backend::Adaptive if self.plans.is_long() => uber(),
            Backend::Specialised => specialised(),
            Backend::Uber => uber(),
            Backend::Adaptive => {
                let wanted = specialised();
                if are_ready(&wanted) { wanted } else { uber() }
            }
        }
    }

    /// The effects that run, in no order.
    pub fn effects(&self) -> Vec<u32> {
        let plans = &self.plans;
        let all = [Some(&plans.context), Some(&plans.lenses), plans.layering.as_ref(), plans.lining.as_ref()];
        let cuts = self.cuts.all().map(|cut| &cut.plan);
        all.into_iter().flatten().chain(cuts).flat_map(|plan| plan.effects()).collect()
    }
}
