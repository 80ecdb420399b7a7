"""A ball falls onto the floor, sliding, and rolls on at five sevenths of its speed."""

import tribo
from tribo import shape

material = tribo.Material(mu_s=0.3, mu_d=0.3)
with tribo.Scene() as scene:
    scene.add(shape.halfspace((0, 0, 1)), kind=tribo.Kind.STATIC, material=material)
    ball = scene.add(shape.sphere(0.5), density=4.0, position=(0, 0, 1), velocity=(7, 0, 0),
                     material=material)
    for _ in scene.run(seconds=2, dt=1 / 1200):
        pass
    body = scene.body(ball)
print(f"{body['velocity'][0]:.6f} m/s, {body['angular_velocity'][1]:.6f} rad/s")
