// The page: a scene that runs as fast as the clock, and what it conserves.
import * as three from "three";
import { Solver, Stop, version } from "tribo";
import { meshOf } from "./meshes.js";
import { Plot } from "./plots.js";
import { make } from "./scenes.js";

const DT = 1 / 120;
const COLORS = [0xd9843b, 0x4f86c6, 0x7aa95c, 0xb85c7a, 0x8f7bbf, 0xc9a93f, 0x5aa6a6];
const get = (id) => document.getElementById(id);
const nameOf = (values, value) => Object.keys(values).find((key) => values[key] === value).toLowerCase();

for (const value of Object.values(Solver)) {
  get("solver").add(new Option(nameOf(Solver, value).replace("_", "-"), value));
}
const plots = {
  energy: new Plot(get("plots"), "energy", "J"),
  kinetic: new Plot(get("plots"), "kinetic energy", "J"),
  momentum: new Plot(get("plots"), "momentum |p|", "N s"),
  angular: new Plot(get("plots"), "angular momentum |L|", "N m s"),
  eta: new Plot(get("plots"), "η of the step", "", { log: true }),
};

// ---- view ----------------------------------------------------------------------------------------

const renderer = new three.WebGLRenderer({ antialias: true });
renderer.shadowMap.enabled = true;
renderer.setClearColor(0xf4f4f2);
get("view").append(renderer.domElement);
const camera = new three.PerspectiveCamera(40, 1, 0.1, 200);
camera.up.set(0, 0, 1);
camera.position.set(4, -13, 5.5);
camera.lookAt(0, 0, 1.8);
const world = new three.Scene();
const sun = new three.DirectionalLight(0xffffff, 2.2);
sun.position.set(-6, -8, 14);
sun.castShadow = true;
Object.assign(sun.shadow.camera, { left: -12, right: 12, top: 12, bottom: -12 });
sun.shadow.mapSize.set(1024, 1024);
const ground = new three.Mesh(new three.PlaneGeometry(60, 60), new three.MeshStandardMaterial({ color: 0xdcdcd4 }));
ground.receiveShadow = true;
world.add(sun, new three.HemisphereLight(0xffffff, 0xb0a898, 1.4), ground);

function fit() {
  const { clientWidth, clientHeight } = get("view");
  renderer.setSize(clientWidth, clientHeight);
  camera.aspect = clientWidth / clientHeight;
  camera.updateProjectionMatrix();
}

// ---- time ----------------------------------------------------------------------------------------

let scene;
let meshes = new Map();
let running = true;
let behind = 0;
let last = performance.now();
const setting = (id) => Number(get(id).value);

function start() {
  scene?.close();
  meshes.forEach((mesh) => {
    world.remove(mesh);
    mesh.geometry.dispose();
    mesh.material.dispose();
  });
  meshes = new Map();
  scene = make(get("scene").value, { mu: setting("mu"), e: setting("e") }, (id, shape) => {
    const mesh = meshOf(shape, COLORS[id % COLORS.length]);
    meshes.set(id, mesh);
    world.add(mesh);
  });
  Object.values(plots).forEach((plot) => plot.clear());
  get("note").textContent = "";
  behind = 0;
}

function step() {
  const info = scene.step(DT, { solver: setting("solver"), tolerance: 10 ** setting("tolerance"), maxIterations: 300 });
  const { linear, angular, energy, potential } = scene.totals();
  plots.energy.push(energy + potential);
  plots.kinetic.push(energy);
  plots.momentum.push(Math.hypot(...linear));
  plots.angular.push(Math.hypot(...angular));
  plots.eta.push(info.eta);
  get("note").textContent = `t = ${scene.time.toFixed(2)} s; ${info.contacts} contacts, ${info.sweeps} sweeps, ` +
    `${info.newtonSteps} Newton steps, ended by ${nameOf(Stop, info.stop)}; tribo ${version}`;
}

function show() {
  for (const [id, mesh] of meshes) {
    const { position, orientation: [w, x, y, z] } = scene.body(id);
    mesh.position.set(...position);
    mesh.quaternion.set(x, y, z, w);
  }
  Object.values(plots).forEach((plot) => plot.draw());
  renderer.render(world, camera);
}

/** Steps that the clock asks for; where they cost more than they cover, time runs slower. */
function frame(now) {
  behind = running ? Math.min(behind + (now - last) / 1000, 0.1) : 0;
  last = now;
  const due = behind >= DT;
  for (; behind >= DT; behind -= DT) {
    step();
  }
  if (due) {
    show();
  }
  requestAnimationFrame(frame);
}

// ---- controls ------------------------------------------------------------------------------------

const TEXTS = { mu: (x) => x.toFixed(2), e: (x) => x.toFixed(2), tolerance: (x) => `1e${x}` };
for (const [id, text] of Object.entries(TEXTS)) {
  const tell = () => {
    get(id).nextElementSibling.value = text(setting(id));
  };
  get(id).addEventListener("input", tell);
  tell();
}
// Materials belong to bodies: friction and restitution are for a new start, solver and tolerance for now.
["scene", "mu", "e"].forEach((id) => get(id).addEventListener("change", start));
get("again").addEventListener("click", start);
get("pause").addEventListener("click", () => {
  running = !running;
  get("pause").textContent = running ? "pause" : "go on";
});
window.addEventListener("resize", () => {
  fit();
  show();
});
fit();
start();
requestAnimationFrame(frame);
