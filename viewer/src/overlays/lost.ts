/** The motion of the tool that is lost at a singularity, or about to be. */
import type { Group } from "three";
import type { LostDirection } from "../protocol";
import { drawn } from "../scene/palette";
import { arrow, vector } from "../scene/shapes";
import type { Context } from "./overlay";
import { drawScrew } from "./screw";

export const lostDirection = {
  colour: "c-lost",
  draw(group: Group, data: LostDirection, context: Context): void {
    const tool = vector(context.state.tool.position);
    const material = drawn("c-lost", data.lost ? 1 : 0.75);
    for (const side of [1, -1]) {
      group.add(arrow(tool, vector(data.linear).multiplyScalar(side), context.line * 0.9, material));
    }
    const angular = vector(data.angular);
    if (data.screw) {
      const end = drawScrew(group, data.screw, tool, {
        length: 0.5 * context.size, radius: 0.045 * context.size, line: context.line * 0.6, material,
      });
      context.label({ text: data.lost ? "lost" : "almost lost", at: end, colour: "c-lost" });
    } else if (angular.lengthSq() > 0) {
      group.add(arrow(tool, angular, context.line * 0.6, material));
    }
  },
  words: (data: LostDirection) => data.sentence,
};
