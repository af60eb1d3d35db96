//! Time (Tiesel chapter 4): the calendar against Python's, operators and loops; the sun against an almanac.

mod chains;
mod sun;
