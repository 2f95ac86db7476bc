"use strict";
// Python in a worker of the page: reads the files beside the book, starts, calls, stops.

const rerunEngine = (() => {
  const STOPPED = "stopped";
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

  /** @param {number} bytes */
  const megabytes = (bytes) => `${(bytes / 1e6).toFixed(bytes < 1e6 ? 1 : 0)} MB`;

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
      this.had = /** @type {Set<LiveFile>} */ (new Set());
      this.reject = /** @type {(why: Error) => void} */ (() => undefined);
      this.ended = /** @type {Promise<never>} */ (
        new Promise((_, reject) => {
          this.reject = reject;
        })
      );
      this.ended.catch(() => undefined); // who waits is told; nobody else has to be
    }

    /**
     * Read the files of some parts, start Python with them, and unpack the packages among them.
     * @param {string[]} parts
     * @param {(done: number, whole: number) => void} progress in bytes
     * @returns {Promise<boolean>} whether any file was still to be read
     */
    async load(parts, progress) {
      const files = filesOf(parts).filter((file) => !this.had.has(file));
      const whole = files.reduce((sum, file) => sum + file.bytes, 0);
      const engine = /** @type {Record<string, ArrayBuffer>} */ ({});
      const archives = /** @type {Record<string, ArrayBuffer>} */ ({});
      let done = 0;
      if (whole) progress(done, whole);
      for (const file of files) {
        const content = await Promise.race([read(file, this.root), this.ended]);
        (file.part === "engine" ? engine : archives)[file.name] = content;
        this.had.add(file);
        done += file.bytes;
        progress(done, whole);
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
      return whole > 0;
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
      const answer = new Promise((resolve, reject) => {
        this.waiting.set(id, { resolve, reject });
        this.worker?.postMessage({ id, ...message }, handed);
      });
      return Promise.race([answer, this.ended]);
    }

    /** @param {string} method @param {...(string | number)} values */
    async call(method, ...values) {
      return (await this.ask({ action: "call", method, values })).answer;
    }

    /** End Python, whatever it does. @param {string} why */
    end(why = STOPPED) {
      this.worker?.terminate();
      this.reject(new Error(why));
    }
  }

  /** Python behind buttons: it starts when it is first needed, and one action runs at a time. */
  class Desk {
    /**
     * @param {string} root address of the book's root, as this page says it
     * @param {string[]} parts that are read before Python starts
     * @param {string[]} modules files that Python imports
     * @param {string} make code whose value answers the calls
     * @param {HTMLProgressElement} progress
     * @param {(text: string, busy: boolean) => void} say
     */
    constructor(root, parts, modules, make, progress, say) {
      this.root = root;
      this.parts = parts;
      this.modules = modules;
      this.make = make;
      this.progress = progress;
      this.say = say;
      this.engine = /** @type {Engine | null} */ (null);
      this.busy = false;
      this.reject = /** @type {(why: Error) => void} */ (() => undefined);
      this.ended = /** @type {Promise<never>} */ (new Promise(() => undefined));
    }

    /** Read one file that is text, unless the action is ended. @param {string} name */
    text(name) {
      return Promise.race([textOf(name, this.root), this.ended]);
    }

    /** Start Python, unless it runs. */
    async ready() {
      if (this.engine) return this.engine;
      const made = new Engine(this.root);
      this.engine = made;
      await made.load(this.parts, (done, whole) => this.reading(done, whole));
      const modules = /** @type {Record<string, string>} */ ({});
      for (const name of this.modules) modules[name] = await this.text(name);
      await made.ask({ action: "open", modules, make: this.make });
      return made;
    }

    /** Show how much is read. @param {number} done @param {number} whole */
    reading(done, whole) {
      Object.assign(this.progress, { max: whole, value: done });
      const read = `Reading ${megabytes(done)} of ${megabytes(whole)} …`;
      this.say(done < whole ? read : "Starting Python …", true);
    }

    /** Run an action, unless one runs; say why it fails. @param {() => Promise<void>} action */
    async guarded(action) {
      if (this.busy) return;
      this.busy = true;
      this.ended = /** @type {Promise<never>} */ (
        new Promise((_, reject) => {
          this.reject = reject;
        })
      );
      this.ended.catch(() => undefined); // who waits is told, also before there is an engine
      try {
        await action();
      } catch (error) {
        const what = /** @type {Error} */ (error).message;
        this.end();
        this.say(
          what === STOPPED ? "Stopped. The next run begins anew." : `Failed: ${what}`,
          false,
        );
      } finally {
        this.busy = false;
      }
    }

    end() {
      this.reject(new Error(STOPPED));
      this.engine?.end();
      this.engine = null;
    }
  }

  window.rerunTake = take;
  return { Desk, known, bytesOf, megabytes };
})();
