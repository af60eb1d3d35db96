//! The seed of property tests, for the library's and for those beside it: one that is fixed, so that an ordinary run tries the same cases
//! each time, or another one each time where `VEDUTA_HARD_SEEDS` is `random`. `PROPTEST_RNG_SEED` goes before both.

use proptest::test_runner::{Config, RngSeed};

/// The seed of ordinary runs.
const SEED: u64 = 20_140_521;

/// The configuration of property tests that say nothing else.
pub fn config() -> Config {
    seeded(Config::default(), std::env::var("VEDUTA_HARD_SEEDS").is_ok_and(|seeds| seeds == "random"))
}

/// [`config`] with this many cases.
#[allow(dead_code, reason = "not all binaries have property tests of a number of cases of their own")]
pub fn cases(cases: u32) -> Config {
    Config { cases, ..config() }
}

/// [`config`] with `all` cases in a thorough run, else with a `sample` of so many.
#[allow(dead_code, reason = "not all binaries have property tests that take so long")]
pub fn sample(sample: u32, all: u32) -> Config {
    cases(if is_thorough() { all } else { sample })
}

/// Whether a property is to be tried with all that there is (`./dev hard`), not with the sample that every run takes.
#[allow(dead_code, reason = "not all binaries take samples")]
pub fn is_thorough() -> bool {
    std::env::var_os("VEDUTA_HARD").is_some()
}

fn seeded(config: Config, is_random: bool) -> Config {
    let is_given = config.rng_seed != RngSeed::Random;
    if is_given || is_random { config } else { Config { rng_seed: RngSeed::Fixed(SEED), ..config } }
}

#[test]
fn seeds_are_fixed_unless_others_are_asked_for() {
    let seed = |given, is_random| seeded(Config { rng_seed: given, ..Config::default() }, is_random).rng_seed;
    assert_eq!(seed(RngSeed::Random, false), RngSeed::Fixed(SEED));
    assert_eq!(seed(RngSeed::Random, true), RngSeed::Random);
    assert_eq!(seed(RngSeed::Fixed(7), false), RngSeed::Fixed(7));
    assert_eq!(seed(RngSeed::Fixed(7), true), RngSeed::Fixed(7));
}
