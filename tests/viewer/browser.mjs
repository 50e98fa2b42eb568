// Debian's Chromium, without anything of the network.
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { createRequire } from "node:module";

const { chromium } = createRequire(join(resolve(process.env.VIEWER_MODULES ?? "."), "x.js"))(
  "playwright-core",
);

const patience = 90000; // ms, on a machine that draws WebGL by its processor and has other work

const flags = [
  "--no-sandbox",
  "--disable-quic",
  "--no-first-run",
  "--disable-background-networking",
  "--disable-component-update",
  "--disable-sync",
  "--disable-domain-reliability",
  "--use-gl=angle",
  "--use-angle=swiftshader",
  "--enable-unsafe-swiftshader",
];

/** Calls `use` with a browser context that has a profile of its own. */
export async function withBrowser(use, options = {}) {
  const profile = mkdtempSync(join(tmpdir(), "viewer-"));
  const browser = await chromium.launchPersistentContext(profile, {
    executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
    headless: true,
    args: [...flags, ...(options.flags ?? [])],
    viewport: { width: 1360, height: 900 },
    ...options.context,
  });
  try {
    return await use(browser);
  } finally {
    await browser.close();
    rmSync(profile, { recursive: true, force: true });
  }
}

/** A page from disk, with what went wrong on it and what it asked of the network. */
export async function openPage(browser, file, hash = "") {
  const page = await browser.newPage();
  page.setDefaultTimeout(patience);
  const complaints = [],
    requests = [];
  page.on(
    "console",
    (message) => ["error", "warning"].includes(message.type()) && complaints.push(message.text()),
  );
  page.on("pageerror", (error) => complaints.push(String(error)));
  page.on("request", (request) => requests.push(request.url()));
  await page.goto(`file://${file}${hash && `#${hash}`}`);
  await page.waitForSelector("html[data-ready]", { timeout: patience });
  return { page, complaints, requests };
}
