//! The walk of `pass/composite.wgsl` through the list of a pixel, written out: a few nodes at a time are put in order by a sorting
//! network and merged into the nearest so far by a bitonic one (Batcher 1968). A loop over them would keep all of them in memory
//! that is indexed by each pixel on its own.

use std::fmt::Write;

use crate::shader::template::Template;

/// How many nodes are nearest at a time; a power of two.
const KEPT: usize = 16;
/// How many nodes of the list are taken at a time; at most [`KEPT`].
const TAKEN: usize = 4;
/// Comparators that put so many in order, first those that may happen at once (Knuth, The Art of Computer Programming 3, 5.3.4).
const NETWORK: [[usize; 2]; 5] = [[0, 1], [2, 3], [0, 2], [1, 3], [1, 2]];

/// Comparators that put in order what rises and falls at most once.
fn bitonic() -> impl Iterator<Item = [usize; 2]> {
    let strides = (0..KEPT.ilog2()).rev().map(|step| 1_usize << step);
    strides.flat_map(|stride| (0..KEPT).filter(move |i| i & stride == 0).map(move |i| [i, i + stride]))
}

/// Pairs of a kept node, from the farthest on, and a taken one that takes its place where it is nearer.
fn exchanged() -> impl Iterator<Item = [usize; 2]> {
    (0..TAKEN).map(|i| [KEPT - 1 - i, i])
}

/// Takes nodes of the list, in order.
fn taken(indent: &str) -> String {
    let mut text = String::new();
    for i in 0..TAKEN {
        let _ = writeln!(text, "{indent}var taken_{i} = take_node(&walk, last, twins);");
    }
    for [a, b] in NETWORK {
        let _ = writeln!(text, "{indent}order(&taken_{a}, &taken_{b});");
    }
    text
}

/// The first nodes of a walk: the nearest so far.
fn first(indent: &str) -> String {
    let mut text = taken(indent);
    for i in 0..KEPT {
        let node = if i < TAKEN { format!("taken_{i}") } else { "NO_NODE".to_owned() };
        let _ = writeln!(text, "{indent}var kept_{i} = {node};");
    }
    text
}

/// More nodes, merged into the nearest so far.
fn more(indent: &str) -> String {
    let mut text = taken(indent);
    for [kept, new] in exchanged() {
        let _ = writeln!(text, "{indent}kept_{kept} = nearer_of(kept_{kept}, taken_{new});");
    }
    for [a, b] in bitonic() {
        let _ = writeln!(text, "{indent}order(&kept_{a}, &kept_{b});");
    }
    for i in 0..KEPT {
        let _ = writeln!(text, "{indent}kept_{i} = node_of(kept_{i});");
    }
    text
}

/// `node`, the one of those kept that `place` says.
fn pick(indent: &str) -> String {
    let mut text = String::new();
    let mut names: Vec<String> = (0..KEPT).map(|i| format!("kept_{i}")).collect();
    for bit in 0..KEPT.ilog2() {
        let _ = writeln!(text, "{indent}let is_odd_{bit} = (place & {}u) != 0u;", 1 << bit);
        for i in 0..names.len() / 2 {
            let [even, odd] = [&names[2 * i], &names[2 * i + 1]];
            let _ = writeln!(text, "{indent}let pick_{bit}_{i} = chosen({even}, {odd}, is_odd_{bit});");
            names[i] = format!("pick_{bit}_{i}");
        }
        names.truncate(names.len() / 2);
    }
    let _ = writeln!(text, "{indent}let node = {};", names[0]);
    text
}

/// Fills the hooks of `pass/composite.wgsl` with all that is said of each kept node.
pub(super) fn filled(text: Template) -> Template {
    text.fill("kept", format!("const KEPT: u32 = {KEPT}u;\n"))
        .fill("first", first("        "))
        .fill("more", more("            "))
        .fill("pick", pick("            "))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A comparator puts the larger number first, as the nearer node.
    fn order(numbers: &mut [u32], [a, b]: [usize; 2]) {
        if numbers[b] > numbers[a] {
            numbers.swap(a, b);
        }
    }

    #[test]
    fn all_that_is_taken_is_put_in_order() {
        // A network that sorts all zeros and ones sorts everything (Knuth, 5.3.4, theorem Z).
        for bits in 0..1_u32 << TAKEN {
            let mut numbers: Vec<u32> = (0..TAKEN).map(|i| bits >> i & 1).collect();
            NETWORK.iter().for_each(|&pair| order(&mut numbers, pair));
            assert!(numbers.is_sorted_by(|a, b| a >= b), "{bits:b}: {numbers:?}");
        }
    }

    #[test]
    fn what_is_merged_are_the_nearest_in_order() {
        for (ones, new_ones) in (0..=KEPT).flat_map(|a| (0..=TAKEN).map(move |b| (a, b))) {
            let mut kept: Vec<u32> = (0..KEPT).map(|i| u32::from(i < ones)).collect();
            let taken: Vec<u32> = (0..TAKEN).map(|i| u32::from(i < new_ones)).collect();
            exchanged().for_each(|[i, new]| kept[i] = kept[i].max(taken[new]));
            bitonic().for_each(|pair| order(&mut kept, pair));
            let expected: Vec<u32> = (0..KEPT).map(|i| u32::from(i < ones + new_ones)).collect();
            assert_eq!(kept, expected, "{ones} and {new_ones}");
        }
    }

    #[test]
    fn each_place_is_picked() {
        let text = pick("");
        for i in 0..KEPT {
            let mut values: std::collections::HashMap<String, usize> =
                (0..KEPT).map(|k| (format!("kept_{k}"), k)).collect();
            for line in text.lines().filter(|line| line.contains("chosen")) {
                let words: Vec<&str> =
                    line.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|w| !w.is_empty()).collect();
                let ["let", name, "chosen", even, odd, bit] = words[..] else { panic!("{line}") };
                let is_odd = i >> bit.trim_start_matches("is_odd_").parse::<u32>().expect("a bit") & 1 == 1;
                values.insert(name.to_owned(), values[if is_odd { odd } else { even }]);
            }
            let picked = text.lines().last().and_then(|line| line.strip_prefix("let node = ")).expect("a node");
            assert_eq!(values[picked.trim_end_matches(';')], i);
        }
    }
}
