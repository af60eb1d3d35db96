//! Insets: pictures of the same city from other eyes, kept as images and drawn again only when they are another (B8).
//!
//! A view has its own state on the card - targets, buffers, bind groups, shadow map, lists - so that views that take turns neither make nor
//! upload anything as long as nothing changes (architecture, decision 5); pipelines, city and images are those of all.

use std::sync::{Mutex, PoisonError};

use crate::{
    gpu::{Gpu, GpuError},
    render::{
        contents::Contents,
        curtain::Curtain,
        deformed::Deformed,
        furniture::{Furniture, FurnitureOnGpu},
        layers::{LayerFigures, LayersOnGpu},
        narrow::Narrowing,
        occlusion::Occlusion,
        own_sprites::OwnSprites,
        picture::{RenderError, Request, Studio},
        regions::RegionsOnGpu,
        renderer::{Buffers, Groups, Renderer, Shadow},
        sections::SectionsOnGpu,
        solids::SolidTable,
        stats::Pass,
        stored::KeptSprite,
        targets::Targets,
        transparency::{MethodFigures, SlotsOnGpu},
    },
    scene::Scene,
};

macro_rules! view_state {
    ($($field:ident: $type:ty,)*) => {
        /// What the renderer keeps for one view.
        #[derive(Debug)]
        pub(super) struct ViewState {
            $($field: $type,)*
        }

        impl ViewState {
            /// Exchanges what the renderer keeps for the view that it is drawing for this.
            fn swap(&mut self, renderer: &mut Renderer) {
                $(std::mem::swap(&mut self.$field, &mut renderer.$field);)*
            }
        }
    };
}

view_state! {
    contents: Contents,
    targets: Option<Targets>,
    buffers: Buffers,
    groups: Option<Groups>,
    shadow_of: Option<Shadow>,
    narrowing: Option<Narrowing>,
    binds_narrowed: bool,
    solids_of: Option<std::sync::Arc<SolidTable>>,
    curtain: Option<Curtain>,
    deformed: Option<Deformed>,
    regions: Option<RegionsOnGpu>,
    sections: Option<SectionsOnGpu>,
    has_sections: bool,
    furniture: Option<FurnitureOnGpu>,
    own_sprites: OwnSprites,
    kept_sprites: Vec<KeptSprite>,
    list_target: Option<wgpu::TextureView>,
    lists_crossings: bool,
    crossing_room: u64,
    layers: Option<LayersOnGpu>,
    layer_figures: LayerFigures,
    slots: Option<SlotsOnGpu>,
    method_figures: MethodFigures,
    longest_list: u32,
}

impl ViewState {
    fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        Ok(Self {
            contents: Contents::default(),
            targets: None,
            buffers: Buffers::new(gpu)?,
            groups: None,
            shadow_of: None,
            narrowing: None,
            binds_narrowed: false,
            solids_of: None,
            curtain: None,
            deformed: None,
            regions: None,
            sections: None,
            has_sections: false,
            furniture: None,
            own_sprites: OwnSprites::default(),
            kept_sprites: Vec::new(),
            list_target: None,
            lists_crossings: false,
            crossing_room: 0,
            layers: None,
            layer_figures: LayerFigures::default(),
            slots: None,
            method_figures: MethodFigures::default(),
            longest_list: 0,
        })
    }
}

/// How many triangles an inset may take for each of its pixels.
pub const TRIANGLES_PER_PIXEL: u64 = 4;

/// One inset.
#[derive(Debug)]
pub(super) struct Inset {
    state: ViewState,
    /// Whom its occlusion lenses found last.
    occlusion: Mutex<Occlusion>,
    /// What its image shows.
    of: Option<(Scene, Request, Furniture)>,
}

impl Studio {
    /// Draws `scene` and `furniture` over it into the image `number` ([`Renderer::images`]), unless that shows it already. The passes that
    /// ran; `None`: it was not drawn. `is_stale`: images of the furniture show something else than before.
    ///
    /// # Errors
    /// Those of a picture.
    pub fn inset(
        &mut self,
        number: u64,
        scene: &Scene,
        request: &Request,
        furniture: &Furniture,
        is_stale: bool,
    ) -> Result<Option<Vec<Pass>>, RenderError> {
        let most = TRIANGLES_PER_PIXEL * request.size.iter().map(|&side| u64::from(side)).product::<u64>();
        self.find_blocks(most)?;
        let mut inset = match self.insets.remove(&number) {
            Some(inset) => inset,
            None => Inset { state: ViewState::new(&self.renderer.gpu)?, occlusion: Mutex::default(), of: None },
        };
        let shows = !is_stale
            && self.renderer.images.size(number).is_some()
            && inset.of.as_ref().is_some_and(|(s, r, f)| s == scene && r == request && f == furniture);
        let drawn = match shows {
            true => Ok(None),
            false => self.draw_inset(&mut inset, number, (scene, request, furniture), most).map(Some),
        };
        if drawn.is_ok() {
            self.insets.insert(number, inset);
        }
        drawn
    }

    fn draw_inset(
        &mut self,
        inset: &mut Inset,
        number: u64,
        (scene, request, furniture): (&Scene, &Request, &Furniture),
        most: u64,
    ) -> Result<Vec<Pass>, RenderError> {
        inset.of = None;
        let swap_occlusion = |a: &mut Mutex<Occlusion>, b: &mut Mutex<Occlusion>| {
            let [a, b] = [a, b].map(|m| m.get_mut().unwrap_or_else(PoisonError::into_inner));
            std::mem::swap(a, b);
        };
        inset.state.swap(&mut self.renderer);
        swap_occlusion(&mut inset.occlusion, &mut self.occlusion);
        let drawn = self.draw_with(scene, request, furniture, Some(most)).and_then(|passes| {
            // Lists that were too short are long enough the second time.
            let grows = self.renderer.makes_room()? | self.renderer.sorts_longer()?;
            if grows { self.draw_with(scene, request, furniture, Some(most)) } else { Ok(passes) }
        });
        if drawn.is_ok()
            && let Some(targets) = &self.renderer.targets
        {
            let is_opaque = !request.transparent;
            self.renderer.images.copy(&self.renderer.gpu, number, &targets.picture.texture, is_opaque);
            inset.of = Some((scene.clone(), *request, furniture.clone()));
        }
        inset.state.swap(&mut self.renderer);
        swap_occlusion(&mut inset.occlusion, &mut self.occlusion);
        drawn
    }

    /// Forgets insets and images whose numbers are not asked for any more.
    pub fn keep_insets(&mut self, is_kept: impl Fn(u64) -> bool) {
        self.insets.retain(|number, _| is_kept(*number));
        self.renderer.images.keep(is_kept);
    }
}
