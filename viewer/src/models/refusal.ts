/** Why a model is not shown, in words. */
import { h, type Child } from "../dom";
import type { Refusal } from "../protocol";

/** The place of a fault, the sentence, the line and the advice. */
export function refusal({ message, file, line, column, text, help }: Refusal): Child[] {
  return [
    file !== null && h("b", {}, placeOf(file, line, column)),
    h("p", {}, message),
    text !== null && text !== "" && h("code", {}, text),
    help !== "" && h("p", { class: "note" }, help),
  ];
}

/** The same as text, without the line and the advice. */
export function sentence({ message, file, line, column }: Refusal): string {
  return file === null ? message : `${placeOf(file, line, column)}: ${message}`;
}

function placeOf(file: string, line: number | null, column: number | null): string {
  return `${file}, line ${line ?? "?"}, column ${column ?? "?"}`;
}
