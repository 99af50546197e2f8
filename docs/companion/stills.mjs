// Draws the stills of the diagrams, for print and for readers without scripts: node docs/companion/stills.mjs
import { readFileSync, writeFileSync } from "node:fs";

// The page is no package, so node would not take the file for a module.
const script = readFileSync(new URL("../../companion/assets/diagrams.js", import.meta.url));
const { diagrams } = await import(`data:text/javascript;base64,${script.toString("base64")}`);
for (const [name, { title, size, state, draw }] of Object.entries(diagrams)) {
  const [shapes, reading] = draw(state);
  const escaped = reading.replaceAll("<", "&lt;");
  const head = `<svg xmlns="http://www.w3.org/2000/svg" class="drawn" viewBox="0 0 ${size.join(" ")}" role="img" aria-labelledby="${name}-title ${name}-desc">`;
  const text = `${head}\n<title id="${name}-title">${title}</title>\n<desc id="${name}-desc">${escaped}</desc>\n<g>${shapes}</g>\n</svg>\n`;
  writeFileSync(new URL(`diagrams/${name}.svg`, import.meta.url), text);
}
