//! Polygons as coverage, pixel by pixel, as letters are.

use swash::zeno::{Command, Mask, Vector};

use crate::render::text::Run;

/// The pixels of a polygon within a picture of `size`; `None` where there are none. What its border goes around is in it.
pub fn rasterised(points: &[[f32; 2]], size: [u32; 2]) -> Option<Run> {
    let is_near = |p: &[f32; 2]| p.iter().all(|v| v.is_finite() && v.abs() < 1e6);
    if points.len() < 3 || !points.iter().all(is_near) {
        return None;
    }
    let bounds = |axis: usize| {
        let all = || points.iter().map(|p| p[axis]);
        let side = size[axis] as f32;
        [all().fold(f32::INFINITY, f32::min).floor(), all().fold(f32::NEG_INFINITY, f32::max).ceil()]
            .map(|v| v.clamp(0.0, side) as u32)
    };
    let ([x0, x1], [y0, y1]) = (bounds(0), bounds(1));
    if x0 >= x1 || y0 >= y1 {
        return None;
    }
    let [width, height] = [x1 - x0, y1 - y0];
    let at = |p: &[f32; 2]| Vector::new(p[0] - x0 as f32, p[1] - y0 as f32);
    let lines = points[1..].iter().map(|p| Command::LineTo(at(p)));
    let path: Vec<Command> =
        std::iter::once(Command::MoveTo(at(&points[0]))).chain(lines).chain([Command::Close]).collect();
    let mut covered = vec![0; width as usize * height as usize];
    Mask::new(&path[..]).size(width, height).render_into(&mut covered, None);
    Some(Run { origin: [x0, y0], size: [width, height], texels: covered.into_iter().map(|c| [c, 0]).collect() })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(run: &Run) -> f32 {
        run.texels.iter().map(|[covered, _]| f32::from(*covered) / 255.0).sum()
    }

    #[test]
    fn a_polygon_covers_its_area_where_it_is() {
        let run = rasterised(&[[10.0, 20.0], [30.0, 20.0], [30.0, 60.0]], [100, 100]).expect("pixels");
        assert_eq!((run.origin, run.size), ([10, 20], [20, 40]));
        assert!((area(&run) - 400.0).abs() < 2.0, "{}", area(&run));
        let at = |x: usize, y: usize| run.texels[(y - 20) * 20 + x - 10][0];
        assert_eq!((at(28, 30), at(12, 50)), (255, 0));
        // Half of it lies beyond the picture.
        let cut = rasterised(&[[-20.0, 10.0], [20.0, 10.0], [20.0, 30.0], [-20.0, 30.0]], [100, 100]).expect("pixels");
        assert_eq!((cut.origin, cut.size), ([0, 10], [20, 20]));
        assert!((area(&cut) - 400.0).abs() < 0.5, "{}", area(&cut));
        for wrong in [
            vec![],
            vec![[0.0, 0.0], [5.0, 5.0]],
            vec![[f32::NAN; 2]; 3],
            vec![[-9.0, -9.0], [-5.0, -9.0], [-5.0, -5.0]],
        ] {
            assert_eq!(rasterised(&wrong, [100, 100]), None);
        }
    }
}
