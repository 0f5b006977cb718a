/** A recording with all that is needed to show it, as text: one line of JSON, then one for each state. */
import type { OverlayName, Scene } from "../protocol";

/** From where one looks, and what is drawn beside the robot. */
export type Look = { camera: number[]; orthographic: boolean; overlays: OverlayName[] };
/** Times of the states of a model, and its scenes, each from its first state on. */
export type Track = { times: number[]; scenes: { from: number; scene: Scene }[] };
/** With the models beside the first, whose sessions are numbers; their states follow those of the first. */
export type Head = Look & Track & { beside: (Track & { session: string })[] };

/** Elements of the page that hold them. */
export const RECORDING = "recording";
export const BODIES = "bodies";

export async function packed(data: Blob): Promise<string> {
  const small = await new Response(data.stream().pipeThrough(new CompressionStream("gzip"))).blob();
  const url = await new Promise<string>((resolve, reject) => {
    const reader = new FileReader();
    reader.onload = () => resolve(String(reader.result));
    reader.onerror = () => reject(reader.error ?? new Error("it cannot be read"));
    reader.readAsDataURL(small);
  });
  return url.slice(url.indexOf(",") + 1);
}

export function unpacked(text: string): Response {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip")));
}
