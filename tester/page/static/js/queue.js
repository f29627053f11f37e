// The queue: what runs, what comes next, why each thing waits; add, move, skip, drop, stand, start.

import { button, field, h, put, say, select } from "./dom.js";
import { local, spell, withU } from "./format.js";

/** States of items that are over. */
const OVER = new Set(["ended", "dropped"]);
const SIGNS = { waiting: "○", skipped: "⤼", starting: "◐", running: "▶", ended: "✓", dropped: "✕" };

/** The view of the queue. */
export class QueueView {
  /** @param {Object} app */
  constructor(app) {
    this.app = app;
    this.title = "Queue";
    this.state = h("p", { class: "queue-state", role: "status" });
    this.ends = h("p", { class: "small" });
    this.list = h("ol", { class: "queue" });
    this.over = h("ol", { class: "queue over" });
    this.buttons = h("p", { class: "buttons" });
    this.limit = h("div", { class: "fields" });
    this.until = h("input", { type: "time", name: "until", id: "queue-until" });
    this.adding = h("div");
    this.night = h("div");
    this.shown = "";
    this.node = h(
      "div",
      { class: "queue-view" },
      h(
        "section",
        { class: "panel", "aria-label": "Queue" },
        h("h2", { text: "Queue" }),
        this.state,
        this.ends,
        this.buttons,
        this.limit,
        this.list,
      ),
      h(
        "section",
        { class: "panel", "aria-label": "Add" },
        h("h2", { text: "Add a recipe" }),
        this.adding,
        this.night,
      ),
      h("section", { class: "panel", "aria-label": "Ended" }, h("h2", { text: "Ended" }), this.over),
    );
  }

  /** Ask for the recipes. */
  async open() {
    this.update(new Set());
    if (this.app.link.role !== "control") {
      put(
        this.adding,
        h("p", { class: "none", text: "This device only looks. Pair it for control to change the queue." }),
      );
      this.#check();
      return;
    }
    const found = await this.app.send({ command: "recipes" });
    const recipes = (found?.recipes ?? []).map((one) => [
      one.path ?? one.name,
      one.name + (one.shipped ? " (shipped)" : ""),
    ]);
    if (!recipes.length) {
      put(this.adding, h("p", { class: "none", text: "The service lists no recipes." }));
      return;
    }
    let recipe = recipes[0][0];
    const copies = h("input", { name: "copies", type: "number", min: 1, max: 50, value: 1 });
    const hours = h("input", { name: "hours", type: "number", min: 0.1, max: 168, step: 0.1, placeholder: "for ever" });
    let unanswered = "stand";
    const operator = h("input", { name: "operator", maxlength: 200 });
    const notes = h("input", { name: "notes", maxlength: 2000 });
    put(
      this.adding,
      h(
        "form",
        {
          class: "fields",
          onsubmit: (event) => {
            event.preventDefault();
            this.#add({
              recipe,
              copies: Number(copies.value) || 1,
              answer_within_s: hours.value ? 3600 * Number(hours.value) : null,
              unanswered,
              operator: operator.value,
              notes: notes.value,
            });
          },
        },
        field(
          "Recipe",
          select(recipes, recipe, (value) => {
            recipe = value;
          }),
        ),
        field("Copies", copies),
        field("A question waits, h", hours),
        field(
          "Without an answer",
          select(
            [
              ["stand", "stop the item; the queue stands"],
              ["skip", "stop the item; go on if the next one needs no person"],
            ],
            unanswered,
            (value) => {
              unanswered = value;
            },
          ),
        ),
        field("Operator", operator),
        field("Notes", notes),
        h("button", { type: "submit", class: "main", text: "Add to the queue" }),
        button("Run now (needs a code)", () =>
          this.app.orders.send(
            { command: "run", recipe, operator: operator.value, notes: notes.value },
            "The run begins",
          ),
        ),
      ),
    );
    this.#check();
  }

  #add(options) {
    return this.app.orders.send({ command: "queue_add", ...options }, "Added; the recipe is frozen as it is now");
  }

  #check() {
    const from = h("input", { type: "time", value: "18:00", name: "from" });
    const to = h("input", { type: "time", value: "08:00", name: "to" });
    const said = h("div", { role: "status", class: "small" });
    put(
      this.night,
      h("h3", { text: "Night check" }),
      h(
        "form",
        {
          class: "fields",
          onsubmit: async (event) => {
            event.preventDefault();
            const found = await this.app.orders.send(
              { command: "queue_check", start: from.value, end: to.value },
              "Checked",
            );
            if (found)
              put(said, ...nightWords(found, this.app.scene.queue?.items ?? []).map((text) => h("p", { text })));
          },
        },
        field("From", from),
        field("To", to),
        h("button", { type: "submit", text: "Until when does it run alone?" }),
      ),
      said,
    );
  }

  /** Draw. */
  update() {
    const { scene, link } = this.app;
    const live = link.connected;
    const key = JSON.stringify([live, link.role, scene.queue, this.app.liveVersion, scene.state?.progress.over]);
    if (key === this.shown) return;
    this.shown = key;
    const queue = live ? scene.queue : null;
    const may = live && link.role === "control";
    const items = queue?.items ?? [];
    const open = items.filter((item) => !OVER.has(item.state));
    const over = items.filter((item) => OVER.has(item.state));
    say(this.state, !live ? link.trouble : !queue ? "The service has no queue." : queue.problem || queue.state);
    const until = queue?.until_utc ? `No item begins that may last beyond ${local(queue.until_utc)}. ` : "";
    say(this.ends, until + (queue?.end_utc && open.length ? endWords(queue) : ""));
    const focused = document.activeElement?.id;
    put(
      this.buttons,
      may && scene.queue
        ? button(
            "Start (needs a code)",
            () => this.app.orders.send({ command: "queue_start", until: this.until.value }, "The queue goes"),
            { class: "main", id: "queue-start" },
          )
        : null,
      may && scene.queue
        ? button(
            "Stand after this item",
            () => this.app.orders.send({ command: "queue_stand" }, "The queue stands; the run under way goes on"),
            { id: "queue-stand" },
          )
        : null,
    );
    put(this.limit, may && scene.queue ? field("Begin no item that may last beyond", this.until) : null);
    put(this.list, ...open.map((item, index) => this.#item(item, index, open, queue.revision, may)));
    put(
      this.over,
      ...(over.length
        ? over
            .slice(-20)
            .reverse()
            .map((item) => this.#item(item, -1, [], 0, false))
        : [h("li", { class: "none", text: "Nothing has ended yet." })]),
    );
    if (focused?.startsWith("queue-")) document.getElementById(focused)?.focus();
  }

  #item(item, index, open, revision, may) {
    const { orders } = this.app;
    const about = [
      `${item.conditions} conditions`,
      spell(item.left_s ?? item.seconds) + (item.left_s === null ? "" : " left"),
      item.start_utc && !OVER.has(item.state) ? `begins ${local(item.start_utc)}` : "",
      item.end_utc ? endWords(item) : item.ended_utc ? `ended ${local(item.ended_utc)}` : "",
      item.asks.length && !OVER.has(item.state) ? `asks a person ${item.asks.length} times` : "",
      item.asks.length && item.unanswered && !OVER.has(item.state)
        ? `is stopped after ${spell(item.unanswered.within_s)} without an answer`
        : "",
      `added by ${item.by} ${local(item.utc)}`,
    ]
      .filter(Boolean)
      .join(", ");
    const why =
      item.reason || (item.state === "waiting" ? (index > 0 ? "waits for the items before it" : "next") : "");
    const act = (command, text, done, label) =>
      button(text, () => orders.send({ ...command, revision }, done), {
        "aria-label": `${label} ${item.name}`,
        id: `queue-${command.command}-${label}-${item.id}`,
      });
    const waits = ["waiting", "skipped"].includes(item.state);
    const movable = open.filter((one) => ["waiting", "skipped"].includes(one.state));
    const at = movable.indexOf(item);
    const buttons =
      may && index >= 0
        ? h(
            "span",
            { class: "buttons" },
            waits && at > 0
              ? act({ command: "queue_move", id: item.id, before: movable[at - 1].id }, "↑", "Moved", "Move up")
              : null,
            waits && at < movable.length - 1
              ? act(
                  { command: "queue_move", id: item.id, before: movable[at + 2]?.id ?? 0 },
                  "↓",
                  "Moved",
                  "Move down",
                )
              : null,
            item.state !== "skipped" ? act({ command: "queue_skip", id: item.id }, "Skip", "Skipped", "Skip") : null,
            waits ? act({ command: "queue_drop", id: item.id }, "Drop", "Dropped", "Drop") : null,
            item.state === "waiting" && item.reason
              ? button(
                  "Agree and start (needs a code)",
                  () => orders.send({ command: "queue_start", agree: [item.id] }, "Agreed; the queue goes"),
                  { id: `queue-agree-${item.id}`, "aria-label": `Agree to ${item.name} and start (needs a code)` },
                )
              : null,
          )
        : null;
    const gave =
      item.run && item.run === this.app.record?.run
        ? this.app.record.conditions.filter((one) => typeof one.mu === "number")
        : [];
    return h(
      "li",
      { class: `item ${item.state}` },
      h("span", { class: "sign", "aria-hidden": "true", text: SIGNS[item.state] ?? "·" }),
      h(
        "div",
        { class: "what" },
        h("strong", { text: item.name }),
        h("span", { class: "word", text: ` ${item.end || item.state}` }),
        why ? h("p", { class: "why", text: why }) : null,
        h("p", { class: "small", text: about }),
        gave.length ? h("p", { class: "small", text: `last: ${gave.at(-1).text}: ${withU(gave.at(-1))}` }) : null,
        item.run
          ? button(
              item.run,
              () => {
                this.app.chosen = item.run;
                this.app.go("map");
              },
              { class: "link" },
            )
          : null,
      ),
      buttons,
    );
  }
}

/** When something ends, with the interval that holds the end in 95 %. */
function endWords({ end_utc, end_low_utc, end_high_utc }) {
  const between = end_low_utc && end_high_utc ? ` (${local(end_low_utc)} to ${local(end_high_utc)}, 95 %)` : "";
  return `ends about ${local(end_utc)}${between}`;
}

/** The check of a night in sentences. */
function nightWords(found, items) {
  const name = (id) => items.find((item) => item.id === id)?.name ?? `item ${id}`;
  const between = `${local(found.alone_low_utc)} to ${local(found.alone_high_utc)}`;
  const until = `${local(found.alone_until_utc)} (${between}, 95 %)`;
  return [
    found.standing,
    found.covered ? `Runs alone the whole time: ${found.because}` : `Runs alone until ${until}: ${found.because}`,
    ...found.needed.map((one) => `${local(one.at_utc)}: a person is needed. ${one.name}: ${one.text}`),
    found.better
      ? `The order ${found.better.order.map(name).join(", ")} would run alone until ` +
        `${local(found.better.alone_until_utc)}, ${spell(found.better.gain_s)} longer`
      : "",
  ].filter(Boolean);
}
