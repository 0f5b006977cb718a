/** Files of a model, chosen or dropped, alone or in a zip: what of them goes to the server, and which may be the model. */
import { unzipSync, type Unzipped } from "three/addons/libs/fflate.module.js";
import type { Given } from "../files";

export type ModelFiles = {
  /** Paths of files that may be the model. */
  candidates: string[];
  files: Map<string, Uint8Array>;
};

const MODELS = ["urdf", "sdf", "mjcf", "toml", "xml"];
/** Motions, and maps of sweeps. */
const MOTIONS = ["csv", "json", "parquet"];
/** Meshes and what they refer to, as the server hands them out. */
const COMPANIONS = ["stl", "dae", "obj", "mtl", "png", "jpg", "jpeg", "gif", "bmp", "tga", "tif", "tiff", "webp"];
/** All files together (bytes): the server takes no more. */
const LARGEST = 256 << 20;
const MOST = 2000;
/** Of files in which there is no model. */
const MOST_NAMED = 5;
/** Where the root of an XML file is looked for (bytes). */
const HEAD = 16_384;

export const ACCEPTED = [...MODELS, ...MOTIONS, ...COMPANIONS, "zip"].map((extension) => `.${extension}`).join(",");

function extension(name: string): string {
  return /\.([^./]+)$/.exec(name)?.[1]?.toLowerCase() ?? "";
}

export function isMotion(name: string): boolean {
  return MOTIONS.includes(extension(name));
}

/** Throws an error in words where the files cannot be a model. */
export async function modelFiles(given: Given[]): Promise<ModelFiles> {
  const files = new Map<string, Uint8Array>();
  // A zip in a folder is none of its files.
  const isZip = (path: string): boolean => extension(path) === "zip" && !path.includes("/");
  for (const { path, file } of given.filter(({ path: one }) => isZip(one) || isKept(one))) {
    if (file.size > LARGEST) throw new Error(`${path} is larger than ${LARGEST >> 20} MiB.`);
    const bytes = new Uint8Array(await file.arrayBuffer());
    if (isZip(path)) for (const [inside, content] of Object.entries(unpacked(path, bytes))) files.set(inside, content);
    else files.set(path, bytes);
    check(files);
  }
  const candidates = [...files].filter(([path, bytes]) => isModel(path, bytes)).map(([path]) => path).sort();
  if (candidates.length > 0) return { candidates, files };
  const program = given.find(({ path }) => extension(path) === "xacro");
  if (program) throw new Error(`${program.path} is a program that writes a URDF: expand it first (xacro ${program.path} > robot.urdf).`);
  const named = given.slice(0, MOST_NAMED).map(({ path }) => path);
  if (given.length > MOST_NAMED) named.push(`${given.length - MOST_NAMED} more`);
  throw new Error(`${named.join(", ")}: no URDF, MJCF, SDF or mechanism file (.toml), and no motion or map (.csv, .json, .parquet).`);
}

function check(files: Map<string, Uint8Array>): void {
  let size = 0;
  for (const { length } of files.values()) size += length;
  if (files.size > MOST || size > LARGEST) throw new Error(`There are ${files.size} files of ${Math.ceil(size / (1 << 20))} MiB; ${MOST} of ${LARGEST >> 20} MiB are taken.`);
}

function isKept(path: string): boolean {
  return [...MODELS, ...COMPANIONS].includes(extension(path)) && !path.split("/").some((part) => part.startsWith(".") || part === "__MACOSX");
}

function isModel(path: string, bytes: Uint8Array): boolean {
  const kind = extension(path);
  if (kind !== "xml") return MODELS.includes(kind);
  return /<(robot|mujoco|sdf)[\s>]/.test(new TextDecoder().decode(bytes.subarray(0, HEAD)));
}

function unpacked(name: string, bytes: Uint8Array): Unzipped {
  let size = 0;
  const filter = (one: { name: string; originalSize: number }): boolean => {
    if (one.name.endsWith("/") || !isKept(one.name)) return false;
    size += one.originalSize;
    if (size > LARGEST) throw new Error(`it has more than ${LARGEST >> 20} MiB`);
    return true;
  };
  try {
    return unzipSync(bytes, { filter });
  } catch (error) {
    throw new Error(`${name} cannot be unpacked: ${error instanceof Error ? error.message : String(error)}.`);
  }
}

/** The body of a request: what is to be opened, the sizes of the files, the files. */
export function request(open: string, files: Map<string, Uint8Array>): Blob {
  const head = JSON.stringify({ open, files: [...files].map(([path, { length }]) => [path, length]) });
  return new Blob([`${head}\n`, ...([...files.values()] as BlobPart[])]);
}
