use super::*;

type Corners = [[i64; 3]; 3];

fn run(rings: &[&[[i64; 3]]]) -> Result<(Face, Vec<Corners>), Refusal> {
    let points: Vec<_> = rings.concat();
    let mut end = 0;
    let ends: Vec<u32> = rings
        .iter()
        .map(|ring| {
            end += ring.len() as u32;
            end
        })
        .collect();
    let mut out = Vec::new();
    let face = Triangulator::default().triangulate(&points, &ends, &mut out)?;
    Ok((face, out.into_iter().map(|t| t.map(|i| points[i as usize])).collect()))
}

#[test]
fn a_square_in_each_direction_has_two_triangles_facing_as_it_does() {
    let square = [[0, 0], [4, 0], [4, 4], [0, 4]];
    for axis in 0..3 {
        for flipped in [false, true] {
            let mut ring: Vec<[i64; 3]> = square
                .iter()
                .map(|p| {
                    let mut q = [7; 3];
                    q[(axis + 1) % 3] = p[0];
                    q[(axis + 2) % 3] = p[1];
                    q
                })
                .collect();
            if flipped {
                ring.reverse();
            }
            let (face, triangles) = run(&[&ring]).unwrap();
            assert_eq!(face.normal[axis], if flipped { -32 } else { 32 });
            assert!(face.planar);
            assert_eq!(triangles.len(), 2);
            for t in triangles {
                assert_eq!(newell(&t).map(i128::signum), face.normal.map(i128::signum));
            }
        }
    }
}

#[test]
fn straight_corners_are_kept() {
    // A square with a corner in the middle of each side: eight corners, six triangles.
    let ring = [[0, 0, 0], [2, 0, 0], [4, 0, 0], [4, 2, 0], [4, 4, 0], [2, 4, 0], [0, 4, 0], [0, 2, 0]];
    assert_eq!(run(&[&ring]).unwrap().1.len(), 6);
    let triangle = [[0, 0, 0], [2, 0, 0], [4, 0, 0], [0, 4, 0]];
    assert_eq!(run(&[&triangle]).unwrap().1.len(), 2);
}

#[test]
fn what_has_no_triangles_says_why() {
    let refusal = |ring: &[[i64; 3]]| run(&[ring]).unwrap_err();
    assert_eq!(refusal(&[]), Refusal::ShortRing);
    assert_eq!(refusal(&[[1, 1, 1], [2, 2, 2]]), Refusal::ShortRing);
    assert_eq!(refusal(&[[1, 1, 1], [2, 2, 2], [1, 1, 1], [1, 1, 1]]), Refusal::ShortRing);
    assert_eq!(refusal(&[[1, 1, 1], [2, 2, 2], [5, 5, 5]]), Refusal::ZeroArea);
    assert_eq!(refusal(&[[0, 0, 0], [4, 4, 0], [4, 0, 0], [0, 4, 0]]), Refusal::SelfCrossing);
    assert_eq!(refusal(&[[0, 0, 0], [4, 4, 0], [4, 0, 0], [0, 9, 0]]), Refusal::SelfCrossing);
    let square = [[0, 0, 0], [4, 0, 0], [4, 4, 0], [0, 4, 0]];
    assert_eq!(refusal(&[square, square].concat()), Refusal::SelfCrossing, "the same square twice");
    assert_eq!(refusal(&[[0, 0, 0], [MAX_EXTENT + 1, 0, 0], [0, 1, 0]]), Refusal::TooLarge);
    assert_eq!(refusal(&[[i64::MIN, 0, 0], [i64::MAX, 0, 0], [0, 1, 0]]), Refusal::TooLarge);
}

#[test]
fn holes_may_touch_and_lie_in_any_direction() {
    let outer = [[0, 0, 5], [10, 0, 5], [10, 10, 5], [0, 10, 5]];
    let hole = [[2, 2, 5], [4, 2, 5], [4, 4, 5], [2, 4, 5]];
    let touching = [[4, 4, 5], [6, 4, 5], [6, 6, 5], [4, 6, 5]];
    let at_the_edge = [[0, 6, 5], [3, 7, 5], [3, 9, 5]];
    let mut turned = touching;
    turned.reverse();
    let area = |triangles: Vec<[[i64; 3]; 3]>| triangles.iter().map(|t| newell(t)[2]).sum::<i128>();
    assert_eq!(area(run(&[&outer, &hole]).unwrap().1), 200 - 8);
    assert_eq!(area(run(&[&outer, &hole, &touching]).unwrap().1), 200 - 16);
    assert_eq!(area(run(&[&outer, &turned, &hole, &at_the_edge]).unwrap().1), 200 - 16 - 6);
    let outside = hole.map(|p| [p[0] + 20, p[1], p[2]]);
    assert_eq!(run(&[&outer, &outside]).unwrap_err(), Refusal::SelfCrossing);
    let across = hole.map(|p| [p[0] + 7, p[1], p[2]]);
    assert_eq!(run(&[&outer, &across]).unwrap_err(), Refusal::SelfCrossing);
    assert_eq!(run(&[&outer, &[[1, 1, 5], [2, 2, 5]]]).unwrap().0.holes_dropped, 1);
}

#[test]
fn flatness_is_measured_in_units() {
    let bent = [[0, 0, 0], [1000, 0, 10], [1000, 1000, 0], [0, 1000, 10]];
    let (face, _) = run(&[&bent]).unwrap();
    assert!(!face.planar);
    assert!((face.deviation - 5.0).abs() < 1e-9, "{}", face.deviation);
}

#[test]
fn a_comb_of_ten_thousand_corners() {
    let mut ring = vec![[5000, -10, 3], [0, -10, 3]];
    for tooth in 0..5000_i64 {
        ring.push([tooth, if tooth % 2 == 0 { 0 } else { 100_000 }, 3]);
        ring.push([tooth, if tooth % 2 == 0 { 100_000 } else { 0 }, 3]);
    }
    let (face, triangles) = run(&[&ring]).unwrap();
    assert_eq!(triangles.iter().map(|t| newell(t)[2]).sum::<i128>(), face.normal[2]);
    assert_eq!(triangles.len(), ring.len() - 2);
}
