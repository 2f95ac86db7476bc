/* The elements that an explorer consists of: those of parts.html, and those made for a robot. */

let mounted = 0; // figures so far; each has ids of its own

/** A prefix for the ids of one more figure.
 * @type {() => string} */
function newPrefix() {
  mounted += 1;
  return `play-${mounted}-`;
}

/** An element of the page.
 * @template {keyof HTMLElementTagNameMap} K
 * @param {K} name
 * @param {Partial<HTMLElementTagNameMap[K]>} properties
 * @param {...(Node | string)} children
 * @returns {HTMLElementTagNameMap[K]} */
function element(name, properties, ...children) {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...children);
  return made;
}

/** A value with its name, a slider and a field. An angle may go on beyond the slider's ends, other
    values stop there. Where there are `places`, the slider counts them.
 * @type {(value: ValueRow, change: (value: number) => void) => SetRow} */
function valueRow({ name, spoken, low, high, step, digits, unit, places }, change) {
  const limits = { min: String(low), max: String(high) };
  const reach = places ? { min: "0", max: String(places.length - 1) } : limits;
  const slide = element("input", { type: "range", ...reach, step: String(places ? 1 : step) });
  const field = element("input", { type: "number", ...limits, step: "any" });
  slide.ariaLabel = spoken;
  field.ariaLabel = `${spoken}, as a number`;
  let [shown, timer] = ["", 0];
  let typed = false; // what a reader types stays as it is typed, until the hand rests
  const showValue = () => {
    field.value = shown;
  };
  for (const input of [slide, field]) {
    input.addEventListener("input", () => {
      const value = places && input === slide ? places[Number(input.value)] : Number(input.value);
      if (input.value === "" || !Number.isFinite(value)) return;
      typed = input === field;
      change(unit === "°" ? value : between(value, low, high));
      typed = false;
      window.clearTimeout(timer);
      timer = window.setTimeout(showValue, 1500);
    });
  }
  for (const end of ["blur", "change"]) field.addEventListener(end, showValue);
  const box = element("span", { className: "unit" }, field, unit);
  return {
    row: element("div", { className: "slider" }, element("span", {}, name), slide, box),
    slide,
    field,
    set(value) {
      shown = String(Number(value.toFixed(digits)));
      slide.value = String(places?.indexOf(value) ?? value);
      if (!typed) field.value = shown;
    },
  };
}

/** Put a copy of the explorer's parts into an element; sections that no one asked for stay outside
    of the page and are updated there, so that no script has to ask which there are.
 * @type {(root: Element, prefix: string, shows: (control: string) => boolean) => Map<string, Element>} */
function addParts(root, prefix, shows) {
  const { body } = new DOMParser().parseFromString(MARKUP, "text/html");
  const parts = new Map([...body.querySelectorAll("[id]")].map((part) => [part.id, part]));
  for (const name of ["id", "for", "aria-labelledby", "aria-describedby"])
    for (const part of body.querySelectorAll(`[${name}]`))
      part.setAttribute(name, `${prefix}${part.getAttribute(name)}`);
  for (const part of body.querySelectorAll("[data-control]"))
    if (!shows(part.getAttribute("data-control") ?? "")) part.remove();
  const side = body.querySelector(".side");
  if (side?.childElementCount === 0) side.remove();
  root.append(...body.children);
  return parts;
}
