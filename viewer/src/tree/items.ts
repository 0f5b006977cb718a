/** Links, joints and frames of a model as a tree: a link with its frames, and the joints that it carries with their links. */
import type { Pose, Scene } from "../protocol";

export type Kind = "link" | "joint" | "frame" | "loop";
export type Item = {
  /** Kind and name: what it is in another version of the model, too. */
  key: string;
  kind: Kind; name: string;
  /** In the list of its kind. */
  index: number;
  /** The link that it is fixed to: a joint to the one that carries it. */
  link: number;
  /** Its frame in that link, which a loop joint does not have: its frame at zero for a joint. */
  pose: Pose | null;
  /** What it is, and what it connects. */
  words: string;
  level: number;
  parent: Item | null;
  children: Item[];
};

const ORIGIN: Pose = { position: [0, 0, 0], quaternion: [1, 0, 0, 0] };

export const keyOf = (kind: Kind, name: string): string => `${kind} ${name}`;

/** All items, each after its parent. */
export function items(scene: Scene): Item[] {
  const all: Item[] = [];
  const linkName = (i: number): string => scene.links[i]?.name ?? "?";
  const carried = new Set(scene.joints.map(({ child }) => child));
  const add = (kind: Kind, index: number, name: string, parent: Item | null, rest: Pick<Item, "link" | "pose" | "words">): Item => {
    const item: Item = { key: keyOf(kind, name), kind, name, index, level: parent ? parent.level + 1 : 1, parent, children: [], ...rest };
    parent?.children.push(item);
    all.push(item);
    return item;
  };
  const addFrames = (link: number, parent: Item): void => {
    scene.frames.forEach((frame, i) => {
      // The frame of a link itself is no item of its own.
      if (frame.link !== link || frame.name === parent.name) return;
      add("frame", i, frame.name, parent, { link, pose: frame.pose, words: `frame on ${parent.name}` });
    });
  };
  /** Links whose children are still to come, the last one first: chains may be long. */
  const waiting: { link: number; parent: Item | null; by: string }[] = [];
  scene.links.forEach((_, link) => {
    if (!carried.has(link)) waiting.unshift({ link, parent: null, by: "the ground" });
  });
  for (let next = waiting.pop(); next; next = waiting.pop()) {
    const { link, parent, by } = next;
    const item = add("link", link, linkName(link), parent, { link, pose: ORIGIN, words: parent ? `link carried by ${by}` : "link, the root of the tree" });
    addFrames(link, item);
    scene.loops.forEach(({ name, kind, a, b }, i) => {
      if (a === link) add("loop", i, name, item, { link, pose: null, words: `${kind} joint that closes a loop, ${linkName(a)} to ${linkName(b)}` });
    });
    const joints = scene.joints.map((joint, i) => ({ joint, i })).filter(({ joint }) => joint.parent === link);
    const made = joints.map(({ joint: { name, kind, origin, child }, i }) => ({
      child, item: add("joint", i, name, item, { link, pose: origin, words: `${kind} joint, ${linkName(link)} to ${linkName(child)}` }),
    }));
    for (const { child, item: joint } of made.reverse()) waiting.push({ link: child, parent: joint, by: joint.name });
  }
  return inOrder(all);
}

/** Each item before its children, and those before its next sibling. */
function inOrder(all: Item[]): Item[] {
  const ordered: Item[] = [];
  const waiting = all.filter(({ parent }) => parent === null).reverse();
  for (let next = waiting.pop(); next; next = waiting.pop()) {
    ordered.push(next);
    waiting.push(...[...next.children].reverse());
  }
  return ordered;
}

/** The name of the frame that makes an item the tool. */
export function toolOf(item: Item, scene: Scene): string | null {
  const isIt = ({ name, link }: Scene["frames"][number]): boolean => name === item.name && link === item.link;
  if (item.kind !== "link" && item.kind !== "frame") return null;
  return scene.frames.find(isIt)?.name ?? null;
}
