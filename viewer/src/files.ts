/** Files that are dropped on the page, alone or in folders. */

/** A file and its path, from the folder that was dropped or chosen. */
export type Given = { path: string; file: File };

/** More files of folders are not looked at: a model has fewer. */
const MOST = 20_000;

/** While files are over the page, it is marked. */
export function onDrop(take: (files: Given[]) => void, fail: (words: string) => void): void {
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
    dropped(event.dataTransfer).then(take, (error: unknown) => fail(error instanceof Error ? error.message : String(error)));
  });
}

/** Those of a choice, whose names are their paths. */
export function chosen(files: Iterable<File>): Given[] {
  return Array.from(files, (file) => ({ path: file.name, file }));
}

/** Entries are there during the event only. */
function dropped({ items, files }: DataTransfer): Promise<Given[]> {
  const entries = Array.from(items, (item) => item.webkitGetAsEntry());
  // Files that a program drops have no entries.
  if (!entries.some((entry) => entry?.isDirectory)) return Promise.resolve(chosen(files));
  return within(entries.filter((entry) => entry !== null));
}

/** All files in folders, and in the folders in them; hidden ones are left out. */
async function within(entries: FileSystemEntry[]): Promise<Given[]> {
  const found: Given[] = [];
  const left = [...entries];
  for (let entry = left.shift(); entry; entry = left.shift()) {
    if (entry.name.startsWith(".")) continue;
    if (found.length + left.length >= MOST) throw new Error(`These folders have more than ${MOST} files: drop the folder of the model alone.`);
    if (isFolder(entry)) left.push(...(await listed(entry)));
    else if (isFile(entry)) found.push({ path: entry.fullPath.replace(/^\//, ""), file: await opened(entry) });
  }
  return found;
}

function isFolder(entry: FileSystemEntry): entry is FileSystemDirectoryEntry {
  return entry.isDirectory;
}

function isFile(entry: FileSystemEntry): entry is FileSystemFileEntry {
  return entry.isFile;
}

/** A reader gives some at a time, and nothing at the end. */
async function listed(folder: FileSystemDirectoryEntry): Promise<FileSystemEntry[]> {
  const reader = folder.createReader();
  const found: FileSystemEntry[] = [];
  for (;;) {
    const some = await new Promise<FileSystemEntry[]>((resolve, reject) => reader.readEntries(resolve, reject));
    if (some.length === 0) return found;
    found.push(...some);
  }
}

function opened(entry: FileSystemFileEntry): Promise<File> {
  return new Promise((resolve, reject) => entry.file(resolve, reject));
}
