//! What a renderer keeps on the GPU for one view.

use crate::{
    gpu::{Gpu, GpuError},
    render::{
        contents::Contents,
        deformed::Deformed,
        own_sprites::OwnSprites,
        pass::Passes,
        resource::targets::{Needs, Targets},
        shared::Shared,
    },
};

/// The state of a view: with one each, views that take turns neither make nor upload anything as long as nothing changes.
#[derive(Debug)]
pub(super) struct ViewState {
    /// Which of the cities that were put on the GPU the rest is of.
    city: u64,
    /// Contents of lenses.
    pub contents: Contents,
    /// What deformations make of the city in this view, and of contents.
    pub deformed: Vec<Deformed>,
    pub targets: Option<Targets>,
    pub shared: Shared,
    pub passes: Passes,
    /// The sprites that have eyes of their own.
    pub own_sprites: OwnSprites,
}

impl ViewState {
    /// Nothing yet.
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        Ok(Self {
            city: 0,
            contents: Contents::default(),
            deformed: Vec::new(),
            targets: None,
            shared: Shared::new(gpu)?,
            passes: Passes::new(gpu)?,
            own_sprites: OwnSprites::default(),
        })
    }

    /// The city that was put on the GPU as the so-manieth is there now: of another, nothing is kept.
    pub fn begin_city(&mut self, number: u64) {
        if self.city == number {
            return;
        }
        self.city = number;
        self.deformed.clear();
        self.contents = Contents::default();
        self.passes.layers.forget();
        self.passes.slots.drop_lists();
        self.change_surfaces();
    }

    /// The table of surfaces is another one now, and what casts shadows.
    pub fn change_surfaces(&mut self) {
        self.shared.stamp += 1;
        self.shared.world += 1;
    }

    /// Gives back the targets and the lists of translucent layers.
    pub fn drop_targets(&mut self) {
        self.targets = None;
        self.shared.stamp += 1;
        self.passes.layers.drop_lists();
        self.passes.slots.drop_lists();
    }
}

/// Makes targets fit; what is there is kept where it does.
pub(super) fn fit_targets<'a>(
    gpu: &Gpu,
    targets: &'a mut Option<Targets>,
    shared: &mut Shared,
    needs: Needs,
    sums: wgpu::TextureFormat,
) -> &'a Targets {
    let fitting = match targets.take() {
        Some(fitting) if fitting.serve(&needs) => fitting,
        before => {
            shared.stamp += 1;
            Targets::new(gpu, needs, sums, before)
        }
    };
    targets.insert(fitting)
}
