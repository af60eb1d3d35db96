//! Memory that must really be free again: cities are loaded in little more than what they end up in.

/// Lists smaller than this are no business of the operating system's.
const SMALL_BYTES: usize = 64 << 10;

/// Frees a large list so that its pages leave the process.
///
/// glibc gives blocks from 128 KiB on a mapping of their own: growing one moves no bytes, freeing one returns it. But
/// it takes the first large block that is freed as a sign that more will come and go, and from then on serves blocks up
/// to that size from its heap, where what is freed stays. A block that shrank to a page before it is freed gives no
/// such sign. Elsewhere this frees like any other way.
pub(crate) fn give_back<T>(mut list: Vec<T>) {
    if list.capacity() * size_of::<T>() >= SMALL_BYTES {
        list.clear();
        list.shrink_to(1);
    }
}
