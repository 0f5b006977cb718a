/** Units in which lengths and angles are shown and typed, kept in this browser; all that is sent and stored is SI. */
import { Euler, Quaternion as Rotation } from "three";
import { text } from "./dom";
import type { Quaternion, Vec3 } from "./protocol";

const CHOICES = { length: ["m", "mm"], angle: ["rad", "deg"], orientation: ["quaternion", "roll, pitch, yaw"] } as const;
export type Choices = typeof CHOICES;
export type Units = { [K in keyof Choices]: Choices[K][number] };
/** Of a value in SI: `m`, `rad`, or none. */
export type Quantity = "m" | "rad" | "";

const KEY = "cylindroid-units";
const SCALES: Record<string, [factor: number, digits: number]> = { mm: [1000, -3], deg: [180 / Math.PI, -2] };
const units: Units = stored();
const told = new Set<{ element: Element; refresh: () => void }>();

function stored(): Units {
  let kept: Partial<Record<string, unknown>> = {};
  try {
    kept = Object(JSON.parse(localStorage.getItem(KEY) ?? "{}")) as typeof kept;
  } catch {
    // storage may be forbidden
  }
  const one = <T>(names: readonly [T, ...T[]], name: unknown): T => names.find((known) => known === name) ?? names[0];
  return { length: one(CHOICES.length, kept["length"]), angle: one(CHOICES.angle, kept["angle"]), orientation: one(CHOICES.orientation, kept["orientation"]) };
}

export function chosenUnits(): Readonly<Units> {
  return units;
}

export function choices<K extends keyof Choices>(key: K): Choices[K] {
  return CHOICES[key];
}

export function chooseUnit(key: keyof Choices, value: string): void {
  const found = CHOICES[key].find((name) => name === value);
  if (!found) return;
  Object.assign(units, { [key]: found });
  try {
    localStorage.setItem(KEY, JSON.stringify(units));
  } catch {
    // lasts until the page is closed then
  }
  for (const one of told) {
    if (one.element.isConnected) one.refresh();
    else told.delete(one);
  }
}

/** Calls now and after each choice of units, as long as the element is on the page. */
export function inUnits(element: Element, refresh: () => void): void {
  told.add({ element, refresh });
  refresh();
}

/** An element whose words contain a unit. */
export function withUnit<E extends Element>(element: E, quantity: Quantity, words: (unit: string) => string): E {
  inUnits(element, () => text(element, words(unitOf(quantity))));
  return element;
}

/** The unit of display. */
export function unitOf(quantity: Quantity): string {
  return quantity === "m" ? units.length : quantity === "rad" ? units.angle : "";
}

/** A value of SI in the unit of display. */
export function shown(value: number, quantity: Quantity): number {
  return value * (SCALES[unitOf(quantity)]?.[0] ?? 1);
}

/** A value that was typed, in SI. */
export function typed(value: number, quantity: Quantity): number {
  return value / (SCALES[unitOf(quantity)]?.[0] ?? 1);
}

/** Digits after the point where SI has so many. */
export function digitsOf(quantity: Quantity, digits: number): number {
  return Math.max(0, digits + (SCALES[unitOf(quantity)]?.[1] ?? 0));
}

/** Roll, pitch and yaw about the fixed axes x, y, z: `Rz(yaw) Ry(pitch) Rx(roll)`. At a pitch of 90 degrees the roll is zero. */
export function rollPitchYaw([w, x, y, z]: Quaternion): Vec3 {
  const { x: roll, y: pitch, z: yaw } = new Euler().setFromQuaternion(new Rotation(x, y, z, w).normalize(), "ZYX");
  return [roll, pitch, yaw];
}

export function ofRollPitchYaw([roll, pitch, yaw]: Vec3): Quaternion {
  const { w, x, y, z } = new Rotation().setFromEuler(new Euler(roll, pitch, yaw, "ZYX"));
  return [w, x, y, z];
}

/** The angle, or the same direction a turn away, that is nearest to another. */
export function nearestTurn(angle: number, to: number): number {
  return angle + 2 * Math.PI * Math.round((to - angle) / (2 * Math.PI));
}
