/** Class and principal pitches of the screw system of the tool's motions. */
import { fill, h } from "../dom";
import { fixed } from "../format";
import { isEmpty, type Scene, type Screw, type State } from "../protocol";
import { empty, numbers, panel, type Panel } from "./panel";

export function screwsPanel(): Panel & { show: (scene: Scene, state: State) => void } {
  const made = panel("screws", "Screw system", true);
  return {
    ...made,
    show(_scene, state) {
      const data = state.overlays["principal-screws"];
      if (!made.isOpen()) return;
      if (!data) {
        fill(made.body, empty("Waiting for the server."));
        return;
      }
      if (isEmpty(data)) {
        made.note("");
        fill(made.body, empty(data.empty));
        return;
      }
      made.note(`order ${data.order}`);
      fill(
        made.body,
        h("p", { class: "row" }, h("span", { class: "class", title: "Gibson-Hunt class" }, data.gibson_hunt), h("span", { class: "note" }, "Gibson-Hunt class", data.order >= 4 && data.order <= 5 ? " of the reciprocal system" : "")),
        h("p", { class: "note" }, data.meaning),
        data.ambiguous && h("p", { class: "doubt" }, "Ambiguous: the margin of this class is narrow."),
        h("h3", {}, "Principal pitches [m/rad]"),
        data.principal_pitches.length > 0
          ? h("p", { class: "number" }, data.principal_pitches.map((pitch) => fixed(pitch, 5)).join("   "))
          : empty("None: this system has no principal pitch."),
        data.screws.length > 0 && h("h3", {}, "Principal screws in the world frame"),
        data.screws.length > 0 && numbers("Principal screws", ["", "direction", "point [m]"], data.screws.map(screwRow)),
      );
    },
  };
}

function screwRow(screw: Screw): string[] {
  const triple = (values: number[]): string => values.map((value) => fixed(value, 2)).join(" ");
  return [`h ${fixed(screw.pitch, 3)}`, triple(screw.direction), screw.point ? triple(screw.point) : "translation"];
}
