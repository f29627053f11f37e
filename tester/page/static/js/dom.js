// Nodes from data. Every text goes through textContent: on this page no text becomes markup.

const SVG = "http://www.w3.org/2000/svg";
let fields = 0;

/**
 * Make an element.
 * @param {string} tag
 * @param {Object<string, any>} [given] class, text, on* handlers, properties in `set`, everything else an attribute
 * @param {...(Node|string|null|undefined|false)} children texts become text nodes
 * @returns {HTMLElement}
 */
export function h(tag, given = {}, ...children) {
  return fill(document.createElement(tag), given, children);
}

/**
 * Make an SVG element.
 * @param {string} tag
 * @param {Object<string, any>} [given]
 * @param {...(Node|string)} children
 * @returns {SVGElement}
 */
export function s(tag, given = {}, ...children) {
  return fill(document.createElementNS(SVG, tag), given, children);
}

function fill(node, given, children) {
  for (const [name, value] of Object.entries(given)) {
    if (value === null || value === undefined || value === false) continue;
    if (name === "text") node.textContent = String(value);
    else if (name === "set") Object.assign(node, value);
    else if (name.startsWith("on")) node.addEventListener(name.slice(2), value);
    else node.setAttribute(name, value === true ? "" : String(value));
  }
  for (const child of children) if (child !== null && child !== undefined && child !== false) node.append(child);
  return node;
}

/**
 * Set a node's text only where it differs, so that readers and selections are left alone.
 * @param {Node} node
 * @param {any} text
 */
export function say(node, text) {
  const wanted = text === null || text === undefined ? "" : String(text);
  if (node.textContent !== wanted) node.textContent = wanted;
}

/**
 * Replace a node's children.
 * @param {Element} node
 * @param {...(Node|string|null|false)} children
 */
export function put(node, ...children) {
  node.replaceChildren(...children.filter((child) => child !== null && child !== false && child !== undefined));
}

/**
 * Make a table with a head, in a frame that scrolls by itself and by keyboard.
 * @param {string} title caption
 * @param {string[]} heads
 * @param {(Node|string|number|null)[][]} rows
 * @param {string} [kind] further class; "cards" becomes cards on a phone
 * @returns {HTMLElement}
 */
export function table(title, heads, rows, kind = "") {
  const cell = (value, index) => {
    const node = h("td", { "data-head": heads[index] });
    node.append(
      value instanceof Node
        ? value
        : document.createTextNode(value === null || value === undefined ? "" : String(value)),
    );
    return node;
  };
  return h(
    "div",
    { class: "scrolls", tabindex: 0, role: "region", "aria-label": title },
    h(
      "table",
      { class: kind },
      h("caption", { text: title }),
      h("thead", {}, h("tr", {}, ...heads.map((head) => h("th", { scope: "col", text: head })))),
      h("tbody", {}, ...rows.map((row) => h("tr", {}, ...row.map(cell)))),
    ),
  );
}

/**
 * Make a labelled field.
 * @param {string} label
 * @param {HTMLElement} input
 * @returns {HTMLElement}
 */
export function field(label, input) {
  input.id ||= `field-${(fields += 1)}`;
  return h("p", { class: "field" }, h("label", { for: input.id, text: label }), input);
}

/**
 * Make a select of [value, text] pairs.
 * @param {[string, string][]} options
 * @param {string} chosen
 * @param {(value: string) => void} onchange
 * @returns {HTMLSelectElement}
 */
export function select(options, chosen, onchange) {
  const node = h(
    "select",
    { onchange: () => onchange(node.value) },
    ...options.map(([value, text]) => h("option", { value, text, selected: value === chosen })),
  );
  return /** @type {HTMLSelectElement} */ (node);
}

/**
 * Make a button.
 * @param {string} text
 * @param {() => void} onclick
 * @param {Object<string, any>} [given]
 * @returns {HTMLElement}
 */
export function button(text, onclick, given = {}) {
  return h("button", { type: "button", text, onclick, ...given });
}

/**
 * Make a panel with its heading.
 * @param {string} title
 * @param {string} kind class of its place
 * @param {...(Node|string)} children
 * @returns {HTMLElement}
 */
export function panel(title, kind, ...children) {
  return h("section", { class: `panel ${kind}`, "aria-label": title }, h("h2", { text: title }), ...children);
}

/**
 * Make a column of panels: beside the others on a wide screen, one below the other on a phone.
 * @param {string} place a, b or c
 * @param {...Node} children
 * @returns {HTMLElement}
 */
export function column(place, ...children) {
  return h("div", { class: `column ${place}` }, ...children);
}
