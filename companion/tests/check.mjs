// Drops pictures on the companion as a reader would and prints what it answers as JSON: see src/tests/check.rs.
// Usage: node check.mjs FOLDER_OF_PAGE PICTURE...
import { once } from "node:events";
import { existsSync, readFileSync } from "node:fs";
import { createServer } from "node:http";
import { basename, delimiter, join } from "node:path";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

const executablePath = process.env.PATH.split(delimiter).map((path) => join(path, "chromium")).find(existsSync);
const browser = await chromium.launch({ executablePath, args: ["--no-sandbox", "--headless=new"] });
setTimeout(() => process.exit(1), 540_000).unref();
const [folder, ...pictures] = process.argv.slice(2);
const seen = { console: [], answers: {}, faults: [] };
const expect = (holds, what) => holds || seen.faults.push(what);

const open = async (url, options = {}) => {
  const page = await browser.newPage({ viewport: { width: 1280, height: 900 }, ...options });
  page.on("console", (message) => message.type() === "error" && seen.console.push(message.text()));
  page.on("pageerror", (error) => seen.console.push(String(error)));
  await page.goto(url);
  return page;
};
const transfer = (page, path) => {
  const file = [basename(path), readFileSync(path).toString("base64")];
  return page.evaluateHandle(([name, data]) => {
    const all = new DataTransfer();
    all.items.add(new File([Uint8Array.from(atob(data), (letter) => letter.charCodeAt(0))], name));
    return all;
  }, file);
};
const drop = async (page, path, where) => page.locator(where).first().dispatchEvent("drop", { dataTransfer: await transfer(page, path) });
const answered = async (page) => {
  await page.locator(".check-verdict").waitFor({ timeout: 300_000 });
  return page.evaluate(async () => {
    const text = (selector) => document.querySelector(`.check ${selector}`)?.textContent ?? null;
    const images = [...document.querySelectorAll(".check-pictures img")];
    await Promise.all(images.map((image) => image.decode()));
    return {
      verdict: text(".check-verdict"), explanation: text(".check-verdict + p"), found: text("option"),
      code: [...document.querySelectorAll(".check-change code")].map((code) => code.textContent),
      sizes: images.map((image) => [image.naturalWidth, image.naturalHeight]),
      links: [...document.querySelectorAll(".check-links a")].map((link) => link.getAttribute("href")).filter((href) => href[0] !== "#" || document.getElementById(href.slice(1))),
      before: document.querySelector(".check").previousElementSibling.className,
    };
  });
};

// From a disk: every picture, one after the other, each dropped at another place.
const disk = pathToFileURL(join(folder, "index.html")).href;
const page = await open(disk);
const places = [".cover .check-box", "#figure-metal", ".chapter .check-box", ".colophon"];
for (const [index, path] of pictures.entries()) {
  await drop(page, path, places[index % places.length]);
  seen.answers[basename(path)] = await answered(page);
}

// A second one takes the place of the first, and Escape ends a check.
const [right, wrong] = pictures;
// The first would be answered sooner.
await drop(page, right, "#figure-metal");
await drop(page, wrong, ".cover .check-box");
expect((await answered(page)).verdict === seen.answers[basename(wrong)].verdict, "the second picture does not replace the first");
await drop(page, wrong, ".cover .check-box");
await page.locator(".check-tried").waitFor();
await page.keyboard.press("Escape");
expect((await page.locator(".check").count()) === 0, "Escape does not end the check");

// By the button, and by keys: the section is chosen, and the pictures are compared.
const [chooser] = await Promise.all([page.waitForEvent("filechooser"), page.getByRole("button", { name: "Choose a file" }).first().click()]);
await chooser.setFiles(right);
await answered(page);
const panel = page.locator(".check");
await panel.getByRole("button", { name: "Difference" }).click();
expect(await page.locator(".check-scale").isVisible(), "the difference has no scale");
await panel.getByRole("button", { name: "Wipe" }).click();
const seam = panel.getByRole("slider", { name: "Boundary between your picture and ours" });
await seam.press("Home");
expect((await page.locator(".check-pictures").evaluate((both) => both.style.getPropertyValue("--at"))) === "0%", "the wipe does not follow keys");
await panel.getByLabel("Section").selectOption("ppm-gradient");
await page.locator(".check-tried").waitFor();
seen.chosen = await answered(page);
for (const width of [400, 1280]) {
  await page.setViewportSize({ width, height: 900 });
  expect(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), `wider than ${width} pixels`);
}
await page.close();

// From a server, with a name of the kind that looks like a flag.
const server = createServer((request, response) => {
  const path = join(folder, new URL(request.url, "http://localhost").pathname);
  response.writeHead(existsSync(path) ? 200 : 404, { "content-type": path.endsWith(".html") ? "text/html" : path.endsWith(".js") ? "text/javascript" : "image/png" });
  response.end(existsSync(path) ? readFileSync(path) : undefined);
}).listen(0, "127.0.0.1");
await once(server, "listening");
const served = await open(`http://127.0.0.1:${server.address().port}/index.html`);
await drop(served, right, ".cover .check-box");
seen.served = (await answered(served)).verdict;
await served.getByRole("button", { name: "Close" }).click();
await served.evaluate((clipboardData) => document.body.dispatchEvent(new ClipboardEvent("paste", { clipboardData, bubbles: true })), await transfer(served, right));
expect((await answered(served)).verdict === seen.served, "a pasted picture has another verdict");

// Without SIMD, and without the program, it says so.
const lacks = {
  SIMD: () => served.evaluate(() => (WebAssembly.validate = () => false)),
  "check.js": () => served.route("**/check.js", (route) => route.fulfill({ status: 404 })),
};
for (const [what, remove] of Object.entries(lacks)) {
  await served.reload();
  await remove();
  await drop(served, right, ".cover .check-box");
  await served.locator(".check-bad").waitFor();
  expect((await served.locator(".check").textContent()).includes(what), `nothing is said of ${what}`);
}
seen.console = seen.console.filter((text) => !text.includes("404"));
server.close();

// Without scripts, there is nothing of it.
const plain = await open(disk, { javaScriptEnabled: false });
expect((await plain.locator(".check-box:visible").count()) === 0, "something is left without scripts");
console.log(JSON.stringify(seen));
await browser.close();
process.exit();
