// The page: one bar, one row of views, the view that is open. State comes from the service, nothing is kept here.

import { h, put, say } from "./dom.js";
import { Link, Refusal } from "./link.js";
import { Scene } from "./scene.js";
import { Bar } from "./bar.js";
import { Alarms } from "./alarms.js";
import { Orders } from "./codes.js";
import { Live } from "./live.js";
import { CampaignMap } from "./map.js";
import { Results } from "./results.js";
import { Replay } from "./replay.js";
import { QueueView } from "./queue.js";
import { Pair, Paired } from "./pairing.js";

/** Events after which the run under way is asked for again: they may have given a value. */
const GIVES = new Set(["repeat", "condition", "run", "step", "trip", "alarm", "hold", "prompt", "wear"]);
/** Shortest time between two such questions, ms. */
const ASK_MS = 1500;

/** Everything together; views get it as `app`. */
class App {
  constructor() {
    this.link = new Link();
    this.scene = new Scene();
    this.told = h("p", { class: "told", role: "status" });
    this.orders = new Orders(this.link, this.told);
    this.bar = new Bar(this.link, this.scene);
    this.alarms = new Alarms(this);
    /** Answer of the query `run` for the run under way or the last one. */
    this.live = null;
    this.liveVersion = 0;
    /** Name of the run that was looked at last. */
    this.chosen = null;
    this.pair = new Pair(this);
    this.views = {
      live: new Live(this),
      map: new CampaignMap(this),
      results: new Results(this),
      replay: new Replay(this),
      queue: new QueueView(this),
      paired: new Paired(this),
    };
    this.tabs = h(
      "nav",
      { "aria-label": "Views" },
      ...Object.entries(this.views).map(([name, view]) => h("a", { href: `#${name}`, text: view.title })),
    );
    this.main = h("main", { id: "main", tabindex: -1 });
    this.skip = h("a", {
      class: "skip",
      href: "#main",
      text: "To the content",
      onclick: (event) => {
        event.preventDefault();
        this.main.focus();
      },
    });
    this.at = null;
    this.changed = new Set(["hello"]);
    this.due = 0;
    this.wanted = false;
    this.asked = -Infinity;
    this.later = 0;
    document.body.append(this.bar.node, this.skip, this.tabs, this.told, this.alarms.node, this.main);
    this.link.addEventListener("change", () => this.#connection());
    this.link.addEventListener("entered", () => this.#show());
    this.link.addEventListener("message", (event) => this.#take(/** @type {CustomEvent} */ (event).detail));
    addEventListener("hashchange", () => this.#show());
    this.link.begin();
    this.#show();
  }

  /**
   * Open a view.
   * @param {string} name
   */
  go(name) {
    if (location.hash === `#${name}`) this.#show();
    else location.hash = name;
  }

  /**
   * Ask; a refusal gives null without a word.
   * @param {string} query
   * @param {Object} more
   * @returns {Promise<any>}
   */
  async quiet(query, more) {
    try {
      return await this.link.ask(query, more);
    } catch (error) {
      if (error instanceof Refusal) return null;
      throw error;
    }
  }

  /**
   * Send a command that changes nothing; a refusal is written down.
   * @param {Object} action
   * @returns {Promise<any>}
   */
  async send(action) {
    try {
      return await this.link.command(action);
    } catch (error) {
      if (!(error instanceof Refusal)) throw error;
      this.orders.tell(`Refused: ${error.message}`, true);
      return null;
    }
  }

  /** The record of the run that the state names; null until it has been asked for. */
  get record() {
    return this.live && this.live.run === this.scene.state?.run?.name ? this.live : null;
  }

  /**
   * Return regions and marks of the run under way: those on record, and events that are newer.
   * @returns {{regions: Object[], marks: Object[]}}
   */
  liveMarks() {
    const live = this.record;
    const last = live?.marks.reduce((high, mark) => Math.max(high, mark.t_s), -1) ?? -1;
    const fresh = this.scene.events
      .filter((event) => event.t_s > last && event.run === this.scene.state?.run?.name)
      .map(({ t_s, kind, text, severity }) => ({ t_s, kind, text, severity }));
    return { regions: live?.regions ?? [], marks: (live?.marks ?? []).concat(fresh) };
  }

  #take(message) {
    const type = this.scene.apply(message);
    this.changed.add(type);
    if (
      type === "hello" ||
      (type === "event" && GIVES.has(message.kind)) ||
      (type === "snapshot" && this.scene.state.run?.name !== this.live?.run)
    )
      this.wanted = true;
    if (this.wanted) this.#askLive();
    this.#draw();
  }

  async #askLive() {
    const name = this.scene.state?.run?.name;
    if (!name || this.later) return;
    const early = ASK_MS - (performance.now() - this.asked);
    if (early > 0) {
      this.later = window.setTimeout(() => {
        this.later = 0;
        this.#askLive();
      }, early);
      return;
    }
    this.wanted = false;
    this.asked = performance.now();
    const run = await this.quiet("run", { run: name });
    if (!run) return;
    this.live = run;
    this.liveVersion += 1;
    this.changed.add("live").add("event");
    this.#draw();
  }

  #connection() {
    this.bar.update();
    if (this.link.status === "pairing" ? this.at !== this.pair : this.at === this.pair || !this.at) this.#show();
    if (this.at === this.pair) this.pair.update();
    this.#draw();
  }

  #show() {
    const pairing = this.link.status === "pairing";
    const name = location.hash.slice(1);
    const view = pairing ? this.pair : (this.views[name] ?? this.views.live);
    this.tabs.hidden = pairing;
    document.body.classList.toggle("pairing", pairing);
    for (const tab of this.tabs.children) {
      if (this.views[tab.getAttribute("href").slice(1)] === view) tab.setAttribute("aria-current", "page");
      else tab.removeAttribute("aria-current");
    }
    if (this.at !== view) {
      this.at?.close?.();
      this.at = view;
      put(this.main, view.node);
    }
    document.title = pairing
      ? "Pair - friction-tester"
      : `${view.title} - ${this.scene.state?.rig ?? "friction-tester"}`;
    if (this.link.status === "entered") view.open?.();
    this.changed.add("hello");
    this.#draw();
  }

  #draw() {
    if (this.due) return;
    this.due = requestAnimationFrame(() => {
      this.due = 0;
      const changed = this.changed;
      this.changed = new Set();
      this.bar.update();
      this.alarms.update();
      document.body.classList.toggle("stale", this.link.status !== "pairing" && !this.link.connected);
      if (this.at && this.at !== this.pair) this.at.update?.(changed);
    });
  }
}

new App();
