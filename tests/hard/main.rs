//! The hard cases (docs/hard-cases.md): one module per case, each a property with an oracle that does not share the
//! code under test.

mod bodies;
mod case_01_national_coordinates;
mod case_02_parallel_walls;
mod case_03_coplanar_faces;
mod case_03_jitter;
mod case_04_flat_lenses;
mod case_04_near_plane;
mod case_05_around_everything;
mod case_06_many_lenses;
mod case_07_concave_solids;
mod case_08_grazing_rays;
mod case_09_coplanar_lens_faces;
mod case_10_axis_parallel_rays;
mod case_10_layers;
mod case_11_layers;
mod case_11_rays_through_edges;
mod case_12_deformed_slivers;
mod case_12_edge_on;
mod case_12_layers;
mod case_12_slivers;
mod case_13_dirty_rings;
mod case_14_deformed_non_planar;
mod case_14_non_planar_faces;
mod case_15_layer_room;
mod case_16_translucency;
mod case_17_deformations;
mod case_18_seams;
mod case_20_coincident_anchors;
mod case_20_identity_deformation;
mod case_20_identity_lens;
mod case_20_identity_rays;
mod case_21_bent_rays;
mod case_21_call_outs;
mod case_21_deformed_terrain;
mod case_21_extreme_views;
mod case_21_layers;
mod case_21_overlays;
mod case_21_zero_size_window;
mod case_22_points_of_interest;
mod case_23_jitter;
mod case_24_combinations;
mod case_25_volumes;
mod case_27_bent_rays;
mod case_27_methods;
mod deformed;
mod large_cities;
mod lenses;
mod oracle;
#[path = "../panes/mod.rs"]
mod panes;
#[path = "../seeds/mod.rs"]
mod seeds;
#[path = "../studio/mod.rs"]
mod studio;
