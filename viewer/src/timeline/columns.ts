/** The numbers of a recording over time, as columns that grow, and the stretches in which something bit. */
import type { Scene, State } from "../protocol";

/** Of a sample: a limit bounds a joint velocity, or a joint is outside of its limits; a singular value is lost. */
export const AT_LIMIT = 1;
export const SINGULAR = 2;
/** After it the user began something. */
export const STEP = 4;

/** Sliders round what they are given (s). */
const ROUNDING = 1e-9;

/** Numbers that are appended. */
export class Column {
  private values = new Float64Array(256);
  length = 0;

  push(value: number): void {
    if (this.length === this.values.length) {
      const more = new Float64Array(2 * this.length);
      more.set(this.values);
      this.values = more;
    }
    this.values[this.length] = value;
    this.length += 1;
  }

  /** Adds bits to the last number. */
  mark(bits: number): void {
    if (this.length > 0) this.values[this.length - 1] = this.at(this.length - 1) | bits;
  }

  at(i: number): number {
    return this.values[i] ?? NaN;
  }

  /** What is there now. */
  view(): Float64Array {
    return this.values.subarray(0, this.length);
  }
}

/** One column for each coordinate, singular value, or coordinate of the tool; not a number where a sample has none. */
export class Columns {
  readonly time = new Column();
  readonly q: Column[];
  /** Where a sample has none, how fast the coordinates change since the one before. */
  readonly rates: Column[];
  areDifferences = false;
  readonly margins: Column[];
  readonly errors = [new Column(), new Column()];
  readonly singular: Column[] = [];
  readonly threshold = new Column();
  readonly tool = [new Column(), new Column(), new Column()];
  readonly marks = new Column();

  constructor(coordinates: number) {
    const all = (): Column[] => Array.from({ length: coordinates }, () => new Column());
    [this.q, this.rates, this.margins] = [all(), all(), all()];
  }

  push(time: number, scene: Scene, state: State): void {
    const [before, sinceLast] = [this.time.length - 1, time - this.time.at(this.time.length - 1)];
    this.time.push(time);
    const rates = state.servo.joint_velocities;
    this.areDifferences ||= rates === null;
    scene.coordinates.forEach(({ lower, upper }, i) => {
      const q = state.q[i] ?? NaN;
      const way = q - (this.q[i]?.at(before) ?? NaN);
      this.q[i]?.push(q);
      this.rates[i]?.push(rates ? rates[i] ?? NaN : sinceLast > 0 ? way / sinceLast : NaN);
      const margin = Math.min(q - (lower ?? -Infinity), (upper ?? Infinity) - q);
      this.margins[i]?.push(Number.isFinite(margin) ? margin : NaN);
    });
    this.errors[0]?.push(state.error.position ?? NaN);
    this.errors[1]?.push(state.error.orientation ?? NaN);
    const values = state.singular?.values ?? [];
    while (this.singular.length < values.length) this.singular.push(absent(this.time.length - 1));
    this.singular.forEach((column, i) => column.push(values[i] ?? NaN));
    this.threshold.push(state.singular?.threshold ?? NaN);
    this.tool.forEach((column, i) => column.push(state.tool.position[i] ?? NaN));
    const limited = state.servo.limits.length > 0 || state.outside_limits.length > 0;
    const lost = state.singular !== null && values.some((value) => value < (state.singular?.threshold ?? 0));
    this.marks.push((limited ? AT_LIMIT : 0) | (lost ? SINGULAR : 0));
  }

  /** The last sample at or before a time; the first one before all. */
  indexAt(time: number): number {
    return lastAt(this.time.view(), time);
  }

  /** The sample before or after this one at which a step of the user began, or the end on that side. */
  step(from: number, way: -1 | 1): number {
    const end = way < 0 ? 0 : this.time.length - 1;
    let i = from + way;
    while ((end - i) * way > 0 && (this.marks.at(i) & STEP) === 0) i += way;
    return (end - i) * way < 0 ? end : i;
  }

  /** Times at which steps of the user began. */
  steps(): number[] {
    const found: number[] = [];
    this.marks.view().forEach((mark, i) => {
      if ((mark & STEP) !== 0) found.push(this.time.at(i));
    });
    return found;
  }

  /** Times from which and until which a mark is set. */
  stretches(mark: number): [number, number][] {
    const found: [number, number][] = [];
    const [times, marks] = [this.time.view(), this.marks.view()];
    let begin: number | null = null;
    marks.forEach((value, i) => {
      const time = times[i] ?? 0;
      if ((value & mark) !== 0) begin ??= time;
      else if (begin !== null) {
        found.push([begin, time]);
        begin = null;
      }
    });
    if (begin !== null) found.push([begin, times.at(-1) ?? begin]);
    return found;
  }
}

/** The number of the last of these rising times at or before one; the first one before all. */
export function lastAt(times: Float64Array, time: number): number {
  let [low, high] = [0, times.length];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if ((times[middle] ?? Infinity) <= time + ROUNDING) low = middle;
    else high = middle;
  }
  return low;
}

function absent(count: number): Column {
  const column = new Column();
  for (let i = 0; i < count; i += 1) column.push(NaN);
  return column;
}
