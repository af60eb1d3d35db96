//! The city as a stream of objects: cell by cell from the middle, each made when it is written and forgotten afterwards.

use std::io::Result;

use crate::city::synth::full::{
    blocks::{Block, Kind, Lot},
    furniture,
    house::House,
    interior, landmark, names,
    object::{Geometry, Object},
    parcels,
    plan::{Cell, Cells, Plan, Street},
    shell::Shell,
    streets, transport,
    trees::Planter,
};

/// Cells around the city.
const COUNTRY: i64 = 2;

/// Hears of objects: one with all that belongs to it, and how many standing buildings there are with it.
pub type Receiver<'a> = dyn FnMut(&[Object], u64) -> Result<()> + 'a;

/// Makes all objects of a city in their order.
pub fn each_family(plan: &Plan, receive: &mut Receiver<'_>) -> Result<()> {
    let mut stream = Stream { plan, receive, standing: 0 };
    let mut last_ring = None;
    for cell in Cells::default() {
        let ring = Plan::ring(cell);
        if last_ring.is_some_and(|last| ring > last + COUNTRY) {
            break;
        }
        let is_city = stream.standing < plan.options.buildings;
        let block = if is_city { Block::city(plan, cell) } else { Block::country(plan, cell) };
        stream.ground(&block)?;
        stream.streets(cell)?;
        stream.buildings(block)?;
        if is_city && stream.standing >= plan.options.buildings {
            last_ring = Some(ring);
        }
    }
    for service in transport::services(plan) {
        stream.alone(service.object())?;
    }
    Ok(())
}

struct Stream<'a, 'b> {
    plan: &'a Plan,
    receive: &'a mut Receiver<'b>,
    standing: u64,
}

impl Stream<'_, '_> {
    fn alone(&mut self, object: Object) -> Result<()> {
        (self.receive)(&[object], self.standing)
    }

    /// The ground of a block, by what it is; parks and woods lie on it.
    fn ground(&mut self, block: &Block) -> Result<()> {
        let [i, j] = block.cell;
        let (prefix, kind, class) = match block.kind {
            Kind::Market => ("square", "TransportSquare", "market"),
            Kind::Square => ("square", "TransportSquare", "square"),
            Kind::Field => ("field", "LandUse", "farmland"),
            Kind::Close => ("close", "LandUse", "churchyard"),
            Kind::Halls => ("works", "LandUse", "industry"),
            Kind::Slabs | Kind::Towers => ("lawn", "LandUse", "green"),
            _ => ("terrain", "TINRelief", ""),
        };
        let shell = streets::ground(self.plan, block.cell);
        let cover = match block.kind {
            Kind::Park => Some("park"),
            Kind::Wood => Some("wood"),
            _ => None,
        };
        if let Some(class) = cover {
            let mut plants = shell.clone();
            plants.points.iter_mut().for_each(|point| point[2] += parcels::LIFT);
            let object = Object::new(format!("{class}{i}_{j}"), "PlantCover").text("class", class);
            self.alone(object.with(Geometry::Surfaces("2", plants)))?;
        }
        let object = Object::new(format!("{prefix}{i}_{j}"), kind);
        if class.is_empty() {
            return self.alone(object.with(Geometry::Relief("2", shell)));
        }
        self.alone(object.text("class", class).with(Geometry::Surfaces("2", shell)))
    }

    /// The streets at the west and the south of a cell with their crossing, or the river with its quays.
    fn streets(&mut self, cell: Cell) -> Result<()> {
        let [i, j] = cell;
        let plan = self.plan;
        let mut planter = Planter::new(plan, cell, "street");
        let road = |id: String, shell: Shell, name: String| {
            Object::new(id, "Road").text("name", name).with(Geometry::Surfaces("2", shell))
        };
        let (upright, level) = (plan.upright(i, j), plan.level(i, j));
        self.alone(road(format!("street{i}_{j}s"), streets::level(plan, i, j), names::street(plan, false, j, level)))?;
        planter.line(level, &plan.level_points(i, j));
        let name = names::street(plan, true, i, upright);
        if upright == Street::River {
            self.alone(road(format!("quay{j}"), streets::quays(plan, j), name))?;
            let river = streets::river(plan, j);
            self.alone(
                Object::new(format!("river{j}"), "WaterBody")
                    .text("class", "river")
                    .with(Geometry::Surfaces("2", river.water)),
            )?;
            self.alone(Object::new(format!("bank{j}"), "TINRelief").with(Geometry::Relief("2", river.banks)))?;
            if transport::has_bridge(j) {
                let mut objects = transport::bridge(plan, j);
                let road = objects.pop();
                (self.receive)(&objects, self.standing)?;
                road.map_or(Ok(()), |road| self.alone(road))?;
            }
            for is_east in [false, true] {
                planter.line(upright, &plan.quay_points(is_east, j));
            }
        } else {
            let mut shell = streets::upright(plan, i, j);
            streets::add(&mut shell, streets::crossing_of(plan, i, j));
            self.alone(road(format!("street{i}_{j}w"), shell, name))?;
            planter.line(upright, &plan.upright_points(i, j));
        }
        planter.trees.into_iter().try_for_each(|tree| self.alone(tree))
    }

    /// The buildings of a block that have a place in the city, with what stood there before, and the trees between.
    fn buildings(&mut self, block: Block) -> Result<()> {
        self.landmarks(&block)?;
        let numbers = [self.standing + 1, self.plan.options.buildings];
        parcels::gardens(self.plan, &block, numbers).into_iter().try_for_each(|garden| self.alone(garden))?;
        for lot in &block.lots {
            if self.standing >= self.plan.options.buildings {
                break;
            }
            self.standing += 1;
            self.lot(block.cell, lot)?;
        }
        let mut planter = Planter::new(self.plan, block.cell, "yard");
        planter.block(&block);
        planter.trees.into_iter().try_for_each(|tree| self.alone(tree))
    }

    /// The church and the town hall, where this is their block.
    fn landmarks(&mut self, block: &Block) -> Result<()> {
        let town = names::town(self.plan);
        let number = self.standing + 1;
        let family = match block.kind {
            Kind::Close => landmark::church(self.plan, block, &format!("b{number}"), &format!("{town} Minster")),
            Kind::Market => interior::hall(self.plan, block).map(|hall| {
                let random = &mut names::register_of(self.plan, number);
                let building = Object::new(format!("b{number}"), "Building").text("name", format!("{town} Town Hall"));
                let mut building = shells(names::register(building, &hall, random), &hall);
                let mut family = interior::inside(&hall, &mut building);
                family.extend(installation(&mut building, &hall));
                family.insert(0, building);
                family
            }),
            _ => None,
        };
        if let Some(family) = family {
            self.standing += 1;
            (self.receive)(&family, self.standing)?;
        }
        if block.kind == Kind::Market {
            furniture::market(self.plan, block).into_iter().try_for_each(|object| self.alone(object))?;
        }
        self.gate(block.cell)
    }

    /// What is left of the old wall, where it was.
    fn gate(&mut self, cell: Cell) -> Result<()> {
        let Some(tower) = furniture::gate(self.plan, cell) else { return Ok(()) };
        if self.standing >= self.plan.options.buildings {
            return Ok(());
        }
        self.standing += 1;
        let random = &mut names::register_of(self.plan, self.standing);
        let building = Object::new(format!("b{}", self.standing), "Building").text("name", "Old Gate");
        self.alone(shells(names::register(building, &tower, random), &tower))
    }

    /// A house, and what stood there before, each an object with what belongs to it.
    fn lot(&mut self, cell: Cell, lot: &Lot) -> Result<()> {
        let number = self.standing;
        let random = &mut names::register_of(self.plan, number);
        let id = |age: usize| if age == 0 { format!("b{number}") } else { format!("b{number}-before{age}") };
        let address = names::address(self.plan, cell, lot);
        let houses: Vec<&House> = std::iter::once(&lot.house).chain(&lot.before).collect();
        for (age, house) in houses.iter().enumerate() {
            let mut building = names::register(Object::new(id(age), "Building"), house, random);
            if age > 0 {
                building = building.text("successor", id(age - 1));
            }
            if age + 1 < houses.len() {
                building = building.text("predecessor", id(age + 1));
            }
            building.address = Some(address.clone());
            let mut building = shells(building, house);
            let installation = if age == 0 { installation(&mut building, house) } else { None };
            let family: Vec<Object> = std::iter::once(building).chain(installation).collect();
            (self.receive)(&family, self.standing)?;
        }
        Ok(())
    }
}

/// The shells of a house in all its levels of detail.
fn shells(building: Object, house: &House) -> Object {
    let building = building.with(Geometry::Solid("1", house.block())).with(Geometry::Solid("2", house.shell()));
    if house.is_fine { building.with(Geometry::Solid("3", house.fine_shell())) } else { building }
}

/// Chimneys and dormers as one object.
fn installation(building: &mut Object, house: &House) -> Option<Object> {
    let shells = house.on_the_roof();
    (!shells.is_empty()).then(|| {
        Object::new(format!("{}-roof", building.id), "BuildingInstallation")
            .with(Geometry::Solids("2", shells))
            .child_of(building)
    })
}
