//! The test vectors of the C library, replayed bit for bit: see vectors.c for the rule.

use tribo::*;

struct Draws(u64);

impl Draws {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e3779b97f4a7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58476d1ce4e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d049bb133111eb);
        z ^= z >> 31;
        (z >> 11) as f64 / 9007199254740992.0
    }
    fn side(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }
    fn sides(&mut self) -> [f64; 3] {
        std::array::from_fn(|_| self.side())
    }
    fn matrix(&mut self) -> [f64; 6] {
        std::array::from_fn(|i| match i {
            0 | 3 | 5 => 2.0 + self.side(),
            _ => 0.5 * self.side(),
        })
    }
    fn pair(&mut self) -> Material {
        let mu_s = 2.0 * self.unit();
        let mu_d = self.unit() * mu_s;
        Material { mu_s, mu_d, e: self.unit(), ..Default::default() }
    }
}

struct Hash(u64);

impl Hash {
    fn put(&mut self, word: u64) {
        for byte in word.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x100000001b3);
        }
    }
    fn numbers(&mut self, numbers: &[f64]) {
        numbers.iter().for_each(|x| self.put(x.to_bits()));
    }
}

type Set = fn(&mut Draws, &mut Hash, u32) -> Result<()>;

fn do_solve(d: &mut Draws, h: &mut Hash, _: u32) -> Result<()> {
    let (w, b, pair) = (d.matrix(), d.sides(), d.pair());
    let (p, info) = solve_info(&w, &b, pair.mu_s, pair.mu_d)?;
    h.put(0);
    h.numbers(&p);
    h.put(info.mode.into());
    Ok(())
}

fn do_impact(d: &mut Draws, h: &mut Hash, i: u32) -> Result<()> {
    let (w, u, pair) = (d.matrix(), d.sides(), d.pair());
    let (p, info) = impact(&w, &u, &pair, ImpactOptions { law: i % 8, ..Default::default() })?;
    h.put(0);
    h.numbers(&p);
    h.put(info.mode.into());
    h.numbers(&[info.energy]);
    Ok(())
}

fn draw_box(d: &mut Draws) -> Result<Body> {
    let half: [f64; 3] = std::array::from_fn(|_| 0.5 + d.unit());
    let (mass, _, inertia) = Shape::cuboid(half[0], half[1], half[2])?.mass(1000.0)?;
    let mut body = body_of(mass, &inertia)?;
    body.position = d.sides();
    body.orientation = rotation(&d.sides())?;
    body.velocity = d.sides();
    body.angular_velocity = d.sides();
    Ok(body)
}

fn do_collide(d: &mut Draws, h: &mut Hash, _: u32) -> Result<()> {
    let (mut a, mut b) = (draw_box(d)?, draw_box(d)?);
    let (point, normal) = (d.sides(), normalize(&d.sides())?);
    let pair = d.pair();
    let info = collide(&mut a, Some(&mut b), &point, &normal, &pair, Default::default())?;
    h.put(0);
    for body in [&a, &b] {
        h.numbers(&body.velocity);
        h.numbers(&body.angular_velocity);
    }
    h.numbers(&info.impulse);
    h.numbers(&[info.energy]);
    Ok(())
}

const BATCH: usize = 100;

fn put_batch(h: &mut Hash, p: &[[f64; 3]], modes: &[u32]) {
    h.put(0);
    p.iter().for_each(|p| h.numbers(p));
    modes.iter().for_each(|&mode| h.put(mode.into()));
}

fn do_batch_solve(d: &mut Draws, h: &mut Hash, _: u32) -> Result<()> {
    let (mut w, mut b, mut mu) = (vec![], vec![], vec![]);
    for _ in 0..BATCH {
        w.push(d.matrix());
        b.push(d.sides());
        let pair = d.pair();
        mu.push([pair.mu_s, pair.mu_d]);
    }
    let (mut p, mut modes) = (vec![[0.0; 3]; BATCH], vec![0; BATCH]);
    batch_solve(Isa::Best, &w, &b, &mu, &mut p, Some(&mut modes), None)?;
    put_batch(h, &p, &modes);
    Ok(())
}

fn do_batch_impact(d: &mut Draws, h: &mut Hash, _: u32) -> Result<()> {
    let (mut w, mut u, mut pairs) = (vec![], vec![], vec![]);
    for _ in 0..BATCH {
        w.push(d.matrix());
        u.push(d.sides());
        pairs.push(d.pair());
    }
    let (mut p, mut modes) = (vec![[0.0; 3]; BATCH], vec![0; BATCH]);
    batch_impact(Isa::Best, &w, &u, &pairs, &mut p, Some(&mut modes), None)?;
    put_batch(h, &p, &modes);
    Ok(())
}

fn draw_shape(d: &mut Draws, kind: u32) -> Result<(Shape, Pose)> {
    let [a, b, c]: [f64; 3] = std::array::from_fn(|_| 0.25 + 0.5 * d.unit());
    let shape = match kind {
        0 => Shape::sphere(a),
        1 => Shape::cuboid(a, b, c),
        2 => Shape::capsule(a, b),
        3 => Shape::cylinder(a, b),
        4 => Shape::cone(a, b),
        _ => Shape::ellipsoid(a, b, c),
    }?;
    let position = d.sides().map(|x| 0.5 * x);
    Ok((shape, pose(position, rotation(&d.sides())?)))
}

fn do_manifold(d: &mut Draws, h: &mut Hash, i: u32) -> Result<()> {
    let (a, pose_a) = draw_shape(d, i % 6)?;
    let (b, pose_b) = draw_shape(d, i / 6 % 6)?;
    let options = CollideOptions { margin: 0.015625, ..Default::default() };
    let manifolds = touch(&a, &pose_a, &b, &pose_b, options)?;
    h.put(0);
    h.put(manifolds.len() as u64);
    for m in manifolds {
        h.put(m.count.into());
        h.numbers(&m.normal);
        for point in &m.points[..m.count as usize] {
            h.numbers(&point.arm_a);
            h.numbers(&point.arm_b);
            h.numbers(&[point.distance]);
            h.put(point.id);
        }
    }
    Ok(())
}

fn do_system(d: &mut Draws, h: &mut Hash, i: u32) -> Result<()> {
    let (mass, _, inertia) = Shape::cuboid(0.5, 0.5, 0.5)?.mass(1000.0)?;
    let (mut bodies, mut contacts) = (vec![], vec![]);
    for k in 0..5_u32 {
        let mut body = body_of(mass, &inertia)?;
        body.position[2] = f64::from(k) + 0.5;
        body.velocity = [0.125 * d.side(), 0.125 * d.side(), -0.015625];
        body.angular_velocity = d.sides().map(|x| 0.125 * x);
        bodies.push(body);
        for j in 0..4 {
            let x = if j % 2 == 0 { -0.5 } else { 0.5 };
            let y = if j / 2 == 0 { -0.5 } else { 0.5 };
            let mut c = SystemContact { a: k, dimension: 3, ..Default::default() };
            c.b = if k > 0 { k - 1 } else { WORLD };
            c.contact.normal = [0.0, 0.0, 1.0];
            (c.contact.arm_a, c.contact.arm_b) = ([x, y, -0.5], [x, y, 0.5]);
            (c.pair.mu_s, c.pair.mu_d) = (0.5, 0.5);
            contacts.push(c);
        }
    }
    let tolerance = (-30_f64).exp2();
    let options = SystemOptions { solver: 1 + i % 2, tolerance, ..Default::default() };
    let mut system = System::new()?;
    system.solve(&bodies, &contacts, options)?;
    h.put(0);
    system.impulses.iter().for_each(|p| h.numbers(p));
    system.velocities.iter().for_each(|v| h.numbers(v));
    Ok(())
}

fn do_scene(d: &mut Draws, h: &mut Hash, _: u32) -> Result<()> {
    let material = Material { mu_s: 0.5, mu_d: 0.5, e: 0.25, ..Default::default() };
    let mut scene = Scene::new([0.0, 0.0, -9.8125])?;
    scene.add(&SceneBody::fixed(Shape::halfspace(&[0.0, 0.0, 1.0], 0.0)?, material))?;
    for k in 0..10_u32 {
        let shape = match k % 4 {
            0 => Shape::sphere(0.25),
            1 => Shape::cuboid(0.25, 0.25, 0.25),
            2 => Shape::capsule(0.25, 0.25),
            _ => Shape::cylinder(0.25, 0.25),
        }?;
        let mut body = SceneBody::solid(shape, 1000.0, material)?;
        body.state.position = [d.side(), d.side(), 1.0 + f64::from(k)];
        body.state.velocity = d.sides();
        body.state.angular_velocity = d.sides();
        scene.add(&body)?;
    }
    for step in 1..=1000 {
        scene.step(0.00390625, Default::default())?;
        for k in (1..=10).filter(|_| step % 100 == 0) {
            let body = scene.body(k)?;
            h.put(0);
            h.numbers(&body.position);
            h.numbers(&body.orientation);
            h.numbers(&body.velocity);
            h.numbers(&body.angular_velocity);
        }
    }
    Ok(())
}

fn vectors() -> serde_json::Value {
    let here = concat!(env!("CARGO_MANIFEST_DIR"), "/../../vectors.json");
    let path = std::env::var("TRIBO_VECTORS").unwrap_or_else(|_| here.to_string());
    serde_json::from_str(&std::fs::read_to_string(path).expect("vectors.json")).expect("JSON")
}

#[test]
fn vectors_are_replayed_to_the_bit() {
    let sets: [(&str, Set); 8] = [
        ("solve", do_solve),
        ("impact", do_impact),
        ("collide", do_collide),
        ("batch_solve", do_batch_solve),
        ("batch_impact", do_batch_impact),
        ("manifold", do_manifold),
        ("system", do_system),
        ("scene", do_scene),
    ];
    let mut wrong = vec![];
    for expected in vectors()["sets"].as_array().expect("sets") {
        let name = expected["name"].as_str().expect("name");
        let run = sets.iter().find(|set| set.0 == name).expect("a set that is known").1;
        let mut draws = Draws(expected["seed"].as_u64().expect("seed"));
        let mut hash = Hash(0xcbf29ce484222325);
        for i in 0..expected["count"].as_u64().expect("count") {
            if let Err(error) = run(&mut draws, &mut hash, i as u32) {
                hash.put(error.status() as u64);
            }
        }
        if format!("{:016x}", hash.0) != expected["hash"] {
            wrong.push(name.to_string());
        }
    }
    assert!(wrong.is_empty(), "{wrong:?} differ");
}

#[test]
fn every_status_is_an_error_with_name_and_text() {
    for status in vectors()["statuses"].as_array().expect("statuses") {
        let value = status["value"].as_i64().expect("value") as i32;
        match Error::of(value) {
            Ok(()) => assert_eq!(value, 0),
            Err(error) => {
                assert_eq!(error.status(), value);
                assert_eq!(error.name(), status["name"]);
                assert_eq!(error.to_string(), status["text"].as_str().expect("text"));
            }
        }
    }
}
