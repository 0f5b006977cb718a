/** Class and principal pitches of the screw system of the tool's motions. */
import { h, Kept, text } from "../dom";
import { fixed } from "../format";
import { isEmpty, type Scene, type State } from "../protocol";
import { grid, panel, type Grid, type Panel } from "./panel";

export function screwsPanel(): Panel & { show: (scene: Scene, state: State) => void } {
  const made = panel("screws", "Screw system", true);
  const none = h("p", { class: "empty" });
  const name = h("span", { class: "class", title: "Gibson-Hunt class" });
  const of = h("span", { class: "note" });
  const meaning = h("p", { class: "note" });
  const doubt = h("p", { class: "doubt" }, "Ambiguous: the margin of this class is narrow.");
  const pitches = h("p", {});
  const screws = h("div", {});
  const kept = new Kept(screws);
  let pitch: HTMLElement[] = [];
  let table: Grid | null = null;
  const all = h("div", {}, h("p", { class: "row" }, name, of), meaning, doubt, h("h3", {}, "Principal pitches [m/rad]"), pitches, screws);
  made.body.append(none, all);
  return {
    ...made,
    show(_scene, state) {
      if (!made.isOpen()) return;
      const data = state.overlays["principal-screws"];
      const shown = data && !isEmpty(data) ? data : null;
      none.hidden = shown !== null;
      all.hidden = shown === null;
      if (!shown) {
        made.note("");
        text(none, data && isEmpty(data) ? data.empty : "Waiting for the server.");
        return;
      }
      made.note(`order ${shown.order}`);
      text(name, shown.gibson_hunt);
      text(of, `Gibson-Hunt class${shown.order >= 4 && shown.order <= 5 ? " of the reciprocal system" : ""}`);
      text(meaning, shown.meaning);
      doubt.hidden = !shown.ambiguous;
      const there = shown.principal_pitches.length > 0;
      pitches.className = there ? "number" : "empty";
      text(pitches, there ? shown.principal_pitches.map((pitch) => fixed(pitch, 5)).join("   ") : "None: this system has no principal pitch.");
      kept.fill(shown.screws.length, () => {
        pitch = shown.screws.map(() => h("span", {}));
        table = grid("Principal screws", ["", "direction", "point [m]"], pitch);
        return shown.screws.length > 0 ? [h("h3", {}, "Principal screws in the world frame"), table.element] : [];
      });
      shown.screws.forEach((screw, i) => {
        const head = pitch[i];
        if (head) text(head, `h ${fixed(screw.pitch, 3)}`);
        table?.set(i, [triple(screw.direction), screw.point ? triple(screw.point) : "translation"]);
      });
    },
  };
}

function triple(values: number[]): string {
  return values.map((value) => fixed(value, 2)).join(" ");
}
