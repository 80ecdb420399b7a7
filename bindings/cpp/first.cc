// A ball of 2 kg falls onto the floor, sliding and spinning, and rolls on.
#include <cstdio>
#include <tribo/tribo.hpp>

int main()
{
    tribo::scene scene(0.0, 0.0, -9.81);

    tribo_scene_body floor = tribo::scene_body();
    floor.kind = TRIBO_BODY_STATIC;
    floor.shape = tribo::halfspace({0.0, 0.0, 1.0}, 0.0);
    floor.material.mu_s = floor.material.mu_d = 0.3;
    scene.add(floor);

    tribo_scene_body ball = tribo::scene_body();
    ball.shape = tribo::sphere(0.5);
    ball.material = floor.material;
    const tribo::mass_properties solid = tribo::shape_mass(ball.shape, 3.8197186342054885);
    ball.state = tribo::body_of(solid.mass, solid.inertia);
    ball.state.position[2] = 1.0;
    ball.state.velocity[0] = 7.0;
    const std::uint32_t id = scene.add(ball);

    for (int i = 0; i < 2400; i++) {
        scene.step(1.0 / 1200.0);
    }
    const tribo_body end = scene.body(id);
    std::printf("after 2 s: %.6f m/s, %.6f rad/s\n", end.velocity[0], end.angular_velocity[1]);
    return 0;
}
