// Lists of crossings. The head of a list, and the second word of each crossing, hold the number of the next crossing, counted
// from 1, 0 ending the list; the first word of a crossing is its distance.
//
//   31        30..25   24           23..0
//   is entry  leaf     incomplete   next

const NEXT: u32 = 0xffffffu;
const INCOMPLETE: u32 = 0x1000000u;
const LEAF_SHIFT: u32 = 25u;
const LEAF: u32 = 63u;
const IS_ENTRY: u32 = 0x80000000u;
