//! Insets: pictures of the same city from other eyes, kept as images and drawn again only when they are another.
//!
//! A view has its own state on the GPU - targets, buffers, bind groups, shadow map, lists - so that views that take turns neither make nor
//! upload anything as long as nothing changes (architecture, decision 5); pipelines, city and images are those of all.

use crate::{
    render::{
        furniture::Furniture,
        images::Whole as Image,
        occlusion::Occlusion,
        picture::{RenderError, Request, Studio},
        renderer::Renderer,
        stats::Pass,
        view_state::ViewState,
    },
    scene::Scene,
};

/// How many triangles an inset may take for each of its pixels.
pub const TRIANGLES_PER_PIXEL: u64 = 4;

/// One inset.
#[derive(Debug)]
pub(super) struct Inset {
    state: ViewState,
    /// What its occlusion lenses found last.
    occlusion: Occlusion,
    /// What its image shows.
    of: Option<Shown>,
}

/// What an image shows.
#[derive(Debug)]
struct Shown {
    scene: Scene,
    request: Request,
    furniture: Furniture,
}

/// What it should show.
#[derive(Clone, Copy)]
struct Asked<'a> {
    scene: &'a Scene,
    request: &'a Request,
    furniture: &'a Furniture,
}

impl Asked<'_> {
    fn is(&self, shown: &Shown) -> bool {
        let Self { scene, request, furniture } = *self;
        shown.scene == *scene && shown.request == *request && shown.furniture == *furniture
    }
}

impl Studio {
    /// Draws `scene` and `furniture` over it into the image `number` ([`crate::render::renderer::Renderer::images`]), unless that shows it already. The passes that
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
        let asked = Asked { scene, request, furniture };
        let most = TRIANGLES_PER_PIXEL * request.size.iter().map(|&side| u64::from(side)).product::<u64>();
        self.find_blocks(most)?;
        let mut inset = match self.insets.remove(&number) {
            Some(inset) => inset,
            None => Inset { state: ViewState::new(&self.renderer.gpu)?, occlusion: Occlusion::default(), of: None },
        };
        let shows = !is_stale
            && self.renderer.images.size(number).is_some()
            && inset.of.as_ref().is_some_and(|of| asked.is(of));
        let drawn = match shows {
            true => Ok(None),
            false => self.draw_inset(&mut inset, number, asked, most).map(Some),
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
        asked: Asked,
        most: u64,
    ) -> Result<Vec<Pass>, RenderError> {
        let Asked { scene, request, furniture } = asked;
        inset.of = None;
        let stood_at = self.stance.at();
        std::mem::swap(&mut inset.state, &mut self.renderer.view);
        std::mem::swap(&mut inset.occlusion, &mut self.known().occlusion);
        let whole = Image { number, size: request.size, is_opaque: !request.transparent };
        let drawn = self.draw_parts(scene, request, furniture, Some(most), &mut |renderer, part| {
            let Renderer { gpu, images, view, .. } = renderer;
            if let Some(targets) = &view.targets {
                images.copy_part(gpu, whole, &targets.picture.texture, part);
            }
        });
        if drawn.is_ok() {
            inset.of = Some(Shown { scene: scene.clone(), request: *request, furniture: furniture.clone() });
        }
        std::mem::swap(&mut inset.state, &mut self.renderer.view);
        std::mem::swap(&mut inset.occlusion, &mut self.known().occlusion);
        self.put_at(stood_at);
        drawn
    }

    /// Forgets insets and images whose numbers are not asked for any more.
    pub fn keep_insets(&mut self, is_kept: impl Fn(u64) -> bool) {
        self.insets.retain(|number, _| is_kept(*number));
        self.renderer.images.keep(is_kept);
    }
}
