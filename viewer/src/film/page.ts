/** A recording as one HTML file: script, styles, states and bodies are in it, and it fetches nothing. */
import type { Recording } from "../timeline/recording";
import { collected } from "./collect";
import { BODIES, packed, RECORDING, type Head, type Look, type Track } from "./film";

/** Nothing from elsewhere. `blob:` is where a browser keeps the images of the bodies. */
const POLICY = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:; connect-src data: blob:";

export async function filmPage(recording: Recording, look: Look): Promise<Blob> {
  const { name } = recording.scene;
  const [script, styles] = await Promise.all(["film.js", "film.css"].map(part));
  const beside = recording.tracks();
  const all = [recording, ...beside.map(([, one]) => one)];
  // Names of sessions, and ids of models, are of the server.
  const numbers = new Map(beside.map(([session], i) => [session, String(i + 1)]));
  const { scenes, bodies } = await collected(all.flatMap((one) => one.parts().map(({ scene }) => scene)), numbers);
  const track = (one: Recording): Track => ({
    times: [...one.columns.time.view()],
    scenes: one.parts().map(({ from, scene }) => ({ from, scene: scenes.shift() ?? scene })),
  });
  const head: Head = { ...look, ...track(recording), beside: beside.map(([session, one]) => ({ session: numbers.get(session) ?? "", ...track(one) })) };
  const states = await packed(new Blob([JSON.stringify(head), ...all.flatMap((one) => ["\n", one.lines()])]));
  const data = (id: string, text: string): string => `<script type="text/plain" id="${id}">${text}</script>\n`;
  return new Blob([
    '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n',
    '<meta name="viewport" content="width=device-width, initial-scale=1">\n<meta name="color-scheme" content="light dark">\n',
    `<meta http-equiv="Content-Security-Policy" content="${POLICY}">\n`,
    `<title>${escaped(name)} – cylindroid</title>\n<style>${styles}</style>\n</head>\n<body>\n<div id="app"></div>\n`,
    data(RECORDING, states), data(BODIES, await packed(bodies)),
    `<script>${inScript(script ?? "")}</script>\n</body>\n</html>\n`,
  ], { type: "text/html" });
}

async function part(name: string): Promise<string> {
  const answer = await fetch(`./${name}`);
  if (!answer.ok) throw new Error(`the server has no ${name}`);
  return answer.text();
}

function escaped(text: string): string {
  return text.replaceAll("&", "&amp;").replaceAll("<", "&lt;").replaceAll('"', "&quot;");
}

/** Words that would end the script, or hide its end, are parts of strings, in which a letter may be a number. */
function inScript(code: string): string {
  return code.replace(/<(?=\/script|!--|script)/gi, "\\x3c");
}
