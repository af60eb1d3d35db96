//! The passes of a frame, one file each, in one ordered table.
//!
//! ```text
//! LIST
//! ```
//!
//! A pass that the scene does not call for is not recorded (U3): [`Inputs::of`] asks each what the plan of a frame wants of it. Another pass
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
        /// What the passes keep on the card for a view.
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
            /// Those of the graphics card.
            pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
                Ok(Self { $($field: <$pass as Pass>::new(gpu)?,)* })
            }

            /// Notes that a frame begins.
            pub fn begin(&mut self, plan: &FramePlan) {
                $(self.$field.begin(plan);)*
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
            /// Those of the graphics card.
            pub fn prepare(&mut self, inputs: &Inputs, stage: &mut Preparing) -> Result<(), GpuError> {
                $(if let Some(input) = &inputs.$field {
                    self.$field.prepare(input, stage)?;
                })*
                Ok(())
            }

            /// Records those that are asked for, in the order of the table.
            ///
            /// # Errors
            /// Those of the graphics card.
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
    sides: solid_sprites::SolidSprites,
    geometry: geometry::Geometry,
    region_geometry: reference::region_geometry::RegionGeometry,
    sections: sections::Sections,
    masks: masks::ClearMasks,
    layers: layers::ExactLayers,
    slots: transparency::slots::SlotLayers,
    stochastic: transparency::stochastic::StochasticLayers,
    narrow: narrow::Narrow,
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
