/** The frame of the page: a bar, two sides, the view between them, and short notices over it. */
import { h } from "./dom";

export type Layout = {
  bar: HTMLElement; left: HTMLElement; right: HTMLElement; plots: HTMLElement; stage: HTMLElement; view: HTMLElement;
  tools: HTMLElement; legend: HTMLElement; dock: HTMLElement; banner: HTMLElement; notice: HTMLElement;
  /** One of a `key` takes the place of the last. */
  toast: (words: string, bad?: boolean, key?: string) => void;
};

const TOAST_TIME = 9000;
const MOST_TOASTS = 3;

export function layout(root: HTMLElement): Layout {
  const bar = h("header", { class: "bar" });
  const left = h("aside", { class: "side left", "aria-label": "Controls" });
  const right = h("aside", { class: "side right", "aria-label": "Measures" });
  const plots = h("aside", { class: "plots", "aria-label": "Recording" });
  const dock = h("div", { class: "dock", role: "group", "aria-label": "Playing back" });
  const tools = h("div", { class: "float top", role: "toolbar", "aria-label": "View" });
  const legend = h("div", { class: "legend", role: "region", "aria-label": "Legend", tabindex: 0 });
  const banner = h("div", { class: "banner", role: "alert", hidden: true });
  const notice = h("div", { class: "banner", role: "alert", hidden: true });
  const toasts = h("div", { class: "toasts", role: "status", "aria-live": "polite" });
  // The legend lies below the view, not over the robot.
  const picture = h("div", { class: "picture" }, notice, banner);
  const view = h("div", { class: "view" }, picture, tools, toasts);
  const stage = h("main", { class: "stage", "aria-label": "Robot" }, view, dock, legend);
  root.append(h("div", { class: "shell" }, bar, left, stage, plots, right));
  const toast = (words: string, bad = false, key = words): void => {
    [...toasts.children].find((child) => child.getAttribute("data-key") === key)?.remove();
    const close = h("button", { type: "button", "aria-label": "Close", onclick: () => {
      made.remove();
      (toasts.querySelector("button") ?? stage.querySelector("canvas"))?.focus();
    } }, "×");
    const made = h("div", { class: bad ? "toast bad" : "toast", "data-key": key }, h("span", {}, words), close);
    toasts.append(made);
    while (toasts.children.length > MOST_TOASTS) toasts.firstElementChild?.remove();
    setTimeout(() => made.remove(), TOAST_TIME);
  };
  return { bar, left, right, plots, stage: picture, view, tools, legend, dock, banner, notice, toast };
}
