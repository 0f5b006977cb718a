/** An overlay: a drawing made from the data of each state, and its legend. */
import type { Group, Vector3 } from "three";
import type { OverlayData, OverlayName, Scene, State } from "../protocol";
import type { Label } from "../scene/labels";

export type Context = {
  scene: Scene;
  state: State;
  /** Lengths that look right for this robot (m). */
  size: number;
  line: number;
  /** Where a coordinate's joint is now. */
  jointPlace: (coordinate: number) => Vector3 | null;
  label: (label: Label) => void;
};

type Full<K extends OverlayName> = Exclude<OverlayData[K], { empty: string }>;

export type Overlay<K extends OverlayName> = {
  colour: string;
  draw: (group: Group, data: Full<K>, context: Context) => void;
  /** A short legend with the values. */
  words: (data: Full<K>, context: Context) => string;
};
