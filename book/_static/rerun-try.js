"use strict";
// Try an arm in the page: the text of a robot file, its errors with their line, its explorer.

(() => {
  const { Desk, known, bytesOf, megabytes } = rerunEngine;
  const FIRST = `schema = 1
name = "My arm on my table"
length_unit = "m"
angle_unit = "deg"
home = { shoulder = 100, elbow = -60 }
tool = "tip"
collisions = "all"                      # whole links keep clear of every obstacle, and of each other
allowed = [["upper arm", "forearm"]]    # but for these, which share the elbow
joint = [{ name = "shoulder", type = "revolute", parent = "table", frame = "upper arm", origin = [0, 0, 0], axis = [0, 0, 1] },
         { name = "elbow", type = "revolute", parent = "upper arm", frame = "forearm", origin = [0.4, 0, 0], axis = [0, 0, 1] }]
point = [{ name = "tip", frame = "forearm", at = [0.35, 0, 0] }]
body = [{ frame = "upper arm", capsule = { from = [0, 0], to = [0.4, 0], radius = 0.04 } },
        { frame = "forearm", capsule = { from = [0, 0], to = [0.35, 0], radius = 0.03 } }]
obstacle = [{ name = "post", disc = { at = [0.5, 0.25], radius = 0.06 } },
            { name = "box", polygon = [[0.3, -0.5], [0.6, -0.5], [0.6, -0.3], [0.3, -0.3]] }]
`;
  const LONGEST = 100_000; // letters of a robot file
  const PARTS = ["engine", "base", "library"];

  /** @param {string} id @returns {any} */
  const by = (id) => document.getElementById(id);
  by(known() ? "desk" : "none").hidden = false;
  if (!known()) return;

  const text = /** @type {HTMLTextAreaElement} */ (by("text"));
  const frame = /** @type {HTMLIFrameElement} */ (by("shown"));

  /** @param {string} words @param {string} kind */
  function say(words, kind = "") {
    by("said").textContent = words;
    by("said").dataset.kind = kind;
    for (const id of ["stop", "progress"]) by(id).hidden = kind !== "busy";
    for (const id of ["run", "reset", "open"]) by(id).disabled = kind === "busy";
  }
  const make = "import try_desk; try_desk.Desk()";
  const desk = new Desk("../", PARTS, ["try_desk.py"], make, by("progress"), (words, isBusy) =>
    say(words, isBusy ? "busy" : "bad"),
  );

  async function run() {
    if (text.value.length > LONGEST) throw new Error("the robot file is too long");
    const python = await desk.ready();
    say("Computing the region …", "busy");
    by("progress").removeAttribute("value");
    show(await python.call("region", text.value));
  }

  /** @param {{error?: string, line?: number, page?: string, parts?: number, seconds?: number}} answer */
  function show({ error, line, page, parts, seconds }) {
    if (error) {
      say(line && !/\bline \d/.test(error) ? `Line ${line}: ${error}` : error, "bad");
      if (line) select(line);
      return;
    }
    frame.srcdoc = page ?? ""; // its own content policy holds there, in a frame without an origin
    frame.hidden = false;
    const told = parts === 1 ? "1 connected set" : `${parts} connected sets`;
    say(`${told} of feasible poses, computed in ${seconds} s.`, "good");
  }

  /** Select a line of the text. @param {number} line from 1 */
  function select(line) {
    const lines = text.value.split("\n");
    const start = lines.slice(0, line - 1).reduce((sum, each) => sum + each.length + 1, 0);
    text.focus();
    text.setSelectionRange(start, start + (lines[line - 1] ?? "").length);
  }

  // The text in the address: what is behind # is never sent to a server.
  const address = () => `${location.href.split("#")[0]}#${encodeURIComponent(text.value)}`;
  function fromAddress() {
    try {
      const given = decodeURIComponent(location.hash.slice(1));
      text.value = given.length > 20 && given.length <= LONGEST ? given : FIRST;
    } catch {
      text.value = FIRST;
    }
  }

  async function copyLink() {
    history.replaceState(null, "", address());
    try {
      await navigator.clipboard.writeText(address());
      say("The link is copied: it holds the whole robot file.");
    } catch {
      say(
        "The address of this frame now holds the whole robot file; open the desk in a tab of its own to copy it.",
      );
    }
  }

  function save() {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([text.value], { type: "application/toml" }));
    link.download = "arm.toml";
    link.click();
    URL.revokeObjectURL(link.href);
  }

  window.addEventListener("message", ({ data, source }) => {
    if (source !== frame.contentWindow || !Number.isFinite(data?.explorerHeight)) return;
    frame.height = String(Math.ceil(Math.min(data.explorerHeight, 5000)));
    frame.contentWindow?.postMessage({ theme: document.documentElement.className }, "*");
  });
  by("run").addEventListener("click", () => void desk.guarded(run));
  by("stop").addEventListener("click", () => desk.end());
  by("save").addEventListener("click", save);
  by("link").addEventListener("click", () => void copyLink());
  by("reset").addEventListener("click", () => {
    text.value = FIRST;
    frame.hidden = true;
    history.replaceState(null, "", location.href.split("#")[0]);
  });
  by("open").addEventListener("change", async () => {
    const file = by("open").files[0];
    if (file && file.size <= LONGEST) text.value = await file.text();
    else if (file) say(`${file.name} is too long for a robot file`, "bad");
    by("open").value = "";
  });
  fromAddress();
  say(
    `Python runs inside this page; about ${megabytes(bytesOf(PARTS))} are read at the first click. Nothing leaves the page.`,
  );
})();
