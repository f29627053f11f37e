// The campaign as a grid over two axes of choice, filled as it is measured. State is told by sign, word and colour.

import { field, h, put, say, select } from "./dom.js";
import { STATES, axisText, muText, newestFirst, number, short, sign, uText, withU } from "./format.js";
import { cividis, inkOn } from "./colours.js";
import { ConditionPanel, why } from "./condition.js";

const FILLED = new Set(["done", "doubtful"]);

/** The view: which run, which axes, the grids, one opened condition. */
export class CampaignMap {
  /** @param {Object} app */
  constructor(app) {
    this.app = app;
    this.title = "Campaign map";
    this.run = null;
    this.axes = ["", ""];
    this.choice = h("div", { class: "fields" });
    this.place = h("div", { class: "maps" });
    this.key = h("p", { class: "key" });
    this.about = h("p", { class: "small", role: "status" });
    this.panel = new ConditionPanel(app, () => this.#again());
    this.node = h(
      "div",
      { class: "map-view" },
      h(
        "section",
        { class: "panel", "aria-label": "Campaign map" },
        h("h2", { text: "Campaign map" }),
        this.choice,
        this.about,
        this.place,
        this.key,
      ),
      this.panel.node,
    );
  }

  /** Show the run under way, else the newest stored one. */
  async open() {
    const { runs } = (await this.app.orders.ask("runs", {})) ?? { runs: [] };
    this.names = newestFirst(runs);
    const wanted = this.app.chosen ?? this.app.record?.run ?? this.names[0];
    if (wanted) await this.load(wanted);
    else say(this.about, "No stored run yet.");
  }

  /**
   * Load a run.
   * @param {string} name
   */
  async load(name) {
    const run = await this.app.orders.ask("run", { run: name });
    if (!run) return;
    this.app.chosen = name;
    if (this.run?.run !== name) {
      this.axes = chosenAxes(run);
      this.panel.close();
    }
    this.run = run;
    this.#draw();
  }

  async #again() {
    if (this.run) await this.load(this.run.run);
  }

  /** Follow the run under way. */
  update(changed) {
    if (changed.has("live") && this.run && this.app.live?.run === this.run.run) {
      this.run = this.app.live;
      this.#fill();
    }
  }

  #draw() {
    const { run } = this;
    const all = run.axes.map((axis) => [axis.key, axisText(axis)]);
    const pick = (at) =>
      select(all, this.axes[at], (value) => {
        if (this.axes[1 - at] === value) this.axes[1 - at] = this.axes[at];
        this.axes[at] = value;
        this.#draw();
      });
    const names = [...new Set([run.run, ...(this.names ?? [])])].map((name) => [name, name]);
    put(
      this.choice,
      field(
        "Run",
        select(names, run.run, (value) => this.load(value)),
      ),
      field("Down", pick(0)),
      field("Across", pick(1)),
    );
    this.#fill();
  }

  #fill() {
    const {
      run,
      axes: [down, across],
    } = this;
    const mus = run.conditions.map((one) => one.mu).filter((mu) => typeof mu === "number");
    this.bounds = [Math.min(...mus), Math.max(...mus)];
    const states = {};
    run.conditions.forEach((one) => {
      states[one.state] = (states[one.state] ?? 0) + 1;
    });
    say(
      this.about,
      `${run.recipe}: ${run.conditions.length} conditions. ${Object.entries(states)
        .map(([state, count]) => `${sign(state)[0]} ${count} ${sign(state)[1]}`)
        .join(", ")}`,
    );
    const focused = document.activeElement?.getAttribute?.("data-n");
    put(this.place, ...layers(run, down, across).map((layer) => this.#grid(layer, down, across)));
    put(this.key, ...this.#legend());
    const again = focused && this.place.querySelector(`[data-n="${CSS.escape(focused)}"]`);
    if (again) this.#focus(again);
  }

  #legend() {
    if (!Number.isFinite(this.bounds[0])) return [];
    const steps = Array.from({ length: 12 }, (_none, index) => {
      const node = h("span", { class: "swatch", "aria-hidden": "true" });
      node.style.background = `rgb(${cividis(index / 11).join()})`;
      return node;
    });
    return [
      `µ ${number(this.bounds[0], 2)} `,
      h("span", { class: "ramp" }, ...steps),
      ` ${number(this.bounds[1], 2)}.  ${Object.values(STATES)
        .map((state) => state.join(" "))
        .join("  ")}; in doubt: hatched`,
    ];
  }

  #grid(layer, down, across) {
    const title = (key) => {
      const axis = this.run.axes.find((one) => one.key === key);
      return axis ? axisText(axis) : key;
    };
    const node = h("div", {
      role: "grid",
      class: "map",
      "aria-label": `${layer.text || "All conditions"}: ${title(down)} down, ${title(across)} across`,
      "aria-readonly": "true",
    });
    node.style.setProperty("--columns", String(layer.across.length));
    const head = h(
      "div",
      { role: "row", class: "map-row" },
      h("span", { role: "columnheader", class: "corner", text: `${title(down)} ↓  ${title(across)} →` }),
      ...layer.across.map((value) => h("span", { role: "columnheader", text: short(value) })),
    );
    node.append(
      head,
      ...layer.down.map((value) =>
        h(
          "div",
          { role: "row", class: "map-row" },
          h("span", { role: "rowheader", text: short(value) }),
          ...layer.across.map((other) => this.#cell(layer.cells.get(`${value}\t${other}`))),
        ),
      ),
    );
    const first = node.querySelector('[role="gridcell"]:not(.empty)');
    if (first) first.setAttribute("tabindex", "0");
    node.addEventListener("keydown", (event) => this.#key(event, node));
    return h(
      "figure",
      { class: "map-figure" },
      h("figcaption", { text: layer.text || "All conditions" }),
      h("div", { class: "scrolls-x" }, node),
    );
  }

  #cell(found) {
    if (!found) return h("span", { role: "gridcell", class: "cell empty", "aria-label": "not in this campaign" });
    const one = found.length > 1 ? merged(found) : found[0];
    const [mark, word] = sign(one.state);
    const value = FILLED.has(one.state) && typeof one.mu === "number";
    const node = h(
      "span",
      {
        role: "gridcell",
        class: `cell ${one.state}`,
        tabindex: -1,
        "data-n": one.n,
        "aria-label": inFull(one, found.length),
        onclick: () => {
          this.#focus(node);
          this.panel.open(this.run, one.n);
        },
      },
      h("span", { class: "sign", text: mark + (found.length > 1 ? ` ×${found.length}` : "") }),
      h("span", { class: "value", text: value ? muText(one) : word }),
      value && typeof one.u === "number" ? h("span", { class: "u", text: `± ${uText(one)}` }) : null,
    );
    if (value) {
      const width = this.bounds[1] - this.bounds[0];
      const fill = cividis(width > 0 ? (one.mu - this.bounds[0]) / width : 0.5);
      node.style.setProperty("--fill", `rgb(${fill.join()})`);
      node.style.setProperty("--on", inkOn(fill));
    }
    return node;
  }

  #focus(cell) {
    cell
      .closest('[role="grid"]')
      .querySelectorAll('[tabindex="0"]')
      .forEach((other) => other.setAttribute("tabindex", "-1"));
    cell.setAttribute("tabindex", "0");
    cell.focus();
  }

  #key(event, grid) {
    const rows = [...grid.querySelectorAll('[role="row"]')]
      .slice(1)
      .map((row) => [...row.querySelectorAll('[role="gridcell"]')]);
    const y = rows.findIndex((row) => row.includes(document.activeElement));
    if (y < 0) return;
    const x = rows[y].indexOf(/** @type {HTMLElement} */ (document.activeElement));
    const moves = { ArrowRight: [1, 0], ArrowLeft: [-1, 0], ArrowDown: [0, 1], ArrowUp: [0, -1] };
    let to = null;
    if (event.key in moves) {
      // over empty cells to the next one
      const [dx, dy] = moves[event.key];
      for (let cx = x + dx, cy = y + dy; rows[cy]?.[cx]; cx += dx, cy += dy)
        if (!rows[cy][cx].classList.contains("empty")) {
          to = rows[cy][cx];
          break;
        }
    } else if (event.key === "Home") to = rows[y].find((cell) => !cell.classList.contains("empty"));
    else if (event.key === "End") to = rows[y].findLast((cell) => !cell.classList.contains("empty"));
    else if (event.key === "Enter" || event.key === " ") this.panel.open(this.run, Number(rows[y][x].dataset.n));
    else return;
    event.preventDefault();
    if (to) this.#focus(to);
  }
}

/** A cell's whole text, for readers that see no colour. */
function inFull(one, replicates) {
  const value = typeof one.mu === "number" ? `${withU(one)}, ` : "";
  const more = [why(one), replicates > 1 ? `${replicates} replicates` : ""].filter(Boolean);
  return [`${one.text}: ${value}${sign(one.state)[1]}, ${one.repeats} of ${one.asked} repeats`, ...more].join(", ");
}

/** Of replicates the worst state is shown, and the newest value. */
function merged(list) {
  const worst = ["refused", "missing", "doubtful", "running", "planned", "excluded"].find((state) =>
    list.some((one) => one.state === state),
  );
  const valued = list.filter((one) => typeof one.mu === "number").at(-1) ?? list.at(-1);
  return { ...valued, state: worst ?? valued.state };
}

function values(run, key) {
  const found = [...new Set(run.conditions.map((one) => one.axes[key] ?? ""))];
  return found.every((value) => typeof value === "number") ? found.sort((a, b) => a - b) : found;
}

/**
 * Return the two axes with the most values; compound first where there are several.
 * @param {Object} run
 * @returns {[string, string]}
 */
export function chosenAxes(run) {
  const by = run.axes.map((axis) => axis.key).sort((a, b) => values(run, b).length - values(run, a).length);
  return by.length > 1 ? [by[1], by[0]] : [by[0] ?? "", by[0] ?? ""];
}

/**
 * Return one grid for each combination of the axes that are not chosen.
 * @param {Object} run
 * @param {string} down
 * @param {string} across
 * @returns {{text: string, down: any[], across: any[], cells: Map<string, Object[]>}[]}
 */
export function layers(run, down, across) {
  const others = run.axes.filter(
    (axis) => axis.key !== down && axis.key !== across && values(run, axis.key).length > 1,
  );
  const found = new Map();
  for (const one of run.conditions) {
    const text = others.map((axis) => `${axis.title} ${short(one.axes[axis.key])} ${axis.unit}`.trim()).join(", ");
    if (!found.has(text)) found.set(text, []);
    found.get(text).push(one);
  }
  return [...found].map(([text, conditions]) => {
    const part = { conditions };
    const cells = new Map();
    for (const one of conditions) {
      const at = `${one.axes[down] ?? ""}\t${one.axes[across] ?? ""}`;
      cells.set(at, [...(cells.get(at) ?? []), one]);
    }
    return { text, down: values(part, down), across: values(part, across), cells };
  });
}
