/** Pictures of a recording at even times, numbered, in a zip: what programs make videos of. */
import { Zip, ZipPassThrough } from "three/addons/libs/fflate.module.js";

/** Eleven minutes at 30 per second; the format ends at 65 535 files and 4 GiB. */
export const MOST_FRAMES = 20_000;

/** The times of the pictures (s); of the last state where it is at one of them. */
export function frameTimes(duration: number, rate: number): number[] {
  return Array.from({ length: Math.floor(duration * rate + 1e-6) + 1 }, (_, i) => i / rate);
}

/** `picture` makes one after the other; null ends it, and there is no zip. */
export async function zipped(name: string, times: number[], picture: (time: number, i: number) => Promise<Blob | null>): Promise<Blob | null> {
  const parts: Uint8Array<ArrayBuffer>[] = [];
  const zip = new Zip((error, data) => {
    if (error) throw error;
    parts.push(new Uint8Array(data));
  });
  const digits = String(times.length).length;
  for (const [i, time] of times.entries()) {
    const blob = await picture(time, i);
    if (!blob) return null;
    // PNG is compressed already.
    const file = new ZipPassThrough(`${name}-${String(i + 1).padStart(digits, "0")}.png`);
    zip.add(file);
    file.push(new Uint8Array(await blob.arrayBuffer()), true);
  }
  zip.end();
  return new Blob(parts, { type: "application/zip" });
}
