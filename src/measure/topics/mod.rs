//! The topics: one file and one row each.

pub mod gpu;
mod handlers;
mod lens_tests;
mod light;
mod ray_lenses;
mod refinement;
mod samples;
mod sprites;
mod time;
mod transparency;

use crate::measure::topic::Topic;

/// All topics, as they are listed.
pub const TOPICS: &[Topic] = &[
    handlers::TOPIC,
    lens_tests::TOPIC,
    light::TOPIC,
    ray_lenses::TOPIC,
    refinement::TOPIC,
    samples::TOPIC,
    sprites::TOPIC,
    time::TOPIC,
    transparency::TOPIC,
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unlike_and_fit_into_file_names() {
        for (i, topic) in TOPICS.iter().enumerate() {
            assert!(TOPICS[..i].iter().all(|other| other.name != topic.name), "{} twice", topic.name);
            assert!(topic.name.chars().all(|c| c.is_ascii_lowercase() || c == '-'), "{}", topic.name);
            assert!(topic.alike.iter().chain(topic.series).all(|&k| k < topic.knobs.len()), "{}", topic.name);
            assert!(topic.about.ends_with('.') && !topic.reference.ends_with('.'), "{}", topic.name);
        }
    }
}
