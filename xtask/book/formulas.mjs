// Renders formulas: a JSON line {tex, display} in, a JSON line {html} or {error} out.
import { createRequire } from "node:module";
import { createInterface } from "node:readline";

const katex = createRequire(`${process.argv[2]}/`)("katex");
const macros = {
  "\\T": "^{\\mathsf T}",
  "\\R": "\\mathbb{R}",
  "\\rank": "\\operatorname{rank}",
  "\\diag": "\\operatorname{diag}",
  "\\tr": "\\operatorname{tr}",
  "\\Ad": "\\operatorname{Ad}",
};

for await (const line of createInterface({ input: process.stdin })) {
  const { tex, display } = JSON.parse(line);
  let answer;
  try {
    const options = { displayMode: display, throwOnError: true, strict: "error", macros: { ...macros } };
    answer = { html: katex.renderToString(tex, options) };
  } catch (error) {
    answer = { error: error.message };
  }
  process.stdout.write(`${JSON.stringify(answer)}\n`);
}
