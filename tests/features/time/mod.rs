//! Time (Tiesel chapter 4): the calendar against Python's, operators and loops; the sun against an almanac; what is there by halves; what moves; what it costs; what looks otherwise.

mod chains;
mod costs;
mod moving;
mod partly;
mod placed;
mod sun;
mod suns;
mod varying;
