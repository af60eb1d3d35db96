//! The tram that crosses the town and the boats on the river: their ways, what they look like, and a day of their timetable.

use std::io::{Result, Write};

use crate::city::synth::full::{
    field::{P2, P3, QUAY, between},
    frame::Frame,
    object::{Geometry, Object, signed_thousandths},
    plan::{Plan, Street},
    shell::{Shell, Surface},
    streets::PARTS,
};

/// The day of the timetable.
const DAY: &str = "2025-06-01";
/// When it begins and ends, seconds after midnight.
const BEGINS: i64 = 5 * 3600;
const ENDS: i64 = 23 * 3600;

/// A way with stops: points, and which of them are stops.
#[derive(Clone, Debug, PartialEq)]
pub struct Way {
    /// Points, millimetres.
    pub points: Vec<P3>,
    /// Indices of stops, the first and the last point among them.
    pub stops: Vec<usize>,
}

/// A kind of vehicle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Vehicle {
    /// Three cars on the street; it goes either way round.
    Tram,
    /// A boat that turns at the ends of its way.
    Boat,
}

/// A vehicle with what it does all day.
#[derive(Clone, Debug)]
pub struct Service {
    /// Its id.
    pub id: String,
    /// What it is.
    pub vehicle: Vehicle,
    /// Its way out.
    pub out: Way,
    /// Its way back.
    pub back: Way,
    /// At which stop it begins its day, counted along its way out and back again.
    pub begins: usize,
}

/// Where a vehicle is at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Key {
    /// Seconds after midnight.
    pub second: i64,
    /// Where the middle of its base is, millimetres.
    pub at: P3,
    /// Where it looks, hundredths of a degree counter-clockwise from east.
    pub yaw: i64,
}

impl Vehicle {
    fn name(self) -> &'static str {
        match self {
            Self::Tram => "tram",
            Self::Boat => "boat",
        }
    }

    /// Millimetres in a second.
    fn speed(self) -> i64 {
        match self {
            Self::Tram => 8_000,
            Self::Boat => 3_500,
        }
    }

    /// Seconds at a stop, and at the ends of the way.
    fn stays(self) -> [i64; 2] {
        match self {
            Self::Tram => [25, 240],
            Self::Boat => [90, 600],
        }
    }

    /// Its solids at a place, in a frame that looks forward, x from the middle of its base.
    fn solids(self, frame: &Frame, height: i64) -> Vec<Shell> {
        let solid = |low: P3, high: P3| {
            let footprint = frame.rectangle([low[0], low[1]], [high[0], high[1]]);
            Shell::prism_of(&footprint, height + low[2], height + high[2], [Surface::Plain; 3])
        };
        match self {
            Self::Tram => {
                let mut solids = Vec::new();
                for car in -1..=1 {
                    let x = car * 40;
                    solids.push(solid([x - 18, -5, 250], [x + 18, 5, 1_300]));
                    solids.push(solid([x - 18, -5, 1_300], [x + 18, 5, 3_100]));
                    solids.push(solid([x - 12, -3, 3_100], [x + 12, 3, 3_450]));
                }
                solids.push(solid([-22, -4, 400], [-18, 4, 3_000]));
                solids.push(solid([18, -4, 400], [22, 4, 3_000]));
                solids
            }
            Self::Boat => {
                let hull = [[-36, -9], [24, -9], [40, 0], [24, 9], [-36, 9]].map(|[x, y]| frame.at(x, y));
                vec![
                    Shell::prism_of(&hull, height - 500, height + 800, [Surface::Plain; 3]),
                    solid([-30, -7, 800], [12, 7, 1_700]),
                    solid([-32, -8, 1_700], [14, 8, 1_800]),
                ]
            }
        }
    }
}

/// All vehicles of a city.
pub fn services(plan: &Plan) -> Vec<Service> {
    let mut all = Vec::new();
    let ways = [(Vehicle::Tram, tram_ways(plan), 600, 8), (Vehicle::Boat, boat_ways(plan), 1_500, 5)];
    for (vehicle, [out, back], apart, most) in ways {
        let turn = duration(&out, vehicle) + duration(&back, vehicle) + 2 * vehicle.stays()[1];
        let count = (turn / apart).clamp(2, most);
        // Runs from stop to stop, there and back; they begin the day evenly spread over these.
        let around = out.stops.len() + back.stops.len() - 2;
        for k in 0..count {
            let begins = around * k as usize / count as usize;
            let (out, back) = (out.clone(), back.clone());
            all.push(Service { id: format!("{}-{}", vehicle.name(), k + 1), vehicle, out, back, begins });
        }
    }
    all
}

/// The tram's tracks in line 0, from the west to the east and back, each on the right of the street.
fn tram_ways(plan: &Plan) -> [Way; 2] {
    let reach = plan.last;
    let track = |is_back: bool| {
        let share = if is_back { 70 } else { 30 };
        let mut way = Way { points: Vec::new(), stops: Vec::new() };
        for i in -reach..=reach {
            for (k, row) in plan.level_points(i, 0).into_iter().enumerate() {
                let height = |at: P2| plan.field.height(at);
                let [x, y] = between(row[1], row[2], share, 100);
                let z = (height(row[1]) * (100 - share) + height(row[2]) * share) / 100;
                // Stops in the middle of every second block, and at the ends.
                let is_stop = k == PARTS as usize / 2 && (i.rem_euclid(2) == 0 || i.abs() == reach);
                if is_stop {
                    way.stops.push(way.points.len());
                }
                way.points.push([x, y, z]);
            }
        }
        // It begins and ends at a stop.
        let (first, last) = (way.stops[0], way.stops[way.stops.len() - 1]);
        way.points = way.points[first..=last].to_vec();
        way.stops.iter_mut().for_each(|stop| *stop -= first);
        way
    };
    [track(false), track(true).reversed()]
}

/// The boats' ways down the river and up again, each on the right.
fn boat_ways(plan: &Plan) -> [Way; 2] {
    let reach = plan.last + 1;
    let course = |share: i64| {
        let mut way = Way { points: Vec::new(), stops: Vec::new() };
        for j in -reach..=reach {
            let [west, east] = [false, true].map(|is_east| plan.water_edge(is_east, j));
            for (k, (w, e)) in west.iter().zip(&east).enumerate() {
                let [x, y] = between(*w, *e, share, 100);
                if k == PARTS as usize / 2 && (j.rem_euclid(3) == 0 || j.abs() == reach) {
                    way.stops.push(way.points.len());
                }
                way.points.push([x, y, 0]);
            }
        }
        let (first, last) = (way.stops[0], way.stops[way.stops.len() - 1]);
        way.points = way.points[first..=last].to_vec();
        way.stops.iter_mut().for_each(|stop| *stop -= first);
        way
    };
    [course(67), course(33).reversed()]
}

impl Way {
    fn reversed(mut self) -> Self {
        self.points.reverse();
        let last = self.points.len() - 1;
        self.stops.iter_mut().for_each(|stop| *stop = last - *stop);
        self.stops.reverse();
        self
    }

    /// How far each point is along the way, millimetres.
    fn lengths(&self) -> Vec<f64> {
        let mut lengths = vec![0.0];
        for pair in self.points.windows(2) {
            let [x, y, z] = [0, 1, 2].map(|k| (pair[1][k] - pair[0][k]) as f64);
            lengths.push(lengths[lengths.len() - 1] + (x * x + y * y + z * z).sqrt());
        }
        lengths
    }
}

/// Seconds from stop to stop.
fn runs(way: &Way, vehicle: Vehicle) -> Vec<i64> {
    let lengths = way.lengths();
    let between = |pair: &[usize]| ((lengths[pair[1]] - lengths[pair[0]]) / vehicle.speed() as f64).ceil() as i64;
    way.stops.windows(2).map(|pair| between(pair).max(1)).collect()
}

fn duration(way: &Way, vehicle: Vehicle) -> i64 {
    let runs = runs(way, vehicle);
    runs.iter().sum::<i64>() + vehicle.stays()[0] * (runs.len() as i64 - 1)
}

impl Service {
    /// Its way out or back, from which stop of it the day begins, and whether it is that out.
    fn beginning(&self) -> (bool, usize) {
        let out = self.out.stops.len() - 1;
        if self.begins < out { (true, self.begins) } else { (false, self.begins - out) }
    }

    /// Where it looks when it goes in a direction: a tram has no front, on its way back it looks where it came from.
    fn looks(&self, is_out: bool, direction: P2) -> P2 {
        if self.vehicle == Vehicle::Tram && !is_out { direction.map(|d| -d) } else { direction }
    }

    /// Its day, key by key, each later than the one before.
    pub fn day(&self, each: &mut dyn FnMut(&Key) -> Result<()>) -> Result<()> {
        let [stay, turn] = self.vehicle.stays();
        let (mut is_out, mut skipped) = self.beginning();
        let mut now = BEGINS;
        let mut last_yaw = None;
        while now < ENDS {
            let way = if is_out { &self.out } else { &self.back };
            let mut key = |second: i64, at: P3, direction: P2| {
                let yaw = yaw(self.looks(is_out, direction));
                let yaw = last_yaw.map_or(yaw, |last: i64| yaw + (last - yaw + 18_000).div_euclid(36_000) * 36_000);
                last_yaw = Some(yaw);
                each(&Key { second, at, yaw })
            };
            let lengths = way.lengths();
            for (pair, seconds) in way.stops.windows(2).zip(runs(way, self.vehicle)).skip(skipped) {
                run(way, &lengths, [pair[0], pair[1]], seconds, &mut |second, at, to| key(now + second, at, to))?;
                now += seconds + if pair[1] + 1 == way.points.len() { turn } else { stay };
            }
            (is_out, skipped) = (!is_out, 0);
        }
        Ok(())
    }

    /// The vehicle as it stands in the city: where its day begins.
    pub fn object(&self) -> Object {
        let (is_out, stop) = self.beginning();
        let way = if is_out { &self.out } else { &self.back };
        let first = way.stops[stop];
        let [a, b] = [way.points[first], way.points[first + 1]];
        let [x, y] = self.looks(is_out, [b[0] - a[0], b[1] - a[1]]);
        let frame = Frame::towards([a[0], a[1]], [a[0] + x, a[1] + y]);
        Object::new(self.id.clone(), "CityFurniture")
            .text("class", self.vehicle.name())
            .with(Geometry::Solids("2", self.vehicle.solids(&frame, a[2])))
    }
}

/// Keys of a run from stop to stop: at both, and at the seconds before and after each point between.
fn run(
    way: &Way,
    lengths: &[f64],
    [from, to]: [usize; 2],
    seconds: i64,
    key: &mut dyn FnMut(i64, P3, P2) -> Result<()>,
) -> Result<()> {
    let start = lengths[from];
    let total = lengths[to] - start;
    let mut times = vec![0];
    for along in &lengths[from + 1..to] {
        let exact = (along - start) / total * seconds as f64;
        times.extend([exact.floor() as i64, exact.ceil() as i64]);
    }
    times.push(seconds);
    times.dedup();
    let mut segment = from;
    for second in times {
        let along = start + total * second as f64 / seconds as f64;
        while segment + 1 < to && lengths[segment + 1] <= along {
            segment += 1;
        }
        let [a, b] = [way.points[segment], way.points[segment + 1]];
        let length = lengths[segment + 1] - lengths[segment];
        let part = ((along - lengths[segment]) / length).clamp(0.0, 1.0);
        let at = [0, 1, 2].map(|k| a[k] + ((b[k] - a[k]) as f64 * part).round() as i64);
        key(second, at, [b[0] - a[0], b[1] - a[1]])?;
    }
    Ok(())
}

/// The angle of a direction, hundredths of a degree counter-clockwise from east, from -180 to 180 degrees.
pub fn yaw([x, y]: P2) -> i64 {
    let (across, along) = (x.abs().min(y.abs()) as f64, x.abs().max(y.abs()) as f64);
    // Half the angle twice, then the series of the arc tangent; sums and roots alone, which every machine rounds alike.
    let half = |t: f64| t / (1.0 + (1.0 + t * t).sqrt());
    let t = half(half(if along > 0.0 { across / along } else { 0.0 }));
    let s = t * t;
    let arc = 4.0 * t * (1.0 - s * (1.0 / 3.0 - s * (1.0 / 5.0 - s * (1.0 / 7.0 - s / 9.0))));
    let angle = (arc * 18_000.0 / std::f64::consts::PI).round() as i64;
    let in_quarter = if y.abs() > x.abs() { 9_000 - angle } else { angle };
    let in_half = if x < 0 { 18_000 - in_quarter } else { in_quarter };
    if y < 0 { -in_half } else { in_half }
}

/// Writes the day of all vehicles: `id,t,x,y,z,yaw,scale`, metres and degrees.
pub fn write_timetable(plan: &Plan, out: &mut dyn Write) -> Result<()> {
    writeln!(out, "id,t,x,y,z,yaw,scale")?;
    for service in services(plan) {
        service.day(&mut |Key { second, at, yaw }| {
            let [hour, minute, second] = [second / 3600, second / 60 % 60, second % 60];
            let [x, y, z] = at.map(signed_thousandths);
            let yaw = signed_thousandths(yaw * 10);
            writeln!(out, "{},{DAY}T{hour:02}:{minute:02}:{second:02},{x},{y},{z},{yaw},1", service.id)
        })?;
    }
    Ok(())
}

/// Whether the street in line `j` crosses the river.
pub fn has_bridge(j: i64) -> bool {
    j.rem_euclid(2) == 0
}

/// The bridge in line `j` with its parapets and piers.
pub fn bridge(plan: &Plan, j: i64) -> Vec<Object> {
    let end = |is_east: bool| {
        let last = plan.quay_points(is_east, j - 1)[PARTS as usize][3];
        [last, plan.quay_points(is_east, j)[0][3]]
    };
    let ([south_west, north_west], [south_east, north_east]) = (end(false), end(true));
    let id = format!("bridge{j}").replace('-', "m");
    // A part of the deck, thousandths across and along.
    let part = |[x0, x1]: [i64; 2], [y0, y1]: [i64; 2]| {
        let at = |x: i64, y: i64| {
            between(between(south_west, south_east, x, 1000), between(north_west, north_east, x, 1000), y, 1000)
        };
        [at(x0, y0), at(x1, y0), at(x1, y1), at(x0, y1)]
    };
    let deck = Shell::prism(&part([0, 1000], [0, 1000]), QUAY - 800, QUAY);
    let mut bridge = Object::new(id.clone(), "Bridge").with(Geometry::Solid("2", deck));
    let rail = |y: [i64; 2]| Shell::prism_of(&part([0, 1000], y), QUAY, QUAY + 1_000, [Surface::Plain; 3]);
    let parapets = Object::new(format!("{id}-parapets"), "BridgeInstallation")
        .with(Geometry::Solids("2", vec![rail([0, 25]), rail([975, 1000])]))
        .child_of(&mut bridge);
    let pier = |x: i64| Shell::prism_of(&part([x - 14, x + 14], [40, 960]), -1_500, QUAY - 800, [Surface::Plain; 3]);
    let piers = Object::new(format!("{id}-piers"), "BridgeConstructiveElement")
        .with(Geometry::Solids("2", vec![pier(170), pier(500), pier(830)]))
        .child_of(&mut bridge);
    let mut road = Shell::default();
    let pavement = Street::Main.pavement().max(60);
    for (y, surface) in [
        ([25, pavement], Surface::Pavement),
        ([pavement, 1000 - pavement], Surface::Traffic),
        ([1000 - pavement, 975], Surface::Pavement),
    ] {
        let first = road.points.len() as u32;
        road.points.extend(part([0, 1000], y).map(|[x, y]| [x, y, QUAY + 30]));
        road.quad(surface, [0, 1, 2, 3].map(|k| first + k));
    }
    let road = Object::new(format!("{id}-road"), "Road").with(Geometry::Surfaces("2", road));
    vec![bridge, parapets, piers, road]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn yaws_are_those_of_the_library_to_a_hundredth() {
        for direction in [[1, 0], [5, 5], [-3, 4], [-1000, -1], [7, -20], [0, -9], [0, 4], [123, 77]] {
            let expected = (direction[1] as f64).atan2(direction[0] as f64).to_degrees() * 100.0;
            assert!((yaw(direction) as f64 - expected).abs() < 0.51, "{direction:?}: {expected}");
        }
    }
}
