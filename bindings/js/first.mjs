// A ball falls onto the floor, sliding, and rolls on at five sevenths of its speed.
import { halfspace, Kind, material, Scene, sphere } from "tribo";

const surface = material(0.3);
const scene = new Scene();
scene.add({ shape: halfspace([0, 0, 1]), kind: Kind.STATIC, material: surface });
const ball = scene.add({ shape: sphere(0.5), density: 4, position: [0, 0, 1], velocity: [7, 0, 0],
  material: surface });
for (let i = 0; i < 2400; i++) {
  scene.step(1 / 1200);
}
const { velocity, angularVelocity } = scene.body(ball);
console.log(`${velocity[0].toFixed(6)} m/s, ${angularVelocity[1].toFixed(6)} rad/s`);
