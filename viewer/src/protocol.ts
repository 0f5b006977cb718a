/** The messages of docs/viewer.md, field by field. Units SI and radians; null stands for infinite or none. */

export type Vec3 = [number, number, number];
/** w, x, y, z */
export type Quaternion = [number, number, number, number];
export type Pose = { position: Vec3; quaternion: Quaternion };
export type Colour = [number, number, number, number] | null;
export type Screw = { point: Vec3 | null; direction: Vec3; pitch: number | null; amplitude: number };

// From the server ---------------------------------------------------------------------------------

export type SimpleShape =
  | { kind: "box"; size: Vec3 }
  | { kind: "cylinder" | "capsule"; radius: number; length: number }
  | { kind: "sphere"; radius: number }
  | { kind: "ellipsoid"; radii: Vec3 }
  | { kind: "half_space" };
export type MeshShape = {
  kind: "mesh"; url: string | null; format: "stl" | "dae" | "obj"; scale: Vec3; uri: string; problem: string | null;
};
export type Visual = { pose: Pose; rgba: Colour } & (SimpleShape | MeshShape);
export type Obstacle = { name: string } & (SimpleShape | MeshShape);
/** Least distance, and the distance below which pairs count (m). */
export type Avoidance = { gap: number; margin: number };
export type Anchor = { name: string; kind: "joint" | "child" | "loop" | "contact" | "frame"; position: Vec3 };
export type CollisionShape = { pose: Pose } & (SimpleShape | MeshShape);
export type SceneLink = { name: string; visuals: Visual[]; collisions: CollisionShape[]; anchors: Anchor[] };
export type JointKind =
  | "revolute" | "continuous" | "prismatic" | "helical" | "cylindrical" | "universal" | "spherical"
  | "planar" | "free" | "fixed";
export type SceneJoint = {
  name: string; kind: JointKind; parent: number; child: number; origin: Pose; axis: Vec3;
  coordinates: number[]; actuated: boolean;
  mimic: { joint: string; multiplier: number; offset: number } | null;
};
export type Coordinate = {
  name: string; joint: number; unit: "rad" | "m"; lower: number | null; upper: number | null;
  velocity: number | null; actuated: boolean; adjustable: boolean;
};
export type Parameter = { name: string; unit: string; default: number; description: string };
export type Method = { name: string; description: string; parameters: Parameter[]; pitch: boolean; servo: boolean };
export type ChosenMethod = {
  name: string; parameters: Record<string, number>; h: number | null; fallback: string | null;
};
export type OverlayInfo = { name: OverlayName; title: string; unit: string; frame: string };
export type Actuator = { name: string; kind: JointKind; actuated: boolean };

export type Scene = {
  type: "scene";
  name: string; format: string; closed: boolean; dimension: 2 | 3; reach: number;
  links: SceneLink[]; joints: SceneJoint[]; coordinates: Coordinate[];
  frames: { name: string; link: number }[]; frame: string;
  task: { name: string; components: string[] };
  loops: { name: string; kind: JointKind; a: number; b: number; axis: Vec3; actuated: boolean }[];
  contacts: { name: string; kind: string; a: number; b: number; friction: number | null }[];
  objects: { link: number; name: string; reference: boolean }[];
  actuators: Actuator[];
  self_motions: number; method: ChosenMethod; methods: Method[];
  overlays: OverlayInfo[]; reports: ReportName[];
  home: number[]; obstacles: Obstacle[]; avoidance: Avoidance | null; ignored: number;
};

export type ServoStatus = "moving" | "reached" | "stalled" | "paused" | "unavailable";
export type Singular = {
  values: number[]; threshold: number; rank: number; gap: number | null; ratio: number; length: number;
};
export type Near = { a: string; b: string; distance: number; point_a: Vec3; point_b: Vec3 };
export type Distances = { margin: number; shapes: number; pairs: number; near: Near[]; more: number };
/** What a configuration determines. */
export type Posture = {
  q: number[]; links: Pose[]; tool: Pose;
  singular: Singular | null;
  outside_limits: number[];
  loops: { a: Vec3; b: Vec3 }[];
  contacts: { point: Vec3; normal: Vec3; other: Vec3 }[];
  closure_error: { distance: number; angle: number; closed: boolean } | null;
  overlays: Partial<OverlayData>;
  /** Poses in the order of the scene. */
  obstacles: Pose[];
  distances: Distances | null;
};
export type ActiveLimit = { coordinate: number; kind: string };
export type State = Posture & {
  type: "state";
  seq: number; time: number; ack: string | number | null; playing: boolean;
  target: Pose;
  /** null only in motions of files. */
  error: { position: number | null; orientation: number | null };
  servo: {
    status: ServoStatus; reason: string | null; sentence: string;
    limits: ActiveLimit[]; pair: [string, string] | null; self_motion: number;
    joint_velocities: number[] | null;
    /** Linear, angular; world axes, at the tool. */
    twist: number[] | null;
  };
};

// Overlays ----------------------------------------------------------------------------------------

export type Ellipsoid = {
  center: Vec3; axes: { vector: Vec3; size: number }[]; scale: number;
  infinite: Vec3[]; unit: string;
};
export type JointAxes = {
  axes: { name: string; screw: Screw; actuated: boolean; coordinate: number | null }[];
};
export type SystemClass = { order: number; gibson_hunt: string; meaning: string };
export type PrincipalScrews = SystemClass & {
  ambiguous: boolean; principal_pitches: (number | null)[]; screws: Screw[]; canonical: Pose;
};
export type Reciprocal = SystemClass & { screws: Screw[] };
export type Cylindroid = {
  of: "system" | "reciprocal"; pitches: (number | null)[];
  rulings: { from: Vec3; to: Vec3; pitch: number | null }[];
};
export type LostDirection = {
  ratio: number; lost: boolean; linear: Vec3; angular: Vec3; screw: Screw | null; sentence: string;
};
export type Empty = { empty: string };
export type OverlayData = {
  "velocity-ellipsoid": Ellipsoid | Empty;
  "angular-velocity-ellipsoid": Ellipsoid | Empty;
  "active-force-ellipsoid": Ellipsoid | Empty;
  "passive-force-ellipsoid": Ellipsoid | Empty;
  "joint-axes": JointAxes | Empty;
  "principal-screws": PrincipalScrews | Empty;
  "reciprocal-system": Reciprocal | Empty;
  cylindroid: Cylindroid | Empty;
  "lost-direction": LostDirection | Empty;
};
export type OverlayName = keyof OverlayData;

export function isEmpty(data: object): data is Empty {
  return "empty" in data;
}

// Answers -----------------------------------------------------------------------------------------

export type Comparison = {
  type: "compare"; reply_to: string | number | null;
  twist: number[]; tool_point: Vec3; point: Vec3; names: string[];
  results: {
    method: string; h: number | null; exists: boolean; reason: string | null;
    joint_velocities: number[] | null; joint_velocities_at_point: number[] | null;
    difference: number | null; invariant: boolean;
    achieved: number[] | null; achieved_at_point: number[] | null;
  }[];
};
export type ReportName = "info" | "mobility" | "manipulability" | "screws";
/** What the command line prints (docs/json.md); panels read the fields they show. */
export type Report = {
  type: "report"; reply_to: string | number | null; name: ReportName; report: Record<string, unknown>;
};
export type Failure = {
  type: "error"; reply_to: string | number | null;
  culprit: string; place: string; message: string; way_out: string | null; nearest: number | null;
};
/** In the order of the configurations that were asked for. */
export type Postures = { type: "states"; reply_to: string | number | null; states: Posture[] };
/** Of a session that several clients may share; others have none. */
export type About = {
  type: "session"; name: string | null; clients: number; driver: "you" | "another" | "nobody"; program: boolean;
};
export type Drawing = { name: string; rgba: Colour } & (
  | { kind: "frame"; pose: Pose; size: number | null }
  | { kind: "line" | "points"; points: Vec3[] }
);
/** All that a program draws beside the robot, in place of what it drew before. */
export type Drawings = { type: "drawings"; drawings: Drawing[] };
export type FromServer = Scene | State | Comparison | Report | Postures | Failure | About | Drawings;

// To the server -----------------------------------------------------------------------------------

export type ToServer = { id?: string | number } & (
  | { type: "joint"; name: string; value: number }
  | { type: "configuration"; q: number[] }
  | ({ type: "target" } & Pose)
  | { type: "twist"; linear: Vec3; angular: Vec3 }
  | { type: "frame"; name: string }
  | { type: "task"; name: string }
  | { type: "play" | "pause" | "reset" }
  | { type: "null_space"; rate: number; index: number }
  | { type: "actuated"; names: string[] }
  | { type: "method"; name: string; parameters: Record<string, number>; h: number | null; fallback: string | null }
  | { type: "overlays"; names: OverlayName[] }
  | { type: "compare"; methods: string[]; point: Vec3; h: number | null; twist: number[] | null }
  | { type: "report"; name: ReportName }
  /** `full`: with overlays and distances. */
  | { type: "states"; q: number[][]; full: boolean }
  | { type: "distances"; margin: number | null }
  | ({ type: "add_obstacle"; name: string; shape: SimpleShape } & Pose)
  | ({ type: "move_obstacle"; name: string } & Pose)
  | { type: "remove_obstacle"; name: string }
  | { type: "avoid_collisions"; on: boolean; gap: number | null; margin: number | null }
  /** Takes over, or lets another drive. */
  | { type: "drive"; on: boolean }
  /** This state has been drawn: the server holds back what a slow browser would only queue. */
  | { type: "seen"; seq: number }
);
