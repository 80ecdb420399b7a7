// Serve the page: node serve.mjs [PORT]. tribo and three are looked for in node_modules, from here upwards.
import { readFile } from "node:fs/promises";
import { createServer } from "node:http";
import { extname, join, normalize, resolve } from "node:path";
import { fileURLToPath } from "node:url";

const here = fileURLToPath(new URL(".", import.meta.url));
const TYPES = { ".html": "text/html", ".js": "text/javascript", ".mjs": "text/javascript", ".wasm": "application/wasm" };

/** A file of the page, or of one of the packages. */
async function find(path, packages) {
  const name = normalize(path).replace(/^\/+/, "") || "index.html";
  const [first, ...rest] = name.split("/");
  const folders = { tribo: packages, three: packages }[first] ?? [here];
  for (const folder of folders) {
    try {
      return await readFile(folder === here ? join(here, name) : join(folder, first, ...rest));
    } catch (error) {
      if (error.code !== "ENOENT" && error.code !== "EISDIR") {
        throw error;
      }
    }
  }
  return undefined;
}

function upwards(from) {
  const parent = resolve(from, "..");
  return [join(from, "node_modules"), ...(parent === from ? [] : upwards(parent))];
}

/** A server of the page; more folders with packages may be named. */
export function serve(port, more = []) {
  const packages = [...upwards(here), ...more];
  const server = createServer(async (request, response) => {
    const { pathname } = new URL(request.url, "http://localhost");
    const body = await find(decodeURIComponent(pathname), packages);
    response.writeHead(body ? 200 : 404, { "content-type": TYPES[extname(pathname)] ?? "text/html" });
    response.end(body ?? "not found");
  });
  return new Promise((done) => server.listen(port, "127.0.0.1", () => done(server)));
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const server = await serve(Number(process.argv[2] ?? 8080));
  console.log(`http://localhost:${server.address().port}/`);
}
