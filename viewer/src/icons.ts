/** Small line drawings on buttons. */
import { s } from "./dom";

const PATHS = {
  play: "M5 3.5v9l7.5-4.5z",
  pause: "M5 3.5v9M11 3.5v9",
  reset: "M3 8a5 5 0 1 0 1.7-3.8M3 2.5V5.5H6",
  undo: "M6 3 3 6l3 3M3 6h6.5a3.5 3.5 0 0 1 0 7H6",
  redo: "M10 3l3 3-3 3M13 6H6.5a3.5 3.5 0 0 0 0 7H10",
  move: "M8 2v12M2 8h12M6 4l2-2 2 2M6 12l2 2 2-2M4 6 2 8l2 2M12 6l2 2-2 2",
  rotate: "M13 8a5 5 0 1 1-1.6-3.7M13 2v3h-3",
  record: "M8 4.5a3.5 3.5 0 1 0 .01 0z",
  loop: "M3 8.5V7a2.5 2.5 0 0 1 2.5-2.5H13M11 2.5l2 2-2 2M13 7.5V9a2.5 2.5 0 0 1-2.5 2.5H3M5 13.5l-2-2 2-2",
  trail: "M2.5 13C5 5.5 7 12 9 8.5S11.5 3.5 13.5 3",
  link: "M5 11 11 5M3.8 14a1.8 1.8 0 1 0-.01 0zM12.2 5.6a1.8 1.8 0 1 0-.01 0z",
  joint: "M8 3a5 5 0 1 0 .01 0zM8 7.2a.8.8 0 1 0 .01 0z",
  frame: "M4.5 2.5v8.5H13M4.5 11 2 13.5",
  closing: "M12.6 6A5 5 0 0 0 4 5M3.4 10a5 5 0 0 0 8.6 1M4 2v3h3M12 14v-3H9",
  open: "M2 13V3.5h4l1.5 2H14V13zM2 8h12",
  save: "M8 2.5v7M5 7l3 3 3-3M3 13h10",
  picture: "M2 3.5h12v9H2zM2 11l3.5-3.5 3 3 2-2L14 11",
  share: "M6.5 9.5 9.5 6.5M7 5l2-2a2.8 2.8 0 0 1 4 4l-2 2M9 11l-2 2a2.8 2.8 0 0 1-4-4l2-2",
  light: "M8 5a3 3 0 1 0 .01 0zM8 1.5v1.2M8 13.3v1.2M1.5 8h1.2M13.3 8h1.2M3.4 3.4l.9.9M11.7 11.7l.9.9M12.6 3.4l-.9.9M4.3 11.7l-.9.9",
  dark: "M13 9.6A5.5 5.5 0 0 1 6.4 3a5.5 5.5 0 1 0 6.6 6.6z",
  system: "M2 3h12v8H2zM6 13.5h4M8 11v2.5",
  fit: "M2.5 6V2.5H6M10 2.5h3.5V6M13.5 10v3.5H10M6 13.5H2.5V10",
} as const;

export type Icon = keyof typeof PATHS;

export function icon(name: Icon): SVGElement {
  return s(
    "svg",
    { viewBox: "0 0 16 16", fill: "none", stroke: "currentColor", "stroke-width": 1.5, "stroke-linecap": "round", "stroke-linejoin": "round", "aria-hidden": "true" },
    s("path", { d: PATHS[name] }),
  );
}
