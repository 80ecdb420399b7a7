// What a user's compiler must accept, and what it must not.
import { batchSolve, box, Kind, numbers, Scene, type SceneContact, solve, System, TriboError } from "tribo";

const impulse: number[] = solve([1, 0, 0, 1, 0, 1], [-1, 0, 0], 0.5).impulse;
const scene = new Scene({ gravity: [0, 0, -9.81] });
const id: number = scene.add({ shape: box(1, 1, 1), density: 1, kind: Kind.DYNAMIC });
const contacts: SceneContact[] = scene.contacts();
const feature: bigint | undefined = contacts[0]?.id;
const { p } = batchSolve(numbers(6), new Float64Array(3), numbers(2));
const status: number = new TriboError(10, "here").status;
new System().solve([], [], { progress: (info) => info.eta < 1 });
export { feature, id, impulse, p, status };

// @ts-expect-error: no Float32Array
batchSolve(new Float32Array(6), new Float64Array(3), new Float64Array(2));
// @ts-expect-error: no such option
scene.step(1, { solvr: 1 });
// @ts-expect-error: no such kind
scene.add({ kind: 7 });
