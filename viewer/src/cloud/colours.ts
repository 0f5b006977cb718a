/** Colours of numbers: viridis, which keeps its order in print and for the colour-blind. */

/** Of the values from 0 to 1 at even distances (van der Walt and Smith 2015). */
const STOPS = [0x440154, 0x472d7b, 0x3b528b, 0x2c728e, 0x21918c, 0x28ae80, 0x5ec962, 0xaddc30, 0xfde725];
/** Of a row without a number. */
const NONE = 0x808080;
/** Shares of the values beyond which colours do not change: single rows near singularities would take all of them. */
const ENDS = [0.02, 0.98] as const;

/** Between which values colours change. */
export function rangeOf(values: Float64Array): [number, number] {
  const finite = values.filter(Number.isFinite).sort();
  const [low, high] = ENDS.map((share) => finite[Math.round(share * (finite.length - 1))] ?? NaN);
  return [low ?? NaN, high ?? NaN];
}

/** Red, green and blue of each value (linear, from 0 to 1). */
export function coloursOf(values: Float64Array, [low, high]: [number, number]): Float32Array {
  const colours = new Float32Array(3 * values.length);
  const linear = (byte: number): number => (byte / 255 <= 0.04045 ? byte / 255 / 12.92 : ((byte / 255 + 0.055) / 1.055) ** 2.4);
  values.forEach((value, i) => {
    const share = high > low ? Math.min(Math.max((value - low) / (high - low), 0), 1) : 0.5;
    const at = share * (STOPS.length - 1);
    const [from, to] = [STOPS[Math.floor(at)] ?? NONE, STOPS[Math.ceil(at)] ?? NONE];
    for (let k = 0; k < 3; k += 1) {
      const part = (colour: number): number => (colour >> (16 - 8 * k)) & 255;
      const byte = Number.isNaN(value) ? part(NONE) : part(from) + (part(to) - part(from)) * (at - Math.floor(at));
      colours[3 * i + k] = linear(byte);
    }
  });
  return colours;
}
