/** Simple bodies in metres; what the page makes of points and directions that the server gave. */
import {
  BoxGeometry, BufferGeometry, CapsuleGeometry, ConeGeometry, CylinderGeometry, Group, Matrix4, Mesh, Object3D,
  Quaternion, Vector3, type Material,
} from "three";

const Y = new Vector3(0, 1, 0);

export function vector(triple: readonly number[]): Vector3 {
  return new Vector3(triple[0] ?? 0, triple[1] ?? 0, triple[2] ?? 0);
}

/** Turns a body that is built along y into a direction. */
export function along(object: Object3D, direction: Vector3): void {
  if (direction.lengthSq() > 0) {
    object.quaternion.setFromUnitVectors(Y, direction.clone().normalize());
  }
}

/** A rod with round ends. */
export function capsule(from: Vector3, to: Vector3, radius: number, material: Material): Mesh {
  const way = to.clone().sub(from);
  const mesh = new Mesh(new CapsuleGeometry(radius, way.length(), 6, 18), material);
  mesh.position.copy(from).addScaledVector(way, 0.5);
  along(mesh, way);
  return mesh;
}

/** A cylinder about an axis, its middle at `at`. */
export function drum(at: Vector3, axis: Vector3, radius: number, length: number, material: Material): Mesh {
  const mesh = new Mesh(new CylinderGeometry(radius, radius, length, 28), material);
  mesh.position.copy(at);
  along(mesh, axis);
  return mesh;
}

/** A block about an axis, its middle at `at`. */
export function block(at: Vector3, axis: Vector3, width: number, length: number, material: Material): Mesh {
  const mesh = new Mesh(new BoxGeometry(width, length, width), material);
  mesh.position.copy(at);
  along(mesh, axis);
  return mesh;
}

/** Shared by all thin rods and arrows: they are scaled, never freed. */
const ROD = shared(new CylinderGeometry(1, 1, 1, 12));
const TIP = shared(new ConeGeometry(1, 1, 18));

function shared<G extends BufferGeometry>(geometry: G): G {
  geometry.userData["shared"] = true;
  return geometry;
}

/** A thin straight line that can be seen from afar. */
export function rod(from: Vector3, to: Vector3, radius: number, material: Material): Mesh {
  const way = to.clone().sub(from);
  const mesh = new Mesh(ROD, material);
  mesh.scale.set(radius, Math.max(way.length(), 1e-12), radius);
  mesh.position.copy(from).addScaledVector(way, 0.5);
  along(mesh, way);
  return mesh;
}

/** The tip of an arrow that ends here. */
export function tip(end: Vector3, direction: Vector3, radius: number, length: number, material: Material): Mesh {
  const mesh = new Mesh(TIP, material);
  mesh.scale.set(radius, length, radius);
  mesh.position.copy(end).addScaledVector(direction.clone().normalize(), -length / 2);
  along(mesh, direction);
  return mesh;
}

/** An arrow from a point; `radius` is that of its shaft. */
export function arrow(from: Vector3, way: Vector3, radius: number, material: Material): Group {
  const group = new Group();
  const length = way.length();
  if (length === 0) return group;
  const head = Math.min(length * 0.45, radius * 8);
  const end = from.clone().add(way);
  group.add(rod(from, end.clone().addScaledVector(way, -(head * 0.8) / length), radius, material));
  group.add(tip(end, way, radius * 2.8, head, material));
  return group;
}

/** Two unit directions that make a right-handed frame with this one. */
export function across(direction: Vector3): [Vector3, Vector3] {
  const z = direction.clone().normalize();
  const turn = new Quaternion().setFromUnitVectors(new Vector3(0, 0, 1), z);
  return [new Vector3(1, 0, 0).applyQuaternion(turn), new Vector3(0, 1, 0).applyQuaternion(turn)];
}

/** A frame as a matrix from three axes (they may have any length) and an origin. */
export function basis(x: Vector3, y: Vector3, z: Vector3, origin: Vector3): Matrix4 {
  return new Matrix4().makeBasis(x, y, z).setPosition(origin);
}

/** Frees what the graphics card holds of an object and takes it out. */
export function discard(object: Object3D): void {
  object.traverse((part) => {
    const geometry = (part as Partial<Mesh>).geometry;
    if (geometry instanceof BufferGeometry && !geometry.userData["shared"]) geometry.dispose();
  });
  object.removeFromParent();
}
