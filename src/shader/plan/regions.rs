//! Regions: the classes of several lenses that a place is in at once, as one number. Sequential accumulation needs none; the
//! techniques that are kept for reference do.

use crate::shader::plan::step::ClassTest;

/// How places are told apart, and by which numbers. What no lens acts on is region 0.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Regions {
    /// Every combination of the classes that lenses act on; of each lens of the plan, these classes, ascending. Of lenses that act
    /// on one class each, the number is a bitmask, the bottom lens its lowest bit.
    Combinations(Vec<Vec<ClassTest>>),
    /// One class of one lens each, from 1: the first that holds. All else is 0; where *behind* is one of them, that is *rest*.
    Passes(Vec<(u32, ClassTest)>),
}

impl Regions {
    /// How many there are; [`None`] beyond what a word counts.
    pub fn count(&self) -> Option<u32> {
        match self {
            Self::Combinations(classes) => {
                classes.iter().try_fold(1_u32, |all, of| all.checked_mul(of.len() as u32 + 1))
            }
            Self::Passes(passes) => Some(passes.len() as u32 + 1),
        }
    }

    /// The classes that a region is in, by lens of the plan; lenses of which it is in no class that is told apart are left out.
    pub fn classes_of(&self, region: u32) -> Vec<(u32, ClassTest)> {
        match self {
            Self::Combinations(classes) => {
                let mut left = region;
                let of = |(lens, asked): (usize, &Vec<ClassTest>)| {
                    let states = asked.len() as u32 + 1;
                    let state = left % states;
                    left /= states;
                    Some((lens as u32, asked[state.checked_sub(1)? as usize]))
                };
                classes.iter().enumerate().filter_map(of).collect()
            }
            Self::Passes(passes) => match region.checked_sub(1) {
                Some(pass) => vec![passes[pass as usize]],
                None => {
                    let behind = passes.iter().filter(|(_, class)| *class == ClassTest::Behind);
                    behind.map(|(lens, _)| (*lens, ClassTest::Rest)).collect()
                }
            },
        }
    }

    /// Whether it asks for other classes of a lens than *inside*.
    pub fn asks_sides(&self, lens: u32) -> bool {
        match self {
            Self::Combinations(classes) => classes[lens as usize].iter().any(|class| *class != ClassTest::Inside),
            Self::Passes(passes) => passes.iter().any(|(of, class)| *of == lens && *class != ClassTest::Inside),
        }
    }
}
