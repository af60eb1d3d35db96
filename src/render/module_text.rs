//! The text of the modules that a frame runs, for people to read.

use crate::{
    geom::Aabb,
    lens::Lens,
    render::{
        frame::{Backend, FrameInput, ShaderPart},
        plans::Plans,
        renderer::Renderer,
        resource::pipeline::adapter,
        seen::seen_volumes,
        stored::SpriteRoom,
    },
    shader::{Module, Plan, Program, Uber, handlers},
};

const NOTHING_TRANSLUCENT: &str = "// Nothing is translucent.\n";

impl Renderer {
    /// The text of a module as it runs where the lenses are in the picture; without lenses in view everywhere.
    pub fn shader(&self, input: &FrameInput, lenses: &[Lens], part: ShaderPart) -> String {
        let bounds = self.cities().map_or(Aabb::EMPTY, |cities| cities.reach());
        let seen = seen_volumes(input, &bounds, SpriteRoom::default(), &[]).volumes;
        let facts = self.cities().map(|cities| cities.facts());
        let clear_materials = facts.as_ref().is_some_and(|facts| facts.has_clear_materials());
        let plans = Plans::new(input, &seen, &[], clear_materials);
        let names: Vec<&str> = plans.seen.iter().map(|&n| lenses[n as usize].name.as_str()).collect();
        let is_written_out = input.backend == Backend::Specialised && !plans.is_long();
        let (plan, operations) = (if seen.is_empty() { plans.context } else { plans.lenses }, input.operations);
        let (haze, masks) = (plan.haze, plan.masks);
        let shade = match is_written_out {
            true => Program::Specialised(plan),
            false => Program::Uber(operations.uber(plan.haze, plan.masks, clear_materials)),
        };
        let of = |plan: Option<Plan>, uber: Option<Uber>| match is_written_out {
            true => plan.map(Program::Specialised),
            false => uber.map(Program::Uber),
        };
        if let Some(regions) = &plans.regions {
            // Of the last region, which most lenses have a part in.
            let last = regions.passes.last().map_or_else(Plan::default, |pass| pass.shade.clone());
            let module = match part {
                ShaderPart::Shade => Some(Module::Shade(Program::Specialised(last))),
                ShaderPart::Geometry => Some(Module::Geometry(Some(Program::Specialised(regions.plan.clone())))),
                _ => None,
            };
            if let Some(module) = module {
                return module.source_for_people(handlers(), &names, &adapter(&self.gpu));
            }
        }
        let layering = match is_written_out {
            true => plans.layering.map(Program::Specialised),
            false => {
                let uber = operations.uber_layering(haze, masks, clear_materials);
                uber.filter(|_| plans.layering.is_some()).map(Program::Uber)
            }
        };
        let [picture, sun] = operations.uber_hiding(clear_materials);
        let by_shapes = |mut plan: Plan| {
            let shapes = seen.iter().map(|v| input.volumes[v.index].test_from_sun());
            plan.lenses.iter_mut().flat_map(|l| &mut l.volumes).zip(shapes).for_each(|(test, shape)| *test = shape);
            plan.clear_materials = false;
            plan.without_borders()
        };
        let module = match part {
            ShaderPart::Shade => Module::Shade(shade),
            ShaderPart::Geometry => Module::Geometry(of(plans.hiding, picture)),
            ShaderPart::Shadow => Module::Shadow(of(plans.hiding.map(by_shapes), sun)),
            ShaderPart::Layers => match of(plans.hiding, picture).filter(|_| layering.is_some()) {
                Some(program) => Module::Layers(program, self.gpu.tests_depth_early()),
                None => return NOTHING_TRANSLUCENT.to_owned(),
            },
            ShaderPart::Composite => match layering {
                Some(program) => Module::Composite(program),
                None => return NOTHING_TRANSLUCENT.to_owned(),
            },
            ShaderPart::Lines => match of(plans.lining, operations.uber_lining()) {
                Some(program) => Module::Lines(program),
                None => return "// Nothing draws lines.\n".to_owned(),
            },
        };
        module.source_for_people(handlers(), &names, &adapter(&self.gpu))
    }
}
