// What three.js draws for a shape of tribo: both have the z axis up here.
import * as three from "three";
import { ShapeType } from "tribo";

const upright = (geometry) => geometry.rotateX(Math.PI / 2); // three's axis of cylinders is y

/** Triangles through the support points of a convex shape. */
function sampled(shape) {
  const geometry = new three.SphereGeometry(1, 24, 16);
  const at = geometry.getAttribute("position");
  for (let i = 0; i < at.count; i++) {
    at.setXYZ(i, ...shape.support([at.getX(i), at.getY(i), at.getZ(i)]));
  }
  return geometry;
}

function geometryOf(shape) {
  const [a, b, c] = shape.size;
  switch (shape.kind) {
    case ShapeType.SPHERE: return new three.SphereGeometry(a, 24, 16);
    case ShapeType.BOX: return new three.BoxGeometry(2 * a, 2 * b, 2 * c);
    case ShapeType.CAPSULE: return upright(new three.CapsuleGeometry(a, 2 * b, 8, 20));
    case ShapeType.CYLINDER: return upright(new three.CylinderGeometry(a, a, 2 * b, 28));
    case ShapeType.CONE: return upright(new three.ConeGeometry(a, 2 * b, 28));
    case ShapeType.ELLIPSOID: return new three.SphereGeometry(1, 24, 16).scale(a, b, c);
    default: return sampled(shape);
  }
}

/** A mesh whose origin is the centre of mass, as that of the body. */
export function meshOf(shape, color) {
  const geometry = geometryOf(shape);
  geometry.translate(...shape.mass(1).center.map((x) => -x));
  const mesh = new three.Mesh(geometry, new three.MeshStandardMaterial({ color, roughness: 0.7, flatShading: true }));
  mesh.castShadow = mesh.receiveShadow = true;
  return mesh;
}
