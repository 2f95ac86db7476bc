"use strict";
// Python in a worker: starts Pyodide from files that the page hands over, and runs cells.
// A classic worker without importScripts, because a module worker does not start from file://.

const HOME = "/home/pyodide";

/** @type {any} */ let python;
/** @type {any} */ let desk;

/** @type {any} */ (self).importScripts = undefined; // Pyodide refuses a worker that has it

/** @param {ArrayBuffer} bytes @param {string} type */
const blobOf = (bytes, type) => URL.createObjectURL(new Blob([bytes], { type }));

const ACTIONS = {
  /**
   * Start Pyodide; no file comes from anywhere but `files`.
   * @param {{files: Record<string, ArrayBuffer>}} given
   */
  async start({ files }) {
    const types = { wasm: "application/wasm", zip: "application/zip" };
    self.fetch = async (address) => {
      const name = String(address).split("/").pop() ?? "";
      const type = types[/** @type {"wasm"} */ (name.split(".").pop())];
      if (!(name in files) || !type) throw new TypeError(`${name} is not among the page's files`);
      return new Response(files[name], { headers: { "Content-Type": type } });
    };
    const load = (/** @type {string} */ name) => import(blobOf(files[name], "text/javascript"));
    const { loadPyodide } = await load("pyodide.mjs");
    const { default: createPyodideModule } = await load("pyodide.asm.mjs");
    python = await loadPyodide({
      indexURL: "https://x.invalid/", // never asked: `fetch` above answers
      lockFileContents: new TextDecoder().decode(files["pyodide-lock.json"]),
      createPyodideModule,
      env: { MPLBACKEND: "agg", HOME },
    });
    python.runPython(`import os, sys; os.chdir("${HOME}"); sys.path.insert(0, "${HOME}")`);
    return {};
  },

  /**
   * Unpack wheels and archives beside Python's own packages.
   * @param {{archives: Record<string, ArrayBuffer>}} given
   */
  unpack({ archives }) {
    const site = python.runPython("import site; site.getsitepackages()[0]");
    for (const [name, bytes] of Object.entries(archives)) {
      python.unpackArchive(bytes, name.endsWith(".whl") ? "whl" : "zip", { extractDir: site });
    }
    python.runPython("import importlib; importlib.invalidate_caches()");
    return {};
  },

  /**
   * Write files into Python's home, and, where it is told, make what answers the calls.
   * @param {{modules: Record<string, string | Uint8Array>, make?: string}} given
   */
  open({ modules, make }) {
    for (const [name, content] of Object.entries(modules)) {
      python.FS.writeFile(`${HOME}/${name}`, content);
    }
    if (make) desk = python.runPython(make);
    return {};
  },

  /**
   * Call a method of what was opened with plain values; it answers with JSON.
   * @param {{method: string, values: (string | number)[]}} given
   */
  call({ method, values }) {
    return { answer: JSON.parse(desk[method](...values) ?? "null") };
  },
};

self.onmessage = async ({ data }) => {
  try {
    const action = ACTIONS[/** @type {keyof typeof ACTIONS} */ (data.action)];
    self.postMessage({ id: data.id, ...(await action(data)) });
  } catch (error) {
    const failed = String(/** @type {Error} */ (error).message ?? error);
    self.postMessage({ id: data.id, failed });
  }
};
