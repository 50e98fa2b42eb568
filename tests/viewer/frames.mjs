// What a page costs while it plays:  node frames.mjs PAGE.html [SECONDS]
// Time between frames, time in scripts, and counts of what is drawn and changed in a frame. VIEWER_MODULES is a folder
// with packages. Software draws WebGL here, so that time between frames is the worst there is.
import { resolve } from "node:path";
import { countFrames, openPage, withBrowser } from "./browser.mjs";

const [file, seconds = "4"] = process.argv.slice(2);
await withBrowser(async (browser) => {
  const { page } = await openPage(browser, resolve(file), "pause", { frames: true });
  const found = await countFrames(page, 1000 * Number(seconds));
  const middle = (values) => [...values].sort((a, b) => a - b)[Math.floor(values.length / 2)];
  const most = (values) => Math.max(...values);
  console.log(
    `${found.frames} frames; between them ${middle(found.gaps).toFixed(1)} ms; in scripts ` +
      `${middle(found.scripts).toFixed(2)} ms, at most ${most(found.scripts).toFixed(2)} ms; at most ` +
      `${most(found.calls)} calls of canvases and ${most(found.changes)} changes of the page`,
  );
});
