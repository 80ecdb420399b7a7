//! A ball falls onto the floor, sliding, and rolls on at five sevenths of its speed.

use tribo::{Material, Scene, SceneBody, Shape};

fn main() -> tribo::Result<()> {
    let material = Material { mu_s: 0.3, mu_d: 0.3, ..Default::default() };
    let mut scene = Scene::new([0.0, 0.0, -9.81])?;
    scene.add(&SceneBody::fixed(Shape::halfspace(&[0.0, 0.0, 1.0], 0.0)?, material))?;

    let mut ball = SceneBody::solid(Shape::sphere(0.5)?, 4.0, material)?;
    ball.state.position[2] = 1.0;
    ball.state.velocity[0] = 7.0;
    let id = scene.add(&ball)?;
    for _ in 0..2400 {
        scene.step(1.0 / 1200.0, Default::default())?;
    }
    let end = scene.body(id)?;
    println!("{:.6} m/s, {:.6} rad/s", end.velocity[0], end.angular_velocity[1]);
    Ok(())
}
