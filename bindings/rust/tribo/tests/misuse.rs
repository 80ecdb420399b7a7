//! What is refused, and what may be done from other threads.

use tribo::*;

const NAN: f64 = f64::NAN;
const UP: [f64; 3] = [0.0, 0.0, 1.0];

fn ball_scene() -> Result<(Scene, u32)> {
    let mut scene = Scene::new([0.0, 0.0, -9.81])?;
    let none = Material::default();
    scene.add(&SceneBody::fixed(Shape::halfspace(&UP, 0.0)?, none))?;
    let mut ball = SceneBody::solid(Shape::sphere(0.5)?, 1.0, none)?;
    ball.state.position[2] = 0.75;
    let id = scene.add(&ball)?;
    Ok((scene, id))
}

#[test]
fn one_contact_refuses() {
    let w = [1.0, 0.0, 0.0, 1.0, 0.0, 1.0];
    assert_eq!(solve(&w, &[NAN, 0.0, 0.0], 0.5, 0.5), Err(Error::NOT_FINITE));
    assert_eq!(solve(&w, &[-1.0, 0.0, 0.0], 0.1, 0.5), Err(Error::FRICTION));
    assert_eq!(material("cheese on moon").err(), Some(Error::NAME));
    assert_eq!(material("a\0b").err(), Some(Error::NAME));
    assert_eq!(body_of(-1.0, &[1.0; 9]).err(), Some(Error::MASS));
}

#[test]
fn batches_refuse_lengths_and_tell_each_contact() {
    let w = [[1.0, 0.0, 0.0, 1.0, 0.0, 1.0]; 3];
    let b = [[-1.0, 0.0, 0.0], [NAN, 0.0, 0.0], [-1.0, 0.0, 0.0]];
    let (mu, mut p, mut statuses) = ([[0.5; 2]; 3], [[0.0; 3]; 3], [0; 3]);
    let mut short = [[0.0; 3]; 2];
    assert_eq!(batch_solve(Isa::Best, &w, &b, &mu, &mut short, None, None), Err(Error::CAPACITY));
    let all = batch_solve(Isa::Best, &w, &b, &mu, &mut p, None, Some(&mut statuses));
    assert_eq!(all, Err(Error::NOT_FINITE));
    assert_eq!(statuses, [0, Error::NOT_FINITE.status(), 0]);
    assert_eq!(p, [[1.0, 0.0, 0.0], [0.0; 3], [1.0, 0.0, 0.0]]);
}

#[test]
fn shapes_refuse() {
    assert_eq!(Shape::sphere(-1.0).err(), Some(Error::SHAPE));
    assert_eq!(Shape::hull(&[[0.0; 3]; 8]).err(), Some(Error::DEGENERATE));
    assert_eq!(Shape::mesh(&[[0.0; 3]; 3], &[[0, 1, 7]]).err(), Some(Error::INDEX));
    assert_eq!(Tree::new(0, 0.0).err(), Some(Error::RANGE));
    let here = pose([0.0; 3], [1.0, 0.0, 0.0, 0.0]);
    let bad = Shape::convex(Box::new(|_| panic!("no")), [0.0; 3], 1.0).unwrap();
    let ball = Shape::sphere(1.0).unwrap();
    std::panic::set_hook(Box::new(|_| {}));
    let seen = touch(&bad, &here, &ball, &here, Default::default()).err();
    let _ = std::panic::take_hook();
    assert_eq!(seen, Some(Error::SUPPORT));
}

#[test]
fn a_users_shape_is_a_shape() {
    let here = pose([0.0; 3], [1.0, 0.0, 0.0, 0.0]);
    let above = pose([0.0, 0.0, 1.9], [1.0, 0.0, 0.0, 0.0]);
    let support = |d: &[f64; 3]| normalize(d).unwrap_or([0.0; 3]);
    let own = Shape::convex(Box::new(support), [0.0; 3], 1.0).unwrap();
    let found = touch(&own, &above, &Shape::sphere(1.0).unwrap(), &here, Default::default());
    let found = found.unwrap();
    assert_eq!(found.len(), 1);
    assert!((found[0].points[0].distance + 0.1).abs() < 1e-6);
}

#[test]
fn scenes_refuse() {
    let (mut scene, ball) = ball_scene().unwrap();
    assert_eq!(scene.step(-1.0, Default::default()).err(), Some(Error::TIME_STEP));
    assert_eq!(scene.body(99).err(), Some(Error::INDEX));
    assert_eq!(scene.remove(99).err(), Some(Error::INDEX));
    assert_eq!(scene.body(ball).unwrap().position[2], 0.75);
}

#[test]
fn balls_resist_rolling() {
    let material = Material { mu_s: 0.5, mu_d: 0.5, ..Default::default() };
    let mut scene = Scene::new([0.0, 0.0, -10.0]).unwrap();
    scene.add(&SceneBody::fixed(Shape::halfspace(&UP, 0.0).unwrap(), material)).unwrap();
    let mut ball = SceneBody::solid(Shape::sphere(0.5).unwrap(), 1.0, material).unwrap();
    ball.state.position[2] = 0.5;
    ball.state.velocity[0] = 1.0;
    ball.state.angular_velocity[1] = 2.0;
    ball.rolling = 0.02;
    let id = scene.add(&ball).unwrap();
    for _ in 0..100 {
        scene.step(0.01, Default::default()).unwrap();
    }
    let left = 1.0 - 5.0 / 7.0 * 0.02 * 10.0 / 0.5;
    assert!((scene.body(id).unwrap().velocity[0] - left).abs() < 1e-9);
    ball.spinning = -1.0;
    assert_eq!(scene.add(&ball), Err(Error::FRICTION));
}

#[test]
fn saved_scenes_keep_their_shapes_and_go_on_to_the_bit() {
    let mut scene = Scene::new([0.0, 0.0, -9.81]).unwrap();
    let none = Material::default();
    let corner = |i: u32, bit: u32| f64::from(i >> bit & 1) - 0.5;
    let points: Vec<_> = (0..8).map(|i| [corner(i, 0), corner(i, 1), corner(i, 2)]).collect();
    scene.add(&SceneBody::fixed(Shape::halfspace(&UP, 0.0).unwrap(), none)).unwrap();
    let mut cube = SceneBody::solid(Shape::hull(&points).unwrap(), 1.0, none).unwrap();
    cube.state.position[2] = 0.6;
    let id = scene.add(&cube).unwrap();
    drop(cube);
    let saved = scene.save().unwrap();
    let ends: Vec<Saved> = (0..2)
        .map(|_| {
            for _ in 0..50 {
                scene.step(0.0078125, Default::default()).unwrap();
            }
            let end = scene.save().unwrap();
            scene.remove(id).unwrap();
            scene.load(&saved).unwrap();
            end
        })
        .collect();
    assert!(ends[0] == ends[1] && ends[0] != saved);
}

#[test]
fn scenes_go_to_other_threads_and_tasks_change_no_bit() {
    let run = |tasks| {
        let (mut scene, ball) = ball_scene().unwrap();
        for _ in 0..100 {
            scene.step(0.01, StepOptions { tasks, ..Default::default() }).unwrap();
        }
        scene.body(ball).unwrap()
    };
    let (one, two) = std::thread::scope(|scope| {
        let (one, two) = (scope.spawn(|| run(1)), scope.spawn(|| run(3)));
        (one.join().unwrap(), two.join().unwrap())
    });
    assert_eq!(one.position.map(f64::to_bits), two.position.map(f64::to_bits));
}

#[test]
fn trees_may_move() {
    let mut tree = Tree::new(8, 0.0).unwrap();
    tree.add(&[0.0; 3], &[1.0; 3]).unwrap();
    let second = tree.add(&[0.5, 0.0, 0.0], &[2.0, 1.0, 1.0]).unwrap();
    let mut moved = Box::new(tree);
    assert_eq!(moved.pairs().unwrap(), [[0, 1]]);
    assert_eq!(moved.query_ray(&[-1.0, 0.5, 0.5], &[9.0, 0.5, 0.5]).unwrap(), [0, 1]);
    moved.move_to(second, &[5.0; 3], &[6.0; 3]).unwrap();
    assert!(moved.pairs().unwrap().is_empty());
    assert_eq!(moved.query_box(&[4.0; 3], &[7.0; 3]).unwrap(), [second]);
    moved.remove(second).unwrap();
    assert_eq!(moved.remove(second), Err(Error::INDEX));
}
