/** A configuration as the fragment of an address, and back. Nothing of it reaches a server by itself. */
import type { Avoidance, ChosenMethod, OverlayName, Pose, Scene, SimpleShape, State } from "./protocol";

/** Obstacles with meshes belong to the server, which has their files. */
export type KeptObstacle = Pose & { name: string; shape: SimpleShape };

export type Snapshot = {
  model: string;
  frame?: string; task?: string; actuated?: string[]; method?: ChosenMethod;
  q: number[]; target?: Pose; playing?: boolean;
  overlays?: OverlayName[];
  obstacles?: KeptObstacle[]; avoidance?: Avoidance | null;
  camera?: number[]; orthographic?: boolean;
};

export function snapshot(scene: Scene, state: State, overlays: Iterable<OverlayName>, camera: number[], orthographic: boolean): Snapshot {
  return {
    model: scene.name,
    frame: scene.frame,
    task: scene.task.name,
    method: scene.method,
    ...(scene.actuators.length > 0 ? { actuated: scene.actuators.filter((d) => d.actuated).map((d) => d.name) } : {}),
    q: state.q,
    target: state.target,
    playing: state.playing,
    overlays: [...overlays],
    obstacles: scene.obstacles.flatMap((obstacle, i) => {
      const pose = state.obstacles[i];
      if (obstacle.kind === "mesh" || !pose) return [];
      const { name, ...shape } = obstacle;
      return [{ name, shape, ...pose }];
    }),
    avoidance: scene.avoidance,
    camera, orthographic,
  };
}

const list = (values: number[]): string => values.map((value) => Number(value.toPrecision(9))).join(",");

export function fragment(shot: Snapshot): string {
  const fields = new URLSearchParams({ model: shot.model, q: list(shot.q) });
  if (shot.frame) fields.set("frame", shot.frame);
  if (shot.task) fields.set("task", shot.task);
  if (shot.method) fields.set("inverse", JSON.stringify(shot.method));
  if (shot.actuated) fields.set("actuated", JSON.stringify(shot.actuated));
  if (shot.target) fields.set("target", list([...shot.target.position, ...shot.target.quaternion]));
  if (shot.playing === false) fields.set("paused", "1");
  if (shot.overlays?.length) fields.set("show", shot.overlays.join(","));
  if (shot.obstacles?.length) fields.set("obstacles", JSON.stringify(shot.obstacles));
  if (shot.avoidance) fields.set("avoid", list([shot.avoidance.gap, shot.avoidance.margin]));
  if (shot.camera) fields.set("camera", list(shot.camera));
  if (shot.orthographic !== undefined) fields.set("projection", shot.orthographic ? "orthographic" : "perspective");
  return `#${fields.toString()}`;
}

/** What a fragment says; null where it says nothing, a sentence where it is broken. */
export function parse(hash: string): Snapshot | string | null {
  if (hash.length < 2) return null;
  const fields = new URLSearchParams(hash.slice(1));
  const model = fields.get("model");
  const q = numbers(fields.get("q"));
  if (!model || !q) return "The address does not contain a valid configuration; the robot starts at its default.";
  const target = numbers(fields.get("target"), 7);
  const camera = numbers(fields.get("camera"), 6);
  const actuated = names(fields.get("actuated"));
  const inverse = method(fields.get("inverse"));
  const bodies = obstacles(fields.get("obstacles"));
  const avoided = numbers(fields.get("avoid"), 2);
  return {
    model, q,
    ...(fields.has("frame") ? { frame: fields.get("frame") ?? "" } : {}),
    ...(fields.has("task") ? { task: fields.get("task") ?? "" } : {}),
    ...(actuated ? { actuated } : {}),
    ...(inverse ? { method: inverse } : {}),
    ...(target ? { target: { position: target.slice(0, 3), quaternion: target.slice(3) } as Pose } : {}),
    playing: fields.get("paused") !== "1",
    overlays: (fields.get("show") ?? "").split(",").filter(Boolean) as OverlayName[],
    ...(bodies ? { obstacles: bodies } : {}),
    ...(avoided ? { avoidance: { gap: avoided[0] ?? 0, margin: avoided[1] ?? 0 } } : {}),
    ...(camera ? { camera } : {}),
    ...(fields.has("projection") ? { orthographic: fields.get("projection") === "orthographic" } : {}),
  };
}

function numbers(text: string | null, length?: number): number[] | null {
  if (text === null) return null;
  const values = text === "" ? [] : text.split(",").map(Number);
  return values.every(Number.isFinite) && (length === undefined || values.length === length) ? values : null;
}

function json(text: string | null): unknown {
  try {
    return text === null ? null : JSON.parse(text);
  } catch {
    return null;
  }
}

function names(text: string | null): string[] | null {
  const value = json(text);
  return Array.isArray(value) && value.every((name) => typeof name === "string") ? value : null;
}

/** The server checks shapes and poses. */
function obstacles(text: string | null): KeptObstacle[] | null {
  const value = json(text);
  const isOne = (one: Partial<KeptObstacle> | null): boolean => typeof one?.name === "string" && typeof one.shape === "object";
  return Array.isArray(value) && value.every(isOne) ? value as KeptObstacle[] : null;
}

function method(text: string | null): ChosenMethod | null {
  const value = json(text) as Partial<ChosenMethod> | null;
  if (typeof value?.name !== "string") return null;
  return { name: value.name, parameters: value.parameters ?? {}, h: value.h ?? null, fallback: value.fallback ?? null };
}
