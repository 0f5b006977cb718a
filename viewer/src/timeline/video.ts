/** A recording as a video, which the browser encodes while it is played. */

/** The first that a browser writes is taken. */
const TYPES = ["video/webm;codecs=vp9", "video/webm;codecs=vp8", "video/webm", "video/mp4"];
/** Of a pixel in a second: sharp edges on a plain background (bits). */
const BITS = 6;

/** Paints what is seen. */
export type Paint = (canvas: HTMLCanvasElement) => void;
/** Times from the first state to the last, pictures of a second, size of a picture (pixels). */
type Film = { end: number; rate: number; width: number; height: number };

/** The type of file that this browser writes, null where it writes none. */
export function videoType(): string | null {
  if (typeof MediaRecorder === "undefined" || !("captureStream" in HTMLCanvasElement.prototype)) return null;
  return TYPES.find((type) => MediaRecorder.isTypeSupported(type)) ?? null;
}

export function endingOf(type: string): string {
  return type.startsWith("video/webm") ? "webm" : "mp4";
}

/** Takes as long as the recording; `show` shows a time, and false ends it without a video. */
export async function filmed(type: string, { end, rate, width, height }: Film, show: (time: number) => Promise<boolean>, paint: Paint): Promise<Blob | null> {
  // Encoders want even numbers.
  const canvas = Object.assign(document.createElement("canvas"), { width: width - (width % 2), height: height - (height % 2) });
  // Streams begin with a picture.
  if (!(await show(0))) return null;
  paint(canvas);
  const stream = canvas.captureStream(0);
  const [track] = stream.getVideoTracks() as CanvasCaptureMediaStreamTrack[];
  const recorder = new MediaRecorder(stream, { mimeType: type, videoBitsPerSecond: BITS * width * height });
  const parts: Blob[] = [];
  recorder.ondataavailable = ({ data }) => parts.push(data);
  let failed = false;
  const over = new Promise<void>((resolve) => {
    recorder.onstop = () => resolve();
    recorder.onerror = () => (failed = true);
  });
  recorder.start();
  let isWhole = false;
  try {
    const begin = performance.now();
    for (let i = 0; !isWhole; i += 1) {
      const time = Math.min((performance.now() - begin) / 1000, end);
      if (failed || !(await show(time))) break;
      paint(canvas);
      track?.requestFrame();
      isWhole = time === end;
      // The last picture is seen as long as the others.
      const next = isWhole ? performance.now() + 1000 / rate : begin + (1000 * (i + 1)) / rate;
      await new Promise((resolve) => setTimeout(resolve, Math.max(next - performance.now(), 0)));
    }
  } finally {
    // An error stops it.
    if (recorder.state !== "inactive") recorder.stop();
    track?.stop();
  }
  await over;
  if (failed) throw new Error("the browser could not encode the video");
  return isWhole ? new Blob(parts, { type }) : null;
}
