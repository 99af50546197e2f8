// Runs the program for browsers with the page's own host, on files of this directory.
//   node tests/cross/program.mjs target/cross/check.js ARGUMENTS...
import { existsSync, lstatSync, mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { dirname } from "node:path";
import { runInThisContext } from "node:vm";
import { gunzipSync } from "node:zlib";

const [script, ...args] = process.argv.slice(2);
runInThisContext(readFileSync(script, "utf8"));
const { host, module } = globalThis.weekenderProgram;
const named = args.filter((path) => existsSync(path) && lstatSync(path).isFile());
const files = Object.fromEntries(named.map((path) => [path, new Uint8Array(readFileSync(path))]));
const result = host(new WebAssembly.Module(gunzipSync(Buffer.from(module, "base64"))), args, files, (line) => console.error(line));
process.stdout.write(result.output);
for (const [path, data] of Object.entries(result.files)) {
  if (path.split("/").pop().startsWith(".")) continue;
  mkdirSync(dirname(path), { recursive: true });
  writeFileSync(path, data);
}
process.exitCode = result.code;
