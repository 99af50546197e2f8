// Draws the stills of the diagrams, for print and for readers without scripts: node docs/companion/stills.mjs
import { readFileSync, writeFileSync } from "node:fs";
import { pathToFileURL } from "node:url";

// The page is no package, so node would not take the file for a module.
const assets = new URL("../../companion/assets/diagrams/", import.meta.url);
const script = ["kit", "chapters-1-to-7", "chapters-8-to-10", "chapters-11-to-14", "chapters-a-to-g"].map((name) => readFileSync(new URL(`${name}.js`, assets), "utf8")).join("");
const { diagrams } = await import(`data:text/javascript;base64,${Buffer.from(script).toString("base64")}`);
// Another folder as an argument, for a comparison.
const folder = process.argv[2] ? pathToFileURL(`${process.argv[2]}/`) : new URL("diagrams/", import.meta.url);
for (const [name, { title, size, state, isRandom, draw }] of Object.entries(diagrams)) {
  const [shapes, reading] = draw(state);
  const escaped = reading.replaceAll("<", "&lt;");
  const head = `<svg xmlns="http://www.w3.org/2000/svg" class="drawn"${isRandom ? " data-random" : ""} viewBox="0 0 ${size.join(" ")}" role="img" aria-labelledby="${name}-title ${name}-desc">`;
  const text = `${head}\n<title id="${name}-title">${title}</title>\n<desc id="${name}-desc">${escaped}</desc>\n<g>${shapes}</g>\n</svg>\n`;
  writeFileSync(new URL(`${name}.svg`, folder), text);
}
