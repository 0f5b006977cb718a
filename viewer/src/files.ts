/** Files that are dropped on the page. */

type Take = (files: File[]) => void;

/** While files are over the page, it is marked. */
export function onDrop(take: Take): void {
  const root = document.documentElement;
  const mark = (over: boolean): void => void root.toggleAttribute("data-dropping", over);
  addEventListener("dragover", (event) => {
    if (!event.dataTransfer?.types.includes("Files")) return;
    event.preventDefault();
    mark(true);
  });
  addEventListener("dragleave", (event) => {
    if (event.relatedTarget === null) mark(false);
  });
  addEventListener("drop", (event) => {
    if (!event.dataTransfer?.types.includes("Files")) return;
    event.preventDefault();
    mark(false);
    take([...event.dataTransfer.files]);
  });
}
