//! The handlers that there are.

use std::sync::{LazyLock, PoisonError, RwLock};

use crate::shader::{
    effect::{
        definition::EffectDefinition,
        prototype::{AskedBy, Mode},
    },
    effect_file::read,
};

macro_rules! built_in {
    ($name:literal) => {
        (concat!("shaders/effect/", $name, ".wgsl"), include_str!(concat!("../../../shaders/effect/", $name, ".wgsl")))
    };
}

/// The handlers that come with the program: effects in the order people read them, then what runs without being asked.
const FILES: &[(&str, &str)] = &[
    built_in!("thematic"),
    built_in!("flat"),
    built_in!("cel"),
    built_in!("gooch"),
    built_in!("clay"),
    built_in!("x-ray-tint"),
    built_in!("hidden-line"),
    built_in!("wireframe"),
    built_in!("greyscale"),
    built_in!("sepia"),
    built_in!("invert"),
    built_in!("darken"),
    built_in!("brighten"),
    built_in!("saturate"),
    built_in!("overlay"),
    built_in!("discard-color"),
    built_in!("posterise"),
    built_in!("engraving"),
    built_in!("blur"),
    built_in!("edges"),
    built_in!("feature-lines"),
    built_in!("coming-lines"),
    built_in!("iso-lines"),
    built_in!("transfer"),
    built_in!("eraser"),
    built_in!("cut-away"),
    built_in!("screen-door"),
    built_in!("transparent"),
    built_in!("x-ray"),
    built_in!("film"),
    built_in!("soft-film"),
    built_in!("peel"),
    built_in!("brick"),
    built_in!("gloss"),
    built_in!("marble"),
    built_in!("velvet"),
    built_in!("glow"),
    built_in!("lighting"),
    built_in!("lambert"),
    built_in!("haze"),
    built_in!("own-ray"),
    built_in!("translate"),
    built_in!("scale"),
    built_in!("shear"),
    built_in!("taper"),
    built_in!("twist"),
    built_in!("bend"),
    built_in!("open-street"),
    built_in!("set"),
    built_in!("shift"),
    built_in!("ceil"),
    built_in!("floor"),
    built_in!("time-of-day"),
    built_in!("loop"),
    built_in!("aggregate"),
    built_in!("ghost"),
    built_in!("link"),
];

/// How many handlers the 13 bits of an invoker can tell apart.
pub const MOST_HANDLERS: usize = 8192;

/// The handlers there are. Definitions are never freed: a pipeline may refer to one that was replaced.
static EFFECTS: LazyLock<RwLock<&'static [EffectDefinition]>> = LazyLock::new(|| {
    let read = |(path, text): &(&str, &str)| {
        read::read(path, text).unwrap_or_else(|error| unreachable!("a built-in effect: {error}"))
    };
    RwLock::new(Vec::leak(FILES.iter().map(read).collect()))
});

/// All handler objects: the program's, then a user's. A handler's place is the number that shaders know it by.
pub fn handlers() -> &'static [EffectDefinition] {
    *EFFECTS.read().unwrap_or_else(PoisonError::into_inner)
}

/// The effects: handlers that a lens, or the context, lists by name.
pub fn effects() -> impl Iterator<Item = &'static EffectDefinition> {
    handlers().iter().filter(|h| h.mode == Mode::Local && h.kind.prototype().asked_by == AskedBy::Effects)
}

/// The effect called `name`.
pub fn find(name: &str) -> Option<&'static EffectDefinition> {
    effects().find(|e| e.name == name)
}

/// The handlers that people ask for by name: effects, and what users have of other prototypes.
pub fn named() -> impl Iterator<Item = &'static EffectDefinition> {
    let is_effect = |h: &EffectDefinition| h.mode == Mode::Local && h.kind.prototype().asked_by == AskedBy::Effects;
    handlers().iter().filter(move |h| h.is_users || is_effect(h))
}

/// A handler called `name` that is asked for in another place than a list of effects.
pub fn find_asked_by(asked_by: AskedBy, name: &str) -> Option<&'static EffectDefinition> {
    asked_for(asked_by).find(|h| h.name == name)
}

/// The number by which shaders know a handler that is asked for there.
pub fn number_asked_by(asked_by: AskedBy, name: &str) -> Option<u32> {
    let is_it = |h: &EffectDefinition| h.kind.prototype().asked_by == asked_by && h.name == name;
    handlers().iter().position(is_it).map(|number| number as u32)
}

/// Handlers that are asked for there by name: users', and the program's where they are files alone.
pub fn asked_for(asked_by: AskedBy) -> impl Iterator<Item = &'static EffectDefinition> {
    let is_named = move |h: &&EffectDefinition| h.is_users || asked_by == AskedBy::Times;
    handlers().iter().filter(move |h| h.kind.prototype().asked_by == asked_by).filter(is_named)
}

/// The number of the handler called `name`, whatever its prototype.
pub fn number_of(name: &str) -> Option<u32> {
    handlers().iter().position(|e| e.name == name).map(|i| i as u32)
}

/// Takes an effect that has a new name, or with `may_replace` that of another effect of a user, in whose place it comes then.
///
/// # Errors
/// Its name is taken, or there is no room.
pub(super) fn put(effect: EffectDefinition, may_replace: bool) -> Result<(), String> {
    let mut all = EFFECTS.write().unwrap_or_else(PoisonError::into_inner);
    let at = all.iter().position(|e| e.name == effect.name);
    if at.is_some_and(|at| !(may_replace && all[at].is_users)) {
        return Err(format!("there is an effect \"{}\" already; expected another name", effect.name));
    }
    if at.is_none() && all.len() == MOST_HANDLERS {
        return Err(format!("there are {MOST_HANDLERS} effects already; expected no more"));
    }
    let mut more = all.to_vec();
    match at {
        Some(at) => more[at] = effect,
        None => more.push(effect),
    }
    *all = Vec::leak(more);
    Ok(())
}
