// Results: stored runs found by what is known of them; one run's table, notes, downloads; several laid over each other.

import { button, field, h, put, say, select, table } from "./dom.js";
import { axisText, hms, local, newestFirst, muText, sign, short, uText } from "./format.js";
import { MOST, Overlay } from "./overlay.js";
import { ConditionPanel, why } from "./condition.js";

const FIELDS = [
  ["text", "Any text"],
  ["recipe", "Recipe"],
  ["compound", "Compound"],
  ["person", "Person"],
  ["tag", "Tag"],
];
const STATUSES = [
  ["", "any"],
  ["done", "done"],
  ["incomplete", "incomplete"],
  ["stopped", "stopped"],
  ["tripped", "tripped"],
  ["failed", "failed"],
  ["running", "running"],
  ["interrupted", "interrupted"],
];

/** The view of stored runs. */
export class Results {
  /** @param {Object} app */
  constructor(app) {
    this.app = app;
    this.title = "Results";
    this.chosen = new Set();
    const text = (name, label) => field(label, h("input", { type: "search", name, maxlength: 200 }));
    this.form = h(
      "form",
      {
        class: "fields",
        role: "search",
        onsubmit: (event) => {
          event.preventDefault();
          this.find();
        },
      },
      ...FIELDS.map(([name, label]) => text(name, label)),
      field(
        "Status",
        Object.assign(
          select(STATUSES, "", () => this.find()),
          { name: "status" },
        ),
      ),
      field("From", h("input", { type: "date", name: "from" })),
      field("To", h("input", { type: "date", name: "to" })),
      h("button", { type: "submit", class: "main", text: "Find" }),
    );
    this.note = h("p", { class: "small", role: "status" });
    this.list = h("div");
    this.bar = h("p", { class: "buttons" });
    this.overlay = new Overlay(app);
    this.head = h("h2", { tabindex: -1 });
    this.body = h("div");
    this.one = h("section", { class: "panel one-run", "aria-label": "One run", hidden: true }, this.head, this.body);
    this.condition = new ConditionPanel(app, () => this.run && this.show(this.run));
    this.node = h(
      "div",
      { class: "results" },
      h(
        "section",
        { class: "panel found", "aria-label": "Stored runs" },
        h("h2", { text: "Stored runs" }),
        this.form,
        this.note,
        this.list,
        this.bar,
      ),
      this.overlay.node,
      this.one,
      this.condition.node,
    );
  }

  /** Show what there is. */
  async open() {
    await this.find();
  }

  /** Find runs as the form asks. */
  async find() {
    const wanted = Object.fromEntries(new FormData(/** @type {HTMLFormElement} */ (this.form)));
    say(this.note, "Looking …");
    const found = await this.app.orders.ask("runs", wanted);
    if (!found) say(this.note, "");
    if (!found) return;
    const by = new Map(found.runs.map((run) => [run.run, run]));
    this.runs = newestFirst(found.runs).map((name) => by.get(name));
    for (const name of this.chosen) if (!this.runs.some((run) => run.run === name)) this.chosen.delete(name);
    say(this.note, `${this.runs.length} runs`);
    put(
      this.list,
      table(
        "Stored runs",
        ["overlay", "run", "recipe", "compounds", "status", "values", "person", "began", "tags"],
        this.runs.map((run) => this.#row(run)),
        "cards runs",
      ),
    );
    this.#tally();
  }

  #row(run) {
    const box = /** @type {HTMLInputElement} */ (
      h("input", { type: "checkbox", "aria-label": `Overlay ${run.run}`, set: { checked: this.chosen.has(run.run) } })
    );
    box.addEventListener("change", () => {
      if (box.checked && this.chosen.size >= MOST) {
        box.checked = false;
        this.app.orders.tell(`At most ${MOST} runs over each other: take one out first`, true);
        return;
      }
      if (box.checked) this.chosen.add(run.run);
      else this.chosen.delete(run.run);
      this.#tally();
    });
    return [
      h("label", { class: "tick" }, box),
      button(run.run, () => this.show(run.run), { class: "link" }),
      run.recipe,
      (run.compounds ?? []).join(", "),
      `${run.status}${run.simulated ? ", simulated" : ""}`,
      `${run.values} of ${run.conditions}`,
      run.operator,
      local(run.started_utc),
      (run.tags ?? []).join(", "),
    ];
  }

  #tally() {
    put(
      this.bar,
      button(
        this.chosen.size > 1 ? `Lay ${this.chosen.size} runs over each other` : "Lay runs over each other",
        () => this.overlay.open([...this.chosen]),
        { class: "main", disabled: this.chosen.size === 0 },
      ),
      h("span", { class: "small", text: ` ${this.chosen.size} of at most ${MOST} chosen` }),
    );
  }

  /**
   * Show one run.
   * @param {string} name
   */
  async show(name) {
    const run = await this.app.orders.ask("run", { run: name });
    if (!run) return;
    this.run = name;
    this.app.chosen = name;
    this.one.hidden = false;
    this.condition.close();
    say(this.head, name);
    const several = run.axes.filter(
      (axis) =>
        run.conditions.some((one) => one.axes[axis.key] !== run.conditions[0]?.axes[axis.key]) ||
        axis.key === "compound",
    );
    const rows = run.conditions.map((one) => [
      String(one.n),
      ...several.map((axis) => short(one.axes[axis.key])),
      muText(one),
      uText(one),
      `${one.repeats} of ${one.asked}`,
      `${sign(one.state)[0]} ${sign(one.state)[1]}`,
      why(one),
      button("Repeats", () => this.condition.open(run, one.n), { "aria-label": `Repeats of condition ${one.n}` }),
    ]);
    put(
      this.body,
      h("p", {
        text:
          `${run.recipe}${run.status ? `, ${run.status}` : ""}${run.simulated ? ", simulated rig" : ""}, ` +
          `${hms(run.t1_s - run.t0_s)} of rig time`,
      }),
      h(
        "p",
        { class: "buttons" },
        ...[
          ["csv", "CSV"],
          ["xlsx", "Excel"],
          ["report", "Report"],
        ].map(([what, text]) => button(text, () => this.#download(name, what), { "aria-label": `Download ${text}` })),
        button("Map", () => this.app.go("map")),
        button("Replay", () => this.app.go("replay")),
      ),
      table(
        "Conditions. U: expanded uncertainty, 95 %",
        ["no.", ...several.map((axis) => axisText(axis)), "µ", "U", "valid", "state", "doubt or reason", "open"],
        rows,
        "cards",
      ),
      this.#notes(run),
    );
    this.head.focus();
  }

  #notes(run) {
    const notes = run.notes ?? [];
    const list = notes.length
      ? h(
          "ul",
          {},
          ...notes.map((note) =>
            h(
              "li",
              {},
              h("span", { text: note.text }),
              h("span", { class: "small", text: `  ${note.by ?? ""} ${local(note.utc)}` }),
            ),
          ),
        )
      : h("p", { class: "none", text: "No notes." });
    const tags = h("p", { class: "tags" }, ...(run.tags ?? []).map((tag) => h("span", { class: "tag", text: tag })));
    const text = h("textarea", { rows: 2, maxlength: 2000, name: "note" });
    const words = h("input", { name: "tags", maxlength: 200, value: (run.tags ?? []).join(", ") });
    const form =
      this.app.link.role === "control"
        ? h(
            "form",
            {
              class: "fields",
              onsubmit: async (event) => {
                event.preventDefault();
                const tagged = words.value
                  .split(",")
                  .map((tag) => tag.trim())
                  .filter(Boolean);
                if (
                  await this.app.orders.ask(
                    "note",
                    { run: run.run, text: text.value.trim(), tags: tagged },
                    "On record",
                  )
                )
                  await this.show(run.run);
              },
            },
            field("Note", text),
            field("Tags, with commas", words),
            h("button", { type: "submit", text: "Put on record" }),
          )
        : null;
    return h("div", { class: "notes" }, h("h3", { text: "Notes and tags" }), list, tags, form);
  }

  async #download(run, what) {
    const ticket = await this.app.orders.ask("ticket", { run, what }, "The download begins");
    if (!ticket?.path?.startsWith("/download/")) return;
    const link = h("a", { href: ticket.path, download: "" });
    document.body.append(link);
    link.click();
    link.remove();
  }
}
