"use strict";
// What every chapter loads: where Python lies beside the book, the scripts that run the page's cells;
// else a line at its foot that says how to have it.

{
  const here = document.currentScript;
  const foot = document.querySelector(".notebook-line");
  if (window.rerunFiles && here instanceof HTMLScriptElement) {
    for (const name of ["rerun-engine.js", "rerun-output.js", "rerun.js"]) {
      const script = document.createElement("script");
      script.src = new URL(name, here.src).href;
      script.async = false; // they run in this order
      document.head.append(script);
    }
  } else if (foot) {
    const how = document.createElement("code");
    how.textContent = "python3 run.py live";
    const rest = " a copy of this book runs its chapters inside their pages, without a network.";
    foot.append(" With ", how, rest);
  }
}
