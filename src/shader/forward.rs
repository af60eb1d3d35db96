//! Translucent fragments shaded where they are drawn: the modules of methods that know no order of layers, put together from
//! what shades a pixel, what tells which fragments are translucent, and what draws the city.

use crate::shader::{
    adapter::Adapter,
    backend,
    effect::definition::EffectDefinition,
    files,
    geometry::{self, Drawn, NOTHING_CUT},
    hiding::{self, Eye},
    library::{
        CHANCE, DITHER, FACADE, FORWARD, FRAGMENT, FRAGMENT_AT, FRAGMENT_NODES, GEOMETRY, SHADE, TAIL, TEXEL,
        TRANSLUCENT,
    },
    names,
    plan::{Bends, program::Program},
    rays,
    shading::Shading,
    table::MOST_SLOTS,
    template::Template,
    translucent::{self, DepthTest, behind_plane},
    wgsl::{function::without_entry, merge::merged},
};

/// Methods: what becomes of a fragment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ForwardKind {
    /// It is added to the layer that all behind the slots are, or all.
    Tail,
    /// It is there or not by chance; whether its depth is that of its plane.
    Chance(bool),
}

/// Such a module.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Forward {
    /// The method.
    pub kind: ForwardKind,
    /// The part of the scene that decides what is translucent.
    pub hidden: Program,
    /// The part that decides how it looks.
    pub shading: Program,
}

impl Forward {
    /// A name for people and statistics.
    pub fn name(&self) -> String {
        let kind = if self.kind == ForwardKind::Tail { "weighted" } else { "stochastic" };
        format!("{kind}{} ({})", names::of_backend(&self.shading), names::of_effects(&self.shading))
    }

    /// The whole WGSL text.
    pub(super) fn source(&self, handlers: &[EffectDefinition], lenses: &[&str], adapter: &Adapter) -> String {
        merged(&self.shading_text(handlers, lenses, adapter), &self.city_text(handlers, lenses))
    }

    /// The text that shades a fragment, and says what becomes of it then.
    fn shading_text(&self, handlers: &[EffectDefinition], lenses: &[&str], adapter: &Adapter) -> String {
        // As many parameters as the longer list reads.
        let slots = match &self.hidden {
            Program::Specialised(plan) => plan.slots(handlers),
            Program::Uber(_) => MOST_SLOTS,
        };
        let own = backend::shading(&self.shading, handlers, lenses, &Shading::of_fragments(slots));
        let opacity = backend::opacity(&self.shading, handlers);
        // The values that a triangle carries elsewhere are made where they are read.
        let shade = SHADE.changed(|text| without_entry(text, "vertex", "corner_of"));
        let text = Template::of_files(&files::of_shading(&self.shading, handlers))
            .then(Template::below_path(SHADE.path, &shade))
            .fill("ray", rays::source(Bends::default(), false))
            .fill("snapping", adapter.snapping())
            .fill("carried", own.members)
            .fill("handlers", own.functions + &opacity)
            .then(Template::of_files(&[TEXEL, FORWARD]));
        match self.kind {
            ForwardKind::Tail => text.then(Template::of_files(&[FRAGMENT_NODES, TAIL])),
            ForwardKind::Chance(is_of_plane) => {
                let (member, set) = match is_of_plane {
                    true => ("    @builtin(frag_depth) depth: f32,\n", "    laid.depth = depth;\n"),
                    false => ("", ""),
                };
                text.then(Template::of_files(&[CHANCE])).fill("depth", member).fill("set", set)
            }
        }
        .text()
    }

    /// The text that draws the city, and tells which fragments are translucent.
    fn city_text(&self, handlers: &[EffectDefinition], lenses: &[&str]) -> String {
        let shading = [files::of_shading(&self.shading, handlers), vec![SHADE]].concat();
        let mut files = files::of_lenses(&self.hidden);
        files.retain(|file| !shading.contains(file));
        files.extend(files::of_objects(&self.hidden).into_iter().filter(|file| !shading.contains(file)));
        files.extend([FRAGMENT, FRAGMENT_AT, files::vertices(&self.hidden), FACADE, GEOMETRY, TRANSLUCENT]);
        if !shading.contains(&DITHER) {
            files = files::with_threshold(files);
        }
        let hidden = hiding::source(&self.hidden, handlers, lenses, Eye::Fragments) + NOTHING_CUT;
        let text = geometry::filled(Template::of_files(&files), Drawn::Shaded, &hidden);
        // The opaque depth is read where shading reads it. Where the depth test comes after the shader, it writes too.
        let opaque = (self.kind == ForwardKind::Tail).then_some("scene_depth");
        translucent::filled(text, DepthTest::Any, self.hidden.has().contents, opaque, "discard;")
            .leave("opaque-depth")
            .fill("behind-plane", opaque.map(behind_plane).unwrap_or_default())
            .text()
    }
}
