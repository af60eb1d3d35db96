//! Names of modules, for people and statistics.

use crate::shader::{effect::registry::handlers, module::Module, names, plan::program::Program};

impl Module {
    /// A name for people and statistics.
    pub fn name(&self) -> String {
        match self {
            Self::Geometry(Some(program)) if program.regions().is_some() => "geometry of a region".to_owned(),
            Self::Geometry(hidden) => format!("geometry{}", hidden_name(hidden.as_ref())),
            Self::Shadow(hidden) => format!("shadow{}", hidden_name(hidden.as_ref())),
            Self::Sprite => "sprite".to_owned(),
            Self::StoredForm(_) => "stored sprite".to_owned(),
            Self::StoredLayers(_) => "stored sprite in layers".to_owned(),
            Self::SpriteList => "crossings of a sprite".to_owned(),
            Self::CombinedSprite(_) => "sprite of a combination".to_owned(),
            Self::Rays(hidden, _) => format!("rays{}", hidden_name(hidden.as_ref())),
            Self::TracedRays(hidden, _) => format!("traced rays{}", hidden_name(hidden.as_ref())),
            Self::RayVertices(hidden, _) => format!("moved corners{}", hidden_name(hidden.as_ref())),
            Self::RayWarp(_) => "looks into images".to_owned(),
            Self::RayImages(_) => "images of rays".to_owned(),
            Self::Shade(program) => {
                let names = names::of_effects(program);
                let names = if names.is_empty() { names } else { format!(" ({names})") };
                let branches = if program.regions().is_some() { " in branches" } else { "" };
                let uber = names::of_backend(program);
                let lenses = if program.has().lenses { " lenses" } else { "" };
                format!("shade{uber}{branches}{names}{lenses}")
            }
            Self::Lines(program) => {
                let uber = names::of_backend(program);
                format!("lines{uber} ({})", names::of_effects(program))
            }
            Self::Layers(program, _) => format!("layers{}", names::of_hidden(program)),
            Self::Composite(program) => {
                let uber = names::of_backend(program);
                format!("composite{uber} ({})", names::of_effects(program))
            }
            Self::RayLayers(program) => format!("layers of rays{}", names::of_hidden(program)),
            Self::CountLayers => "count layers".to_owned(),
            Self::SortLayers => "sort layers".to_owned(),
            Self::ShownLayers => "shown layers".to_owned(),
            Self::Slots(program, _) => format!("slots{}", names::of_hidden(program)),
            Self::LinkSlots => "link slots".to_owned(),
            Self::Forward(own) => own.name(),
            Self::Regions(_) => "regions".to_owned(),
            Self::Sections(program) => format!("sections{}", names::of_hidden(program)),
            Self::Filter(effect) => format!("filter {}", handlers()[*effect as usize].name),
            Self::AmbientOcclusion => "ambient occlusion".to_owned(),
            Self::Resolve => "resolve".to_owned(),
            Self::Narrow => "narrow".to_owned(),
            Self::Refine(_) => "refine".to_owned(),
            Self::Furniture => "furniture".to_owned(),
            Self::FurnitureOver => "furniture over".to_owned(),
            Self::Bare => "bare".to_owned(),
        }
    }
}

fn hidden_name(hidden: Option<&Program>) -> String {
    hidden.map_or_else(String::new, names::of_hidden)
}
