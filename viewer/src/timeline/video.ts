/** A recording as a video, encoded picture by picture: none is dropped, however slow the machine. */

/** What a browser encodes, and its name in a WebM file; the first that it does is taken. */
const CODECS = [
  { codec: "vp09.00.51.08", track: "V_VP9" },
  { codec: "vp8", track: "V_VP8" },
];
/** Of a pixel in a second: sharp edges on a plain background (bits). */
const BITS = 6;
/** Pictures that wait for the encoder: each takes the memory of a window. */
const WAITING = 4;
/** Microseconds in a second. */
const MICRO = 1e6;

/** Paints what is seen. */
export type Paint = (canvas: HTMLCanvasElement) => void;
/** Times from the first state to the last (s), pictures of a second, size of a picture (pixels). */
type Film = { times: number[]; rate: number; width: number; height: number };

/** Only pages of localhost and of HTTPS have encoders. */
export function hasVideo(): boolean {
  return "VideoEncoder" in window;
}

/** `show` shows a time, and false ends it without a video. */
export async function filmed({ times, rate, ...whole }: Film, show: (time: number) => Promise<boolean>, paint: Paint): Promise<Blob | null> {
  // Encoders want even numbers.
  const [width, height] = [whole.width - (whole.width % 2), whole.height - (whole.height % 2)];
  const format = { width, height, framerate: rate, bitrate: BITS * width * height };
  const { codec, track } = await supported(format);
  const { ArrayBufferTarget, Muxer } = await import("webm-muxer");
  const muxer = new Muxer({ target: new ArrayBufferTarget(), video: { codec: track, width, height, frameRate: rate } });
  let failure: DOMException | null = null;
  const encoder = new VideoEncoder({
    output: (chunk, metadata) => muxer.addVideoChunk(chunk, metadata),
    error: (error) => (failure = error),
  });
  encoder.configure({ codec, ...format });
  const canvas = Object.assign(document.createElement("canvas"), { width, height });
  try {
    for (const [i, time] of times.entries()) {
      if (!(await show(time))) return null;
      paint(canvas);
      const frame = new VideoFrame(canvas, { timestamp: MICRO * time, duration: MICRO / rate });
      // A key in each second: players jump to it.
      encoder.encode(frame, { keyFrame: i % Math.ceil(rate) === 0 });
      frame.close();
      while (encoder.encodeQueueSize > WAITING) await new Promise((resolve) => encoder.addEventListener("dequeue", resolve, { once: true }));
    }
    await encoder.flush();
  } catch (error) {
    throw failure ?? error;
  } finally {
    if (encoder.state !== "closed") encoder.close();
  }
  muxer.finalize();
  return new Blob([muxer.target.buffer], { type: "video/webm" });
}

async function supported(format: Omit<VideoEncoderConfig, "codec">): Promise<(typeof CODECS)[number]> {
  for (const one of CODECS) {
    if ((await VideoEncoder.isConfigSupported({ codec: one.codec, ...format })).supported) return one;
  }
  throw new Error(`the browser encodes no video of ${format.width} x ${format.height} pixels`);
}
