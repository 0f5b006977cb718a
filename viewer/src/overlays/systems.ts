/** Systems of screws: the joints' axes, principal screws, the reciprocal system. */
import type { Group } from "three";
import { count, fixed } from "../format";
import type { JointAxes, PrincipalScrews, Reciprocal } from "../protocol";
import { drawn } from "../scene/palette";
import { vector } from "../scene/shapes";
import type { Context } from "./overlay";
import { drawScrew, pitchText } from "./screw";

/** How much of a robot's joint names is its own name: `panda_`. */
function sharedStart(names: string[]): number {
  const [first = "", ...others] = names;
  let length = others.length > 0 ? first.length : 0;
  for (const name of others) while (!name.startsWith(first.slice(0, length))) length -= 1;
  return Math.max(first.lastIndexOf("_", length - 1), first.lastIndexOf("/", length - 1)) + 1;
}

export const jointAxes = {
  colour: "c-axes",
  draw(group: Group, data: JointAxes, context: Context): void {
    const about = vector(context.state.tool.position);
    const start = sharedStart(data.axes.map((axis) => axis.name));
    for (const { name, screw, actuated, coordinate } of data.axes) {
      const place = coordinate === null ? null : context.jointPlace(coordinate);
      const end = drawScrew(group, screw, place ?? (screw.point ? vector(screw.point) : about), {
        length: 0.26 * context.size,
        radius: 0.035 * context.size,
        line: context.line * 0.5,
        material: drawn(actuated ? "c-axes" : "line-strong", 0.9),
      });
      if (data.axes.length <= 12) context.label({ text: name.slice(start), at: end, colour: "c-axes" });
    }
  },
  words: (data: JointAxes) => `${count(data.axes.length, "axis", "axes")}; passive joints are paler`,
};

export const principalScrews = {
  colour: "c-principal",
  draw(group: Group, data: PrincipalScrews, context: Context): void {
    const center = vector(data.canonical.position);
    data.screws.forEach((screw) => {
      const end = drawScrew(group, screw, center, {
        length: 0.62 * context.size,
        radius: 0.05 * context.size,
        line: context.line * 0.8,
        material: drawn("c-principal"),
      });
      context.label({ text: pitchText(screw.pitch), at: end, colour: "c-principal" });
    });
  },
  words(data: PrincipalScrews): string {
    const pitches = data.principal_pitches.map((pitch) => fixed(pitch, 3)).join(", ");
    return `order ${data.order}, class ${data.gibson_hunt}${pitches ? `; pitches ${pitches} m/rad` : ""}${data.ambiguous ? "; ambiguous" : ""}`;
  },
};

export const reciprocalSystem = {
  colour: "c-reciprocal",
  draw(group: Group, data: Reciprocal, context: Context): void {
    const about = vector(context.state.tool.position);
    for (const screw of data.screws) {
      const end = drawScrew(group, screw, about, {
        length: 0.7 * context.size,
        radius: 0.03 * context.size,
        line: context.line * 0.6,
        material: drawn("c-reciprocal", 0.95),
      });
      context.label({ text: pitchText(screw.pitch), at: end, colour: "c-reciprocal" });
    }
  },
  words: (data: Reciprocal) => `order ${data.order}, class ${data.gibson_hunt}`,
};
