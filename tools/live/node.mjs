// Pyodide in Node: run a job of Python with the files that a page has.
//     node node.mjs FILES JOB   (FILES: the folder of `fetch.py`; JOB: JSON from standard input or a file)
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { pathToFileURL } from "node:url";

const [folder, jobFile] = process.argv.slice(2);
const job = JSON.parse(readFileSync(jobFile, "utf8"));
const { loadPyodide } = await import(pathToFileURL(join(folder, "pyodide.mjs")).href);
const start = performance.now();
const python = await loadPyodide({ indexURL: folder + "/", env: job.env ?? {} });
for (const name of job.archives) {
  python.unpackArchive(new Uint8Array(readFileSync(name)), name.endsWith(".whl") ? "whl" : "zip", {
    extractDir: job.site,
  });
}
for (const [inside, outside] of Object.entries(job.mounts ?? {})) {
  python.FS.mkdirTree(inside);
  python.FS.mount(python.FS.filesystems.NODEFS, { root: outside }, inside);
}
python.globals.set("job_text", JSON.stringify(job));
const engine = (performance.now() - start) / 1000;
python.globals.set("engine_seconds", engine);
const status = await python.runPythonAsync(readFileSync(job.script, "utf8"));
process.exit(Number(status ?? 0));
