//! Whole files, small and wrong, through the loader.
