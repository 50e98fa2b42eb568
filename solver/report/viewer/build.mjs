// Bundles scripts, style and packages into the text of a page, as C++ source.
//   node build.mjs NODE_MODULES PAGE_TEMPLATE.cpp
import { createRequire } from "node:module";
import { readFileSync, writeFileSync } from "node:fs";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const modules = resolve(process.argv[2]);
const { build } = createRequire(join(modules, "x.js"))("esbuild");

async function bundled(file) {
  const result = await build({
    entryPoints: [join(here, file)],
    bundle: true,
    minify: true,
    write: false,
    format: "iife",
    target: "es2020",
    nodePaths: [modules],
    legalComments: "none",
    logLevel: "warning",
  });
  return result.outputFiles[0].text;
}

/** The licences of what is bundled, to stand in the page. */
function licences() {
  return ["three", "uplot"]
    .map((name) => {
      const { version } = JSON.parse(readFileSync(join(modules, name, "package.json"), "utf8"));
      return `${name} ${version}\n${readFileSync(join(modules, name, "LICENSE"), "utf8").trim()}`;
    })
    .join("\n\n")
    .replaceAll("--", "- -");
}

/** A C++ literal of any text; a raw one may not hold its own end. */
function literal(text) {
  const end = "page";
  if (text.includes(`)${end}"`)) throw new Error("the text holds the end of its literal");
  const size = 12000; // compilers promise 65536 bytes
  const pieces = [];
  for (let k = 0; k < text.length; k += size) pieces.push(`R"${end}(${text.slice(k, k + size)})${end}"`);
  return pieces.join("\n");
}

const script = (await bundled("main.js")).replaceAll("</script", "<\\/script");
const style = await bundled("page.css");
const parts = readFileSync(join(here, "page.html"), "utf8")
  .split(/(\{\{\w+\}\})/)
  .map((part) => ({ "{{licences}}": licences(), "{{style}}": style, "{{script}}": script })[part] ?? part)
  .join("")
  .split(/\{\{(?:title|data)\}\}/);
if (parts.length !== 3) throw new Error("page.html needs {{title}}, then {{data}}");

writeFileSync(
  process.argv[3],
  `#include "report/page_data.hpp"

namespace extremal {

PageTemplate page_template() {
  return {${parts.map(literal).join(",\n")}, ""};
}

}  // namespace extremal
`,
);
