"use strict";
// Python in a worker of the page: reads the files beside the book, starts, calls, stops.

const rerunEngine = (() => {
  const handed = /** @type {Map<string, (text: string) => void>} */ (new Map());

  /** Take what the script of a file hands over. @param {string} name @param {string} text */
  function take(name, text) {
    handed.get(name)?.(text);
    handed.delete(name);
  }

  /** What the book has, if anything; a file is a script that hands over base64 of gzip. */
  const known = () => window.rerunFiles ?? null;

  /** @param {string[]} parts */
  const filesOf = (parts) => (known()?.files ?? []).filter((file) => parts.includes(file.part));

  /** Bytes that are read for some parts. @param {string[]} parts */
  const bytesOf = (parts) => filesOf(parts).reduce((sum, file) => sum + file.bytes, 0);

  /**
   * Read one file by its script.
   * @param {LiveFile} file
   * @param {string} root address of the book's root, as this page says it
   * @returns {Promise<ArrayBuffer>}
   */
  async function read(file, root) {
    const text = await new Promise((resolve, reject) => {
      const script = document.createElement("script");
      handed.set(file.name, resolve);
      script.src = `${root}${known()?.folder}/${file.script}`;
      script.onload = () => script.remove();
      script.onerror = () => reject(new Error(`${file.script} cannot be read`));
      document.head.append(script);
    });
    return unpacked(/** @type {string} */ (text));
  }

  /**
   * Read one file that is text.
   * @param {string} name @param {string} root as above
   */
  async function textOf(name, root) {
    const file = known()?.files.find((one) => one.name === name);
    if (!file) throw new Error(`${name} is missing`);
    return new TextDecoder().decode(await read(file, root));
  }

  /** @param {string} text base64 of gzip */
  async function unpacked(text) {
    const binary = atob(text);
    const bytes = new Uint8Array(binary.length);
    for (let k = 0; k < binary.length; k++) bytes[k] = binary.charCodeAt(k);
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
    return new Response(stream).arrayBuffer();
  }

  /** One Python, from its start to its end. */
  class Engine {
    /** @param {string} root */
    constructor(root) {
      this.root = root;
      this.next = 0;
      this.waiting = /** @type {Map<number, {resolve: Function, reject: Function}>} */ (new Map());
      this.worker = /** @type {Worker | null} */ (null);
      this.had = /** @type {Set<string>} */ (new Set());
    }

    /**
     * Read the files of some parts, start Python with them, and unpack the packages among them.
     * @param {string[]} parts
     * @param {(done: number, whole: number) => void} progress in bytes
     */
    async load(parts, progress) {
      const files = filesOf(parts).filter((file) => !this.had.has(file.name));
      const whole = files.reduce((sum, file) => sum + file.bytes, 0);
      const engine = /** @type {Record<string, ArrayBuffer>} */ ({});
      const archives = /** @type {Record<string, ArrayBuffer>} */ ({});
      let done = 0;
      progress(done, whole);
      for (const file of files) {
        (file.part === "engine" ? engine : archives)[file.name] = await read(file, this.root);
        this.had.add(file.name);
        done += file.bytes;
        progress(done, whole);
        if (this.stopped) throw new Error("stopped");
      }
      if (!this.worker) {
        const text = new TextDecoder().decode(engine["worker.js"]);
        delete engine["worker.js"];
        this.begin(text);
        await this.ask({ action: "start", files: engine }, Object.values(engine));
      }
      if (Object.keys(archives).length) {
        await this.ask({ action: "unpack", archives }, Object.values(archives));
      }
    }

    /** @param {string} text of the worker */
    begin(text) {
      const address = URL.createObjectURL(new Blob([text], { type: "text/javascript" }));
      this.worker = new Worker(address);
      this.worker.onmessage = ({ data }) => {
        const waiting = this.waiting.get(data.id);
        this.waiting.delete(data.id);
        if ("failed" in data) waiting?.reject(new Error(data.failed));
        else waiting?.resolve(data);
      };
      this.worker.onerror = (event) => this.end(event.message || "the worker does not start");
    }

    /**
     * @param {object} message
     * @param {ArrayBuffer[]} handed
     * @returns {Promise<any>}
     */
    ask(message, handed = []) {
      const id = this.next++;
      return new Promise((resolve, reject) => {
        if (!this.worker) return reject(new Error("stopped"));
        this.waiting.set(id, { resolve, reject });
        this.worker.postMessage({ id, ...message }, handed);
      });
    }

    /** @param {string} method @param {...(string | number)} values */
    async call(method, ...values) {
      return (await this.ask({ action: "call", method, values })).answer;
    }

    /** End Python, whatever it does. @param {string} why */
    end(why = "stopped") {
      this.stopped = true;
      this.worker?.terminate();
      this.worker = null;
      for (const { reject } of this.waiting.values()) reject(new Error(why));
      this.waiting.clear();
    }
  }

  window.rerunTake = take;
  return { Engine, known, bytesOf, textOf };
})();
