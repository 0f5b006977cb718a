/** The models of a recording on one axis of time: the first, and those beside it, each as it was sent last. */
import type { Recording } from "./recording";

/** `samples`: at each time the number of its sample; -1 where it was not there. */
export type Model = { name: string; recording: Recording; samples: Int32Array };
/** Times at which the server sent one of the models, and the models, the first one first. */
export type Together = { times: Float64Array; models: Model[] };

export function together(first: Recording): Together {
  const tracks: [string | null, Recording][] = [[null, first], ...first.tracks()];
  if (tracks.length === 1) {
    const times = first.columns.time.view();
    return { times, models: [{ name: first.scene.name, recording: first, samples: Int32Array.from(times.keys()) }] };
  }
  const times = merged(tracks.map(([, { columns }]) => columns.time.view()));
  const own = held(times, first.columns.time.view());
  const names = new Set<string>();
  const models = tracks.map(([session, recording]): Model => {
    const samples = session === null ? own : held(times, recording.columns.time.view());
    // It is there while the scene of the first has it.
    const isThere = (row: number): boolean => session === null || first.sceneAt(own[row] ?? 0).beside.some((one) => one.session === session);
    return { name: unique(recording.scene.name, names), recording, samples: samples.map((sample, row) => (isThere(row) ? sample : -1)) };
  });
  return { times, models };
}

/** All times of several rising lists, each once. */
function merged(all: Float64Array[]): Float64Array {
  const sorted = new Float64Array(all.reduce((sum, { length }) => sum + length, 0));
  let end = 0;
  for (const times of all) {
    sorted.set(times, end);
    end += times.length;
  }
  return sorted.sort().filter((time, i) => i === 0 || time !== sorted[i - 1]);
}

/** At each time the number of the last one of its own times; of the first one before all. */
function held(times: Float64Array, own: Float64Array): Int32Array {
  let next = 0;
  return Int32Array.from(times, (time) => {
    while (next < own.length && (own[next] ?? Infinity) <= time) next += 1;
    return Math.max(next - 1, 0);
  });
}

/** A name that no other one has. */
function unique(name: string, taken: Set<string>): string {
  let one = name;
  for (let i = 2; taken.has(one); i += 1) one = `${name} ${i}`;
  taken.add(one);
  return one;
}
