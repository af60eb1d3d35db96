//! Boolean combinations of bodies, as the operations of a stack machine.

/// An operation that joins two bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Operation {
    /// The points that are in either.
    Union = 1,
    /// The points that are in both.
    Intersection = 2,
    /// The points that are in the first alone.
    Difference = 3,
}

impl Operation {
    /// All, in the order of their numbers in `lib/combined.wgsl`, which begin with 1.
    pub const ALL: [Self; 3] = [Self::Union, Self::Intersection, Self::Difference];

    /// The word that scene files have for it.
    pub fn word(self) -> &'static str {
        match self {
            Self::Union => "union",
            Self::Intersection => "intersection",
            Self::Difference => "difference",
        }
    }

    /// Whether a place is in the result.
    pub fn joins(self, first: bool, second: bool) -> bool {
        match self {
            Self::Union => first | second,
            Self::Intersection => first & second,
            Self::Difference => first & !second,
        }
    }
}

/// A tree of operations over leaves.
#[derive(Clone, Debug, PartialEq)]
pub enum Tree<T> {
    /// A body that holds nothing.
    Nothing,
    /// A leaf.
    Leaf(T),
    /// An operation over two trees.
    Join(Operation, Box<(Tree<T>, Tree<T>)>),
}

impl<T> Tree<T> {
    /// The operation over all parts, the first with the second, that with the third and so on, simplified: no part of the result
    /// holds nothing.
    pub fn joined(operation: Operation, parts: impl IntoIterator<Item = Self>) -> Self {
        let join = |first: Self, second: Self| match (operation, &first, &second) {
            (Operation::Union, Self::Nothing, _) => second,
            (Operation::Union | Operation::Difference, _, Self::Nothing) => first,
            (_, Self::Nothing, _) | (_, _, Self::Nothing) => Self::Nothing,
            _ => Self::Join(operation, Box::new((first, second))),
        };
        parts.into_iter().reduce(join).unwrap_or(Self::Nothing)
    }

    /// Its leaves from left to right, each with the operations that a stack machine does after it.
    pub fn program(self) -> Vec<(T, Vec<Operation>)> {
        let mut program = Vec::new();
        self.append(&mut program);
        program
    }

    fn append(self, program: &mut Vec<(T, Vec<Operation>)>) {
        match self {
            Self::Nothing => {}
            Self::Leaf(leaf) => program.push((leaf, Vec::new())),
            Self::Join(operation, parts) => {
                parts.0.append(program);
                parts.1.append(program);
                if let Some((_, operations)) = program.last_mut() {
                    operations.push(operation);
                }
            }
        }
    }
}

/// Whether a place is in a combination, of whose leaves `holds` says which hold it.
pub fn holds<T>(program: &[(T, Vec<Operation>)], holds: impl Fn(&T) -> bool) -> bool {
    fold(program, |leaf| holds(leaf), |operation, a, b| operation.joins(a, b)).unwrap_or(false)
}

/// The value that a stack machine makes of a program: each leaf's value, joined by its operations. `None` without leaves.
pub fn fold<T, V: Clone>(
    program: &[(T, Vec<Operation>)],
    value: impl Fn(&T) -> V,
    join: impl Fn(Operation, V, V) -> V,
) -> Option<V> {
    let mut stack: Vec<V> = Vec::new();
    for (leaf, operations) in program {
        let mut top = value(leaf);
        for operation in operations {
            top = match stack.pop() {
                Some(below) => join(*operation, below, top),
                None => top,
            };
        }
        stack.push(top);
    }
    stack.pop()
}

/// The number of values that a program keeps on the stack at most.
pub fn depth<T>(program: &[(T, Vec<Operation>)]) -> usize {
    let (mut now, mut most) = (0_usize, 0);
    for (_, operations) in program {
        most = most.max(now + 1);
        now = (now + 1).saturating_sub(operations.len());
    }
    most
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn trees() -> impl Strategy<Value = Tree<u8>> {
        let leaf = prop_oneof![1 => Just(Tree::Nothing), 5 => (0..6_u8).prop_map(Tree::Leaf)];
        leaf.prop_recursive(5, 24, 4, |inner| {
            (prop::sample::select(Operation::ALL.to_vec()), prop::collection::vec(inner, 1..4))
                .prop_map(|(operation, parts)| Tree::joined(operation, parts))
        })
    }

    fn value(tree: &Tree<u8>, bits: u8) -> bool {
        match tree {
            Tree::Nothing => false,
            Tree::Leaf(i) => bits >> i & 1 == 1,
            Tree::Join(operation, parts) => operation.joins(value(&parts.0, bits), value(&parts.1, bits)),
        }
    }

    proptest! {
        #![proptest_config(crate::seeds::config())]

        #[test]
        fn the_program_of_a_tree_says_what_the_tree_says(tree in trees(), bits in 0..64_u8) {
            let expected = value(&tree, bits);
            let program = tree.program();
            prop_assert_eq!(holds(&program, |i| bits >> i & 1 == 1), expected);
            prop_assert!(depth(&program) <= program.len());
        }
    }

    #[test]
    fn parts_that_hold_nothing_are_left_out() {
        let leaf = |i: u8| Tree::Leaf(i);
        let join = |operation, parts| Tree::joined(operation, parts);
        assert_eq!(join(Operation::Union, vec![Tree::Nothing, leaf(1)]), leaf(1));
        assert_eq!(join(Operation::Intersection, vec![leaf(1), Tree::Nothing]), Tree::Nothing);
        assert_eq!(join(Operation::Difference, vec![leaf(1), Tree::Nothing]), leaf(1));
        assert_eq!(join(Operation::Difference, vec![Tree::Nothing, leaf(1)]), Tree::Nothing);
        assert_eq!(
            join(Operation::Difference, vec![leaf(0), leaf(1), leaf(2)]).program(),
            [(0, vec![]), (1, vec![Operation::Difference]), (2, vec![Operation::Difference])]
        );
    }
}
