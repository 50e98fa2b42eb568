// A picture of a page:  node screenshot.mjs PAGE.html PICTURE.png [HASH] [WIDTH] [HEIGHT]
// The hash is as in #solution=2&time=0.4&view=1&theme=dark&pause. VIEWER_MODULES is a folder with packages.
import { resolve } from "node:path";
import { openPage, withBrowser } from "./browser.mjs";

const [file, picture, hash = "pause", width = "1360", height = "900"] = process.argv.slice(2);
const viewport = { width: Number(width), height: Number(height) };
await withBrowser(
  async (browser) => {
    const { page, complaints } = await openPage(browser, resolve(file), hash);
    await page.waitForTimeout(300);
    await page.screenshot({ path: picture, fullPage: process.env.FULL_PAGE === "1" });
    for (const complaint of complaints) console.error(complaint);
  },
  { context: { viewport } },
);
