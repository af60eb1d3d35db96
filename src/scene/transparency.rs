//! How translucent layers are laid one over the other: exactly, which is the default, or by a method of the literature that
//! takes less memory or time and leaves something out.

use std::borrow::Cow;

/// A method.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Transparency {
    /// All layers in lists, sorted: exact, as much memory as there are layers.
    #[default]
    Exact,
    /// The nearest layers first, pass by pass over the city (Everitt 2001): exact as far as it goes, bounded memory.
    Peel {
        /// How many layers of a pixel; 0: until nothing is left.
        layers: u32,
    },
    /// The nearest layers of each pixel exactly, all behind them as one (Bavoil et al. 2007; Maule et al. 2013): bounded memory.
    KBuffer {
        /// How many are exact: one of [`SLOTS`].
        layers: u32,
    },
    /// All layers as one, those nearer weighing more (McGuire and Bavoil 2013): one pass without an order.
    Weighted,
    /// Each layer there or not by chance, in every sample anew (Enderton et al. 2010): right in the mean of many samples.
    Stochastic,
}

/// Layers that [`Transparency::KBuffer`] keeps.
pub const SLOTS: [u32; 3] = [4, 8, 16];
/// Those that it keeps if nothing is said.
pub const DEFAULT_SLOTS: u32 = 8;
/// Layers that [`Transparency::Peel`] may be told to take off.
pub const MOST_PEELED: u32 = 4096;

impl Transparency {
    /// The words of scene files.
    pub const WORDS: [&str; 5] = ["exact", "peel", "k-buffer", "weighted", "stochastic"];

    /// Its word in scene files.
    pub fn word(self) -> &'static str {
        Self::WORDS[match self {
            Self::Exact => 0,
            Self::Peel { .. } => 1,
            Self::KBuffer { .. } => 2,
            Self::Weighted => 3,
            Self::Stochastic => 4,
        }]
    }

    /// The method of a word, and of how many layers if that is said.
    ///
    /// # Errors
    /// What is wrong with the number, and what would be right; `None` as a value: the word is none of [`Self::WORDS`].
    pub fn of(word: &str, layers: Option<u32>) -> Result<Option<Self>, Cow<'static, str>> {
        let method = match (word, layers) {
            ("peel", layers) => Self::Peel { layers: layers.unwrap_or(0) },
            ("k-buffer", None) => Self::KBuffer { layers: DEFAULT_SLOTS },
            ("k-buffer", Some(layers)) if SLOTS.contains(&layers) => Self::KBuffer { layers },
            ("k-buffer", Some(layers)) => {
                return Err(format!("must be 4, 8 or 16 for \"k-buffer\", is {layers}").into());
            }
            (word, Some(_)) if Self::WORDS.contains(&word) => {
                return Err(format!("\"{word}\" takes none; \"peel\" and \"k-buffer\" do").into());
            }
            ("exact", _) => Self::Exact,
            ("weighted", _) => Self::Weighted,
            ("stochastic", _) => Self::Stochastic,
            _ => return Ok(None),
        };
        Ok(Some(method))
    }

    /// How many layers, where that can be said.
    pub fn layers(self) -> Option<u32> {
        match self {
            Self::Peel { layers } | Self::KBuffer { layers } => Some(layers),
            Self::Exact | Self::Weighted | Self::Stochastic => None,
        }
    }

    /// Whether its layers have numbers along the ray, as opacity rules may ask.
    pub fn counts_layers(self) -> bool {
        !matches!(self, Self::Weighted | Self::Stochastic)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_and_methods_belong_together() {
        for word in Transparency::WORDS {
            let method = Transparency::of(word, None).expect("right").expect("known");
            assert_eq!(method.word(), word);
            assert_eq!(Transparency::of(word, Some(8)).is_ok(), method.layers().is_some(), "{word}");
            assert_eq!(Transparency::of(word, Some(7)).is_ok(), word == "peel", "{word}");
        }
        assert_eq!(Transparency::of("nothing", Some(1)), Ok(None));
        assert_eq!(Transparency::default().word(), "exact");
    }
}
