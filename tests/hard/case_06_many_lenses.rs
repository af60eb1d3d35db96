//! Case 6: 1 to 64 lenses that overlap, of all shapes: each bit of the mask is what f64 says of the shown place, outside the
//! band of an analytic test; in which order lenses came to be changes nothing. Oracle: the definitions of the shapes, at the f32 depth.

use veduta::{
    figure::scene_file,
    geom::Shape,
    lens::Lens,
    render::{
        frame::Backend,
        picture::{Request, Studio},
    },
    scene::{Command, Scene},
};

use crate::{
    lenses::{KINDS, cameras, check_mask, in_cube, pixels, shape, share, view},
    oracle::Numbers,
    studio,
};

const SIZE: [u32; 2] = [320, 240];

/// `count` lenses around what can be seen, from a tenth of a metre to the size of the city.
fn lenses(count: usize, studio: &Studio, numbers: &mut Numbers) -> Vec<Lens> {
    let extent = studio.extent();
    let one = |i: usize| {
        let center = extent.center() + 0.5 * extent.size() * in_cube(numbers);
        // Half of them on a house.
        let house = studio.geometries[numbers.below(studio.geometries.len() as u64) as usize];
        let center = [center, studio.model.geometries[house as usize].bounds.center()][i % 2];
        let r = 0.1 * (0.5 * extent.size().length() / 0.1).powf(share(numbers).sqrt());
        let kind = numbers.below(KINDS as u64) as usize;
        let mut shapes: Vec<Shape> = vec![shape(kind, center, r, numbers)];
        if numbers.below(4) == 0 {
            shapes.push(shape(kind + 1, center + r * in_cube(numbers), r, numbers));
        }
        let effects = ["sepia", "greyscale", "invert", "darken"];
        studio::lens(&format!("lens {i}"), shapes, effects[numbers.below(4) as usize])
    };
    (0..count).map(one).collect()
}

#[test]
fn masks_of_many_lenses_are_those_of_f64() {
    let mut studio = studio::synthetic(60);
    let mut numbers = Numbers(6);
    let (mut looked_at, mut inside, mut round) = (0, 0, 0);
    while looked_at < pixels(1_300_000) {
        let count = [1, 64, 7, 33, 2, 16][round % 6];
        let list = lenses(count, &studio, &mut numbers);
        let backend = if round % 2 == 0 { Backend::Specialised } else { Backend::Uber };
        for camera in cameras(&studio) {
            let scene = studio::scene(camera, list.clone());
            let request = Request { aovs: studio::ALL, backend, ..Request::plain(SIZE) };
            let drawn = studio.render(&scene, &request).expect("a picture");
            let view = view(camera, SIZE);
            for (bit, lens) in list.iter().enumerate() {
                match check_mask(&drawn, &view, lens, bit) {
                    Ok(n) => inside += n,
                    Err(why) => panic!("round {round}, {count} lenses from {}: {why}", camera.eye),
                }
            }
            looked_at += u64::from(SIZE[0] * SIZE[1]);
        }
        round += 1;
    }
    assert!(inside > looked_at / 2, "{inside} bits set in {looked_at} pixels");
}

#[test]
fn in_which_order_lenses_came_to_be_changes_nothing() {
    let mut studio = studio::synthetic(40);
    let mut numbers = Numbers(66);
    let camera = cameras(&studio)[0];
    let wanted = studio::scene(camera, lenses(12, &studio, &mut numbers));
    let expected = studio::picture(&mut studio, &wanted, SIZE);
    for round in 0..3 {
        // Added in any order, each then moved between those that are there; drawn on the way, so that a renderer that
        // remembers would.
        let mut scene = studio::scene(camera, vec![]);
        let mut missing: Vec<usize> = (0..wanted.lenses.len()).collect();
        let mut there: Vec<usize> = Vec::new();
        while !missing.is_empty() {
            let i = missing.swap_remove(numbers.below(missing.len() as u64) as usize);
            Command::add_lens(&scene, wanted.lenses[i].clone()).redo(&mut scene);
            let place = there.partition_point(|&other| other < i);
            let moved = Command::reorder_lens(&scene, there.len(), place).expect("both places are");
            moved.redo(&mut scene);
            there.insert(place, i);
            if there.len() % 5 == round {
                studio::picture(&mut studio, &scene, SIZE);
            }
        }
        assert!(scene == wanted, "the commands lead to the same scene");
        let drawn = studio::picture(&mut studio, &scene, SIZE);
        assert!(drawn.rgba == expected.rgba && drawn.lens_mask == expected.lens_mask, "round {round}");
    }
    // Another way there: values that are set, one after the other, forwards and backwards.
    let other = |scene: &Scene, backwards: bool| {
        let mut scene = scene.clone();
        for step in 0..12 {
            let i = if backwards { 11 - step } else { step };
            for value in ["enabled=false", "color=\"#123456\"", "enabled=true"] {
                let command = scene_file::set(&scene, &format!("lens.{i}.{value}")).expect("it can be set");
                command.redo(&mut scene);
            }
        }
        scene
    };
    let (forwards, backwards) = (other(&wanted, false), other(&wanted, true));
    assert!(forwards == backwards && forwards != wanted);
    for scene in [forwards, backwards] {
        let drawn = studio::picture(&mut studio, &scene, SIZE);
        assert!(drawn.rgba == expected.rgba && drawn.lens_mask == expected.lens_mask);
    }
}
