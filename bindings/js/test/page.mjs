// The page in headless Chromium: it runs, the sliders act, numbers stay sane; keeps a screenshot. Prints a line with
// "# SKIP" where there is no Chromium.
import assert from "node:assert/strict";
import { existsSync } from "node:fs";
import { createRequire } from "node:module";
import { serve } from "../demo/serve.mjs";

const tools = process.env.TRIBO_TOOLS;
const browserPath = ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"].find(existsSync);
if (!browserPath) {
  console.log(" # SKIP no Chromium (Debian: chromium)");
  process.exit(0);
}
const { chromium } = createRequire(`${tools}/`)("playwright-core");
const server = await serve(0, [tools]);
const browser = await chromium.launch({ executablePath: browserPath, args: ["--no-sandbox", "--use-gl=angle",
  "--use-angle=swiftshader", "--enable-unsafe-swiftshader"] });
try {
  const page = await browser.newPage({ viewport: { width: 900, height: 720 } });
  page.setDefaultTimeout(180000); // it draws without a graphics card, maybe on a busy machine
  const faults = [];
  page.on("pageerror", (error) => faults.push(String(error)));
  page.on("console", (message) => message.type() === "error" && faults.push(message.text()));
  page.on("response", (response) => response.status() >= 400 && faults.push(response.url()));
  await page.goto(`http://127.0.0.1:${server.address().port}/`);
  const time = () => page.$eval("#note", (note) => Number(/t = ([\d.]+)/.exec(note.textContent)?.[1] ?? 0));
  const value = (id) => page.$eval(`#${id}`, (output) => parseFloat(output.value));
  const until = (seconds) => page.waitForFunction((least) =>
    Number(/t = ([\d.]+)/.exec(document.getElementById("note").textContent)?.[1] ?? 0) >= least, seconds);
  const set = (id, to) => page.$eval(`#${id}`, (control, x) => {
    control.value = x;
    control.dispatchEvent(new Event("input"));
    control.dispatchEvent(new Event("change"));
  }, to);

  await until(0.1);
  const before = await value("energy");
  await until(0.8);
  assert.ok((await value("energy")) < before, "friction and impacts take energy");
  assert.ok((await value("η")) < 1e-6, "solves are certified");
  const pause = () => page.$eval("#pause", (button) => button.click());
  await pause(); // a screenshot waits for the page to be idle
  await page.screenshot({ path: process.env.TRIBO_SHOT });
  await pause();

  // On the slope, tan 0.45 = 0.48: with more friction than that all stays, with less it slides.
  await set("scene", "slope");
  await set("mu", "1.2");
  await until(0.6);
  assert.ok((await value("kinetic")) < 1e-3, "sticks");
  await set("mu", "0.1");
  await until(0.4);
  assert.ok((await value("kinetic")) > 1, "slides");

  for (const solver of ["1", "2"]) {
    await set("solver", solver);
    await set("tolerance", "-6");
    await set("scene", "heap");
    await until(0.2);
  }
  const now = await time();
  await pause();
  assert.deepEqual(faults, []);
  console.log(`ran to ${now} s; energy ${await value("energy")} J`);
} finally {
  await browser.close();
  server.close();
}
