/** Numbers of many configurations, as `cylindroid sweep` and `map` write them: Parquet, CSV or JSON with names of columns. */

/** Rows of a table. */
const MOST = 2_000_000;
/** Largest file (bytes). */
const LARGEST = 256 << 20;
/** Columns of strings, such as classes of screw systems, have no colour. */
const TIME = "time";
const PLACES = ["x", "y", "z"];

export type Table = {
  name: string;
  rows: number;
  /** Numbers of each column, not a number where a row has none. */
  columns: Map<string, Float64Array>;
  loci: Locus[];
  /** The frame, which may move, whose axes and origin the places have; null for the world. */
  relativeTo: string | null;
};

/** A curve of a map on which the mechanism is singular or at a limit. */
export type Locus = {
  kind: string;
  /** Places [m], one after the other. */
  places: number[];
};

/** Null for a file that is a motion. Throws an error that names the file and the place. */
export async function readTable(file: File): Promise<Table | null> {
  if (file.size > LARGEST) throw new Error(`${file.name} has ${Math.ceil(file.size / (1 << 20))} MiB, more than ${LARGEST >> 20}; open a part of it.`);
  const kind = file.name.toLowerCase().replace(/^.*\./, "");
  const table = kind === "parquet" ? await fromParquet(file) : kind === "csv" ? fromCsv(file.name, await file.text()) : fromJson(file.name, await file.text());
  if (!table || table.columns.has(TIME) || !(table.columns.has("x") && table.columns.has("y"))) {
    if (kind !== "parquet") return null;
    throw new Error(`${file.name} has no columns x and y: add the quantity "pose" to the sweep.`);
  }
  if (table.rows === 0) throw new Error(`${file.name} has no row.`);
  if (table.rows > MOST) throw new Error(`${file.name} has ${table.rows} rows, more than ${MOST}; open a part of it.`);
  return table;
}

async function fromParquet(file: File): Promise<Table> {
  const { parquetMetadataAsync, parquetRead } = await import("hyparquet");
  const buffer = { byteLength: file.size, slice: (start: number, end?: number) => file.slice(start, end).arrayBuffer() };
  try {
    const metadata = await parquetMetadataAsync(buffer);
    const rows = Number(metadata.num_rows);
    const columns = new Map<string, Float64Array>();
    await parquetRead({
      file: buffer, metadata,
      onChunk: ({ columnName, columnData, rowStart }) => {
        const column = columns.get(columnName) ?? new Float64Array(rows).fill(NaN);
        columns.set(columnName, column);
        for (let i = 0; i < columnData.length; i += 1) column[rowStart + i] = numberOf(columnData[i]);
      },
    });
    return { name: file.name, rows, columns, loci: [], relativeTo: baseOf(metadata.key_value_metadata) };
  } catch (error) {
    throw new Error(`${file.name} is no Parquet file that can be read: ${error instanceof Error ? error.message : String(error)}.`);
  }
}

/** Null where the first line names no columns. */
function fromCsv(name: string, text: string): Table | null {
  const lines = text.split(/\r?\n/).filter((line) => line !== "" && !line.startsWith("#"));
  const names = (lines[0] ?? "").split(",").map((cell) => cell.trim());
  if (!names.includes("x") || !names.includes("y") || names.includes(TIME)) return null;
  const columns = names.map(() => new Float64Array(lines.length - 1));
  for (let i = 1; i < lines.length; i += 1) {
    const cells = (lines[i] ?? "").split(",");
    if (cells.length !== names.length) throw new Error(`${name}, row ${i} has ${cells.length} cells, not ${names.length}.`);
    cells.forEach((cell, k) => {
      const column = columns[k];
      if (column) column[i - 1] = cell === "" ? NaN : numberOf(cell);
    });
  }
  return { name, rows: lines.length - 1, columns: named(names, columns), loci: [], relativeTo: null };
}

/** The frame from which the poses of a sweep are seen, by what its file says about itself. */
function baseOf(entries: { key: string; value?: string }[] | undefined): string | null {
  const about = entries?.find(({ key }) => key === "cylindroid")?.value;
  if (about === undefined) return null;
  try {
    const base = (JSON.parse(about) as Entry | null)?.["relative_to"];
    return typeof base === "string" ? base : null;
  } catch {
    return null; // of another program
  }
}

/** Null where it is no table with columns and rows. */
function fromJson(name: string, text: string): Table | null {
  let read: unknown;
  try {
    read = JSON.parse(text);
  } catch {
    return null; // told as a motion
  }
  const { columns: given, rows, axes, held, loci } = (read ?? {}) as Record<string, unknown>;
  if (!Array.isArray(given) || !Array.isArray(rows)) return null;
  const names = given.map((column: unknown) => (typeof column === "string" ? column : String((column as { name?: unknown } | null)?.name)));
  const columns = names.map(() => new Float64Array(rows.length));
  rows.forEach((row: unknown, i) => {
    if (!Array.isArray(row) || row.length !== names.length) throw new Error(`${name}, row ${i + 1} is no list of ${names.length} numbers.`);
    columns.forEach((column, k) => (column[i] = numberOf(row[k])));
  });
  const found = named(names, columns);
  // A place that the map holds is that of every row.
  for (const component of list(held)) {
    const place = String(component["name"]);
    if (PLACES.includes(place) && !found.has(place)) found.set(place, new Float64Array(rows.length).fill(numberOf(component["value"])));
  }
  return { name, rows: rows.length, columns: found, loci: lociOf(list(axes), list(held), list(loci)), relativeTo: null };
}

/** The curves in space: components that are no axis keep what is held, or zero. None where two axes are no places. */
function lociOf(axes: Entry[], held: Entry[], loci: Entry[]): Locus[] {
  const places = PLACES.map((name) => ({
    axis: axes.findIndex((axis) => axis["name"] === name),
    value: numberOf(held.find((component) => component["name"] === name)?.["value"] ?? 0),
  }));
  if (places.filter(({ axis }) => axis >= 0).length < 2) return [];
  // A curve has two points at least.
  return loci.filter((locus) => list(locus["points"]).length > 1).map((locus) => ({
    kind: String(locus["kind"]),
    places: list<unknown[]>(locus["points"]).flatMap((point) => places.map(({ axis, value }) => (axis < 0 ? value : numberOf(point[axis])))),
  }));
}

type Entry = Record<string, unknown>;

function list<T = Entry>(value: unknown): T[] {
  return Array.isArray(value) ? (value as T[]) : [];
}

/** Columns without a number are left out. */
function named(names: string[], columns: Float64Array[]): Map<string, Float64Array> {
  return new Map(names.flatMap((name, i) => {
    const column = columns[i];
    return column?.some((value) => !Number.isNaN(value)) ? [[name, column]] : [];
  }));
}

function numberOf(value: unknown): number {
  return typeof value === "number" ? value : typeof value === "bigint" || (typeof value === "string" && value.trim() !== "") ? Number(value) : NaN;
}
