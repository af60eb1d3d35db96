//! Time (Tiesel chapter 4): the calendar against Python's, operators and loops.

mod chains;
