/** Files of a model, chosen or dropped, alone or in a zip: what of them goes to the server, and which may be the model. */
import { unzipSync, type Unzipped } from "three/addons/libs/fflate.module.js";

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
export async function modelFiles(given: File[]): Promise<ModelFiles> {
  const files = new Map<string, Uint8Array>();
  for (const file of given) {
    if (file.size > LARGEST) throw new Error(`${file.name} is larger than ${LARGEST >> 20} MiB.`);
    const bytes = new Uint8Array(await file.arrayBuffer());
    if (extension(file.name) === "zip") {
      for (const [path, content] of Object.entries(unpacked(file.name, bytes))) files.set(path, content);
    } else if (isKept(file.name)) {
      files.set(file.name, bytes);
    } else if (extension(file.name) === "xacro") {
      throw new Error(`${file.name} is a program that writes a URDF: expand it first (xacro ${file.name} > robot.urdf).`);
    }
  }
  let size = 0;
  for (const { length } of files.values()) size += length;
  if (files.size > MOST || size > LARGEST) throw new Error(`There are ${files.size} files of ${Math.ceil(size / (1 << 20))} MiB; ${MOST} of ${LARGEST >> 20} MiB are taken.`);
  const candidates = [...files].filter(([path, bytes]) => isModel(path, bytes)).map(([path]) => path).sort();
  if (candidates.length === 0) {
    throw new Error(`${given.map(({ name }) => name).join(", ")}: no URDF, MJCF, SDF or mechanism file (.toml), and no motion or map (.csv, .json, .parquet).`);
  }
  return { candidates, files };
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
