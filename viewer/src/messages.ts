/* Made of the structs of the server by a test of crates/cylindroid-cli: see CONTRIBUTING.md. */

/** The message `session`. */
export type About = {
  "type": "session",
  name: string | null,
  begun: number,
  clients: number,
  driver: Driver,
  program: boolean,
};
export type ActiveLimit = { coordinate: number, kind: string };
export type Actuator = { name: string, kind: JointKind, actuated: boolean };
export type AddObstacleMessage = {
  name: string,
  shape: SimpleShape,
  position: [number, number, number],
  /** w, x, y, z. */
  quaternion: [number, number, number, number],
};
/** A point of a link, in its frame. */
export type Anchor = { name: string, kind: AnchorKind, position: [number, number, number] };
export type AnchorKind = "joint" | "child" | "loop" | "contact" | "frame";
export type AvoidCollisionsMessage = { on: boolean, gap: number | null, margin: number | null };
export type Avoidance = { gap: number, margin: number };
export type AxisScrew = { name: string, screw: Screw, actuated: boolean, coordinate: number | null };
export type BesideMessage = { models: Array<ModelBeside> };
/** The inverse that the client chose, with the values of its parameters. */
export type ChosenMethod = { name: string, parameters: { [key in string]: number }, h: number | null, fallback: string | null };
export type ClosureError = { distance: number, angle: number, closed: boolean };
export type CollisionShape = { pose: Pose } & (
  { "kind": "box", size: [number, number, number] }
  | { "kind": "cylinder", radius: number, length: number }
  | { "kind": "capsule", radius: number, length: number }
  | { "kind": "sphere", radius: number }
  | { "kind": "ellipsoid", radii: [number, number, number] }
  | { "kind": "half_space" }
  | { "kind": "mesh", url: string | null, format: "stl" | "dae" | "obj" | null, scale: [number, number, number], uri: string, problem: string | null });
export type CompareMessage = {
  methods: [string, string],
  point: [number, number, number],
  h: number | null,
  twist: [number, number, number, number, number, number] | null,
};
export type ComparedMethod = {
  method: string,
  h: number | null,
  exists: boolean,
  reason: string | null,
  joint_velocities: Array<number> | null,
  joint_velocities_at_point: Array<number> | null,
  difference: number | null,
  invariant: boolean,
  achieved: [number, number, number, number, number, number] | null,
  achieved_at_point: [number, number, number, number, number, number] | null,
};
export type Comparison = {
  "type": "compare",
  reply_to: string | number | null,
  twist: [number, number, number, number, number, number],
  tool_point: [number, number, number],
  point: [number, number, number],
  names: Array<string>,
  results: Array<ComparedMethod>,
};
export type ConfigurationMessage = { q: Array<number> };
export type ContactPoints = {
  point: [number, number, number],
  normal: [number, number, number],
  other: [number, number, number],
};
export type Coordinate = {
  name: string,
  joint: number,
  unit: "rad" | "m",
  lower: number | null,
  upper: number | null,
  velocity: number | null,
  actuated: boolean,
  adjustable: boolean,
};
export type Cylindroid = { of: "system" | "reciprocal", pitches: [number | null, number | null], rulings: Array<Ruling> };
/** The distances in a state. */
export type Distances = { margin: number, shapes: number, pairs: number, near: Array<Near>, more: number };
export type DistancesMessage = {
  /** Without it no distances are computed. */
  margin: number | null,
};
export type Drawing = { name: string, rgba: [number, number, number, number] | null } & (
  { "kind": "frame", pose: Pose, size: number | null }
  | { "kind": "line", points: Array<[number, number, number]> }
  | { "kind": "points", points: Array<[number, number, number]> });
export type Drawings = { "type": "drawings", drawings: Array<Drawing> };
export type DriveMessage = { on: boolean };
/** Who drives, to one client. */
export type Driver = "you" | "another" | "nobody";
export type Ellipsoid = {
  center: [number, number, number],
  axes: Array<SemiAxis>,
  /** Of all semi-axes alike [m of drawing per unit]. */
  scale: number,
  infinite: Array<[number, number, number]>,
  unit: string,
};
export type Empty = { empty: string };
/** An error in a message. */
export type Failure = {
  "type": "error",
  reply_to: string | number | null,
  culprit: string,
  /** Message and field. */
  place: string,
  message: string,
  way_out: string,
  /** The value reached by a joint. */
  nearest: number | null,
};
export type JointAxes = { axes: Array<AxisScrew> };
export type JointKind = "revolute" | "continuous" | "prismatic" | "helical" | "cylindrical" | "universal" | "spherical" | "planar" | "free" | "fixed";
export type JointMessage = { name: string, value: number };
export type LoopEnds = { a: [number, number, number], b: [number, number, number] };
export type LostDirection = {
  ratio: number,
  lost: boolean,
  linear: [number, number, number],
  angular: [number, number, number],
  screw: Screw,
  sentence: string,
};
export type Method = { name: string, description: string, parameters: Array<Parameter>, pitch: boolean, servo: boolean };
export type MethodMessage = { name: string, parameters: { [key in string]: number }, h: number | null, fallback: string | null };
/** The joint followed by a mimic joint, in JSON. */
export type Mimic = { joint: string, multiplier: number, offset: number };
/** A model that is shown beside that of a session. */
export type ModelBeside = {
  /** An opened model; null: that of the command. */
  model: string | null,
  /** The session of its joints. */
  session: string,
  position: [number, number, number],
  /** w, x, y, z. */
  quaternion: [number, number, number, number],
  transparent: boolean,
};
/** The message `model`. */
export type ModelNews = {
  "type": "model",
  /** How often the model has been loaded again. */
  reloads: number,
  /** Why the newest version is not shown. */
  problem: Refusal | null,
};
export type Models = { name: string, catalogue: Array<OfferedModel>, opened: Array<OpenedModel>, opens: boolean };
export type MoveObstacleMessage = { name: string, position: [number, number, number], quaternion: [number, number, number, number] };
export type NameMessage = { name: string };
export type NamesMessage = { names: Array<string> };
export type Near = {
  a: string,
  b: string,
  distance: number,
  point_a: [number, number, number],
  point_b: [number, number, number],
};
export type NullSpaceMessage = { rate: number, index: number };
export type Obstacle = { name: string } & (
  { "kind": "box", size: [number, number, number] }
  | { "kind": "cylinder", radius: number, length: number }
  | { "kind": "capsule", radius: number, length: number }
  | { "kind": "sphere", radius: number }
  | { "kind": "ellipsoid", radii: [number, number, number] }
  | { "kind": "half_space" }
  | { "kind": "mesh", url: string | null, format: "stl" | "dae" | "obj" | null, scale: [number, number, number], uri: string, problem: string | null });
/** A model of the catalogue. */
export type OfferedModel = { name: string, description: string };
/** A model that is open. */
export type OpenedModel = { id: string, name: string };
export type OverlayData = {
  "velocity-ellipsoid": Ellipsoid | Empty,
  "angular-velocity-ellipsoid": Ellipsoid | Empty,
  "active-force-ellipsoid": Ellipsoid | Empty,
  "passive-force-ellipsoid": Ellipsoid | Empty,
  "joint-axes": JointAxes | Empty,
  "principal-screws": PrincipalScrews | Empty,
  "reciprocal-system": Reciprocal | Empty,
  "cylindroid": Cylindroid | Empty,
  "lost-direction": LostDirection | Empty,
};
export type OverlayInfo = { name: OverlayName, title: string, unit: string, frame: string };
export type OverlayName = "velocity-ellipsoid" | "angular-velocity-ellipsoid" | "active-force-ellipsoid" | "passive-force-ellipsoid" | "joint-axes" | "principal-screws" | "reciprocal-system" | "cylindroid" | "lost-direction";
export type Parameter = { name: string, unit: string, default: number, description: string };
/** A pose: `world_from_...`, unless it is said to be in a link. */
export type Pose = {
  position: [number, number, number],
  /** w, x, y, z. */
  quaternion: [number, number, number, number],
};
export type PoseError = { position: number, orientation: number };
export type Posture = {
  q: Array<number>,
  links: Array<Pose>,
  tool: Pose,
  singular: Singular | null,
  outside_limits: Array<number>,
  loops: Array<LoopEnds>,
  contacts: Array<ContactPoints>,
  closure_error: ClosureError | null,
  overlays: Partial<OverlayData>,
  obstacles: Array<Pose>,
  distances: Distances | null,
};
export type Postures = { "type": "states", reply_to: string | number | null, states: Posture[] };
export type PrincipalScrews = {
  order: number,
  gibson_hunt: string,
  meaning: string,
  ambiguous: boolean,
  principal_pitches: (number | null)[],
  screws: Array<Screw>,
  canonical: Pose,
};
export type Reciprocal = { order: number, gibson_hunt: string, meaning: string, screws: Array<Screw> };
/** Why a model is not shown. */
export type Refusal = {
  message: string,
  file: string | null,
  /** From 1. */
  line: number | null,
  /** In characters, from 1. */
  column: number | null,
  /** The line itself. */
  text: string | null,
  help: string,
};
export type Report = {
  "type": "report",
  reply_to: string | number | null,
  name: ReportName,
  report: Record<string, unknown>,
};
export type ReportName = "info" | "mobility" | "manipulability" | "screws";
export type Ruling = { from: [number, number, number], to: [number, number, number], pitch: number | null };
export type Scene = {
  "type": "scene",
  name: string,
  format: string,
  closed: boolean,
  dimension: 2 | 3,
  reach: number,
  links: Array<SceneLink>,
  joints: Array<SceneJoint>,
  coordinates: Array<Coordinate>,
  frames: Array<SceneFrame>,
  frame: string,
  task: SceneTask,
  loops: Array<SceneLoop>,
  contacts: Array<SceneContact>,
  objects: Array<SceneObject>,
  actuators: Array<Actuator>,
  self_motions: number,
  method: ChosenMethod,
  methods: Array<Method>,
  overlays: Array<OverlayInfo>,
  reports: ReportName[],
  home: Array<number>,
  obstacles: Array<Obstacle>,
  avoidance: Avoidance | null,
  beside: Array<ModelBeside>,
  ignored: number,
};
export type SceneContact = { name: string, kind: string, a: number, b: number, friction: number | null };
export type SceneFrame = {
  name: string,
  link: number,
  /** In the frame of the link. */
  pose: Pose,
};
export type SceneJoint = {
  name: string,
  kind: JointKind,
  parent: number,
  child: number,
  origin: Pose,
  axis: [number, number, number],
  coordinates: Array<number>,
  actuated: boolean,
  mimic: Mimic | null,
};
export type SceneLink = { name: string, visuals: Array<Visual>, collisions: Array<CollisionShape>, anchors: Array<Anchor> };
export type SceneLoop = {
  name: string,
  kind: JointKind,
  a: number,
  b: number,
  axis: [number, number, number],
  actuated: boolean,
};
export type SceneObject = { link: number, name: string, reference: boolean };
export type SceneTask = { name: string, components: Array<string> };
/** A screw in the world frame. */
export type Screw = {
  /** Point of the axis closest to the origin; null for a translation. */
  point: [number, number, number] | null,
  direction: [number, number, number],
  /** [m/rad]; null for a translation. */
  pitch: number | null,
  /** [rad/s]; for a translation [m/s]. */
  amplitude: number,
};
export type SeenMessage = { seq: number };
export type SemiAxis = { vector: [number, number, number], size: number };
export type Servo = {
  status: ServoStatus,
  reason: string | null,
  sentence: string,
  limits: Array<ActiveLimit>,
  pair: [string, string] | null,
  self_motion: number,
  joint_velocities: Array<number> | null,
  /** Linear, angular; world axes, at the tool. */
  twist: [number, number, number, number, number, number] | null,
};
export type ServoStatus = "moving" | "reached" | "stalled" | "paused" | "unavailable";
export type Shape =
  | { "kind": "box", size: [number, number, number] }
  | { "kind": "cylinder", radius: number, length: number }
  | { "kind": "capsule", radius: number, length: number }
  | { "kind": "sphere", radius: number }
  | { "kind": "ellipsoid", radii: [number, number, number] }
  | { "kind": "half_space" }
  | { "kind": "mesh", url: string | null, format: "stl" | "dae" | "obj" | null, scale: [number, number, number], uri: string, problem: string | null };
/** The shapes of obstacles. Meshes are files, which a client cannot name. */
export type SimpleShape =
  | { "kind": "sphere", radius: number }
  | { "kind": "box", size: [number, number, number] }
  | { "kind": "cylinder", radius: number, length: number }
  | { "kind": "capsule", radius: number, length: number }
  | { "kind": "ellipsoid", radii: [number, number, number] }
  | { "kind": "half_space" };
export type Singular = {
  values: Array<number>,
  threshold: number,
  rank: number,
  gap: number | null,
  ratio: number,
  length: number,
};
export type State = {
  "type": "state",
  seq: number,
  time: number,
  /** Since the session began (s). */
  clock: number,
  ack: string | number | null,
  playing: boolean,
  target: Pose,
  error: PoseError,
  servo: Servo,
  q: Array<number>,
  links: Array<Pose>,
  tool: Pose,
  singular: Singular | null,
  outside_limits: Array<number>,
  loops: Array<LoopEnds>,
  contacts: Array<ContactPoints>,
  closure_error: ClosureError | null,
  overlays: Partial<OverlayData>,
  obstacles: Array<Pose>,
  distances: Distances | null,
};
export type StatesMessage = {
  q: Array<Array<number>>,
  /** With overlays and distances. */
  full: boolean,
};
export type TargetMessage = {
  position: [number, number, number],
  /** w, x, y, z. */
  quaternion: [number, number, number, number],
};
/** A message with the id that is returned to its sender. */
export type ToServer = { id?: string | number } & (
  { "type": "joint" } & JointMessage
  | { "type": "configuration" } & ConfigurationMessage
  | { "type": "target" } & TargetMessage
  | { "type": "twist" } & TwistMessage
  | { "type": "frame" } & NameMessage
  | { "type": "task" } & NameMessage
  | { "type": "play" }
  | { "type": "pause" }
  | { "type": "reset" }
  | { "type": "null_space" } & NullSpaceMessage
  | { "type": "actuated" } & NamesMessage
  | { "type": "method" } & MethodMessage
  | { "type": "overlays" } & NamesMessage
  | { "type": "compare" } & CompareMessage
  | { "type": "report" } & NameMessage
  | { "type": "states" } & StatesMessage
  | { "type": "distances" } & DistancesMessage
  | { "type": "add_obstacle" } & AddObstacleMessage
  | { "type": "move_obstacle" } & MoveObstacleMessage
  | { "type": "remove_obstacle" } & NameMessage
  | { "type": "avoid_collisions" } & AvoidCollisionsMessage
  | { "type": "beside" } & BesideMessage
  | { "type": "drive" } & DriveMessage
  | { "type": "seen" } & SeenMessage);
/** World axes, at the tool. */
export type TwistMessage = { linear: [number, number, number], angular: [number, number, number] };
export type Visual = { pose: Pose, rgba: [number, number, number, number] | null } & (
  { "kind": "box", size: [number, number, number] }
  | { "kind": "cylinder", radius: number, length: number }
  | { "kind": "capsule", radius: number, length: number }
  | { "kind": "sphere", radius: number }
  | { "kind": "ellipsoid", radii: [number, number, number] }
  | { "kind": "half_space" }
  | { "kind": "mesh", url: string | null, format: "stl" | "dae" | "obj" | null, scale: [number, number, number], uri: string, problem: string | null });
