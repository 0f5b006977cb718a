/** A PNG that is small enough for a README: fewer shades, every row filtered by what packs it best. */
import { crc32, deflateSync } from "node:zlib";

/**
 * @param {Buffer} rgba four bytes a pixel; those of opacity are left out
 * @param {number} width
 * @param {number} height
 * @param {number} shades of each colour
 */
export function smallPng(rgba, width, height, shades = 64) {
  const stride = 3 * width;
  const before = Buffer.alloc(stride);
  const row = Buffer.alloc(stride);
  const rows = [];
  for (let y = 0; y < height; y += 1) {
    row.copy(before);
    for (let i = 0; i < stride; i += 1) {
      const value = rgba[4 * (y * width + Math.floor(i / 3)) + (i % 3)] ?? 0;
      row[i] = Math.round((Math.round((value * (shades - 1)) / 255) * 255) / (shades - 1));
    }
    rows.push(best([0, 1, 2, 4].map((kind) => filtered(kind, row, y > 0 ? before : Buffer.alloc(stride)))));
  }
  const head = Buffer.alloc(13);
  head.writeUInt32BE(width, 0);
  head.writeUInt32BE(height, 4);
  head.set([8, 2, 0, 0, 0], 8);
  return Buffer.concat([
    Buffer.from([0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a]),
    chunk("IHDR", head), chunk("IDAT", deflateSync(Buffer.concat(rows), { level: 9, memLevel: 9 })), chunk("IEND", Buffer.alloc(0)),
  ]);
}

/**
 * A row as PNG's filter of this kind leaves it: 0 none, 1 left, 2 up, 4 Paeth.
 * @param {number} kind
 * @param {Buffer} row
 * @param {Buffer} before
 */
function filtered(kind, row, before) {
  const out = Buffer.alloc(row.length + 1);
  out[0] = kind;
  for (let i = 0; i < row.length; i += 1) {
    const [left, up, corner] = [i < 3 ? 0 : (row[i - 3] ?? 0), before[i] ?? 0, i < 3 ? 0 : (before[i - 3] ?? 0)];
    const guess = kind === 1 ? left : kind === 2 ? up : kind === 4 ? paeth(left, up, corner) : 0;
    out[i + 1] = ((row[i] ?? 0) - guess) & 255;
  }
  return out;
}

/** @param {number} a @param {number} b @param {number} c */
function paeth(a, b, c) {
  const [da, db, dc] = [Math.abs(b - c), Math.abs(a - c), Math.abs(a + b - 2 * c)];
  return da <= db && da <= dc ? a : db <= dc ? b : c;
}

/** @param {Buffer[]} rows */
function best(rows) {
  const cost = (/** @type {Buffer} */ row) => row.subarray(1).reduce((sum, value) => sum + Math.min(value, 256 - value), 0);
  return rows.reduce((least, row) => (cost(row) < cost(least) ? row : least));
}

/** @param {string} name @param {Buffer} data */
function chunk(name, data) {
  const body = Buffer.concat([Buffer.from(name, "latin1"), data]);
  const [length, check] = [Buffer.alloc(4), Buffer.alloc(4)];
  length.writeUInt32BE(data.length);
  check.writeUInt32BE(crc32(body));
  return Buffer.concat([length, body, check]);
}
