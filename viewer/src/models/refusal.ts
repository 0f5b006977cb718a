/** Why a model is not shown, in words. */
import { h, type Child } from "../dom";
import type { Refusal } from "../protocol";

/** The place of a fault, the sentence, the line and the advice. */
export function refusal({ message, file, line, column, text, help }: Refusal): Child[] {
  return [
    file !== null && h("b", {}, `${file}, line ${line ?? "?"}, column ${column ?? "?"}`),
    h("p", {}, message),
    text !== null && text !== "" && h("code", {}, text),
    help !== "" && h("p", { class: "note" }, help),
  ];
}
