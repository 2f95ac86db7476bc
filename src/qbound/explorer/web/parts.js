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
