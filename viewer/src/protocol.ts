/** The messages of docs/viewer.md, with what the page adds. Units SI and radians; null stands for infinite or none. */
import type { About, Comparison, Drawings, Empty, Failure, ModelNews, Pose, Postures, Report, Scene, Shape, State as FromSession } from "./messages";

export type * from "./messages";

export type Vec3 = Pose["position"];
/** w, x, y, z */
export type Quaternion = Pose["quaternion"];
export type Colour = [number, number, number, number] | null;
export type MeshShape = Extract<Shape, { kind: "mesh" }>;
/** A state of the session, or of the motion of a file, which may have no errors. */
export type State = Omit<FromSession, "error"> & { error: { position: number | null; orientation: number | null } };
export type FromServer = Scene | FromSession | Comparison | Report | Postures | Failure | About | Drawings | ModelNews;

export function isEmpty(data: object): data is Empty {
  return "empty" in data;
}
