"use strict";
// Check a certificate in the page: `check.py` itself runs, and what it says is shown as text.

(() => {
  const { Desk, known, bytesOf, megabytes } = rerunEngine;
  const VERDICTS = /** @type {Record<number, [string, string]>} */ ({
    0: ["Proved", "good"],
    3: ["Refuted", "good"],
    2: ["Not proved", "bad"],
  });
  const LARGEST = 8_000_000; // bytes; the checker itself takes 4,000,000 and says so
  const PARTS = ["engine"];

  /** @param {string} id @returns {any} */
  const by = (id) => document.getElementById(id);
  by(known() ? "desk" : "none").hidden = false;
  if (!known()) return;

  /** @param {string} text @param {boolean} isBusy */
  function say(text, isBusy = false) {
    by("said").textContent = text;
    for (const id of ["stop", "progress"]) by(id).hidden = !isBusy;
  }
  const modules = ["check.py", "check_desk.py"];
  const make = "import check_desk; check_desk.Desk()";
  const desk = new Desk("../", PARTS, modules, make, by("progress"), say);

  /** Have the checker, and show its text once. */
  async function ready() {
    const python = await desk.ready();
    if (by("text").hidden) {
      const about = await python.call("about");
      by("hash").textContent = about.sha256;
      by("text").textContent = about.text;
      by("text").hidden = false;
      by("read").hidden = true;
    }
    return python;
  }

  /** @param {File} certificate */
  async function check(certificate) {
    by("answer").hidden = true;
    const robot = by("robot").files[0];
    for (const file of [certificate, ...(robot ? [robot] : [])]) {
      if (file.size > LARGEST)
        throw new Error(`${file.name} is larger than any certificate or robot file`);
    }
    const python = await ready();
    say("Checking …", true);
    by("progress").removeAttribute("value");
    const modules = {
      certificate: new Uint8Array(await certificate.arrayBuffer()),
      robot: new Uint8Array(),
    };
    if (robot) modules.robot = new Uint8Array(await robot.arrayBuffer());
    await python.ask({ action: "open", modules });
    show(certificate, await python.call("check", "certificate", robot ? "robot" : ""));
  }

  /** @param {File} file @param {{status: number, said: string, seconds: number}} answer */
  function show(file, { status, said, seconds }) {
    const [verdict, kind] = VERDICTS[status] ?? ["No answer", "bad"];
    by("verdict").textContent = verdict;
    by("answer").dataset.kind = kind;
    by("about").textContent =
      `${file.name}, ${file.size.toLocaleString("en")} bytes, checked in ${seconds} s`;
    by("words").textContent = said;
    by("answer").hidden = false;
    say("Drop another file to check it.");
  }

  const drop = by("drop");
  for (const name of ["dragover", "drop"]) {
    document.addEventListener(name, (event) => event.preventDefault());
  }
  document.addEventListener("dragover", () => drop.classList.add("over"));
  document.addEventListener("dragleave", () => drop.classList.remove("over"));
  document.addEventListener("drop", (event) => {
    drop.classList.remove("over");
    const file = event.dataTransfer?.files[0];
    if (file) void desk.guarded(() => check(file));
  });
  by("certificate").addEventListener("change", () => {
    const file = by("certificate").files[0];
    if (file) void desk.guarded(() => check(file));
    by("certificate").value = "";
  });
  by("stop").addEventListener("click", () => desk.end());
  by("read").addEventListener("click", () => {
    void desk.guarded(async () => {
      await ready();
      invite();
    });
  });
  const invite = () =>
    say(
      `Nothing leaves this page. Python (${megabytes(bytesOf(PARTS))}) is read when the first file comes.`,
    );
  invite();
})();
