/** A robot as it is drawn, as a binary glTF: metres, y upwards as that format has it. */
import { Group, type Object3D } from "three";

export async function gltf(name: string, drawn: Object3D): Promise<Blob> {
  const { GLTFExporter } = await import("three/addons/exporters/GLTFExporter.js");
  const root = new Group();
  root.name = name;
  root.rotation.x = -Math.PI / 2;
  root.add(drawn.clone());
  root.updateMatrixWorld(true);
  const file = await new GLTFExporter().parseAsync(root, { binary: true, onlyVisible: true });
  return new Blob([file as ArrayBuffer], { type: "model/gltf-binary" });
}
