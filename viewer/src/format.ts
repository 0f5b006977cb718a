/** Numbers for people. A minus sign is a minus sign; what is absent is a dash. */

const MINUS = "\u2212";

export function fixed(value: number | null | undefined, digits = 4): string {
  if (value === null || value === undefined || Number.isNaN(value)) return "–";
  if (!Number.isFinite(value)) return value > 0 ? "∞" : `${MINUS}∞`;
  const shown = value.toFixed(digits);
  const unsigned = Number(shown) === 0 ? shown.replace("-", "") : shown;
  return unsigned.replace("-", MINUS);
}

/** A few significant digits, powers of ten where they are shorter. */
export function short(value: number | null | undefined, digits = 3): string {
  if (value === null || value === undefined || Number.isNaN(value)) return "–";
  if (!Number.isFinite(value)) return value > 0 ? "∞" : `${MINUS}∞`;
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e-3 && size < 1e5) {
    return Number(value.toPrecision(digits)).toString().replace("-", MINUS);
  }
  const [mantissa = "", exponent = "0"] = value.toExponential(digits - 1).split("e");
  const power = Number(exponent).toString().replace("-", MINUS);
  return `${Number(mantissa).toString().replace("-", MINUS)}e${power}`;
}

/** "1 motion", "2 motions". */
export function count(value: number, one: string, many = `${one}s`): string {
  return `${value} ${value === 1 ? one : many}`;
}

/** For a field in which one types: an ordinary minus, and none before zero. */
export function plain(value: number, digits = 4): string {
  const shown = value.toFixed(digits);
  return Number(shown) === 0 ? shown.replace("-", "") : shown;
}
