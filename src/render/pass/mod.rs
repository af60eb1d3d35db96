//! The passes of a frame, one file each, in one ordered table.
//!
//! ```text
//! crossings of sprites    of rays with the solids of lenses that have layered sprites
//! stored depth sprites    of the lens volumes in view that are tested by them, and those that have eyes of their own and are not there yet
//! shadow map              if the sun casts shadows and the map does not hold this view yet
//! sky map                 of several samples: what a point of the sky sees, in each another
//! depth sprites           of the solids in view whose sides are asked for: nothing, then
//! depth sprites, nearest  where rays enter first
//! depth sprites, farthest and where they leave last
//! geometry                everything once; on a software adapter what is near, and then
//! geometry beyond         what that does not hide, where it hides much
//! geometry                where a technique goes by regions: chunks that no lens reaches, as ever
//! geometry of a region    for each region that may occur: chunks that may reach into it; fragments in other regions are discarded before visibility
//! ends of lenses          where rays leave lenses that ask for sections, and enter them,
//! count sections          how many closed shells are laid open there,
//! sections                and the surface that closes them
//! bent rays               what lenses that bend rays show, in place of what was drawn there,
//! moved corners           or the city's triangles where they show its corners,
//! images of rays          and its images, where it has some
//! images of lenses        of lenses that bend pictures: what the eye sees, as finely as they show it,
//! bent pictures           and what pixels in them find there, in place of what was drawn
//! clear lens masks        where AOVs or statistics ask for them
//! layers                  every fragment that is seen through and not behind what is opaque, into the list of its pixel
//! count layers            where opacity rules ask how many layers the picture has
//! sort layers             where a list is very long
//! composite               the lists, sorted and laid one over the other
//! slots, depths           where the scene asks for a K-buffer or peeling: the nearest layers of each pixel,
//! slots, codes            which fragments these are,
//! slots, rest             and their normals and colours
//! link slots              slots as lists
//! weighted                what found no slot as one layer
//! stochastic              layers that are there by chance, in place of lists
//! narrow lists            per-tile lens culling: of many lenses, those that each tile shows something of
//! ambient occlusion       of one sample, where it is asked for: how much of the sky the picture's places see
//! lines                   edges, where effects draw them
//! unfiltered              for each neighbourhood filter in view: its lens' own image over the lens' bounds and what the filter reaches beyond them,
//! filter down             and the filter, down
//! filter across           and across
//! classes                 the lens masks, where a technique goes by regions and something asks for them
//! shade                   outside of where lenses may be seen without them, inside with them
//! regions                 the numbers of regions as depths, with those of the background
//! shade regions           each region by a shader of its own that tests no lens
//! shown layers            where AOVs are asked for
//! resolve                 the mean of the samples, after the last of several
//! furniture               title, caption, legends: over the last sample
//! furniture over          its layer, where the picture is transparent
//! ```
//!
//! A pass that the scene does not call for is not recorded: [`Inputs::of`] asks each what the plan of a frame wants of it. Another pass
//! is a file here and a row in the table.

use crate::{
    gpu::{Gpu, GpuError},
    render::{
        pass::context::{Board, FrameContext, Keys, Line, Pass, Preparing},
        plan::FramePlan,
        programs::Programs,
        resource::{recording::Recording, targets::Needs},
    },
};

pub mod ambient_occlusion;
pub mod composite;
pub mod context;
pub mod culling_depth;
pub mod filters;
pub mod furniture;
pub mod geometry;
pub mod layering;
pub mod layers;
pub mod lines;
pub mod masks;
pub mod narrow;
pub mod opaque;
pub mod picture_pass;
pub mod ray_warp;
pub mod rays;
pub mod reference;
pub mod resolve;
pub mod section_kind;
pub mod sections;
pub mod shade;
pub mod shadow;
pub mod shown_layers;
pub mod solid_sprites;
pub mod stored_sprites;
pub mod translucent;
pub mod transparency;

macro_rules! table {
    ($($field:ident: $pass:ty,)*) => {
        /// What the passes keep on the GPU for a view.
        #[derive(Debug)]
        pub(in crate::render) struct Passes {
            $(pub $field: $pass,)*
        }

        /// What a frame asks of the passes.
        pub(in crate::render) struct Inputs<'a> {
            $($field: Option<<$pass as Pass>::Input<'a>>,)*
        }

        impl<'a> Inputs<'a> {
            /// What a plan asks of each.
            pub fn of(plan: &'a FramePlan<'a>) -> Self {
                Self { $($field: <$pass as Pass>::wanted(plan),)* }
            }

            /// The lines of the list of those that are asked for.
            #[cfg(test)]
            pub fn lines(&self) -> Vec<&'static [Line]> {
                let mut lines = Vec::new();
                $(lines.extend(self.$field.as_ref().map(|_| <$pass as Pass>::LIST));)*
                lines
            }

            /// Adds the targets that they draw into.
            pub fn add_needs(&self, plan: &FramePlan, needs: &mut Needs) {
                $(if let Some(input) = &self.$field {
                    <$pass as Pass>::add_needs(input, plan, needs);
                })*
            }
        }

        impl Passes {
            /// Nothing yet.
            ///
            /// # Errors
            /// Those of the GPU.
            pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
                Ok(Self { $($field: <$pass as Pass>::new(gpu)?,)* })
            }

            /// Notes that a frame begins.
            pub fn begin(&mut self, plan: &FramePlan) {
                $(self.$field.begin(plan);)*
            }

            /// Forgets what they take to be on the GPU.
            pub fn forget(&mut self) {
                $(Pass::forget(&mut self.$field);)*
            }

            /// The pipelines that they ask for where a frame runs these programs.
            pub fn keys(&self, inputs: &Inputs, plan: &FramePlan, programs: &Programs) -> Keys {
                let mut keys = Keys::default();
                $(self.$field.add_keys(inputs.$field.as_ref(), plan, programs, &mut keys);)*
                keys
            }

            /// Brings what they keep up to date.
            ///
            /// # Errors
            /// Those of the GPU.
            pub fn prepare(&mut self, inputs: &Inputs, stage: &mut Preparing) -> Result<(), GpuError> {
                $(if let Some(input) = &inputs.$field {
                    self.$field.prepare(input, stage)?;
                })*
                Ok(())
            }

            /// Records those that are asked for, in the order of the table.
            ///
            /// # Errors
            /// Those of the GPU.
            pub fn record(
                &mut self,
                inputs: &Inputs,
                frame: &FrameContext,
                recording: &mut Recording,
            ) -> Result<(), GpuError> {
                let mut board = Board::default();
                $(if let Some(input) = &inputs.$field {
                    self.$field.record(input, frame, recording, &mut board)?;
                })*
                Ok(())
            }
        }

        /// The list of all passes, in the order of a frame.
        pub fn list() -> Vec<Line> {
            [$(<$pass as Pass>::LIST,)*].concat()
        }
    };
}

table! {
    // Before the city: what a lens hides is decided by them.
    stored: stored_sprites::StoredSprites,
    shadow: shadow::ShadowMap,
    sky: shadow::SkyMap,
    sides: solid_sprites::SolidSprites,
    geometry: geometry::Geometry,
    region_geometry: reference::region_geometry::RegionGeometry,
    sections: sections::Sections,
    rays: rays::Rays,
    warp: ray_warp::RayWarp,
    masks: masks::ClearMasks,
    layers: layers::ExactLayers,
    slots: transparency::slots::SlotLayers,
    stochastic: transparency::stochastic::StochasticLayers,
    narrow: narrow::Narrow,
    occlusion: ambient_occlusion::AmbientOcclusion,
    lines: lines::Lines,
    filters: filters::Filters,
    classes: reference::region_shade::Classes,
    shade: shade::Shade,
    region_shade: reference::region_shade::RegionShade,
    shown_layers: shown_layers::ShownLayers,
    resolve: resolve::Resolve,
    furniture: furniture::FurniturePass,
}

#[cfg(test)]
mod tests;
