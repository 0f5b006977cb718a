/** Light, dark, or as the system has it; kept in this browser. */

export type Theme = "system" | "light" | "dark";
const KEY = "cylindroid-theme";
const ORDER: Theme[] = ["system", "light", "dark"];
const dark = matchMedia("(prefers-color-scheme: dark)");

function stored(): Theme {
  try {
    const value = localStorage.getItem(KEY);
    return ORDER.find((t) => t === value) ?? "system";
  } catch {
    return "system"; // storage may be forbidden
  }
}

let current: Theme = stored();
const listeners = new Set<() => void>();

function apply(): void {
  const shown = current === "system" ? (dark.matches ? "dark" : "light") : current;
  document.documentElement.dataset["theme"] = shown;
  for (const listener of listeners) listener();
}

dark.addEventListener("change", apply);
apply();

export function theme(): Theme {
  return current;
}

export function nextTheme(): void {
  current = ORDER[(ORDER.indexOf(current) + 1) % ORDER.length] ?? "system";
  try {
    localStorage.setItem(KEY, current);
  } catch {
    // lasts until the page is closed then
  }
  apply();
}

export function onTheme(listener: () => void): void {
  listeners.add(listener);
}

/** Wears the colour that is asked for: the style sheet's own words are `light-dark(…)`. */
const probe = document.head.appendChild(document.createElement("i"));

/** A colour of the style sheet in the theme that is shown, by its name there without the dashes. */
export function colour(name: string): string {
  probe.style.color = `var(--${name})`;
  return getComputedStyle(probe).color;
}
