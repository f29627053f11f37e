// The machine from the side, with its values where they belong: drawn from the tables that the kind brings.

import { h, put, s, say } from "./dom.js";
import { UNKNOWN, number } from "./format.js";

const FORMS = {
  line: (at) => s("polyline", { points: at.join(" ") }),
  box: ([x, y, width, height, rx]) => s("rect", { x, y, width, height, rx: rx ?? 0 }),
  circle: ([cx, cy, r]) => s("circle", { cx, cy, r }),
  text: ([x, y], text) => s("text", { x, y, text }),
};

/** The drawing; `update` writes the values into it. */
export class RigDrawing {
  constructor() {
    this.node = h("figure", { class: "drawing" });
    this.drawn = null;
    this.values = new Map();
    this.listed = null;
  }

  /**
   * Draw.
   * @param {{drawing: Object|null}} machine
   * @param {Object[]} values of a state; empty: nothing is known
   */
  update(machine, values) {
    const listed = machine.drawing ? null : values.map((value) => value.key).join();
    if (this.drawn !== machine.drawing || this.listed !== listed || !this.node.childElementCount) {
      this.listed = listed;
      this.#make(machine.drawing, values);
    }
    const by = new Map(values.map((value) => [value.key, value]));
    for (const [key, place] of this.values) this.#write(place, by.get(key));
  }

  #write(place, value) {
    say(place.label, value ? value.label : "");
    const good = value && (value.quality === "good" || value.value === null);
    say(
      place.number,
      value ? `${number(value.value, value.decimals)} ${value.unit}${good ? "" : ` (${value.quality})`}` : UNKNOWN,
    );
    say(
      place.wanted,
      value && typeof value.setpoint === "number" ? `set ${number(value.setpoint, value.decimals)}` : "",
    );
    place.node.classList.toggle("absent", !value);
  }

  #make(drawing, values) {
    this.drawn = drawing;
    this.values.clear();
    if (!drawing) {
      // a kind without a drawing: its values as a list
      put(this.node, h("dl", { class: "values" }, ...values.map((value) => this.#row(value.key))));
      return;
    }
    put(
      this.node,
      s(
        "svg",
        { viewBox: `0 0 ${drawing.width} ${drawing.height}`, role: "img", "aria-label": drawing.text },
        ...drawing.shapes.map((shape) => {
          const node = (FORMS[shape.form] ?? FORMS.line)(shape.points, shape.text);
          node.setAttribute("class", `part ${shape.role}`);
          return node;
        }),
        ...drawing.anchors.map((anchor) => this.#anchor(anchor)),
      ),
    );
  }

  #anchor({ key, x, y, side }) {
    const text = (dy, kind) => s("text", { x, y: y + dy, "text-anchor": side, class: kind });
    const place = {
      label: text(-15, "name"),
      number: text(2, "number"),
      wanted: text(18, "wanted"),
      node: s("g", {}),
    };
    place.node.append(place.label, place.number, place.wanted);
    this.values.set(key, place);
    return place.node;
  }

  #row(key) {
    const place = {
      label: h("dt"),
      number: h("dd", { class: "number" }),
      wanted: h("dd", { class: "wanted" }),
      node: h("div"),
    };
    place.node.append(place.label, place.number, place.wanted);
    this.values.set(key, place);
    return place.node;
  }
}
