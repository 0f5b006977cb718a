/** Motions in files: what `cylindroid move --out` and this page write, and CSV of configurations by the names of joints. */
import type { ActiveLimit, Pose, Scene } from "../protocol";
import { MOST } from "./recording";

/** Of files without times (1/s). */
const RATE = 60;
/** Largest file (bytes). */
const LARGEST = 128 << 20;

export type Sample = {
  /** From the first sample (s). */
  time: number;
  q: number[];
  joint_velocities: number[] | null;
  error: { position: number | null; orientation: number | null };
  target: Pose | null;
  limits: ActiveLimit[];
};
export type Motion = {
  samples: Sample[];
  /** Controlled in the file, where it says so. */
  frame: string | null;
  /** False where rows are `RATE` per second for want of times. */
  hasTimes: boolean;
};

const NO_ERROR = { position: null, orientation: null };

/** Throws an error that names the file and the place. */
export async function readMotion(file: File, scene: Scene): Promise<Motion> {
  if (file.size > LARGEST) throw new Error(`${file.name} has ${Math.ceil(file.size / (1 << 20))} MiB, more than 128; split it, or write fewer samples.`);
  const text = await file.text();
  const motion = file.name.toLowerCase().endsWith(".json") ? fromJson(file.name, text, scene) : fromCsv(file.name, text, scene);
  if (motion.samples.length === 0) throw new Error(`${file.name} has no sample.`);
  return motion;
}

function fromCsv(name: string, text: string, scene: Scene): Motion {
  const lines = text.split(/\r?\n/);
  const at = lines.findIndex((line) => line.trim() !== "" && !line.startsWith("#"));
  const head = cells(lines[at] ?? "");
  const isHead = head.some((cell) => !isNumber(cell));
  const names = scene.coordinates.map((coordinate) => coordinate.name);
  const column = (...known: string[]): number => head.findIndex((cell) => known.includes(cell));
  const places = isHead ? names.map((joint) => column(`q.${joint}`, joint)) : names.map((_, i) => i);
  const missing = names.filter((_, i) => places[i] === -1);
  if (missing.length > 0) throw new Error(`${name}, line ${at + 1}: no column for ${list(missing)}; its columns are ${list(head)}.`);
  const rates = names.map((joint) => column(`velocity.${joint}`));
  const [time, position, orientation] = isHead ? ["time", "position_error", "orientation_error"].map((title) => column(title)) : [-1, -1, -1];
  const limits = isHead ? column("limits") : -1;
  const wanted = [...places, ...rates, time, position, orientation].filter((place): place is number => place !== undefined && place >= 0);
  const samples: Sample[] = [];
  let first = 0;
  for (let i = isHead ? at + 1 : at; i < lines.length; i += 1) {
    const line = lines[i] ?? "";
    if (line.trim() === "" || line.startsWith("#")) continue;
    const row = cells(line);
    if (row.length !== head.length) throw new Error(`${name}, line ${i + 1} has ${row.length} cells, not ${isHead ? head.length : `${names.length} (${list(names)})`}.`);
    for (const place of wanted) {
      const isEmpty = row[place] === "" && !places.includes(place) && place !== time;
      if (!isEmpty && !isNumber(row[place] ?? "")) throw new Error(`${name}, line ${i + 1}: ${quoted(row[place])} ${isHead ? `in column ${head[place]} ` : ""}is not a number.`);
    }
    const number = (place: number | undefined): number | null => (place === undefined || place < 0 || row[place] === "" ? null : Number(row[place]));
    const all = rates.map(number);
    const now = number(time);
    if (samples.length === 0) first = now ?? 0;
    samples.push({
      time: now === null ? samples.length / RATE : now - first,
      q: places.map((place) => Number(row[place])),
      joint_velocities: all.every((rate) => rate !== null) ? all : null,
      error: { position: number(position), orientation: number(orientation) },
      target: null, limits: limitsIn(row[limits] ?? "", names),
    });
    check(samples, () => `${name}, line ${i + 1}`);
  }
  return { samples, frame: null, hasTimes: time !== undefined && time >= 0 };
}

type Fields = Record<string, unknown>;

function fromJson(name: string, text: string, scene: Scene): Motion {
  let read: unknown;
  try {
    read = JSON.parse(text);
  } catch (error) {
    throw new Error(`${name} is not JSON: ${error instanceof Error ? error.message : String(error)}.`);
  }
  const names = scene.coordinates.map((coordinate) => coordinate.name);
  const whole: Fields = Array.isArray(read) ? { samples: read.map((q: unknown) => ({ q })) } : object(read);
  const listed = whole["joint_names"];
  const given = Array.isArray(listed) ? listed.map(String) : names;
  const places = names.map((joint) => given.indexOf(joint));
  const missing = names.filter((_, i) => places[i] === -1);
  if (missing.length > 0) throw new Error(`${name} is a motion of ${String(whole["model"] ?? "another model")} without ${list(missing)}; its joints are ${list(given)}.`);
  const rows = whole["samples"] ?? whole["states"];
  if (!Array.isArray(rows)) throw new Error(`${name} has neither "samples", as cylindroid move --out writes them, nor "states", as this page does.`);
  const times = Array.isArray(whole["times"]) ? whole["times"] : null;
  const samples: Sample[] = [];
  let [first, hasTimes] = [0, true];
  rows.forEach((row: unknown, i) => {
    const place = `${name}, ${whole["states"] ? "state" : "sample"} ${i + 1}`;
    const sample = object(row);
    const numbers = (value: unknown, what: string): number[] => {
      if (!Array.isArray(value) || value.length !== given.length || !value.every((x) => typeof x === "number")) {
        throw new Error(`${place}: ${what} is not a list of ${given.length} numbers.`);
      }
      return places.map((k) => value[k] as number);
    };
    const now = times ? times[i] : sample["time"];
    if (now !== undefined && typeof now !== "number") throw new Error(`${place}: its time is ${quoted(now)}, not a number.`);
    if (now === undefined) hasTimes = false;
    if (i === 0) first = now ?? 0;
    const servo = object(sample["servo"]);
    const rates = sample["joint_velocities"] ?? servo["joint_velocities"] ?? null;
    samples.push({
      time: now === undefined ? i / RATE : now - first,
      q: numbers(sample["q"], "q"),
      joint_velocities: rates === null ? null : numbers(rates, "joint_velocities"),
      error: errorOf(sample),
      target: poseOf(sample["target"]),
      limits: limitsOf(sample["limits"] ?? servo["limits"], places, names),
    });
    check(samples, () => place);
  });
  return { samples, frame: typeof whole["frame"] === "string" ? whole["frame"] : null, hasTimes };
}

function check(samples: Sample[], place: () => string): void {
  if (samples.length > MOST) throw new Error(`${place()} is one more than the ${MOST} samples of a recording; write fewer.`);
  const [last, now] = [samples.at(-2)?.time ?? 0, samples.at(-1)?.time ?? 0];
  if (!(now >= last)) throw new Error(`${place()}: its time is before that of the sample before.`);
}

function errorOf(sample: Fields): Sample["error"] {
  const of = object(sample["error"]);
  const number = (value: unknown): number | null => (typeof value === "number" ? value : null);
  const error = { position: number(of["position"] ?? sample["position_error"]), orientation: number(of["orientation"] ?? sample["orientation_error"]) };
  return error.position === null && error.orientation === null ? NO_ERROR : error;
}

function poseOf(value: unknown): Pose | null {
  const { position, quaternion } = object(value);
  const isList = (list: unknown, length: number): boolean => Array.isArray(list) && list.length === length && list.every(Number.isFinite);
  return isList(position, 3) && isList(quaternion, 4) ? ({ position, quaternion } as Pose) : null;
}

/** By the names of joints in files of `move`, by places in those of this page. */
function limitsOf(value: unknown, places: number[], names: string[]): ActiveLimit[] {
  if (!Array.isArray(value)) return [];
  return value.flatMap((limit) => {
    const { coordinate, joint, kind } = object(limit);
    const own = typeof coordinate === "number" ? places.indexOf(coordinate) : names.indexOf(String(joint));
    return own >= 0 ? [{ coordinate: own, kind: String(kind) }] : [];
  });
}

/** Of a cell: `shoulder velocity; elbow position`. */
function limitsIn(cell: string, names: string[]): ActiveLimit[] {
  return cell.split(";").flatMap((words) => {
    const [, name = "", kind = ""] = /^(.*) (\w+)$/.exec(words.trim()) ?? [];
    const coordinate = names.indexOf(name);
    return coordinate >= 0 ? [{ coordinate, kind }] : [];
  });
}

function object(value: unknown): Fields {
  return typeof value === "object" && value !== null && !Array.isArray(value) ? (value as Fields) : {};
}

/** The cells of a line; quotes may enclose one, and two quotes in it are one. */
function cells(line: string): string[] {
  if (!line.includes('"')) return line.split(",").map((cell) => cell.trim());
  return [...line.matchAll(/(?:^|,)\s*(?:"((?:[^"]|"")*)"|([^,]*))/g)].map(([, inside, plain]) => inside?.replaceAll('""', '"') ?? plain?.trim() ?? "");
}

function isNumber(cell: string): boolean {
  return cell !== "" && Number.isFinite(Number(cell));
}

function quoted(value: unknown): string {
  const words = JSON.stringify(value) ?? "nothing";
  return words.length > 40 ? `${words.slice(0, 40)}…` : words;
}

function list(names: string[]): string {
  const MANY = 8;
  return names.length > MANY ? `${names.slice(0, MANY).join(", ")} and ${names.length - MANY} more` : names.join(", ");
}
